#pragma once

#include <string>

#include "client/cli/flags.h"
#include "client/lib/outcome.h"

namespace ccst::cli {

/// One JSON object and a line end: what was asked for and what came out. `job` and `server` are
/// null for a run in the process.
std::string SummaryJson(const SampleCommand& command, const SampleOutcome& outcome);

/// The figures that matter, a few lines for people.
std::string SummaryText(const SampleCommand& command, const SampleOutcome& outcome);

}  // namespace ccst::cli
