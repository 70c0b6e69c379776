#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/base/interrupt.h"
#include "core/methods/capacity_curve.h"
#include "core/spatial/box_tree.h"

namespace ccst {

/// White noise on a surface from which a method chooses its samples: parallel arrays in spatial
/// order, and a tree over them.
struct Cloud {
  std::vector<Eigen::Vector3d> positions;  ///< N x 3.
  std::vector<std::int32_t> faces;         ///< N.
  std::vector<double> capacities;          ///< N: where on the curve, which has the host.
  std::vector<float> spacings;             ///< N: r_max / sqrt(rho) for the samples to come.
  std::vector<std::int32_t> draws;         ///< N: the points in the order in which they were drawn.
  BoxTree tree;
};

/// Draws `size` independent points for a method that will keep `count` of them. Unfinished when
/// `interrupt` was requested. Cost O(N log N).
void DrawCloud(const Surface& surface, const Density& density, const CapacityCurve& curve,
               std::int64_t size, std::int64_t count, std::uint64_t seed, std::uint64_t stream,
               Interrupt* interrupt, Cloud* cloud);

}  // namespace ccst
