#pragma once

#include "absl/status/status.h"

namespace ccst::cli {

/// How `ccst` ends; scripts rely on the numbers.
enum ExitCode : int {
  kOk = 0,
  kUsage = 1,        ///< The command line is wrong, or an output cannot be written there.
  kRefused = 2,      ///< The input or the request was refused.
  kFailed = 3,       ///< The job failed, or its answer is broken.
  kCancelled = 4,    ///< By Ctrl-C or by the server.
  kUnreachable = 5,  ///< No server there, or the connection was lost.
};

/// The exit code for an error of reading the input or of a run.
ExitCode ExitCodeFor(const absl::Status& status);

}  // namespace ccst::cli
