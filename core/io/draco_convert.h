#pragma once

#include "absl/status/statusor.h"
#include "core/io/mesh_limits.h"
#include "core/mesh/triangle_mesh.h"
#include "draco/mesh/mesh.h"

namespace ccst::io {

/// What DecodeDraco() returns for a mesh that Draco has decoded.
/// @errors INVALID_ARGUMENT  DRACO_DECODE_FAILED, MESH_EMPTY, MESH_DEGENERATE, LIMIT_EXCEEDED
absl::StatusOr<TriangleMesh> FromDraco(const draco::Mesh& mesh, const MeshLimits& limits);

}  // namespace ccst::io
