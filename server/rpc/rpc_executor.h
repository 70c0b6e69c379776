#pragma once

#include "absl/functional/function_ref.h"
#include "absl/status/status.h"

namespace ccst::server {

/// RESOURCE_EXHAUSTED QUEUE_FULL: how a call ends whose work an Executor refused.
absl::Status ExecutorFull();

/// What `step` returns; what it throws as RESOURCE_EXHAUSTED OUT_OF_MEMORY or INTERNAL INTERNAL.
/// Tasks of an Executor must not throw.
absl::Status RunStep(absl::FunctionRef<absl::Status()> step);

}  // namespace ccst::server
