#pragma once

#include <span>

#include <Eigen/Core>

namespace ccst::quality {

/// How nearly the neighbours of samples form hexagons: mean over the vertices off the boundary of
/// |sum_j exp(6 i theta_j)| / k, theta_j the directions of the k edges at the vertex, with the
/// angles between them scaled to a full turn. In [0, 1]: 1 for a hexagonal lattice, 0 for
/// regular fans of four or five; 0 without such vertices.
/// @param positions  n x 3 [mesh unit].  @param triangles  m x 3 indices in [0, n), an oriented
/// manifold.  Cost O(m).
/// Source: the local bond-orientational order parameter of Halperin, Nelson, "Theory of
/// two-dimensional melting", Phys. Rev. Lett. 41, 1978.
double MeasureBondOrder(std::span<const Eigen::Vector3d> positions,
                        std::span<const Eigen::Vector3i> triangles);

}  // namespace ccst::quality
