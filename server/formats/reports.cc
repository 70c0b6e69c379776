#include "server/formats/reports.h"

namespace ccst::server::internal {

void Write(const AlternationReport& report, store::v1::Report& message) {
  message.set_alternation(report.alternation);
  message.set_alternation_limit(report.alternation_limit);
  message.set_energy(report.energy);
  message.set_capacity_cv(report.capacity_cv);
  message.set_flips(report.flips);
  message.set_relocations(report.relocations);
  message.set_max_displacement(report.max_displacement);
  message.set_elapsed_seconds(report.elapsed_seconds);
}

AlternationReport Read(const store::v1::Report& message) {
  AlternationReport report;
  report.alternation = message.alternation();
  report.alternation_limit = message.alternation_limit();
  report.energy = message.energy();
  report.capacity_cv = message.capacity_cv();
  report.flips = message.flips();
  report.relocations = message.relocations();
  report.max_displacement = message.max_displacement();
  report.elapsed_seconds = message.elapsed_seconds();
  return report;
}

}  // namespace ccst::server::internal
