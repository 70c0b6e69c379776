#include "core/quality/sample_mesh_quality.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "core/mesh/faces.h"

namespace ccst::quality {

AngleFigures MeasureAngles(std::span<const Eigen::Vector3d> positions,
                           std::span<const Eigen::Vector3i> triangles) {
  AngleFigures figures;
  if (triangles.empty()) return figures;
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  std::int64_t below_30 = 0;
  std::int64_t above_90 = 0;
  double sum_smallest = 0.0;
  figures.smallest = 60.0;
  for (const Eigen::Vector3i& t : triangles) {
    double smallest = 180.0;
    for (int corner = 0; corner < 3; ++corner) {
      const Eigen::Vector3d& apex = positions[t[corner]];
      const Eigen::Vector3d u = positions[t[(corner + 1) % 3]] - apex;
      const Eigen::Vector3d v = positions[t[(corner + 2) % 3]] - apex;
      const double dot = u.dot(v);
      // atan2 keeps its accuracy at 0 and 180 degrees, acos does not.
      const double angle = std::atan2(u.cross(v).norm(), dot) * kDegrees;
      if (angle < 30.0) ++below_30;
      if (dot < 0.0) ++above_90;
      const int bin = static_cast<int>(angle / AngleFigures::kBinWidth);
      ++figures.histogram[std::min(bin, AngleFigures::kBins - 1)];
      smallest = std::min(smallest, angle);
    }
    sum_smallest += smallest;
    figures.smallest = std::min(figures.smallest, smallest);
  }
  const auto count = static_cast<double>(triangles.size());
  figures.mean_smallest = sum_smallest / count;
  figures.share_below_30 = static_cast<double>(below_30) / (3.0 * count);
  figures.share_above_90 = static_cast<double>(above_90) / (3.0 * count);
  return figures;
}

ShapeFigures MeasureShapes(std::span<const Eigen::Vector3d> positions,
                           std::span<const Eigen::Vector3i> triangles) {
  ShapeFigures figures;
  if (triangles.empty()) return figures;
  figures.smallest = 1.0;
  for (const Eigen::Vector3i& t : triangles) {
    const Eigen::Vector3d u = positions[t[1]] - positions[t[0]];
    const Eigen::Vector3d v = positions[t[2]] - positions[t[0]];
    const double a = u.norm();
    const double b = v.norm();
    const double c = (u - v).norm();
    const double longest = std::max({a, b, c});
    // r = 2 area / perimeter.
    const double inscribed = longest > 0.0 ? u.cross(v).norm() / (a + b + c) : 0.0;
    const double quality = longest > 0.0 ? 2.0 * std::sqrt(3.0) * inscribed / longest : 0.0;
    figures.smallest = std::min(figures.smallest, quality);
    figures.mean += quality / static_cast<double>(triangles.size());
  }
  return figures;
}

ValenceFigures MeasureValences(std::int64_t vertex_count,
                               std::span<const Eigen::Vector3i> triangles) {
  std::vector<std::pair<std::int32_t, std::int32_t>> sides;
  sides.reserve(3 * triangles.size());
  for (const Eigen::Vector3i& t : triangles) {
    for (int slot = 0; slot < 3; ++slot) {
      sides.push_back(std::minmax({t[slot], t[(slot + 1) % 3]}));
    }
  }
  std::sort(sides.begin(), sides.end());
  std::vector<std::int32_t> valence(vertex_count, 0);
  std::vector<bool> inner(vertex_count, true);
  for (std::size_t begin = 0, end = 0; begin < sides.size(); begin = end) {
    while (end < sides.size() && sides[end] == sides[begin]) ++end;
    for (const std::int32_t v : {sides[begin].first, sides[begin].second}) {
      ++valence[v];
      if (end - begin != 2) inner[v] = false;
    }
  }
  ValenceFigures figures;
  std::int64_t regular = 0;
  for (std::int64_t v = 0; v < vertex_count; ++v) {
    if (!inner[v] || valence[v] == 0) continue;
    ++figures.inner_vertices;
    ++figures.histogram[std::min(valence[v], ValenceFigures::kBins - 1)];
    if (valence[v] >= 5 && valence[v] <= 7) ++regular;
  }
  if (figures.inner_vertices > 0) {
    figures.share_5_to_7 =
        static_cast<double>(regular) / static_cast<double>(figures.inner_vertices);
  }
  return figures;
}

std::int64_t CountTurnedOver(std::span<const Eigen::Vector3d> positions,
                             std::span<const Eigen::Vector3d> normals,
                             std::span<const Eigen::Vector3i> triangles) {
  return std::count_if(triangles.begin(), triangles.end(), [&](const Eigen::Vector3i& t) {
    return !(FaceCross(positions, t).dot(normals[t[0]] + normals[t[1]] + normals[t[2]]) > 0.0);
  });
}

}  // namespace ccst::quality
