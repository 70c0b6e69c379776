#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/base/interrupt.h"
#include "core/repair/geometry.h"
#include "core/repair/linked_faces.h"

namespace ccst::repair {

/// Edges of three or more faces, as lists of slots: edge i has slots[start[i] .. start[i + 1]).
struct CrowdedEdges {
  std::vector<std::int32_t> slots;
  std::vector<std::int32_t> start = {0};
  bool any = false;  ///< Whether there were such edges, listed here or not.
  std::size_t count() const { return start.size() - 1; }
};

/// Drops faces whose vertices are those of an earlier face. @return how many. Unfinished when
/// `interrupt` was requested, as what follows.
/// Cost O(F log F).
std::int64_t DropDuplicates(LinkedFaces* linked, std::int64_t vertex_count, Interrupt* interrupt);

/// Drops slivers (height under 1e-7 of the longest side, or within rounding to floats) that hang on
/// an edge of three or more faces and on nothing else: what exporters leave of a T-junction that
/// was closed otherwise. At least two faces of the edge stay. Links are not looked at, and wrong
/// afterwards where it dropped any. @return how many.
std::int64_t DropHangingSlivers(const Geometry& geometry, LinkedFaces* linked,
                                std::int64_t vertex_count, Interrupt* interrupt);

/// Fills `linked->links` for edges of two faces, and for those pairs at other edges that are
/// the only two faces there which name the same vertices of the input.
/// @return what is left at edges of more faces: two slots or more each.
CrowdedEdges LinkPlainEdges(const std::vector<Eigen::Vector3i>& input_faces,
                            const std::vector<std::int32_t>& leaders, LinkedFaces* linked,
                            Interrupt* interrupt);

}  // namespace ccst::repair
