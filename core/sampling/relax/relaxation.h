#pragma once

#include <cstdint>
#include <functional>

#include "absl/status/statusor.h"
#include "core/base/interrupt.h"
#include "core/density/density.h"
#include "core/sampling/mesh/sample_mesh.h"
#include "core/sampling/mesh/samples.h"
#include "core/sampling/options.h"
#include "core/sampling/result.h"
#include "core/sampling/run_control.h"
#include "core/sampling/start/plan.h"
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
/// not worth fitting to the end. Calls `report` after every alternation and once, with alternation
/// 0, before the first. `interrupt` is polled within alternations; once it is requested the
/// relaxation ends with what it has: a whole sample mesh, every sample on the surface.
/// @param reserve  what the caller needs of the time until the deadline of `interrupt`: the
///                 relaxation ends this much earlier.
/// @errors those of Interrupt::Error() where not even the first capacities could be measured.
absl::StatusOr<RelaxationReport> Relax(const Surface& surface, const Density& density,
                                       const Plan& plan, const SamplingOptions& options,
                                       const std::function<void(const AlternationReport&)>& report,
                                       Interrupt* interrupt, Interrupt::Clock::duration reserve,
                                       SampleMesh* mesh, Samples* samples);

}  // namespace ccst::internal
