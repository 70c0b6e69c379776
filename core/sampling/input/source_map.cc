#include "core/sampling/input/source_map.h"

#include <algorithm>

#include "core/surface/closest_point.h"

namespace ccst::internal {
namespace {

/// Barycentric coordinates on triangle `corner` of a point that lies on it, up to rounding.
Eigen::Vector3d Locate(const std::array<Eigen::Vector3d, 3>& corner, const Eigen::Vector3d& point) {
  // In units of the triangle, so that no product overflows or vanishes.
  const Eigen::Vector3d b = corner[1] - corner[0];
  const Eigen::Vector3d c = corner[2] - corner[0];
  const double unit = std::max(b.cwiseAbs().maxCoeff(), c.cwiseAbs().maxCoeff());
  return ClosestWeights((point - corner[0]) / unit, Eigen::Vector3d::Zero(), b / unit, c / unit);
}

}  // namespace

SourceMap::SourceMap(const TriangleMesh& input, const RepairedMesh& repaired)
    : faces_(repaired.source_face), corners_(repaired.source_corner) {
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    for (int k = 0; k < 3; ++k) {
      if (corners_[f][k] >= 0) continue;
      const Eigen::Vector3i& face = input.faces[faces_[f]];
      const std::array<Eigen::Vector3d, 3> corner = {
          input.positions[face[0]], input.positions[face[1]], input.positions[face[2]]};
      on_sides_.emplace_back(3 * static_cast<std::int64_t>(f) + k,
                             Locate(corner, repaired.mesh.positions[repaired.mesh.faces[f][k]]));
    }
  }
}

Eigen::Vector3d SourceMap::Corner(std::int32_t face, int k) const {
  if (const int corner = corners_[face][k]; corner >= 0) return Eigen::Vector3d::Unit(corner);
  const std::int64_t slot = 3 * static_cast<std::int64_t>(face) + k;
  const auto found =
      std::lower_bound(on_sides_.begin(), on_sides_.end(), slot,
                       [](const auto& entry, std::int64_t s) { return entry.first < s; });
  return found->second;
}

}  // namespace ccst::internal
