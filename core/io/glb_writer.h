#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "core/mesh/triangle_mesh.h"

namespace ccst::io {

/// Binary glTF 2.0 with one mesh. Positions are 32-bit floats relative to ChooseOrigin, which
/// becomes the node's translation. Indices of `mesh` must be in range.
/// @errors INVALID_ARGUMENT  MESH_EMPTY no face; MESH_DEGENERATE see ToWirePrecision;
///                           LIMIT_EXCEEDED more than 4 GiB
absl::StatusOr<std::string> EncodeGlb(const TriangleMesh& mesh);

}  // namespace ccst::io
