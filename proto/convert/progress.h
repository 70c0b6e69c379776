#pragma once

#include <optional>

#include "ccst/v1/job.pb.h"
#include "core/sampling/run_control.h"

namespace ccst {

/// `positions` do not travel with progress.
v1::IterationProgress ToProto(const AlternationReport& report, std::optional<Phase> phase);

/// The report inside, without positions; the phase is `FromProto(progress.phase())`.
AlternationReport FromProto(const v1::IterationProgress& progress);

}  // namespace ccst
