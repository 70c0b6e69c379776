#pragma once

#include <functional>
#include <stop_token>

#include "absl/status/statusor.h"
#include "client/cli/mesh_input.h"
#include "client/lib/outcome.h"
#include "core/sampling/sampling.h"

namespace ccst::cli {

/// What a server would do with `input`, in this process: the same samples, bit for bit.
/// @param on_progress  called on this thread after every alternation.
/// @param stages       shown the stages of the run, positions relative to the origin of `input`;
///                     may be null.
/// @errors those of SampleSurface(); CANCELLED when stopped
absl::StatusOr<SampleOutcome> SampleLocally(
    const MeshInput& input, const SamplingOptions& options,
    const std::function<void(const AlternationReport&)>& on_progress, const std::stop_token& stop,
    StageSink* stages = nullptr);

}  // namespace ccst::cli
