#pragma once

#include <cstdint>
#include <vector>

#include "core/base/interrupt.h"
#include "core/repair/geometry.h"
#include "core/repair/linked_faces.h"

namespace ccst::repair {

/// What RemoveZeroArea() did.
struct ZeroAreaReport {
  std::int64_t removed = 0;  ///< Faces dropped or replaced.
  std::int64_t splits = 0;   ///< Neighbours cut in two in their place.
};

/// Rids an oriented manifold of faces without area where no crack opens: pieces of nothing else
/// and faces that hang on one edge are dropped; so is one whose long side is boundary and whose
/// middle vertex is not; a middle vertex on the side of a neighbour splits that neighbour. Needles
/// (two corners at nearly the same place) stay.
/// @param[in,out] linked faces by fan. @param positions_of per fan its vertex in `geometry`.
/// Unfinished when `interrupt` was requested.
/// Cost O(F) where there is no such face.
ZeroAreaReport RemoveZeroArea(const Geometry& geometry,
                              const std::vector<std::int32_t>& positions_of, LinkedFaces* linked,
                              Interrupt* interrupt);

}  // namespace ccst::repair
