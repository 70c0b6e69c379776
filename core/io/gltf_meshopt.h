#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "absl/status/statusor.h"

namespace ccst::io {

/// The extension of a buffer view whose bytes are compressed by meshoptimizer.
inline constexpr char kMeshoptExtension[] = "EXT_meshopt_compression";

/// Decodes a buffer view that EXT_meshopt_compression describes: modes ATTRIBUTES, TRIANGLES and
/// INDICES, with any of its filters.
/// @param extension  its JSON; `encoded` are the bytes it names
/// @param max_bytes  that may come out; also no more than meshoptimizer can make of `encoded`
/// @errors INVALID_ARGUMENT  MESH_UNREADABLE | LIMIT_EXCEEDED
absl::StatusOr<std::string> DecodeMeshopt(const nlohmann::json& extension, std::string_view encoded,
                                          std::int64_t max_bytes);

}  // namespace ccst::io
