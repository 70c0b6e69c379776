#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace ccst {

/// `text` without anything that a terminal obeys or that would end a line of a log: control
/// characters (also those of ISO 6429 beyond ASCII), separators of lines and paragraphs, and marks
/// that turn the direction of writing become escapes as JSON has them, `\n` or `\u001b`; bytes that
/// are no UTF-8 become `\xff`. All else stays as it is, backslashes included. Cost O(size).
/// @param keep  ASCII characters that stay nevertheless, such as line breaks
std::string PrintableText(std::string_view text, std::string_view keep = {});

/// PrintableText(), cut at a whole character or escape so that it has at most `max_bytes` [byte],
/// with `...` where something is missing. `max_bytes` >= 3.
std::string PrintableExcerpt(std::string_view text, std::size_t max_bytes);

}  // namespace ccst
