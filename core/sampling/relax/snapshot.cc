#include "core/sampling/relax/snapshot.h"

#include <utility>

#include "core/base/assert.h"

namespace ccst::internal {
namespace {

/// Samples that one thread puts back in one go.
constexpr std::int64_t kSamplesAtOnce = 8192;

/// The point of `face` with these weights.
SurfacePoint PointOf(const Surface& surface, std::int32_t face, const Eigen::Vector3d& weights) {
  const Eigen::Vector3i& corner = surface.faces()[face];
  SurfacePoint point;
  point.face = face;
  point.weights = weights;
  point.position = weights[0] * surface.positions()[corner[0]] +
                   weights[1] * surface.positions()[corner[1]] +
                   weights[2] * surface.positions()[corner[2]];
  return point;
}

}  // namespace

void Snapshot::Take(const SampleMesh& mesh, const Samples& samples) {
  origin_ = mesh.origin;
  twin_ = mesh.twin;
  locked_ = mesh.locked;
  outgoing_ = mesh.outgoing;
  face_ = samples.face;
  weights_ = samples.weights;
  arc_ = samples.arc;
}

void Snapshot::Restore(const Surface& surface, const Parallel& parallel, SampleMesh* mesh,
                       Samples* samples) {
  CCST_ASSERT(face_.size() == samples->face.size());
  mesh->origin = std::move(origin_);
  mesh->twin = std::move(twin_);
  mesh->locked = std::move(locked_);
  mesh->outgoing = std::move(outgoing_);
  samples->arc = std::move(arc_);
  parallel.ForRanges(samples->count(), kSamplesAtOnce, [&](std::int64_t first, std::int64_t end) {
    for (std::int64_t i = first; i < end; ++i) {
      const auto v = static_cast<std::int32_t>(i);
      samples->Place(v, surface, PointOf(surface, face_[v], weights_[v]));
    }
  });
  *this = {};
}

}  // namespace ccst::internal
