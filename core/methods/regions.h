#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/base/interrupt.h"
#include "core/methods/capacity_curve.h"

namespace ccst {

/// The surface cut into regions of equal capacity along its curve, each with one site and `parts`
/// parts of equal capacity: what the methods that improve regions start from. The parts of region
/// k are [k * parts, (k + 1) * parts).
struct Regions {
  std::int64_t parts = 0;
  std::vector<SurfacePoint> sites;              ///< n: one of the region's parts, at random.
  std::vector<Eigen::Vector3d> part_positions;  ///< n * parts x 3: a random point of the part.
  std::vector<std::int32_t> part_faces;         ///< n * parts.
  /// n * parts: capacity times rho, relative to that of the mean part.
  std::vector<float> part_weights;
};

/// Components get regions by largest remainder of their capacities, so one may get none; ties go
/// to the first. Unfinished when `interrupt` was requested. Cost O(n parts log F).
Regions CutRegions(const Density& density, const CapacityCurve& curve, std::int64_t count,
                   std::int64_t parts, std::uint64_t seed, std::uint64_t stream,
                   Interrupt* interrupt);

/// `site` moved towards the centroid of what it owns and back onto the surface; as it is when that
/// would not bring it closer.
SurfacePoint MoveTo(const Surface& surface, const SurfacePoint& site,
                    const Eigen::Vector3d& centroid);

}  // namespace ccst
