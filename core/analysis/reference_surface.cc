#include "core/analysis/reference_surface.h"

#include <cstdint>
#include <utility>

namespace ccst::analysis {
namespace {

// Points that one thread looks up in one go.
constexpr std::int64_t kPiece = 1024;

}  // namespace

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

std::vector<SurfacePoint> ReferenceSurface::Locate(std::span<const Eigen::Vector3d> positions,
                                                   const Parallel& parallel) const {
  std::vector<SurfacePoint> points(positions.size());
  parallel.ForRanges(
      static_cast<std::int64_t>(positions.size()), kPiece,
      [&](std::int64_t first, std::int64_t end) {
        for (auto i = static_cast<std::size_t>(first); i < static_cast<std::size_t>(end); ++i) {
          const auto hit = tree_.FindClosest(positions[i]);
          points[i] = surface_.ClosestOnFace(static_cast<std::int32_t>(hit.triangle), positions[i]);
        }
      });
  return points;
}

}  // namespace ccst::analysis
