#pragma once

#include "absl/status/statusor.h"
#include "server/jobs/job.h"
#include "server/jobs/job_input.h"
#include "server/jobs/run_dependencies.h"
#include "server/metrics/job_observer.h"

namespace ccst::server {

/// What one run needs besides.
struct RunInputs {
  InputSource source;
  JobObserver& observer;
};

/// Computes `job`, which is RUNNING, on this thread. Its samples are in `run.samples` of the
/// result. A stop is answered within 100 ms. The time limit of its options counts from here, over
/// all that is done for it: a job that hits it ends with what it has, or with DEADLINE_EXCEEDED
/// TIME_LIMIT_EXCEEDED. Exceptions become errors: memory that is not there RESOURCE_EXHAUSTED
/// OUT_OF_MEMORY, others INTERNAL.
absl::StatusOr<JobResult> RunJob(Job& job, const RunDependencies& dependencies,
                                 const RunInputs& inputs);

}  // namespace ccst::server
