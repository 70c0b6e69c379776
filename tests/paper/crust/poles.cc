#include "tests/paper/crust/poles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "absl/container/flat_hash_set.h"
#include "core/base/status.h"
#include "tests/paper/crust/delaunay.h"

namespace ccst {
namespace {

using Tetrahedron = std::array<std::int32_t, 4>;

/// No pole is farther from the points than about this many diagonals.
constexpr double kFarthest = 5.0;
/// Of poles within this share of the diagonal one is kept. Points share poles, and where the medial
/// axis is a line, as that of a torus is, all poles crowd there: to Qhull such places are failures
/// of precision, for which it moves everything until they differ.
constexpr double kSamePlace = 1e-4;
/// From the first corner of `t` to the centre of the ball through all; at most `reach` long.
Eigen::Vector3d ToCircumcenter(const std::vector<Eigen::Vector3d>& points, const Tetrahedron& t,
                               double reach) {
  Eigen::Matrix3d edges;
  Eigen::Vector3d squares;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d edge = points[t[k + 1]] - points[t[0]];
    edges.row(k) = edge.transpose();
    squares[k] = 0.5 * edge.squaredNorm();
  }
  Eigen::Vector3d offset = edges.fullPivLu().solve(squares);
  if (const double length = offset.norm(); length > reach) offset *= reach / length;
  return offset;
}

/// Sums of the outward normals of the convex hull at each point; zero inside. Outwards is away from
/// `inside`, a point within the hull: the tetrahedron at a face of the hull may be nearly flat.
std::vector<Eigen::Vector3d> HullNormals(const std::vector<Eigen::Vector3d>& points,
                                         const std::vector<Tetrahedron>& tetrahedra,
                                         const Eigen::Vector3d& inside) {
  std::vector<std::array<std::int32_t, 3>> faces;  // Corners increasing.
  faces.reserve(4 * tetrahedra.size());
  for (const Tetrahedron& t : tetrahedra) {
    for (int k = 0; k < 4; ++k) {
      faces.push_back({t[(k + 1) % 4], t[(k + 2) % 4], t[(k + 3) % 4]});
      std::sort(faces.back().begin(), faces.back().end());
    }
  }
  std::sort(faces.begin(), faces.end());
  std::vector<Eigen::Vector3d> normals(points.size(), Eigen::Vector3d::Zero());
  for (std::size_t i = 0; i < faces.size(); ++i) {
    if (i + 1 < faces.size() && faces[i] == faces[i + 1]) {
      ++i;  // Two tetrahedra share it.
      continue;
    }
    const auto& [a, b, c] = faces[i];
    Eigen::Vector3d normal = (points[b] - points[a]).cross(points[c] - points[a]).normalized();
    if (normal.dot(points[a] - inside) < 0.0) normal = -normal;
    for (const std::int32_t v : faces[i]) normals[v] += normal;
  }
  return normals;
}

}  // namespace

absl::StatusOr<Poles> FindPoles(const std::vector<Eigen::Vector3d>& points) {
  CCST_ASSIGN_OR_RETURN(const std::vector<Tetrahedron> tetrahedra, DelaunayTetrahedra(points));
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& p : points) box.extend(p);
  const double reach = kFarthest * box.diagonal().norm();

  Eigen::Vector3d inside = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points) inside += p / static_cast<double>(points.size());

  std::vector<Eigen::Vector3d> centers;
  centers.reserve(tetrahedra.size());
  for (const Tetrahedron& t : tetrahedra) {
    centers.push_back(points[t[0]] + ToCircumcenter(points, t, reach));
  }

  Poles poles;
  poles.first = HullNormals(points, tetrahedra, inside);
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
  absl::flat_hash_set<std::array<std::int64_t, 3>> taken;
  const auto add = [&](std::size_t v, std::vector<Eigen::Vector3d>* directions) {
    if (farthest[v] < 0) return;
    const Eigen::Vector3d& pole = centers[farthest[v]];
    const Eigen::Vector3d cell = (pole - box.min()) / (kSamePlace * box.diagonal().norm());
    if (taken.insert({std::llround(cell.x()), std::llround(cell.y()), std::llround(cell.z())})
            .second) {
      poles.places.push_back(pole);
    }
    (*directions)[v] = (pole - points[v]).normalized();
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
