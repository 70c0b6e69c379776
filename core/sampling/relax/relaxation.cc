#include "core/sampling/relax/relaxation.h"

#include <algorithm>
#include <numbers>
#include <utility>

#include "core/base/assert.h"
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

/// What a result may not keep as long as there is a choice.
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

/// One defect that a result may not keep outweighs a hundred of the others.
std::size_t Weigh(const std::vector<Defect>& defects,
                  const std::vector<UncoveredPlace>& uncovered) {
  const auto grave = std::count_if(defects.begin(), defects.end(),
                                   [](const Defect& defect) { return defect.grave; });
  return defects.size() + kGraveWeight * (uncovered.size() + static_cast<std::size_t>(grave));
}

}  // namespace

Relaxation::Relaxation(const Surface* surface, const Density* density, const Plan* plan,
                       const SamplingOptions& options, Listeners listeners, Interrupt* interrupt,
                       Interrupt::Clock::duration reserve, SampleMesh* mesh, Samples* samples)
    : surface_(*surface),
      density_(*density),
      plan_(*plan),
      max_alternations_(options.max_iterations),
      relative_tolerance_(options.relative_tolerance),
      listeners_(std::move(listeners)),
      whole_(*interrupt),
      parallel_(options.thread_count),
      geometry_(surface, density, plan, options.energy, mesh, samples, &parallel_, interrupt),
      mesh_(geometry_.packed().mesh()),
      samples_(geometry_.packed().samples()),
      flips_(geometry_.packed().MakeFlips()),
      changed_(samples->count(), 1) {
  // Going back to the best state measures all densities again.
  if (!density->uniform()) reserve += Interrupt::Clock::now() - begin_;
  alternating_ = interrupt->Earlier(reserve);
  state_.alternation_limit = options.max_iterations;
}

absl::StatusOr<RelaxationReport> Relaxation::Run() {
  if (whole_.Requested()) return whole_.Error("the first capacities were measured");
  coverage_.emplace(&surface_, &density_, &plan_, &parallel_, &alternating_);
  projection_.emplace(&surface_, kDenseSpacing * plan_.spacing, &parallel_);
  Measure();
  if (mesh_.triangle_count() == 0) return Finish(Termination::kConverged);  // Points alone.
  while (result_.alternations < max_alternations_) {
    if (!Alternate()) return Finish(Interrupted());
    bool done = false;
    if (result_.alternations <= kEarlyAlternations) {
      MendEarly();
    } else if (result_.alternations == kFirstMend) {
      MendOnce();
    } else if (result_.alternations > kFirstMend && HasConverged()) {
      UpdateDefects();
      const std::vector<UncoveredPlace> uncovered =
          coverage_->FindUncovered(mesh_, samples_, &alternating_);
      if (alternating_.Requested()) return Finish(Interrupted());
      done = !MendFinal(uncovered);
    }
    NoteChanges();
    Measure();
    if (done) return Finish(Termination::kConverged);
    history_.push_back(result_.capacity_cv);
  }
  return Finish(Termination::kIterationLimit);
}

bool Relaxation::Alternate() {
  if (alternating_.Requested()) return false;
  geometry_.ClearMoved();
  flips_.touched.clear();
  state_.max_displacement = 0.0;
  state_.flips = 0;
  state_.relocations = 0;
  // Densities have to keep up with the samples.
  const int passes_at_once = density_.uniform() ? kPassesPerAlternation : 1;
  for (int pass = 0; pass < kPassesPerAlternation; pass += passes_at_once) {
    const GeometryPhase::Change change = geometry_.Alternate(passes_at_once, &alternating_);
    if (alternating_.Requested()) return false;
    state_.max_displacement =
        std::max(state_.max_displacement, change.largest_move * plan_.spacing);
    state_.flips += change.flips;
    geometry_.UpdateDensities(&alternating_);
  }
  result_.passes += kPassesPerAlternation;
  ++result_.alternations;
  state_.alternation = result_.alternations;
  return true;
}

void Relaxation::MendEarly() {
  Relocate(FindDefectsEverywhere(kEarlyLimits), {});
  if (result_.alternations == kEarlyAlternations) Show(Stage::kEarly);
}

void Relaxation::MendOnce() {
  Relocate(FindDefectsEverywhere(kMendLimits),
           coverage_->FindUncovered(mesh_, samples_, &alternating_));
  Show(Stage::kMended);
}

bool Relaxation::MendFinal(const std::vector<UncoveredPlace>& uncovered) {
  if (mends_ == 0) Show(Stage::kConverged);
  const std::size_t count = Weigh(defects_, uncovered);
  if (count < best_.defects) {
    best_.state.Take(mesh_, samples_);
    best_.defects = count;
  } else {
    ++failed_mends_;
  }
  if (count == 0 || mends_ == kMaxFinalMends || failed_mends_ == kMaxFailedMends) return false;
  // From here on only what a relocation disturbs moves.
  geometry_.DeactivateAll();
  geometry_.rest = kMendRest;
  Relocate(defects_, uncovered);
  ++mends_;
  return state_.relocations > 0;
}

void Relaxation::Show(Stage stage) const {
  if (listeners_.on_stage) listeners_.on_stage(stage);
}

void Relaxation::Measure() {
  const GeometryPhase::Spread spread = geometry_.EstimateCapacities();
  result_.energy = state_.energy = spread.energy;
  result_.capacity_cv = state_.capacity_cv = spread.cv;
  state_.positions = samples_.position;
  if (listeners_.on_alternation) listeners_.on_alternation(state_);
}

RelaxationReport Relaxation::Finish(Termination termination) {
  if (best_.defects != std::numeric_limits<std::size_t>::max()) {
    Interrupt finishing = whole_.WithoutDeadline();
    geometry_.Restore(&best_.state, &finishing);
  }
  geometry_.packed().RefineNormals(parallel_);
  Show(Stage::kRelaxed);
  const GeometryPhase::Spread spread = geometry_.MeasureCapacities();
  result_.energy = spread.energy;
  result_.capacity_cv = spread.cv;
  result_.termination = termination;
  return result_;
}

bool Relaxation::HasConverged() const {
  const std::size_t size = history_.size();
  return size > kWindow && history_[size - 1 - kWindow] - history_.back() <
                               kWindow * relative_tolerance_ * history_.back();
}

Termination Relaxation::Interrupted() const {
  return alternating_.cause() == Interrupt::Cause::kTimeLimit ? Termination::kTimeLimit
                                                              : Termination::kStopped;
}

std::vector<Defect> Relaxation::FindDefectsEverywhere(const DefectLimits& limits) {
  const std::vector<std::uint8_t> everywhere(samples_.count(), 1);
  return FindDefects(surface_, density_, plan_, mesh_, samples_, limits, limits, everywhere,
                     parallel_, &alternating_);
}

void Relaxation::UpdateDefects() {
  std::erase_if(defects_, [&](const Defect& defect) { return changed_[defect.sample] != 0; });
  const std::vector<Defect> fresh =
      FindDefects(surface_, density_, plan_, mesh_, samples_, kFinalLimits, kGraveLimits, changed_,
                  parallel_, &alternating_);
  defects_.insert(defects_.end(), fresh.begin(), fresh.end());
  KeepOneEach(&defects_);
  std::fill(changed_.begin(), changed_.end(), std::uint8_t{0});
}

void Relaxation::Relocate(const std::vector<Defect>& crowded,
                          const std::vector<UncoveredPlace>& uncovered) {
  const std::size_t before = flips_.touched.size();
  state_.relocations = internal::Relocate(crowded, uncovered, surface_, &*projection_, &geometry_,
                                          &flips_, &alternating_);
  for (std::size_t i = before; i < flips_.touched.size(); ++i) {
    geometry_.ActivateFlipped(flips_.touched[i]);
  }
  if (state_.relocations > 0) history_.clear();
  geometry_.UpdateDensities(&alternating_);
}

void Relaxation::NoteChanges() {
  CCST_ASSERT_NO_FAULT(FindFault(geometry_.packed()));
  for (std::int32_t v = 0; v < samples_.count(); ++v) changed_[v] |= geometry_.moved()[v];
  for (const std::int32_t v : flips_.touched) changed_[v] = 1;
}

}  // namespace ccst::internal
