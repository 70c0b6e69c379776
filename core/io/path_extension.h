#pragma once

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <optional>
#include <string_view>
#include <utility>

namespace ccst::io {

/// The value whose extension (lowercase, with its dot) `path` has, in any case.
template <typename T, std::size_t kSize>
std::optional<T> FindByExtension(
    std::string_view path, const std::array<std::pair<std::string_view, T>, kSize>& extensions) {
  for (const auto& [extension, value] : extensions) {
    if (path.size() < extension.size()) continue;
    const std::string_view end = path.substr(path.size() - extension.size());
    if (std::equal(end.begin(), end.end(), extension.begin(), [](char a, char b) {
          return std::tolower(static_cast<unsigned char>(a)) == b;
        })) {
      return value;
    }
  }
  return std::nullopt;
}

}  // namespace ccst::io
