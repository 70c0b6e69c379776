#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "core/mesh/triangle_mesh.h"

namespace ccst::io {

/// Binary glTF 2.0 with one mesh; of points where there are no faces. Positions are 32-bit floats
/// relative to ChooseOrigin, which becomes the node's translation.
///
/// Attributes become COLOR_0, COLOR_1..., TEXCOORD_0... with v counted from above, and `_NAME`, all
/// as floats, of which glTF wants those that are not finite to be zero. Vertices whose corners
/// differ become several. Indices of `mesh` must be in range and attributes of the right size.
/// @errors INVALID_ARGUMENT  MESH_EMPTY no vertex; MESH_DEGENERATE see ToFloatPositions();
///                           LIMIT_EXCEEDED more than 4 GiB
absl::StatusOr<std::string> EncodeGlb(const TriangleMesh& mesh);

}  // namespace ccst::io
