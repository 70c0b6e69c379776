#include "core/analysis/reference_surface.h"

#include <cstdint>
#include <utility>

namespace ccst::analysis {
namespace {

// Points that one thread looks up in one go.
constexpr std::int64_t kPiece = 1024;
// Units of work, for an Interrupt, of looking up a point.
constexpr std::int64_t kSearchWork = 16;

}  // namespace

ReferenceSurface::ReferenceSurface(Surface surface, Density density, Interrupt* interrupt)
    : surface_(std::move(surface)),
      density_(std::move(density)),
      mesh_{surface_.positions(), surface_.faces()},
      tree_(mesh_.positions, mesh_.faces, interrupt) {}

std::vector<Eigen::Vector3d> ReferenceSurface::ToFrame(
    std::span<const Eigen::Vector3d> positions) const {
  const Eigen::Vector3d center = surface_.ToMesh(Eigen::Vector3d::Zero());
  std::vector<Eigen::Vector3d> moved;
  moved.reserve(positions.size());
  for (const Eigen::Vector3d& p : positions) moved.emplace_back((p - center) / surface_.unit());
  return moved;
}

std::vector<SurfacePoint> ReferenceSurface::Locate(std::span<const Eigen::Vector3d> positions,
                                                   const Parallel& parallel,
                                                   Interrupt* interrupt) const {
  Interrupt never;
  if (interrupt == nullptr) interrupt = &never;
  std::vector<SurfacePoint> points(positions.size());
  parallel.ForRanges(
      static_cast<std::int64_t>(positions.size()), kPiece,
      [&, stop = *interrupt](std::int64_t first, std::int64_t end) {
        Interrupt own = stop;
        for (auto i = static_cast<std::size_t>(first); i < static_cast<std::size_t>(end); ++i) {
          if (own.RequestedAfter(kSearchWork)) return;
          const auto hit = tree_.FindClosest(positions[i]);
          points[i] = surface_.ClosestOnFace(static_cast<std::int32_t>(hit.triangle), positions[i]);
        }
      });
  return points;
}

}  // namespace ccst::analysis
