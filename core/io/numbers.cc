#include "core/io/numbers.h"

#include <charconv>
#include <system_error>

#include <fast_float/fast_float.h>

namespace ccst::io {
namespace {

// Both std::from_chars and fast_float refuse a leading plus, which files do have.
std::string_view WithoutPlus(std::string_view token) {
  if (token.size() > 1 && token[0] == '+' && token[1] != '-' && token[1] != '+') {
    token.remove_prefix(1);
  }
  return token;
}

}  // namespace

std::optional<double> ParseDouble(std::string_view token) {
  token = WithoutPlus(token);
  double value = 0.0;
  const char* const end = token.data() + token.size();
  const auto [stop, error] = fast_float::from_chars(token.data(), end, value);
  // Out of range leaves infinity or zero, the nearest there is; that is no syntax error.
  if (stop != end || (error != std::errc() && error != std::errc::result_out_of_range)) {
    return std::nullopt;
  }
  return value;
}

std::optional<std::int64_t> ParseInteger(std::string_view token) {
  token = WithoutPlus(token);
  std::int64_t value = 0;
  const char* const end = token.data() + token.size();
  const auto [stop, error] = std::from_chars(token.data(), end, value);
  if (stop != end || error != std::errc()) return std::nullopt;
  return value;
}

void AppendDouble(std::string& out, double value) {
  char buffer[32];
  const auto result = std::to_chars(buffer, buffer + sizeof(buffer), value);
  out.append(buffer, result.ptr);
}

void AppendFloat(std::string& out, float value) {
  char buffer[32];
  const auto result = std::to_chars(buffer, buffer + sizeof(buffer), value);
  out.append(buffer, result.ptr);
}

void AppendInteger(std::string& out, std::int64_t value) {
  char buffer[24];
  const auto result = std::to_chars(buffer, buffer + sizeof(buffer), value);
  out.append(buffer, result.ptr);
}

std::string Quoted(std::string_view token) {
  constexpr std::size_t kMaxShown = 40;
  std::string result = "'";
  for (const char c : token.substr(0, kMaxShown)) {
    result += c >= 0x20 && c < 0x7f ? c : '?';
  }
  if (token.size() > kMaxShown) result += "...";
  result += '\'';
  return result;
}

}  // namespace ccst::io
