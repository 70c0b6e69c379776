#pragma once

#include <cstdint>
#include <vector>

#include "core/base/interrupt.h"
#include "core/repair/geometry.h"
#include "core/repair/linked_faces.h"

namespace ccst::repair {

/// Which faces are to be turned over.
struct Orientation {
  std::vector<std::uint8_t> flips;   ///< F.
  std::vector<std::int32_t> pieces;  ///< F: pieces connected by links, numbered from 0.
  std::int32_t piece_count = 0;
};

/// Orients what is linked: as few faces turned over in a piece as can be. Links that contradict
/// every orientation are undone: where the input breaks already, unless a cut elsewhere is shorter.
/// @param[out] cuts how many were undone. Unfinished when `interrupt` was requested. Cost O(F).
Orientation OrientAlongLinks(LinkedFaces* linked, std::int64_t* cuts, Interrupt* interrupt);

/// Given flips that agree along every link: turns whole pieces so that most faces stay as they
/// are; of equals a closed piece gets the positive volume, another keeps its first face.
/// Then applies the flips to `linked` and clears them.
/// @param positions_of per vertex of `linked` its vertex in `geometry`. @return faces turned over.
/// Unfinished when `interrupt` was requested.
std::int64_t ApplyOrientation(const Geometry& geometry,
                              const std::vector<std::int32_t>& positions_of,
                              Orientation* orientation, LinkedFaces* linked, Interrupt* interrupt);

}  // namespace ccst::repair
