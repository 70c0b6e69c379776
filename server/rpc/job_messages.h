#pragma once

#include <optional>

#include <Eigen/Core>

#include "ccst/v1/job.pb.h"
#include "server/jobs/job.h"

namespace ccst::server {

v1::Job::State ToProto(JobState state);

/// The whole job as callers see it; `origin` is the request's.
v1::Job ToProto(const JobView& view, const std::optional<Eigen::Vector3d>& origin);

}  // namespace ccst::server
