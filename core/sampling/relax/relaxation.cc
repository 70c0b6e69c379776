#include "core/sampling/relax/relaxation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "core/sampling/mesh/edge_flips.h"
#include "core/sampling/relax/coverage.h"
#include "core/sampling/relax/geometry_phase.h"
#include "core/sampling/relax/relocation.h"

namespace ccst::internal {
namespace {

/// Relocation after each of the first alternations, when samples still crowd and triangles
/// still turn over.
constexpr int kEarlyAlternations = 2;
constexpr DefectLimits kEarlyLimits = {};

/// Afterwards it mends what is left: once while the rest settles too, and then whenever the
/// capacities have converged, as long as that leaves fewer defects.
constexpr int kFirstMend = 5;
constexpr int kMaxFinalMends = 40;
constexpr int kMaxFailedMends = 14;
constexpr DefectLimits kMendLimits = {.least_facing = 0.2,
                                      .least_separation = 0.66,
                                      .least_angle = 27.0 * std::numbers::pi / 180.0,
                                      .most_excess = 0.55};

constexpr DefectLimits kFinalLimits = {.least_facing = kMendLimits.least_facing,
                                       .least_separation = kMendLimits.least_separation,
                                       .all_near = true,
                                       .least_angle = kMendLimits.least_angle,
                                       .most_excess = kMendLimits.most_excess};

/// What a result may not keep as long as there is a choice: one such defect outweighs a hundred of
/// the others.
constexpr DefectLimits kGraveLimits = {
    .least_facing = 0.1, .least_separation = 0.63, .least_angle = 25.5 * std::numbers::pi / 180.0};
constexpr std::size_t kGraveWeight = 100;

/// Moves that count as rest while the surroundings of relocated samples settle, in spacings.
constexpr double kMendRest = 0.01;

/// Improvement is judged over this many alternations: single ones are noisy after flips.
constexpr int kWindow = 3;

constexpr int kPassesPerAlternation = 3;

/// Between the points in which projections look up far places, in spacings: following their hosts
/// finds the rest of the way, and more of them would be much of the memory.
constexpr double kDenseSpacing = 2.0;

/// Calls `each(v)` for every sample.
template <typename Each>
void ForEach(const Parallel& parallel, const Samples& samples, const Each& each) {
  constexpr std::int64_t kPiece = 8192;
  parallel.ForRanges(samples.count(), kPiece, [&](std::int64_t first, std::int64_t end) {
    for (std::int64_t v = first; v < end; ++v) each(static_cast<std::int32_t>(v));
  });
}

/// What changes of samples and their mesh, without what follows from it.
class Snapshot {
 public:
  /// In the place of what was taken before: a second one would not fit beside it.
  void Take(const SampleMesh& mesh, const Samples& samples) {
    origin_ = mesh.origin;
    twin_ = mesh.twin;
    locked_ = mesh.locked;
    outgoing_ = mesh.outgoing;
    face_ = samples.face;
    weights_ = samples.weights;
    arc_ = samples.arc;
  }

  void Restore(const Surface& surface, const Parallel& parallel, SampleMesh* mesh,
               Samples* samples) {
    mesh->origin = std::move(origin_);
    mesh->twin = std::move(twin_);
    mesh->locked = std::move(locked_);
    mesh->outgoing = std::move(outgoing_);
    samples->arc = std::move(arc_);
    ForEach(parallel, *samples, [&](std::int32_t v) {
      const Eigen::Vector3i& corner = surface.faces()[face_[v]];
      SurfacePoint point;
      point.face = face_[v];
      point.weights = weights_[v];
      point.position = weights_[v][0] * surface.positions()[corner[0]] +
                       weights_[v][1] * surface.positions()[corner[1]] +
                       weights_[v][2] * surface.positions()[corner[2]];
      samples->Place(v, surface, point);
    });
  }

 private:
  std::vector<std::int32_t> origin_;
  std::vector<std::int32_t> twin_;
  std::vector<std::uint8_t> locked_;
  std::vector<std::int32_t> outgoing_;
  std::vector<std::int32_t> face_;
  std::vector<Eigen::Vector3d> weights_;
  std::vector<double> arc_;
};

}  // namespace

absl::StatusOr<RelaxationReport> Relax(const Surface& surface, const Density& density,
                                       const Plan& plan, const SamplingOptions& options,
                                       const std::function<void(const AlternationReport&)>& report,
                                       Interrupt* whole, Interrupt::Clock::duration reserve,
                                       SampleMesh* mesh, Samples* samples) {
  RelaxationReport result;
  const Parallel parallel(options.thread_count);
  const auto begin = Interrupt::Clock::now();
  GeometryPhase geometry(&surface, &density, &plan, options.energy, mesh, samples, &parallel,
                         whole);
  if (whole->Requested()) return whole->Error("the first capacities were measured");
  // Going back to the best state measures all of them again.
  if (!density.uniform()) reserve += Interrupt::Clock::now() - begin;
  Interrupt alternating = whole->Earlier(reserve);
  Interrupt* const interrupt = &alternating;
  Interrupt finishing = whole->WithoutDeadline();
  EdgeFlips flips(mesh, &samples->position, &samples->normal);
  Coverage coverage(&surface, &density, &plan, &parallel, interrupt);
  Projection projection(&surface, kDenseSpacing * plan.spacing, &parallel);

  AlternationReport state;
  state.alternation_limit = options.max_iterations;
  const auto measure = [&] {
    const GeometryPhase::Spread spread = geometry.EstimateCapacities();
    result.energy = state.energy = spread.energy;
    result.capacity_cv = state.capacity_cv = spread.cv;
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
    Snapshot state;
    std::size_t defects = std::numeric_limits<std::size_t>::max();
  } best;
  const auto finish = [&](Termination termination) {
    if (best.defects != std::numeric_limits<std::size_t>::max()) {
      best.state.Restore(surface, parallel, mesh, samples);
      geometry.TakeOver(&finishing);
    }
    // Passes keep normals in single precision.
    ForEach(parallel, *samples, [&](std::int32_t v) {
      samples->normal[v] = surface.NormalAt(samples->face[v], samples->weights[v]);
    });
    const GeometryPhase::Spread spread = geometry.MeasureCapacities();
    result.energy = spread.energy;
    result.capacity_cv = spread.cv;
    result.termination = termination;
    return result;
  };

  const std::vector<std::uint8_t> everywhere(samples->count(), 1);
  std::vector<std::uint8_t> changed = everywhere;  // Since the last look for defects.
  std::vector<Defect> defects;
  const auto update_defects = [&] {
    std::erase_if(defects, [&](const Defect& d) { return changed[d.sample] != 0; });
    const std::vector<Defect> fresh =
        FindDefects(surface, density, plan, *mesh, *samples, kFinalLimits, kGraveLimits, changed,
                    parallel, interrupt);
    defects.insert(defects.end(), fresh.begin(), fresh.end());
    KeepOneEach(&defects);
    std::fill(changed.begin(), changed.end(), std::uint8_t{0});
  };
  const auto find_everywhere = [&](const DefectLimits& limits) {
    return FindDefects(surface, density, plan, *mesh, *samples, limits, limits, everywhere,
                       parallel, interrupt);
  };
  const auto activate_touched = [&](std::size_t first) {
    for (std::size_t i = first; i < flips.touched.size(); ++i) {
      geometry.ActivateFlipped(flips.touched[i]);
    }
  };
  const auto relocate = [&](const std::vector<Defect>& crowded,
                            const std::vector<UncoveredPlace>& uncovered) {
    const std::size_t before = flips.touched.size();
    state.relocations = Relocate(crowded, uncovered, surface, &projection, &geometry, &flips,
                                 interrupt, mesh, samples);
    activate_touched(before);
    if (state.relocations > 0) history.clear();
    geometry.UpdateDensities(interrupt);
  };

  const auto interrupted = [&] {
    return interrupt->cause() == Interrupt::Cause::kTimeLimit ? Termination::kTimeLimit
                                                              : Termination::kStopped;
  };

  if (mesh->triangle_count() == 0) return finish(Termination::kConverged);  // Points alone.
  // Densities have to keep up with the samples.
  const int passes_at_once = density.uniform() ? kPassesPerAlternation : 1;
  int mends = 0;
  int failed = 0;
  while (result.alternations < options.max_iterations) {
    if (interrupt->Requested()) return finish(interrupted());
    geometry.ClearMoved();
    flips.touched.clear();
    state.max_displacement = 0.0;
    state.flips = 0;
    for (int pass = 0; pass < kPassesPerAlternation; pass += passes_at_once) {
      const GeometryPhase::Change change = geometry.Alternate(passes_at_once, interrupt);
      if (interrupt->Requested()) return finish(interrupted());
      state.max_displacement = std::max(state.max_displacement, change.largest_move * plan.spacing);
      state.flips += change.flips;
      geometry.UpdateDensities(interrupt);
    }
    result.passes += kPassesPerAlternation;
    ++result.alternations;
    state.alternation = result.alternations;

    state.relocations = 0;
    bool done = false;
    if (result.alternations <= kEarlyAlternations) {
      relocate(find_everywhere(kEarlyLimits), {});
    } else if (result.alternations == kFirstMend) {
      relocate(find_everywhere(kMendLimits), coverage.FindUncovered(*mesh, *samples, interrupt));
    } else if (result.alternations > kFirstMend && converged()) {
      update_defects();
      const std::vector<UncoveredPlace> uncovered =
          coverage.FindUncovered(*mesh, *samples, interrupt);
      if (interrupt->Requested()) return finish(interrupted());
      const std::size_t count =
          defects.size() +
          kGraveWeight * (uncovered.size() + static_cast<std::size_t>(std::count_if(
                                                 defects.begin(), defects.end(),
                                                 [](const Defect& d) { return d.grave; })));
      if (count < best.defects) {
        best.state.Take(*mesh, *samples);
        best.defects = count;
      } else {
        ++failed;
      }
      done = count == 0 || mends == kMaxFinalMends || failed == kMaxFailedMends;
      if (!done) {
        // From here on only what a relocation disturbs moves.
        geometry.DeactivateAll();
        geometry.rest = kMendRest;
        relocate(defects, uncovered);
        ++mends;
        done = state.relocations == 0;
      }
    }
    for (std::int32_t v = 0; v < samples->count(); ++v) changed[v] |= geometry.moved()[v];
    for (const std::int32_t v : flips.touched) changed[v] = 1;
    measure();
    if (done) return finish(Termination::kConverged);
    history.push_back(result.capacity_cv);
  }
  return finish(Termination::kIterationLimit);
}

}  // namespace ccst::internal
