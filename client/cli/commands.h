#pragma once

#include "client/cli/exit_code.h"
#include "client/cli/flags.h"

namespace ccst::cli {

/// Runs `ccst sample`: progress and errors go to standard error.
ExitCode RunSample(const SampleCommand& command);

/// Runs `ccst info`.
ExitCode RunInfo(const InfoCommand& command);

}  // namespace ccst::cli
