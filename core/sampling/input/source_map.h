#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "core/mesh/triangle_mesh.h"
#include "core/repair/repair.h"

namespace ccst::internal {

/// Where the faces of a repaired mesh, which are those of the surface, lie on the input's. Where
/// nothing was repaired it changes nothing, not even bits.
class SourceMap {
 public:
  /// @param repaired  what Repair() made of `input`; only its faces' sources are kept.
  SourceMap(const TriangleMesh& input, const RepairedMesh& repaired);

  /// The input's face on which a face of the surface lies.
  std::int32_t Face(std::int32_t face) const { return faces_[face]; }

  /// Barycentric coordinates on Face(face) of corner `k` of a face of the surface. Cost O(1) but
  /// for corners on the side of a face that was split: O(log of their number).
  Eigen::Vector3d Corner(std::int32_t face, int k) const;

  /// Barycentric coordinates on Face(face) of the point of `face` with these weights.
  Eigen::Vector3d Weights(std::int32_t face, const Eigen::Vector3d& weights) const {
    return weights[0] * Corner(face, 0) + weights[1] * Corner(face, 1) +
           weights[2] * Corner(face, 2);
  }

 private:
  std::vector<std::int32_t> faces_;
  std::vector<std::array<std::int8_t, 3>> corners_;
  std::vector<std::pair<std::int64_t, Eigen::Vector3d>> on_sides_;  // By 3 * face + k.
};

}  // namespace ccst::internal
