#pragma once

#include <span>

#include <Eigen/Core>

namespace ccst::quality {

/// How evenly the triangles of a sample mesh share the capacity C_t = rho_t * A_t.
struct CapacityFigures {
  double total = 0.0;     ///< [density * mesh unit^2]
  double mean = 0.0;      ///< total / m.
  double smallest = 0.0;  ///< Over the mean, in [0, 1].
  double largest = 0.0;   ///< Over the mean, >= 1.
  double cv = 0.0;        ///< Standard deviation / mean, >= 0.
};

/// Measures the capacities of `triangles` (m x 3 indices into `positions`).
/// @param densities  m values > 0, the mean density over each triangle; empty: uniform, 1.
/// All figures are 0 when the total is.
CapacityFigures MeasureCapacities(std::span<const Eigen::Vector3d> positions,
                                  std::span<const Eigen::Vector3i> triangles,
                                  std::span<const double> densities = {});

/// Sum of the areas of `triangles` [mesh unit^2].
double TotalArea(std::span<const Eigen::Vector3d> positions,
                 std::span<const Eigen::Vector3i> triangles);

}  // namespace ccst::quality
