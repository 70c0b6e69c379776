#include "core/sampling/output/export.h"

#include <algorithm>

#include "core/base/assert.h"
#include "core/sampling/output/attributes.h"

namespace ccst::internal {
namespace {

/// Samples or triangles that one thread takes in one go.
constexpr std::int64_t kPiece = 8192;

}  // namespace

SampleSet ExportSamples(const TriangleMesh& mesh, const SourceMap& sources, const Samples& samples,
                        const SampleMesh& triangulation, const std::vector<std::int32_t>& order,
                        const Parallel& parallel) {
  CCST_ASSERT(order.size() == samples.position.size());
  SampleSet set;
  const std::size_t n = order.size();
  set.faces.resize(n);
  set.normals.resize(n);
  set.barycentrics.resize(n);
  set.positions.resize(n);
  std::vector<std::int32_t> place(n);
  const auto export_one = [&](std::size_t k) {
    const std::int32_t i = order[k];
    CCST_ASSERT(i >= 0 && i < samples.count());
    place[i] = static_cast<std::int32_t>(k);
    // The two weights that are reported determine the position; the third is what they leave.
    const Eigen::Vector3d weights = sources.Weights(samples.face[i], samples.weights[i]);
    const double u = std::clamp(weights[0], 0.0, 1.0);
    const double v = std::clamp(weights[1], 0.0, 1.0 - u);
    set.barycentrics[k] = {u, v};
    set.faces[k] = sources.Face(samples.face[i]);
    set.normals[k] = samples.normal[i];
    const Eigen::Vector3i& face = mesh.faces[set.faces[k]];
    set.positions[k] = u * mesh.positions[face[0]] + v * mesh.positions[face[1]] +
                       (1.0 - u - v) * mesh.positions[face[2]];
  };
  parallel.ForRanges(static_cast<std::int64_t>(n), kPiece,
                     [&](std::int64_t first, std::int64_t end) {
                       for (std::int64_t k = first; k < end; ++k) {
                         export_one(static_cast<std::size_t>(k));
                       }
                     });
  set.triangles.resize(static_cast<std::size_t>(triangulation.triangle_count()));
  parallel.ForRanges(
      triangulation.triangle_count(), kPiece, [&](std::int64_t first, std::int64_t end) {
        for (std::int64_t t = first; t < end; ++t) {
          CCST_ASSERT(!triangulation.IsDead(TriangleIndex(static_cast<std::int32_t>(t))));
          const std::int32_t* corner = &triangulation.origin[3 * t];
          set.triangles[static_cast<std::size_t>(t)] = {place[corner[0]], place[corner[1]],
                                                        place[corner[2]]};
        }
      });
  set.attributes = InterpolateAttributes(mesh, set);
  return set;
}

}  // namespace ccst::internal
