#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

namespace ccst::quality {

/// What the Voronoi cells of samples hold, by their triangulation: the cells between the centres of
/// the triangles' circles, (1/8) sum_j (cot alpha_ij + cot beta_ij) |x_i - x_j|^2. Exact in the
/// plane where the triangulation is Delaunay, and on any mesh of triangles intrinsically so.
/// @param positions  n x 3 [mesh unit].  @param triangles  m x 3 indices in [0, n).
/// @param densities  m values > 0, the mean density over each triangle; empty: 1.
/// @return capacities of the cells of the vertices off the boundary [density * mesh unit^2], in
/// their order. Triangles without area are left out. Cost O(m).
/// Source: Meyer, Desbrun, Schroeder, Barr, "Discrete differential-geometry operators for
/// triangulated 2-manifolds", VisMath 2002, section 3.3.
std::vector<double> VoronoiCellCapacities(std::span<const Eigen::Vector3d> positions,
                                          std::span<const Eigen::Vector3i> triangles,
                                          std::span<const double> densities = {});

/// Standard deviation over mean of VoronoiCellCapacities(), >= 0; 0 without cells.
double MeasureVoronoiVariation(std::span<const Eigen::Vector3d> positions,
                               std::span<const Eigen::Vector3i> triangles,
                               std::span<const double> densities = {});

}  // namespace ccst::quality
