#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"

namespace ccst::io {

/// Whether `bytes` begin as a file compressed by gzip does; no mesh format does.
bool IsGzip(std::string_view bytes);

/// What a file compressed by gzip holds; of several, one behind the other, all.
/// @param max_bytes  the most that may come out
/// @errors INVALID_ARGUMENT  MESH_UNREADABLE damaged or cut off; LIMIT_EXCEEDED
absl::StatusOr<std::string> DecompressGzip(std::string_view bytes, std::int64_t max_bytes);

}  // namespace ccst::io
