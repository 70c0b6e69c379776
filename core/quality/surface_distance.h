#pragma once

#include <cstdint>
#include <span>

#include <Eigen/Core>

#include "core/mesh/triangle_mesh.h"
#include "core/parallel/parallel.h"
#include "core/quality/triangle_tree.h"

namespace ccst::quality {

/// Distances of one surface from another: largest and root mean square over its area.
struct OneSidedDistance {
  double largest = 0.0;  ///< [mesh unit]
  double rms = 0.0;      ///< [mesh unit]
};

/// Distance between a surface and a sample mesh [mesh unit].
struct SurfaceDistanceFigures {
  OneSidedDistance surface_to_samples;
  OneSidedDistance samples_to_surface;
  double hausdorff = 0.0;  ///< The larger of the two largest.
  double rms = 0.0;        ///< The larger of the two.
};

/// Largest distance of `points` from the triangles of `surface` [mesh unit]; exact.
double LargestDistance(std::span<const Eigen::Vector3d> points, const TriangleTree& surface);

/// Hausdorff distance both ways between `surface` and the sample mesh.
///
/// Point-to-triangle distances are exact; where they are taken is the approximation:
/// - surface to sample mesh: at the surface's vertices and on every face in rows parallel to its
///   longest side, `spacing` apart at most. Distance is 1-Lipschitz, so the largest is
///   underestimated by less than `spacing`;
/// - sample mesh to surface: at vertices, edge midpoints and centroids. For each triangle the
///   deviation is underestimated by at most a third of its longest side; on a curved surface
///   it is largest near these points.
/// @param surface_tree  over `surface.faces`.
/// @param positions     n x 3 samples.  @param triangles  m x 3 indices in [0, n), m > 0.
/// @param spacing       > 0 [mesh unit]; 0: the square root of area / 1e5, or more where needles
///                      would get more than 2e7 points.
/// Cost O((area / spacing^2 + F + m) log(F + m)); the same bits on any number of threads.
SurfaceDistanceFigures MeasureSurfaceDistance(const TriangleMesh& surface,
                                              const TriangleTree& surface_tree,
                                              std::span<const Eigen::Vector3d> positions,
                                              std::span<const Eigen::Vector3i> triangles,
                                              double spacing = 0.0,
                                              const Parallel& parallel = Parallel());

}  // namespace ccst::quality
