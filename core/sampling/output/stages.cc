#include "core/sampling/output/stages.h"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <vector>

namespace ccst::internal {

void ShowSamples(Stage stage, const Surface& surface, const SampleMesh& mesh,
                 const Samples& samples, StageSink* sink) {
  if (sink == nullptr) return;
  std::vector<Eigen::Vector3d> positions;
  positions.reserve(samples.position.size());
  std::transform(samples.position.begin(), samples.position.end(), std::back_inserter(positions),
                 [&](const Eigen::Vector3d& position) { return surface.ToMesh(position); });
  std::vector<Eigen::Vector3i> triangles;
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
    if (mesh.IsDead(TriangleIndex(t))) continue;
    triangles.emplace_back(mesh.origin[3 * t], mesh.origin[3 * t + 1], mesh.origin[3 * t + 2]);
  }
  sink->OnStage(stage, positions, triangles);
}

}  // namespace ccst::internal
