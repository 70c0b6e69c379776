#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/base/interrupt.h"
#include "core/parallel/parallel.h"

namespace ccst {

/// The order of `positions` (N x 3, in [-1/2, 1/2]^3; others count as on its border) along the
/// Hilbert curve of order 16: element k is the index of the k-th point. Points of one cell keep
/// their order. Unfinished when `interrupt` was requested. Cost O(N log N); the same on any number
/// of threads.
std::vector<std::int32_t> HilbertOrder(const std::vector<Eigen::Vector3d>& positions,
                                       Interrupt* interrupt, const Parallel& parallel = Parallel());

}  // namespace ccst
