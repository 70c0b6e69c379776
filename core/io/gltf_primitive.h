#pragma once

#include <map>
#include <string>

#include <nlohmann/json.hpp>

#include "absl/status/statusor.h"
#include "core/io/gltf_document.h"
#include "core/io/mesh_limits.h"
#include "core/mesh/triangle_mesh.h"

namespace ccst::io {

/// The extension of a primitive whose numbers are in a Draco stream.
inline constexpr char kDracoExtension[] = "KHR_draco_mesh_compression";

/// Counts of what primitives have that is passed over, by name, for people.
using GltfIgnored = std::map<std::string, std::int64_t>;

/// Reads a primitive of triangles, or of a strip or a fan of them; empty for points and lines,
/// which are counted in `ignored`, as are morph targets and attributes that cannot be read.
/// Positions are as stored, attributes named by their keys. Texture coordinates are moved by the
/// KHR_texture_transform of the base colour texture, so that an image belongs to them as they are.
/// @errors INVALID_ARGUMENT  MESH_UNREADABLE | DRACO_DECODE_FAILED | MESH_DEGENERATE |
///                           LIMIT_EXCEEDED
/// @throws nlohmann::json::exception where a value has another type than it needs
absl::StatusOr<TriangleMesh> ReadGltfPrimitive(const GltfDocument& document,
                                               const nlohmann::json& primitive,
                                               const MeshLimits& limits, GltfIgnored& ignored);

}  // namespace ccst::io
