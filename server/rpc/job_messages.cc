#include "server/rpc/job_messages.h"

#include "proto/convert/options.h"
#include "proto/convert/progress.h"
#include "proto/convert/result.h"
#include "proto/convert/scalars.h"
#include "proto/convert/status.h"

namespace ccst::server {
namespace {

v1::SamplingResult ToProto(const JobResult& result,
                           const std::optional<AlternationReport>& last_report) {
  return ccst::ToProto(result.run, RunRecord{.last_report = last_report,
                                             .samples_sha256 = result.samples_sha256,
                                             .samples_bytes = result.samples_bytes,
                                             .queue_seconds = result.queue_seconds,
                                             .decode_seconds = result.decode_seconds,
                                             .total_seconds = result.total_seconds,
                                             .warnings = result.warnings});
}

}  // namespace

v1::Job::State ToProto(JobState state) {
  switch (state) {
    case JobState::kQueued:
      return v1::Job::STATE_QUEUED;
    case JobState::kRunning:
      return v1::Job::STATE_RUNNING;
    case JobState::kCancelling:
      return v1::Job::STATE_CANCELLING;
    case JobState::kSucceeded:
      return v1::Job::STATE_SUCCEEDED;
    case JobState::kFailed:
      return v1::Job::STATE_FAILED;
    case JobState::kCancelled:
      return v1::Job::STATE_CANCELLED;
  }
  return v1::Job::STATE_UNSPECIFIED;
}

v1::Job ToProto(const JobView& view, const std::optional<Eigen::Vector3d>& origin) {
  v1::Job job;
  job.set_name(view.name);
  *job.mutable_effective_options() = ccst::ToProto(view.options);
  if (job.effective_options().has_texture()) {
    job.mutable_effective_options()->mutable_texture()->clear_image();
  }
  job.set_state(ToProto(view.state));
  job.set_queue_position(view.queue_position);
  if (view.phase.has_value()) {
    AlternationReport latest;
    latest.alternation_limit = view.options.max_iterations;
    *job.mutable_progress() = ccst::ToProto(view.last_report.value_or(latest), view.phase);
  }
  if (view.result != nullptr) {
    *job.mutable_result() = ToProto(*view.result, view.last_report);
  }
  if (!view.error.ok()) *job.mutable_error() = ccst::ToProto(view.error);
  *job.mutable_create_time() = TimestampToProto(view.create_time);
  if (view.start_time.has_value()) *job.mutable_start_time() = TimestampToProto(*view.start_time);
  if (view.end_time.has_value()) *job.mutable_end_time() = TimestampToProto(*view.end_time);
  if (origin.has_value()) *job.mutable_origin() = ccst::ToProto(*origin);
  return job;
}

}  // namespace ccst::server
