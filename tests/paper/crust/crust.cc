#include "tests/paper/crust/crust.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

#include <Eigen/Geometry>

#include "core/base/status.h"
#include "core/random/random.h"
#include "tests/paper/crust/delaunay.h"
#include "tests/paper/crust/outside.h"
#include "tests/paper/crust/poles.h"

namespace ccst {
namespace {

/// How far points are moved into general position, in diagonals: well above what rounding does to
/// balls and angles, well below distances of points.
constexpr double kNudge = 1e-7;

/// Triangles of the Delaunay tetrahedra of points and poles with points alone as corners, each
/// once.
absl::StatusOr<std::vector<Eigen::Vector3i>> FindCandidates(
    const std::vector<Eigen::Vector3d>& points, const Poles& poles) {
  std::vector<Eigen::Vector3d> all = points;
  all.insert(all.end(), poles.places.begin(), poles.places.end());
  CCST_ASSIGN_OR_RETURN(const auto tetrahedra, DelaunayTetrahedra(all));
  const std::int32_t count = static_cast<std::int32_t>(points.size());
  std::vector<std::array<std::int32_t, 3>> faces;
  for (const std::array<std::int32_t, 4>& t : tetrahedra) {
    for (int k = 0; k < 4; ++k) {
      std::array<std::int32_t, 3> face = {t[(k + 1) % 4], t[(k + 2) % 4], t[(k + 3) % 4]};
      if (*std::max_element(face.begin(), face.end()) >= count) continue;
      std::sort(face.begin(), face.end());
      faces.push_back(face);
    }
  }
  std::sort(faces.begin(), faces.end());
  faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
  std::vector<Eigen::Vector3i> triangles;
  triangles.reserve(faces.size());
  for (const auto& [a, b, c] : faces) triangles.emplace_back(a, b, c);
  return triangles;
}

/// Corner of the largest angle: opposite to the longest edge.
int LargestAngle(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3i& t) {
  int largest = 0;
  double longest = 0.0;
  for (int k = 0; k < 3; ++k) {
    const double edge = (points[t[(k + 2) % 3]] - points[t[(k + 1) % 3]]).squaredNorm();
    if (edge > longest) {
      longest = edge;
      largest = k;
    }
  }
  return largest;
}

bool FollowsPoles(const std::vector<Eigen::Vector3d>& points, const Poles& poles,
                  const Eigen::Vector3i& t, double limit) {
  const Eigen::Vector3d normal =
      (points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]).normalized();
  const int largest = LargestAngle(points, t);
  for (int k = 0; k < 3; ++k) {
    const double least =
        std::cos(std::min(k == largest ? limit : 1.5 * limit, 0.5 * std::numbers::pi));
    for (const Eigen::Vector3d& direction : {poles.first[t[k]], poles.second[t[k]]}) {
      if (!direction.isZero() && std::abs(normal.dot(direction)) < least) return false;
    }
  }
  return true;
}

}  // namespace

std::vector<Eigen::Vector3d> InGeneralPosition(std::vector<Eigen::Vector3d> points) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& p : points) box.extend(p);
  const double length = kNudge * box.diagonal().norm();
  const CounterRandom random(1, 0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      points[i][static_cast<Eigen::Index>(k)] += length * (random.Uniform(3 * i + k) - 0.5);
    }
  }
  return points;
}

absl::StatusOr<Crust> ReconstructByCrust(const std::vector<Eigen::Vector3d>& given,
                                         const CrustOptions& options) {
  const std::vector<Eigen::Vector3d> points = InGeneralPosition(given);
  CCST_ASSIGN_OR_RETURN(const Poles poles, FindPoles(points));
  CCST_ASSIGN_OR_RETURN(std::vector<Eigen::Vector3i> triangles, FindCandidates(points, poles));
  Crust crust;
  crust.candidates = triangles.size();
  std::erase_if(triangles, [&](const Eigen::Vector3i& t) {
    return !FollowsPoles(points, poles, t, options.normal_filter);
  });
  crust.filtered = triangles.size();
  TrimSharpEdges(points, options.trim_holes, &triangles);
  crust.trimmed = triangles.size();
  crust.triangles = WalkOutside(points, triangles);
  return crust;
}

}  // namespace ccst
