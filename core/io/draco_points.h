#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/mesh/triangle_mesh.h"

namespace ccst::io {

/// The points of a mesh in a sequential Draco stream, which has one value a point for positions as
/// for all else: every vertex in its order, in several points where its corners differ in an
/// attribute.
struct DracoPoints {
  std::vector<std::int32_t> vertex;  ///< P, not decreasing.
  std::vector<std::int64_t> corner;  ///< P: a corner (3 f + k) there; -1 for vertices of no face.
  std::vector<std::uint32_t> of_corner;  ///< 3 F: the point of each corner.

  std::size_t count() const { return vertex.size(); }
};

/// Cost O(F log F) when attributes have values by corner, O(V + F) otherwise. Indices must be in
/// range and attributes of the right size.
DracoPoints SplitIntoPoints(const TriangleMesh& mesh);

/// What remains of a mesh that went through a Draco stream, apart from rounding. Attributes get fit
/// names and their number in the stream, and have values by corner only where the corners of a
/// vertex differ. Draco's decoder refuses sequential streams with more points than corners: then
/// vertices of no face are left out, the others keep their order.
/// Indices must be in range and attributes of the right size.
TriangleMesh ToStreamLayout(TriangleMesh mesh);

}  // namespace ccst::io
