#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "client/cli/distinct_files.h"
#include "client/cli/flags.h"
#include "client/cli/summary.h"
#include "core/mesh/triangle_mesh.h"

namespace ccst::cli {

/// Checks before anything is computed that every output can be written: extensions, folders,
/// permissions, no two outputs in one place, none that is one of `inputs`.
/// @errors INVALID_ARGUMENT naming the path and what would be right
absl::Status CheckOutputs(const OutputPaths& paths, const std::vector<NamedFile>& inputs);

/// Whether an output may be written to `path`, which is no device, no folder and in a folder that
/// exists; empty and `-` are. @errors INVALID_ARGUMENT naming the path and what would be right
absl::Status CheckWritable(const std::string& path);

/// Writes what `paths` ask for, each file whole or not at all, the summary last. All of them
/// are encoded before the first is written.
/// @param surface  what the picture shows below the samples; unused without one.
/// @errors those of the encoders and of WriteFileAtomically()
absl::Status WriteOutputs(const OutputPaths& paths, const TriangleMesh& surface,
                          const FinishedRun& run);

}  // namespace ccst::cli
