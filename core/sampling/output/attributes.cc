#include "core/sampling/output/attributes.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include "core/base/assert.h"
#include "core/mesh/attributes.h"

namespace ccst::internal {
namespace {

Attribute Interpolate(const TriangleMesh& mesh, const Attribute& source, const SampleSet& samples) {
  Attribute result{.name = source.name, .kind = source.kind, .components = source.components};
  result.id = source.id;
  const auto width = static_cast<std::size_t>(source.components);
  result.values.resize(width * samples.faces.size());
  for (std::size_t i = 0; i < samples.faces.size(); ++i) {
    CCST_ASSERT(samples.faces[i] >= 0 &&
                static_cast<std::size_t>(samples.faces[i]) < mesh.faces.size());
    const auto face = static_cast<std::size_t>(samples.faces[i]);
    const double u = samples.barycentrics[i][0];
    const double v = samples.barycentrics[i][1];
    const std::array<double, 3> weights = {u, v, 1.0 - u - v};
    std::array<const float*, 3> rows = {};
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::size_t row =
          source.per_corner ? 3 * face + corner
                            : static_cast<std::size_t>(mesh.faces[face][static_cast<int>(corner)]);
      rows[corner] = source.values.data() + width * row;
    }
    if (source.kind == AttributeKind::kLabel) {
      const auto nearest = std::max_element(weights.begin(), weights.end()) - weights.begin();
      std::copy_n(rows[static_cast<std::size_t>(nearest)], width, &result.values[width * i]);
      continue;
    }
    for (std::size_t k = 0; k < width; ++k) {
      result.values[width * i + k] = static_cast<float>(
          weights[0] * rows[0][k] + weights[1] * rows[1][k] + weights[2] * rows[2][k]);
    }
  }
  return result;
}

}  // namespace

std::vector<Attribute> InterpolateAttributes(const TriangleMesh& mesh, const SampleSet& samples) {
  CCST_ASSERT(CheckAttributes(mesh).ok());
  std::vector<Attribute> result;
  result.reserve(mesh.attributes.size());
  for (const Attribute& attribute : mesh.attributes) {
    result.push_back(Interpolate(mesh, attribute, samples));
  }
  return result;
}

}  // namespace ccst::internal
