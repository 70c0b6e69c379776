#include "core/sampling/export.h"

#include <algorithm>

#include "core/sampling/attributes.h"

namespace ccst {

SampleSet ExportSamples(const TriangleMesh& mesh, const SourceMap& sources, const Samples& samples,
                        const SampleMesh& triangulation, const std::vector<std::int32_t>& order) {
  SampleSet set;
  const std::size_t n = order.size();
  set.faces.resize(n);
  set.normals.resize(n);
  set.barycentrics.resize(n);
  set.positions.resize(n);
  std::vector<std::int32_t> place(n);
  for (std::size_t k = 0; k < n; ++k) {
    const std::int32_t i = order[k];
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
  }
  set.triangles.reserve(triangulation.triangle_count());
  for (std::int32_t t = 0; t < triangulation.triangle_count(); ++t) {
    set.triangles.emplace_back(place[triangulation.origin[3 * t]],
                               place[triangulation.origin[3 * t + 1]],
                               place[triangulation.origin[3 * t + 2]]);
  }
  set.attributes = InterpolateAttributes(mesh, set);
  return set;
}

}  // namespace ccst
