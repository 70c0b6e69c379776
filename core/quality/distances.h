#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/base/interrupt.h"
#include "core/parallel/parallel.h"

namespace ccst::quality {

/// r_max = sqrt(2 area / (sqrt(3) count)): the spacing of `count` > 0 points of a hexagonal
/// lattice on `area` [mesh unit].
double HexagonalSpacing(double area, std::int64_t count);

/// Two samples and what lies between them.
struct SamplePair {
  std::int32_t first = -1;  ///< < second; -1 when there is no such pair.
  std::int32_t second = -1;
  double distance = 0.0;  ///< Straight [mesh unit].
};

/// Spacing of samples. Ratios are over r_max.
struct DistanceFigures {
  double r_max = 0.0;                      ///< [mesh unit]
  double relative_radius = 0.0;            ///< Smallest distance of all pairs.
  double relative_radius_same_side = 0.0;  ///< Of pairs with normals less than 90 degrees apart.
  double mean_nearest_distance = 0.0;      ///< Mean distance to the nearest other sample.
  SamplePair closest;                      ///< The pair of relative_radius.
  SamplePair closest_same_side;            ///< The pair of relative_radius_same_side.
  std::vector<double> nearest;             ///< n: distance to the nearest other sample.
};

/// The closest pair on one side, as MeasureDistances() finds it, for a fraction of its cost: what
/// is found bounds every further search.
/// @param normals, scales  as there. Equal distances go to the smaller indices.
/// @param interrupt  may be null; once requested, the pair is the closest of those looked at.
/// Cost O(n log n); the same on any number of threads.
SamplePair FindClosestSameSide(std::span<const Eigen::Vector3d> positions,
                               std::span<const Eigen::Vector3d> normals,
                               std::span<const double> scales = {}, Interrupt* interrupt = nullptr,
                               const Parallel& parallel = Parallel());

/// Measures the spacing of `positions` (n x 3, finite).
/// @param normals       n x 3, those of the host faces; empty: every pair is on the same side.
/// @param area          of the sampled surface, > 0 [mesh unit^2].
/// @param periodic_box  extents of a box whose opposite sides are glued; 0 in a direction means
///                      not periodic there. Extents must exceed twice r_max. With a box,
///                      distances are those of the torus.
/// @param scales        n factors > 0 of the spacing wanted at each point, where that differs;
///                      distances are then divided by the mean of the two ends' factors.
///                      Empty: 1 everywhere.
/// @param interrupt     may be null; once requested, the figures mean nothing.
/// Ratios without a pair (n < 2, or none on the same side) are 0.
/// Cost O(n log n) with a k-d tree; about 0.2 s for n = 1e5. The same on any number of threads.
DistanceFigures MeasureDistances(std::span<const Eigen::Vector3d> positions,
                                 std::span<const Eigen::Vector3d> normals, double area,
                                 const Eigen::Vector3d& periodic_box = Eigen::Vector3d::Zero(),
                                 std::span<const double> scales = {},
                                 const Parallel& parallel = Parallel(),
                                 Interrupt* interrupt = nullptr);

}  // namespace ccst::quality
