#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/interrupt.h"
#include "core/density/density.h"
#include "core/parallel/parallel.h"
#include "core/sampling/mesh/edge_flips.h"
#include "core/sampling/mesh/sample_mesh.h"
#include "core/sampling/mesh/samples.h"
#include "core/sampling/options.h"
#include "core/sampling/relax/coverage.h"
#include "core/sampling/relax/defects.h"
#include "core/sampling/relax/geometry_phase.h"
#include "core/sampling/relax/snapshot.h"
#include "core/sampling/result.h"
#include "core/sampling/run_control.h"
#include "core/sampling/start/plan.h"
#include "core/surface/projection.h"
#include "core/surface/surface.h"

namespace ccst::internal {

/// How a relaxation ended and what it took.
struct RelaxationReport {
  Termination termination = Termination::kIterationLimit;
  int alternations = 0;
  std::int64_t passes = 0;
  double energy = 0.0;
  double capacity_cv = 0.0;
};

/// Alternates geometry phases, edge flips and relocations until the capacities no longer improve.
/// One alternation is three passes over the active samples, each followed by flips where it left an
/// edge spoilt, and then, where it is its turn, relocations: connectivity that is already wrong is
/// not worth fitting to the end.
class Relaxation {
 public:
  /// Called while it goes on; each may be empty.
  struct Listeners {
    /// After every alternation and once, with alternation 0, before the first.
    std::function<void(const AlternationReport&)> on_alternation = nullptr;
    /// When the samples and their mesh are at a stage of the relaxation.
    std::function<void(Stage)> on_stage = nullptr;
  };

  /// Measures the first capacities, unless `interrupt` is requested in between.
  /// @param surface, density, plan, mesh, samples, interrupt  not owned; must outlive this.
  /// @param reserve   what the caller needs of the time until the deadline of `interrupt`: the
  ///                  relaxation ends this much earlier.
  Relaxation(const Surface* surface, const Density* density, const Plan* plan,
             const SamplingOptions& options, Listeners listeners, Interrupt* interrupt,
             Interrupt::Clock::duration reserve, SampleMesh* mesh, Samples* samples);

  Relaxation(const Relaxation&) = delete;
  Relaxation& operator=(const Relaxation&) = delete;

  /// The whole relaxation; to be called once. The interrupt is polled within alternations; once it
  /// is requested the relaxation ends with what it has: a whole sample mesh, every sample on the
  /// surface.
  /// @errors those of Interrupt::Error() where not even the first capacities could be measured.
  absl::StatusOr<RelaxationReport> Run();

 private:
  // Passes, flips and densities of one alternation. @return false when the interrupt ended it.
  bool Alternate();
  // While samples still crowd and triangles still turn over.
  void MendEarly();
  // Once while the rest settles too.
  void MendOnce();
  // Whenever the capacities have converged: keeps the state if it is the best so far, and goes on
  // from it. @return false when there is nothing left to mend or it does not get better.
  bool MendFinal(const std::vector<UncoveredPlace>& uncovered);
  void Show(Stage stage) const;
  // The capacities as they are now, for the report and the listener.
  void Measure();
  // Goes back to the best state and measures it exactly.
  RelaxationReport Finish(Termination termination);

  bool HasConverged() const;
  Termination Interrupted() const;
  std::vector<Defect> FindDefectsEverywhere(const DefectLimits& limits);
  // Looks where something changed since the last look.
  void UpdateDefects();
  void Relocate(const std::vector<Defect>& crowded, const std::vector<UncoveredPlace>& uncovered);
  // Adds what the alternation changed to what UpdateDefects() has to look at.
  void NoteChanges();

  const Surface& surface_;
  const Density& density_;
  const Plan& plan_;
  const int max_alternations_;
  const double relative_tolerance_;
  const Listeners listeners_;
  Interrupt& whole_;
  const Parallel parallel_;
  const Interrupt::Clock::time_point begin_ = Interrupt::Clock::now();
  GeometryPhase geometry_;
  const SampleMesh& mesh_;  // Of geometry_, like the next.
  const Samples& samples_;
  Interrupt alternating_;  // Ends early enough for Finish() and for the caller.
  EdgeFlips flips_;
  // Both take time, which a run that has been stopped does not have: made by Run().
  std::optional<Coverage> coverage_;
  std::optional<Projection> projection_;

  RelaxationReport result_;
  AlternationReport state_;            // Of the present alternation.
  std::vector<double> history_;        // Capacity variation since the last relocation.
  std::vector<Defect> defects_;        // As UpdateDefects() found them.
  std::vector<std::uint8_t> changed_;  // Per sample: something did since then.
  // The converged state with the fewest defects so far.
  struct {
    Snapshot state;
    std::size_t defects = std::numeric_limits<std::size_t>::max();
  } best_;
  int mends_ = 0;         // Calls of MendFinal() that relocated.
  int failed_mends_ = 0;  // Those that found no better state than the best.
};

}  // namespace ccst::internal
