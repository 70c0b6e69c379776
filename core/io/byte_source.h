#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <span>

#include "absl/status/status.h"

namespace ccst {

/// Bytes of which a part can be read without the rest, in memory or elsewhere.
struct ByteSource {
  std::int64_t size = 0;
  /// Fills `out` from `offset` on; the range is inside.
  std::function<absl::Status(std::int64_t offset, std::span<char> out)> read;
};

/// The source of bytes in memory, which outlive it.
inline ByteSource SourceOf(std::span<const char> bytes) {
  return {.size = static_cast<std::int64_t>(bytes.size()),
          .read = [bytes](std::int64_t offset, std::span<char> out) {
            const auto part = bytes.subspan(static_cast<std::size_t>(offset), out.size());
            std::copy(part.begin(), part.end(), out.begin());
            return absl::OkStatus();
          }};
}

}  // namespace ccst
