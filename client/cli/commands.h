#pragma once

#include "client/cli/exit_code.h"
#include "client/cli/flags.h"

namespace ccst::cli {

// Each runs a command: results go to standard output, progress and errors to standard error.
ExitCode Run(const SampleCommand& command);
ExitCode Run(const InfoCommand& command);
ExitCode Run(const UploadCommand& command);
ExitCode Run(const MeshesCommand& command);
ExitCode Run(const JobsCommand& command);
ExitCode Run(const WatchCommand& command);
ExitCode Run(const CancelCommand& command);
ExitCode Run(const DeleteCommand& command);
ExitCode Run(const FetchCommand& command);
ExitCode Run(const AnalyzeCommand& command);

}  // namespace ccst::cli
