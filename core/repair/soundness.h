#pragma once

#include <cstdint>
#include <vector>

#include "core/base/interrupt.h"
#include "core/mesh/triangle_mesh.h"
#include "core/parallel/parallel.h"
#include "core/repair/geometry.h"

namespace ccst::repair {

/// Whether there is nothing to repair: every vertex is used, no two positions are equal, every
/// face has an area, no two have the same vertices, no edge has more than two faces or two that run
/// the same way, every vertex has one fan. Most meshes are like that, and finding it out is cheaper
/// than repairing.
/// @param mesh  finite, indices in range. @param used  per vertex: a face uses it.
/// @return false, too, when `interrupt` is requested.
/// Cost O((V + F) log F), about 70 bytes a face.
bool IsSound(const TriangleMesh& mesh, const std::vector<std::uint8_t>& used,
             const Geometry& geometry, const Parallel& parallel, Interrupt* interrupt);

}  // namespace ccst::repair
