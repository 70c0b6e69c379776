#pragma once

#include <cstdint>
#include <vector>

#include "core/base/interrupt.h"
#include "core/surface/surface.h"

namespace ccst::internal {

/// A sharp line of the surface between two corners, or a closed one without any.
struct Crease {
  std::vector<std::int32_t> half_edges;  ///< In walking order; of the two at each edge one.
  bool closed = false;
  std::int32_t component = 0;
};

/// Finds the edges at which the faces turn by more than `angle` [rad], in (0, pi), as lines from
/// corner to corner. Corners are vertices where not exactly two such edges meet, where the line
/// turns by more than 45 degrees, and those on a boundary. Connected lines that are shorter than
/// `least_length` altogether are left out: they are noise, not shape. Unfinished when `interrupt`,
/// which may be null, was requested.
/// Cost O(F).
std::vector<Crease> FindCreases(const Surface& surface, double angle, double least_length,
                                Interrupt* interrupt = nullptr);

}  // namespace ccst::internal
