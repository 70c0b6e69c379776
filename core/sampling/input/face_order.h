#pragma once

#include "core/base/interrupt.h"
#include "core/parallel/parallel.h"
#include "core/repair/repair.h"

namespace ccst::internal {

/// Renumbers the faces along the Hilbert curve through their centroids and the vertices as those
/// use them first, so that what is near on the surface is near in memory. Of a mesh with one set of
/// positions it depends on the order of faces and vertices in the input only where centroids share
/// a cell of the curve. When `interrupt` was requested, the mesh is none any more. Cost O(F log F).
void SortFaces(RepairedMesh* repaired, Interrupt* interrupt, const Parallel& parallel = Parallel());

}  // namespace ccst::internal
