#pragma once

#include <string>

#include "absl/status/status.h"

namespace ccst::cli {

/// What went wrong and what to do about it, for people; `server` is empty for a local run.
std::string ErrorText(const absl::Status& status, const std::string& server);

/// Prints ErrorText() to standard error, a line that starts with `ccst: `.
void PrintError(const absl::Status& status, const std::string& server);

}  // namespace ccst::cli
