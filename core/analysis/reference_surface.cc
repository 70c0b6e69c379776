#include "core/analysis/reference_surface.h"

#include <cstdint>
#include <utility>

namespace ccst::analysis {

ReferenceSurface::ReferenceSurface(Surface surface, Density density)
    : surface_(std::move(surface)),
      density_(std::move(density)),
      mesh_{surface_.positions(), surface_.faces()},
      tree_(mesh_.positions, mesh_.faces) {}

std::vector<Eigen::Vector3d> ReferenceSurface::ToFrame(
    std::span<const Eigen::Vector3d> positions) const {
  const Eigen::Vector3d center = surface_.ToMesh(Eigen::Vector3d::Zero());
  std::vector<Eigen::Vector3d> moved;
  moved.reserve(positions.size());
  for (const Eigen::Vector3d& p : positions) moved.emplace_back((p - center) / surface_.unit());
  return moved;
}

std::vector<SurfacePoint> ReferenceSurface::Locate(
    std::span<const Eigen::Vector3d> positions) const {
  std::vector<SurfacePoint> points;
  points.reserve(positions.size());
  for (const Eigen::Vector3d& p : positions) {
    const quality::TriangleTree::Hit hit = tree_.FindClosest(p);
    points.push_back(surface_.ClosestOnFace(static_cast<std::int32_t>(hit.triangle), p));
  }
  return points;
}

}  // namespace ccst::analysis
