#include "core/base/printable_text.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <utility>

namespace ccst {
namespace {

constexpr std::string_view kEllipsis = "...";

// A character of UTF-8 and its length in bytes; length 0 where the text begins with none.
struct Character {
  std::uint32_t code = 0;
  std::size_t size = 0;
};

// `text` is not empty.
Character FirstOf(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const std::uint32_t lead = byte(0);
  if (lead < 0x80) return {lead, 1};
  const std::size_t size = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
  if (lead < 0xC2 || lead > 0xF4 || text.size() < size) return {};
  std::uint32_t code = lead & (0x7FU >> size);
  for (std::size_t i = 1; i < size; ++i) {
    if ((byte(i) & 0xC0U) != 0x80) return {};
    code = code << 6 | (byte(i) & 0x3FU);
  }
  // Longer than need be, half of a pair of UTF-16, or beyond Unicode.
  constexpr std::array<std::uint32_t, 5> kSmallest = {0, 0, 0x80, 0x800, 0x10000};
  const bool is_surrogate = code >= 0xD800 && code <= 0xDFFF;
  if (code < kSmallest[size] || is_surrogate || code > 0x10FFFF) return {};
  return {code, size};
}

bool IsObeyed(std::uint32_t code) {
  const bool is_control = code < 0x20 || (code >= 0x7F && code <= 0x9F);
  const bool separates = code == 0x2028 || code == 0x2029;
  const bool turns = code == 0x061C || code == 0x200E || code == 0x200F ||
                     (code >= 0x202A && code <= 0x202E) || (code >= 0x2066 && code <= 0x2069);
  return is_control || separates || turns;
}

std::string Escape(const char* format, std::uint32_t value) {
  std::array<char, 16> text;
  std::snprintf(text.data(), text.size(), format, value);
  return text.data();
}

std::string EscapeOf(std::uint32_t code) {
  constexpr std::array<std::pair<std::uint32_t, const char*>, 3> kShort = {
      {{'\n', "\\n"}, {'\r', "\\r"}, {'\t', "\\t"}}};
  for (const auto& [known, escape] : kShort) {
    if (code == known) return escape;
  }
  return Escape("\\u%04x", code);
}

// Takes the next character off `text`, which is not empty, and says how it is shown.
std::string TakeNext(std::string_view& text, std::string_view keep) {
  const Character next = FirstOf(text);
  const std::string_view bytes = text.substr(0, std::max<std::size_t>(1, next.size));
  text.remove_prefix(bytes.size());
  if (next.size == 0) return Escape("\\x%02x", static_cast<unsigned char>(bytes.front()));
  if (!IsObeyed(next.code) || keep.find(bytes) != std::string_view::npos) return std::string(bytes);
  return EscapeOf(next.code);
}

}  // namespace

std::string PrintableText(std::string_view text, std::string_view keep) {
  std::string shown;
  shown.reserve(text.size());
  while (!text.empty()) shown += TakeNext(text, keep);
  return shown;
}

std::string PrintableExcerpt(std::string_view text, std::size_t max_bytes) {
  std::string shown;
  std::size_t whole = 0;  // Of `shown`, that leave room for the ellipsis.
  while (!text.empty()) {
    shown += TakeNext(text, {});
    if (shown.size() > max_bytes) return shown.substr(0, whole) + std::string(kEllipsis);
    if (shown.size() + kEllipsis.size() <= max_bytes) whole = shown.size();
  }
  return shown;
}

}  // namespace ccst
