#pragma once

#include <cstdint>
#include <vector>

#include "core/base/interrupt.h"
#include "core/repair/linked_faces.h"

namespace ccst::repair {

/// Gives each fan of faces around a vertex a vertex of its own. Afterwards the faces alone,
/// without the links, say which edges are shared: links that two faces with the same two vertices
/// should not have are undone, and boundary edges that came to have the same vertices are linked.
/// @param[in,out] linked its faces' vertices become fan numbers, dense from 0 in order of first
///        use.
/// @return per fan the vertex it was made of. Nothing that is of use when `interrupt` was
/// requested. Cost O(F log F) whatever the degrees.
std::vector<std::int32_t> SplitFans(LinkedFaces* linked, Interrupt* interrupt);

}  // namespace ccst::repair
