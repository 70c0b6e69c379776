#pragma once

#include <string>

#include "client/lib/outcome.h"
#include "core/sampling/sampling.h"

namespace ccst::cli {

/// A run that succeeded: what was asked for, where, and what came out.
struct FinishedRun {
  SamplingOptions options;
  std::string server;  ///< HOST:PORT; empty: in this process.
  SampleOutcome outcome;
};

/// One JSON object and a line end: what was asked for and what came out. `job` and `server` are
/// null for a run in the process.
std::string SummaryJson(const FinishedRun& run);

/// The figures that matter, a few lines for people.
std::string SummaryText(const FinishedRun& run);

}  // namespace ccst::cli
