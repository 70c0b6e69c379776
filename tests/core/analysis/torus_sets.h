#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

/// Samples in the unit square that is repeated on all sides, by methods whose figures are known
/// from print, written down as simply as they are.
namespace ccst::torus {

using Points = std::vector<Eigen::Vector2d>;

/// The Voronoi cells of points and the Delaunay triangles between them.
struct Cells {
  std::vector<double> areas;               ///< n.
  Points centroids;                        ///< n, relative to the points.
  std::vector<Eigen::Vector3i> triangles;  ///< Counter-clockwise; corners a step across the border
                                           ///< are those of the nearest copy.
};
/// Every cell by cutting a square at the bisectors. @param points in [0, 1)^2, at least 30 of them.
Cells MakeCells(const Points& points);

/// The difference between two points, by way of the nearest copies.
Eigen::Vector2d Difference(const Eigen::Vector2d& from, const Eigen::Vector2d& to);

/// The triangles with corners of their own, in the plane z = 0: what measures of meshes in space
/// take, but for those over edges.
struct Unrolled {
  std::vector<Eigen::Vector3d> positions;
  std::vector<Eigen::Vector3i> triangles;
};
Unrolled Unroll(const Points& points, const std::vector<Eigen::Vector3i>& triangles);

/// Independent points.
Points WhiteNoise(int count, std::uint64_t seed);
/// Darts at random, accepted where they are at least a radius from all others; the radius is
/// lowered by a thousandth whenever too many darts in a row were in vain. Source: McCool, Fiume,
/// "Hierarchical Poisson disk sampling distributions", Graphics Interface 1992.
Points DartThrowing(int count, std::uint64_t seed);
/// `steps` times every point to the centroid of its cell, from white noise.
Points Lloyd(int count, int steps, std::uint64_t seed);
/// Capacity-constrained Delaunay triangulation from white noise: in each alternation points are
/// moved to where the areas of their triangles are most equal, then the triangulation is made
/// Delaunay. Source: Xu, Liu, Gotsman, Hu, "Capacity-constrained Delaunay triangulation for point
/// distributions", Computers & Graphics 35(3), 2011.
Points Ccdt(int count, int alternations, std::uint64_t seed);

}  // namespace ccst::torus
