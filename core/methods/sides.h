#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include "core/surface/surface.h"

namespace ccst {

/// Tells points that are near each other on the surface from those that are only near in space.
class Sides {
 public:
  explicit Sides(const Surface& surface) : components_(surface.face_components()) {
    normals_.reserve(surface.face_count());
    for (std::int32_t f = 0; f < surface.face_count(); ++f) {
      const Eigen::Vector3i& face = surface.faces()[f];
      const Eigen::Vector3d& corner = surface.positions()[face[0]];
      const Eigen::Vector3d cross =
          (surface.positions()[face[1]] - corner).cross(surface.positions()[face[2]] - corner);
      const Eigen::Vector3d normal =
          surface.face_areas()[f] > 0.0 ? cross.normalized()
                                        : surface.NormalAt(f, Eigen::Vector3d::Constant(1.0 / 3.0));
      normals_.emplace_back(normal.cast<float>());
    }
  }

  /// Whether two faces lie in the same component and their normals are less than 120 degrees apart.
  bool Same(std::int32_t a, std::int32_t b) const {
    return a == b || (components_[a] == components_[b] && normals_[a].dot(normals_[b]) > -0.5F);
  }

 private:
  const std::vector<std::int32_t>& components_;
  std::vector<Eigen::Vector3f> normals_;
};

}  // namespace ccst
