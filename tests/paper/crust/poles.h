#pragma once

#include <vector>

#include <Eigen/Core>

#include "absl/status/statusor.h"

namespace ccst {

/// The poles of a set of points, as parallel arrays.
struct Poles {
  std::vector<Eigen::Vector3d> places;  ///< Up to 2 N; of those at about one place, one.
  std::vector<Eigen::Vector3d> first;   ///< N x 3 unit: from the point to its first pole, or the
                                        ///< hull's normal there where that lies at infinity.
  std::vector<Eigen::Vector3d> second;  ///< N x 3 unit: to its second pole; zero without one.
};

/// The first pole of a point is the vertex of its Voronoi cell farthest away, the second the
/// farthest on the other side. Four points in one plane must not occur, but for rounding: nothing
/// says where the ball through them is. InGeneralPosition() sees to that.
/// @errors as DelaunayTetrahedra().
absl::StatusOr<Poles> FindPoles(const std::vector<Eigen::Vector3d>& points);

}  // namespace ccst
