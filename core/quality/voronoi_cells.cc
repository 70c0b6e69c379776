#include "core/quality/voronoi_cells.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include <Eigen/Geometry>

namespace ccst::quality {
namespace {

// Whether each vertex has triangles and no edge of fewer or more than two.
std::vector<bool> InnerVertices(std::size_t count, std::span<const Eigen::Vector3i> triangles) {
  std::vector<std::pair<std::int32_t, std::int32_t>> sides;
  sides.reserve(3 * triangles.size());
  std::vector<bool> inner(count, false);
  for (const Eigen::Vector3i& t : triangles) {
    for (int k = 0; k < 3; ++k) {
      sides.push_back(std::minmax({t[k], t[(k + 1) % 3]}));
      inner[static_cast<std::size_t>(t[k])] = true;
    }
  }
  std::sort(sides.begin(), sides.end());
  for (std::size_t begin = 0, end = 0; begin < sides.size(); begin = end) {
    while (end < sides.size() && sides[end] == sides[begin]) ++end;
    if (end - begin == 2) continue;
    inner[static_cast<std::size_t>(sides[begin].first)] = false;
    inner[static_cast<std::size_t>(sides[begin].second)] = false;
  }
  return inner;
}

}  // namespace

std::vector<double> VoronoiCellCapacities(std::span<const Eigen::Vector3d> positions,
                                          std::span<const Eigen::Vector3i> triangles,
                                          std::span<const double> densities) {
  std::vector<double> all(positions.size(), 0.0);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const Eigen::Vector3i& t = triangles[i];
    const double density = densities.empty() ? 1.0 : densities[i];
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d& apex = positions[t[k]];
      const Eigen::Vector3d u = positions[t[(k + 1) % 3]] - apex;
      const Eigen::Vector3d v = positions[t[(k + 2) % 3]] - apex;
      const double twice_area = u.cross(v).norm();
      if (!(twice_area > 0.0)) break;
      // The angle at the apex is opposite to the edge between the others.
      const double part = 0.125 * u.dot(v) / twice_area * (u - v).squaredNorm() * density;
      all[static_cast<std::size_t>(t[(k + 1) % 3])] += part;
      all[static_cast<std::size_t>(t[(k + 2) % 3])] += part;
    }
  }
  const std::vector<bool> inner = InnerVertices(positions.size(), triangles);
  std::vector<double> cells;
  for (std::size_t v = 0; v < all.size(); ++v) {
    if (inner[v]) cells.push_back(all[v]);
  }
  return cells;
}

double MeasureVoronoiVariation(std::span<const Eigen::Vector3d> positions,
                               std::span<const Eigen::Vector3i> triangles,
                               std::span<const double> densities) {
  const std::vector<double> cells = VoronoiCellCapacities(positions, triangles, densities);
  double sum = 0.0;
  for (const double cell : cells) sum += cell;
  const double mean = cells.empty() ? 0.0 : sum / static_cast<double>(cells.size());
  if (!(mean > 0.0)) return 0.0;
  double squares = 0.0;
  for (const double cell : cells) squares += (cell / mean - 1.0) * (cell / mean - 1.0);
  return std::sqrt(squares / static_cast<double>(cells.size()));
}

}  // namespace ccst::quality
