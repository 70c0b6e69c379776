#pragma once

#include "absl/status/statusor.h"
#include "ccst/v1/sampling_service.pb.h"
#include "server/rpc/job_intake.h"

namespace ccst::server {

/// Measures the samples of a job (core/quality). Cost O(n log n), about 2 s for a million samples.
/// @errors as JobManager::OpenSamples()
absl::StatusOr<v1::AnalyzeJobResponse> Analyze(const JobSupport& support, const Job& job);

}  // namespace ccst::server
