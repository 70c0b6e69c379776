#include "core/crust/poles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "core/base/status.h"
#include "core/crust/delaunay.h"

namespace ccst {
namespace {

using Tetrahedron = std::array<std::int32_t, 4>;

/// No pole is farther from the middle of the points than this many diagonals.
constexpr double kFarthest = 5.0;

Eigen::Vector3d Circumcenter(const std::vector<Eigen::Vector3d>& points, const Tetrahedron& t) {
  Eigen::Matrix3d edges;
  Eigen::Vector3d squares;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d edge = points[t[k + 1]] - points[t[0]];
    edges.row(k) = edge.transpose();
    squares[k] = 0.5 * edge.squaredNorm();
  }
  return points[t[0]] + edges.fullPivLu().solve(squares);
}

/// Sums of the outward normals of the convex hull at each point; zero inside.
std::vector<Eigen::Vector3d> HullNormals(const std::vector<Eigen::Vector3d>& points,
                                         const std::vector<Tetrahedron>& tetrahedra) {
  struct Face {
    std::array<std::int32_t, 3> corners;  // Increasing.
    std::int32_t apex;
  };
  std::vector<Face> faces;
  faces.reserve(4 * tetrahedra.size());
  for (const Tetrahedron& t : tetrahedra) {
    for (int k = 0; k < 4; ++k) {
      Face face{{t[(k + 1) % 4], t[(k + 2) % 4], t[(k + 3) % 4]}, t[k]};
      std::sort(face.corners.begin(), face.corners.end());
      faces.push_back(face);
    }
  }
  std::sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) {
    return std::pair(a.corners, a.apex) < std::pair(b.corners, b.apex);
  });
  std::vector<Eigen::Vector3d> normals(points.size(), Eigen::Vector3d::Zero());
  for (std::size_t i = 0; i < faces.size(); ++i) {
    if (i + 1 < faces.size() && faces[i].corners == faces[i + 1].corners) {
      ++i;  // Two tetrahedra share it.
      continue;
    }
    const auto& [a, b, c] = faces[i].corners;
    Eigen::Vector3d normal = (points[b] - points[a]).cross(points[c] - points[a]).normalized();
    if (normal.dot(points[faces[i].apex] - points[a]) > 0.0) normal = -normal;
    for (const std::int32_t v : faces[i].corners) normals[v] += normal;
  }
  return normals;
}

}  // namespace

absl::StatusOr<Poles> FindPoles(const std::vector<Eigen::Vector3d>& points) {
  CCST_ASSIGN_OR_RETURN(const std::vector<Tetrahedron> tetrahedra, DelaunayTetrahedra(points));
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& p : points) box.extend(p);
  const double reach = kFarthest * box.diagonal().norm();

  std::vector<Eigen::Vector3d> centers;
  centers.reserve(tetrahedra.size());
  for (const Tetrahedron& t : tetrahedra) {
    Eigen::Vector3d offset = Circumcenter(points, t) - box.center();
    if (const double length = offset.norm(); length > reach) offset *= reach / length;
    centers.push_back(box.center() + offset);
  }

  Poles poles;
  poles.first = HullNormals(points, tetrahedra);
  poles.second.assign(points.size(), Eigen::Vector3d::Zero());
  std::vector<std::int32_t> farthest(points.size(), -1);
  const auto keep_farthest = [&](const auto& admits) {
    std::fill(farthest.begin(), farthest.end(), -1);
    for (std::size_t t = 0; t < tetrahedra.size(); ++t) {
      for (const std::int32_t v : tetrahedra[t]) {
        const Eigen::Vector3d offset = centers[t] - points[v];
        if (!offset.allFinite() || !admits(v, offset)) continue;
        if (farthest[v] < 0 ||
            offset.squaredNorm() > (centers[farthest[v]] - points[v]).squaredNorm()) {
          farthest[v] = static_cast<std::int32_t>(t);
        }
      }
    }
  };
  const auto add = [&](std::size_t v, std::vector<Eigen::Vector3d>* directions) {
    if (farthest[v] < 0) return;
    poles.places.push_back(centers[farthest[v]]);
    (*directions)[v] = (centers[farthest[v]] - points[v]).normalized();
  };
  std::vector<std::uint8_t> on_hull(points.size());
  for (std::size_t v = 0; v < points.size(); ++v) on_hull[v] = !poles.first[v].isZero();
  keep_farthest([&](std::int32_t v, const Eigen::Vector3d&) { return !on_hull[v]; });
  for (std::size_t v = 0; v < points.size(); ++v) {
    on_hull[v] ? poles.first[v].normalize() : add(v, &poles.first);
  }
  keep_farthest([&](std::int32_t v, const Eigen::Vector3d& offset) {
    return offset.dot(poles.first[v]) < 0.0;
  });
  for (std::size_t v = 0; v < points.size(); ++v) add(v, &poles.second);
  return poles;
}

}  // namespace ccst
