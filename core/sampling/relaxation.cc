#include "core/sampling/relaxation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "core/sampling/edge_flips.h"
#include "core/sampling/geometry_phase.h"
#include "core/sampling/relocation.h"

namespace ccst {
namespace {

/// Relocation in the first alternations, when samples still crowd and triangles still turn over.
constexpr int kEarlyAlternations = 8;
constexpr DefectLimits kEarlyLimits = {};

/// Afterwards it mends what is left: every few alternations while the rest settles too, and then
/// whenever the capacities have converged, as long as that leaves fewer defects.
constexpr int kLastRegularMend = 26;
constexpr int kMendInterval = 4;
constexpr int kMaxFinalMends = 16;
constexpr int kMaxFailedMends = 4;
constexpr DefectLimits kFinalLimits = {.least_facing = 0.1,
                                       .least_separation = 0.66,
                                       .reach = 3,
                                       .least_angle = 27.0 * std::numbers::pi / 180.0,
                                       .most_excess = 0.9};

/// Improvement is judged over this many alternations: single ones are noisy after flips.
constexpr int kWindow = 5;

}  // namespace

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

  std::vector<double> history;  // Capacity variation since the last relocation.
  const auto converged = [&] {
    const std::size_t size = history.size();
    return size > kWindow && history[size - 1 - kWindow] - history.back() <
                                 kWindow * options.relative_tolerance * history.back();
  };
  // The converged state with the fewest defects so far.
  struct {
    SampleMesh mesh;
    Samples samples;
    std::size_t defects = std::numeric_limits<std::size_t>::max();
  } best;
  const auto finish = [&](Termination termination) {
    if (best.defects != std::numeric_limits<std::size_t>::max()) {
      *mesh = std::move(best.mesh);
      *samples = std::move(best.samples);
      result.energy = geometry.MeanEnergy();
      result.capacity_cv = geometry.CapacityCv();
    }
    result.termination = termination;
    return result;
  };

  int mends = 0;
  int failed = 0;
  while (result.alternations < options.max_iterations) {
    if (Termination reason; interrupted(&reason)) return finish(reason);
    ++result.alternations;
    state.alternation = result.alternations;
    geometry.ClearMoved();
    state.max_displacement = geometry.Pass() * plan.spacing;
    ++result.passes;

    flips.touched.clear();
    state.flips = flips.FlipAround(geometry.moved());
    for (const std::int32_t v : flips.touched) geometry.Activate(v);

    state.relocations = 0;
    const auto relocate = [&](const std::vector<std::int32_t>& defects) {
      state.relocations = Relocate(defects, surface, &geometry, &flips, mesh, samples);
      if (state.relocations > 0) history.clear();
    };
    bool done = false;
    if (result.alternations <= kEarlyAlternations) {
      relocate(FindDefects(surface, plan, *mesh, *samples, kEarlyLimits));
    } else if (result.alternations <= kLastRegularMend &&
               result.alternations % kMendInterval == 2) {
      relocate(FindDefects(surface, plan, *mesh, *samples, kFinalLimits));
    } else if (result.alternations > kLastRegularMend && converged()) {
      const std::vector<std::int32_t> defects = FindDefects(surface, plan, *mesh, *samples, kFinalLimits);
      if (defects.size() < best.defects) {
        best.mesh = *mesh;
        best.samples = *samples;
        best.defects = defects.size();
      } else {
        ++failed;
      }
      done = defects.empty() || mends == kMaxFinalMends || failed == kMaxFailedMends;
      if (!done) {
        relocate(defects);
        ++mends;
        done = state.relocations == 0;
      }
    }
    measure();
    if (done) return finish(Termination::kConverged);
    history.push_back(result.capacity_cv);
  }
  return finish(Termination::kIterationLimit);
}

}  // namespace ccst
