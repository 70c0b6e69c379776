#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace ccst::io {

/// Walks over text token by token and knows the line it is on. Lines end with LF, CR LF or CR;
/// other white space separates tokens.
class TextCursor {
 public:
  struct Syntax {
    char comment = '\0';        ///< From here to the end of the line is no token.
    bool continuation = false;  ///< A backslash before a line's end joins it to the next.
  };

  TextCursor(std::string_view text, Syntax syntax) : text_(text), syntax_(syntax) {}

  /// The next token of this line; empty at its end, which is not passed.
  std::string_view TokenOnLine();

  /// The next token on this line or a later one; empty at the end of the text.
  std::string_view Token();

  /// What is left of this line, comments included, and moves to the next one.
  std::string_view RestOfLine();

  /// Moves to the start of the next line.
  void SkipLine() { RestOfLine(); }

  bool AtEnd() const { return position_ >= text_.size(); }
  std::size_t position() const { return position_; }
  std::size_t remaining() const { return text_.size() - position_; }

  /// Of the token read last, counted from 1.
  std::int64_t line() const { return line_; }
  /// For messages: `line 17`.
  std::string Where() const { return "line " + std::to_string(line_); }

 private:
  // Length of the line end at `at`: 0, 1 or 2.
  std::size_t LineEndAt(std::size_t at) const;
  // Length of a joined line end at `at`, backslash included: 0, 2 or 3.
  std::size_t ContinuationAt(std::size_t at) const;

  std::string_view text_;
  Syntax syntax_;
  std::size_t position_ = 0;
  std::int64_t line_ = 1;
};

}  // namespace ccst::io
