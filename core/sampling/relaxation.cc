#include "core/sampling/relaxation.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/sampling/edge_flips.h"
#include "core/sampling/geometry_phase.h"
#include "core/sampling/relocation.h"

namespace ccst {

RelaxationReport Relax(const Surface& surface, const Plan& plan, const SamplingOptions& options,
                       const std::function<void(const AlternationReport&)>& report,
                       const std::function<bool(Termination*)>& interrupted, SampleMesh* mesh,
                       Samples* samples) {
  RelaxationReport result;
  GeometryPhase geometry(&surface, &plan, options.energy, mesh, samples);
  EdgeFlips flips(mesh, &samples->position, &samples->normal);

  AlternationReport state;
  state.alternation_limit = options.max_iterations;
  const auto measure = [&] {
    result.energy = state.energy = geometry.MeanEnergy();
    result.capacity_cv = state.capacity_cv = geometry.CapacityCv();
    state.positions = samples->position;
    report(state);
  };
  measure();

  double last_cv = result.capacity_cv;
  int settled = 0;
  int quiet = 0;
  while (result.alternations < options.max_iterations) {
    if (interrupted(&result.termination)) return result;
    ++result.alternations;
    state.alternation = result.alternations;
    geometry.ClearMoved();
    state.max_displacement = geometry.Pass() * plan.spacing;
    ++result.passes;

    flips.touched.clear();
    state.flips = flips.FlipAround(geometry.moved());
    for (const std::int32_t v : flips.touched) geometry.Activate(v);

    DefectLimits limits;
    const bool early = result.alternations <= 8;
    if (!early) {
      limits.least_separation = 0.66;
      limits.least_angle = 26.0 * std::numbers::pi / 180.0;
      limits.least_facing = 0.1;
    }
    state.relocations = 0;
    if (early || quiet >= 8) {
      state.relocations =
          Relocate(FindDefects(*mesh, *samples, limits), surface, &geometry, &flips, mesh, samples);
      quiet = 0;
    } else {
      ++quiet;
    }
    measure();

    // Two small improvements in a row: one may be an accident of the flips.
    settled = last_cv - result.capacity_cv < options.relative_tolerance * last_cv ? settled + 1 : 0;
    last_cv = result.capacity_cv;
    if (settled >= 2 && state.relocations == 0) {
      result.termination = Termination::kConverged;
      return result;
    }
  }
  result.termination = Termination::kIterationLimit;
  return result;
}

}  // namespace ccst
