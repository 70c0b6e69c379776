#pragma once

#include "core/mesh/triangle_mesh.h"

namespace ccst::io {

/// Draco's decoder refuses sequential streams with more vertices than corners. Such a mesh
/// without the vertices of no face, the others in their order; any other as it is. Indices must
/// be in range. Cost O(V + F).
TriangleMesh WithoutExcessVertices(TriangleMesh mesh);

}  // namespace ccst::io
