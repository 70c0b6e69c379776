#include "core/sampling/start/initial_points.h"

#include <algorithm>
#include <numeric>

#include "core/random/random.h"

namespace ccst::internal {
namespace {

constexpr std::uint64_t kPointStream = 0x706f696e74;  // "point"

/// Samples that one thread places in one go.
constexpr std::int64_t kPiece = 1024;

/// Faces by component, in their order.
std::vector<std::int32_t> OrderFaces(const Surface& surface) {
  const std::vector<std::int32_t>& component = surface.face_components();
  std::vector<std::size_t> next(surface.component_areas().size() + 1, 0);
  for (const std::int32_t c : component) ++next[c + 1];
  std::partial_sum(next.begin(), next.end(), next.begin());
  std::vector<std::int32_t> order(component.size());
  for (std::int32_t f = 0; f < surface.face_count(); ++f) order[next[component[f]]++] = f;
  return order;
}

}  // namespace

absl::StatusOr<Samples> DrawInitialPoints(const Surface& surface, const Density& density,
                                          const Plan& plan, std::uint64_t seed,
                                          Interrupt* interrupt, const Parallel& parallel) {
  const auto stopped = [&] { return interrupt->Error("the first samples were drawn"); };
  Samples samples;
  std::int64_t count = 0;
  for (const ComponentPlan& component : plan.components) count += component.samples;
  samples.Resize(static_cast<std::int32_t>(count));

  const CounterRandom random(seed, kPointStream);
  const std::vector<std::int32_t> order = OrderFaces(surface);
  std::vector<double> shares(samples.position.size(), 0.0);  // Of the host's capacity, before it.
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
      if (interrupt->RequestedAt(k)) return stopped();
      const double wanted = (k + random.Uniform(component.points ? begin : i)) * stratum;
      while (in_component(at + 1) && passed + capacities[order[at]] <= wanted) {
        passed += capacities[order[at++]];
      }
      const std::int32_t face = order[at];
      const double share = capacities[face] > 0.0 ? (wanted - passed) / capacities[face] : 0.5;
      shares[i] = std::clamp(share, 0.0, 1.0 - 0x1.0p-53);
      samples.face[i] = face;
      if (component.points) samples.kind[i] = SampleMesh::Kind::kPoint;
      samples.component[i] = static_cast<std::int32_t>(c);
    }
    while (in_component(at)) ++at;
    for (const std::int32_t index : plan.LoopsOf(static_cast<std::int32_t>(c))) {
      const LoopPlan& loop = plan.loops[index];
      for (std::size_t k = 0; k < loop.arcs.size(); ++k, ++i) {
        if (interrupt->RequestedAt(i)) return stopped();
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
  parallel.ForRanges(
      samples.count(), kPiece, [&, stop = *interrupt](std::int64_t first, std::int64_t end) {
        if (Interrupt(stop).Requested()) return;
        for (auto k = static_cast<std::int32_t>(first); k < static_cast<std::int32_t>(end); ++k) {
          if (samples.loop[k] >= 0) continue;
          SurfacePoint point;
          point.face = samples.face[k];
          point.weights = density.PointAt(point.face, shares[k]);
          for (int corner = 0; corner < 3; ++corner) {
            point.position +=
                point.weights[corner] * surface.positions()[surface.faces()[point.face][corner]];
          }
          samples.Place(k, surface, point);
        }
      });
  if (interrupt->Requested()) return stopped();
  return samples;
}

}  // namespace ccst::internal
