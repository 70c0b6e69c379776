#pragma once

#include <optional>
#include <string>

#include "ccst/v1/job.pb.h"
#include "ccst/v1/sampling_service.pb.h"
#include "proto/convert/violations.h"
#include "server/jobs/job.h"
#include "server/jobs/job_manager.h"

namespace ccst::server {

v1::Job::State ToProto(JobState state);
/// Empty for one this version does not know.
std::optional<JobState> FromProto(v1::Job::State state);

/// The figures of a whole run.
v1::SamplingResult ToProto(const JobResult& result,
                           const std::optional<AlternationReport>& last_report);

/// The whole job as callers see it, without the bytes of an image.
v1::Job ToProto(const std::string& id, const JobSpec& spec, const JobView& view);
v1::Job ToProto(const Job& job);

/// Which jobs `owner` asks for, and how many; adds to `violations`.
JobFilter FromProto(const v1::ListJobsRequest& request, const std::string& owner,
                    Violations& violations);

}  // namespace ccst::server
