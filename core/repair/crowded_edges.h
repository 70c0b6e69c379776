#pragma once

#include "core/repair/edge_links.h"
#include "core/repair/geometry.h"
#include "core/repair/linked_faces.h"
#include "core/repair/orientation.h"

namespace ccst::repair {

/// Links pairs of faces at each crowded edge: those that agree in orientation first, then those
/// that do once a whole piece is turned over; flattest first, the convex of equals, then the
/// smaller indices. Updates the flips so that they agree along the new links. `pieces` becomes
/// stale. Cost O(k log k) at an edge of k faces: of more than 16 faces each looks at the 16 next
/// to its flat continuation. Unfinished when `interrupt` was requested.
void LinkCrowdedEdges(const Geometry& geometry, const CrowdedEdges& crowded,
                      Orientation* orientation, LinkedFaces* linked, Interrupt* interrupt);

}  // namespace ccst::repair
