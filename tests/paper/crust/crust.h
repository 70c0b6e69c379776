#pragma once

#include <numbers>
#include <vector>

#include <Eigen/Core>

#include "absl/status/statusor.h"

namespace ccst {

struct CrustOptions {
  /// Largest angle between a triangle's normal and the pole directions at the corner of its largest
  /// angle [rad], in (0, pi / 2]; at the other corners one and a half times as much.
  double normal_filter = 50.0 * std::numbers::pi / 180.0;
  /// Edges of one triangle are sharp, as the paper has it for closed surfaces: everything around a
  /// hole falls, from there everything around what fell, to the end. Else a hole stays one.
  bool trim_holes = true;
};

/// What the Crust algorithm makes of points alone.
struct Crust {
  /// m x 3 indices of points, outwards. Whether they are a manifold through all points is for the
  /// caller to see; core/quality/mesh_topology.h does.
  std::vector<Eigen::Vector3i> triangles;
  std::size_t candidates = 0;  ///< Triangles of the crust before any was left out.
  std::size_t filtered = 0;    ///< Left after the filter of normals.
  std::size_t trimmed = 0;     ///< Left after trimming.
};

/// `points` moved by less than 1e-7 of the diagonal of their box, always in the same way. Samples
/// of a mesh lie by fours in one plane, wherever a face holds that many: there balls through four
/// points, which of them are on the convex hull, and the order of triangles around an edge would be
/// what rounding makes of them.
std::vector<Eigen::Vector3d> InGeneralPosition(std::vector<Eigen::Vector3d> points);

/// Reconstructs a surface from `points` (N x 3 [any unit], all different): the Delaunay triangles
/// of the points and their poles whose corners are all points, filtered by normals, trimmed of
/// sharp edges, and of what remains the outside of each connected piece. Works on
/// InGeneralPosition(points).
///
/// This is the start that the paper of CCST names (section 3.2), here to compare with: the sampler
/// does not use it. It needs points dense beside the distance to the medial axis; white noise is
/// not, where a surface is thin or sharp.
/// @errors as DelaunayTetrahedra().
/// Cost O(N log N) expected, twice.
/// Source: Amenta, Bern, Kamvysselis, "A new Voronoi-based surface reconstruction algorithm",
/// SIGGRAPH 1998. Poles farther than five diagonals of the points are moved to there: Qhull's
/// precision is that of the largest coordinate, and what is empty around them stays so.
absl::StatusOr<Crust> ReconstructByCrust(const std::vector<Eigen::Vector3d>& points,
                                         const CrustOptions& options = {});

}  // namespace ccst
