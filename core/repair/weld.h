#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/base/interrupt.h"
#include "core/parallel/parallel.h"

namespace ccst::repair {

/// Per position the smallest index of those it is joined with (itself when alone). Positions not
/// `used` stay alone. With `tolerance` = 0 equal positions are joined; else, in order of index,
/// each joins the first leader at most `tolerance` away or becomes one. So leaders
/// stay farther apart than the tolerance.
/// @param positions finite. @param tolerance [their unit], >= 0, finite.
/// Unfinished when `interrupt` was requested. Cost O(V log V).
std::vector<std::int32_t> WeldLeaders(const std::vector<Eigen::Vector3d>& positions,
                                      const std::vector<std::uint8_t>& used, double tolerance,
                                      Interrupt* interrupt);

/// Whether no two positions are equal; may be wrong, once in 10^19 pairs, by saying that two are.
/// Positions must be finite. When `interrupt` is requested the answer means nothing.
/// Cost O(V log V), a few times less than WeldLeaders().
bool AllDiffer(const std::vector<Eigen::Vector3d>& positions, const Parallel& parallel,
               Interrupt* interrupt);

}  // namespace ccst::repair
