#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/repair/repair.h"
#include "tests/figures/report.h"

namespace ccst::figures {

/// What became of one mesh file.
struct Survey {
  /// What was sampled and how good it is; `run.error` says why there is no result.
  RunRecord run;
  bool readable = false;
  std::int64_t components = 0;
  std::int64_t untriangulated_components = 0;
  std::int64_t untriangulated_samples = 0;
  RepairReport repairs;
  /// Smallest distance over r_max of samples on the same side at most three edges apart. The radius
  /// of the figures counts pairs across a cut, a crack or a gap too, which no sampling of the
  /// surface can keep apart; where only those are too close, `radius` is no miss here.
  double radius_on_sheet = 0.0;
};

/// Reads, repairs and samples the mesh file `path`, n = max(4000, 40 per component), and holds
/// the result against the floors, judged on the repaired surface: what is not triangulated is left
/// out, and is a miss ("points") where its share of the samples would have been enough.
Survey SurveyFile(const std::string& path, std::uint64_t seed);

/// The counts of a report that are not 0, as "3 welded, 1 cut edges"; "-" where all are.
std::string DescribeRepairs(const RepairReport& report);

}  // namespace ccst::figures
