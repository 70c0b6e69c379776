#include "core/sampling/initial_points.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "core/random/random.h"
#include "core/spatial/hilbert.h"

namespace ccst {
namespace {

constexpr std::uint64_t kPointStream = 0x706f696e74;  // "point"

/// Faces ordered by component, then along the Hilbert curve through their centroids.
std::vector<std::int32_t> OrderFaces(const Surface& surface) {
  std::vector<std::pair<std::uint64_t, std::int32_t>> keys(surface.face_count());
  for (std::int32_t f = 0; f < surface.face_count(); ++f) {
    const Eigen::Vector3i& face = surface.faces()[f];
    const Eigen::Vector3d center = (surface.positions()[face[0]] + surface.positions()[face[1]] +
                                    surface.positions()[face[2]]) /
                                   3.0;
    std::array<std::uint32_t, 3> cell;
    for (int k = 0; k < 3; ++k) {
      cell[k] = static_cast<std::uint32_t>(std::clamp((center[k] + 0.5) * 65535.0, 0.0, 65535.0));
    }
    keys[f] = {HilbertIndex(cell), f};
  }
  std::sort(keys.begin(), keys.end(), [&](const auto& a, const auto& b) {
    const auto ca = surface.face_components()[a.second];
    const auto cb = surface.face_components()[b.second];
    return ca != cb ? ca < cb : a < b;
  });
  std::vector<std::int32_t> order(keys.size());
  std::transform(keys.begin(), keys.end(), order.begin(), [](const auto& k) { return k.second; });
  return order;
}

}  // namespace

Samples DrawInitialPoints(const Surface& surface, const Density& density, const Plan& plan,
                          std::uint64_t seed) {
  Samples samples;
  std::int64_t count = 0;
  for (const ComponentPlan& component : plan.components) count += component.samples;
  samples.Resize(static_cast<std::int32_t>(count));

  const CounterRandom random(seed, kPointStream);
  const std::vector<std::int32_t> order = OrderFaces(surface);
  const std::vector<double>& capacities = density.face_capacities();
  std::size_t at = 0;
  std::int32_t i = 0;
  for (std::size_t c = 0; c < plan.components.size(); ++c) {
    const ComponentPlan& component = plan.components[c];
    const auto interior = static_cast<std::int32_t>(component.samples - component.boundary_samples -
                                                    component.crease_samples);
    const double stratum = density.component_capacities()[c] / std::max(1, interior);
    const auto in_component = [&](std::size_t k) {
      return k < order.size() &&
             surface.face_components()[order[k]] == static_cast<std::int32_t>(c);
    };
    const std::int32_t begin = i;
    double passed = 0.0;  // Capacity of the component's faces before order[at].
    for (std::int32_t k = 0; k < interior; ++k, ++i) {
      const double wanted = (k + random.Uniform(component.points ? begin : i)) * stratum;
      while (in_component(at + 1) && passed + capacities[order[at]] <= wanted) {
        passed += capacities[order[at++]];
      }
      const std::int32_t face = order[at];
      const double share = capacities[face] > 0.0 ? (wanted - passed) / capacities[face] : 0.5;
      SurfacePoint point;
      point.face = face;
      point.weights = density.PointAt(face, std::clamp(share, 0.0, 1.0 - 0x1.0p-53));
      for (int corner = 0; corner < 3; ++corner) {
        point.position +=
            point.weights[corner] * surface.positions()[surface.faces()[face][corner]];
      }
      samples.Place(i, surface, point);
      if (component.points) samples.kind[i] = SampleMesh::Kind::kPoint;
      samples.component[i] = static_cast<std::int32_t>(c);
    }
    while (in_component(at)) ++at;
    for (std::size_t l = 0; l < plan.loops.size(); ++l) {
      const LoopPlan& loop = plan.loops[l];
      if (loop.component != static_cast<std::int32_t>(c)) continue;
      for (std::size_t k = 0; k < loop.arcs.size(); ++k, ++i) {
        const auto index = static_cast<std::int32_t>(l);
        samples.Place(i, surface, PointOnLoop(surface, plan, index, loop.arcs[k]));
        samples.kind[i] = loop.fixed[k] ? SampleMesh::Kind::kFixed
                          : loop.crease ? SampleMesh::Kind::kCrease
                                        : SampleMesh::Kind::kBoundary;
        samples.component[i] = static_cast<std::int32_t>(c);
        samples.loop[i] = index;
        samples.arc[i] = loop.arcs[k];
      }
    }
  }
  return samples;
}

}  // namespace ccst
