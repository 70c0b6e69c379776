#include "core/io/text_cursor.h"

namespace ccst::io {
namespace {

bool IsSpace(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }

}  // namespace

std::size_t TextCursor::LineEndAt(std::size_t at) const {
  if (at >= text_.size()) return 0;
  if (text_[at] == '\n') return 1;
  if (text_[at] != '\r') return 0;
  return at + 1 < text_.size() && text_[at + 1] == '\n' ? 2 : 1;
}

std::size_t TextCursor::ContinuationAt(std::size_t at) const {
  if (!syntax_.continuation || at >= text_.size() || text_[at] != '\\') return 0;
  const std::size_t end = LineEndAt(at + 1);
  return end == 0 ? 0 : end + 1;
}

std::string_view TextCursor::TokenOnLine() {
  while (position_ < text_.size()) {
    if (IsSpace(text_[position_])) {
      ++position_;
    } else if (const std::size_t joined = ContinuationAt(position_); joined > 0) {
      position_ += joined;
      ++line_;
    } else {
      break;
    }
  }
  const std::size_t start = position_;
  while (position_ < text_.size()) {
    const char c = text_[position_];
    if (IsSpace(c) || c == '\n' || c == '\r') break;
    if (syntax_.comment != '\0' && c == syntax_.comment) break;
    if (ContinuationAt(position_) > 0) break;
    ++position_;
  }
  return text_.substr(start, position_ - start);
}

std::string_view TextCursor::RestOfLine() {
  const std::size_t start = position_;
  while (position_ < text_.size()) {
    if (const std::size_t joined = ContinuationAt(position_); joined > 0) {
      position_ += joined;
      ++line_;
    } else if (const std::size_t end = LineEndAt(position_); end > 0) {
      const std::string_view rest = text_.substr(start, position_ - start);
      position_ += end;
      ++line_;
      return rest;
    } else {
      ++position_;
    }
  }
  return text_.substr(start);
}

std::string_view TextCursor::Token() {
  while (!AtEnd()) {
    const std::string_view token = TokenOnLine();
    if (!token.empty()) return token;
    SkipLine();
  }
  return {};
}

}  // namespace ccst::io
