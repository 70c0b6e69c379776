#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/base/interrupt.h"
#include "core/parallel/parallel.h"

namespace ccst::internal {

/// An order of the samples in which every prefix is well spread: the samples of a prefix of p are
/// apart by about 0.45 r_max(p) or more, where all of them are apart by 0.65 r_max(n).
/// Darts are thrown at the samples themselves, in a random order, with a radius that shrinks in
/// steps; the last, which no radius separates any more, follow in that order.
/// @param positions  n x 3.
/// @param normals    n x 3 unit; samples are compared with those on their side only.
/// @param scales     n factors of the spacing wanted at each; empty: 1.
/// @param r_max      the hexagonal spacing of all n where the factor is 1.
/// @return a permutation: entry k is the sample that comes k-th; part of it when `interrupt` was
///         requested; the same on any number of threads. Cost O(n log n), little of it for the
///         sorting.
/// Source: the nested sets of McCool and Fiume, "Hierarchical Poisson disk sampling
/// distributions", Graphics Interface 1992.
std::vector<std::int32_t> ProgressiveOrder(std::span<const Eigen::Vector3d> positions,
                                           std::span<const Eigen::Vector3d> normals,
                                           std::span<const double> scales, double r_max,
                                           std::uint64_t seed, Interrupt* interrupt,
                                           const Parallel& parallel = Parallel());

}  // namespace ccst::internal
