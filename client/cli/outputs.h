#pragma once

#include "absl/status/status.h"
#include "client/cli/flags.h"
#include "client/cli/mesh_input.h"
#include "client/lib/outcome.h"

namespace ccst::cli {

/// Checks before anything is computed that every output can be written: extensions, folders,
/// permissions, no two outputs in one place.
/// @errors INVALID_ARGUMENT naming the path and what would be right
absl::Status CheckOutputs(const SampleCommand& command);

/// Writes what `command` asks for, each file whole or not at all, the summary last. All of them
/// are encoded before the first is written.
/// @errors those of the encoders and of WriteFileAtomically()
absl::Status WriteOutputs(const SampleCommand& command, const MeshInput& input,
                          const SampleOutcome& outcome);

}  // namespace ccst::cli
