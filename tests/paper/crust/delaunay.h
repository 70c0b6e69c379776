#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "absl/status/statusor.h"

namespace ccst {

/// The Delaunay tetrahedra of `points` (N x 3 [any unit], N >= 5, not all in one plane) as indices
/// into them, in no promised order or orientation. Qhull moves each point by some rounding errors
/// to break ties, always in the same way.
/// @errors INVALID_ARGUMENT MESH_DEGENERATE: fewer than 5 points, one that is not finite, or Qhull
///         finds no tetrahedra.
/// Cost O(N log N) expected for points on a surface. Source: Barber, Dobkin, Huhdanpaa, "The
/// Quickhull algorithm for convex hulls", ACM TOMS 22(4), 1996.
absl::StatusOr<std::vector<std::array<std::int32_t, 4>>> DelaunayTetrahedra(
    const std::vector<Eigen::Vector3d>& points);

}  // namespace ccst
