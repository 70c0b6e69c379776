#include "proto/convert/progress.h"

#include "proto/convert/enums.h"
#include "proto/convert/scalars.h"

namespace ccst {

v1::IterationProgress ToProto(const AlternationReport& report, std::optional<Phase> phase) {
  v1::IterationProgress progress;
  if (phase.has_value()) progress.set_phase(ToProto(*phase));
  progress.set_iteration(report.alternation);
  progress.set_iteration_limit(report.alternation_limit);
  progress.set_energy(report.energy);
  progress.set_capacity_cv(report.capacity_cv);
  progress.set_flip_count(report.flips);
  progress.set_relocation_count(report.relocations);
  progress.set_max_displacement(report.max_displacement);
  *progress.mutable_elapsed_duration() = DurationToProto(report.elapsed_seconds);
  return progress;
}

AlternationReport FromProto(const v1::IterationProgress& progress) {
  AlternationReport report;
  report.alternation = progress.iteration();
  report.alternation_limit = progress.iteration_limit();
  report.energy = progress.energy();
  report.capacity_cv = progress.capacity_cv();
  report.flips = progress.flip_count();
  report.relocations = progress.relocation_count();
  report.max_displacement = progress.max_displacement();
  report.elapsed_seconds = SecondsFromProto(progress.elapsed_duration());
  return report;
}

}  // namespace ccst
