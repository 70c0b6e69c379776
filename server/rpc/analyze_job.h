#pragma once

#include "ccst/v1/sampling_service.pb.h"
#include "server/jobs/job_analyst.h"

namespace ccst::server {

/// What callers see of `figures`.
v1::AnalyzeJobResponse ToProto(const JobFigures& figures);

}  // namespace ccst::server
