#include "core/surface/projection.h"

#include <algorithm>
#include <cmath>

namespace ccst {
namespace {

/// Dense points tried for one target.
constexpr int kNearest = 8;
/// Rows of dense points along a face's longest edge, at most.
constexpr int kMaxRows = 64;

}  // namespace

void Projection::Discretise() {
  for (std::int32_t f = 0; f < surface_.face_count(); ++f) {
    const Eigen::Vector3d& a = surface_.positions()[surface_.faces()[f][0]];
    const Eigen::Vector3d& b = surface_.positions()[surface_.faces()[f][1]];
    const Eigen::Vector3d& c = surface_.positions()[surface_.faces()[f][2]];
    const double longest =
        std::sqrt(std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()}));
    const int rows =
        static_cast<int>(std::clamp(longest / spacing_, 1.0, static_cast<double>(kMaxRows)));
    // Centroids of the rows^2 congruent parts that stand like the face itself.
    for (int i = 0; i < rows; ++i) {
      for (int j = 0; i + j < rows; ++j) {
        const double u = (i + 1.0 / 3.0) / rows;
        const double v = (j + 1.0 / 3.0) / rows;
        points_.push_back((1.0 - u - v) * a + u * b + v * c);
        faces_.push_back(f);
      }
    }
  }
  tree_ = std::make_unique<PointTree>(points_, parallel_);
}

SurfacePoint Projection::Project(std::int32_t face, const Eigen::Vector3d& target,
                                 const Eigen::Vector3d& normal, double tolerance) {
  SurfacePoint best = surface_.Follow(face, target);
  double least = (best.position - target).norm();
  if (least <= tolerance) return best;
  if (tree_ == nullptr) Discretise();
  const SurfacePoint host = surface_.ClosestOnFace(face, best.position);
  for (const std::int32_t i : tree_->Nearest(target, kNearest)) {
    const SurfacePoint point = surface_.Follow(faces_[i], target);
    const double distance = (point.position - target).norm();
    if (distance >= least || surface_.NormalAt(point.face, point.weights).dot(normal) <= 0.0) {
      continue;
    }
    const SurfacePoint back = surface_.Follow(point.face, host.position);
    if ((back.position - host.position).norm() > 1e-9) continue;
    best = point;
    least = distance;
  }
  return best;
}

}  // namespace ccst
