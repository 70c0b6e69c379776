#include "server/rpc/job_messages.h"

#include "proto/convert/field_limits.h"
#include "proto/convert/job_request.h"
#include "proto/convert/names.h"
#include "proto/convert/options.h"
#include "proto/convert/progress.h"
#include "proto/convert/result.h"
#include "proto/convert/scalars.h"
#include "proto/convert/status.h"

namespace ccst::server {

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

std::optional<JobState> FromProto(v1::Job::State state) {
  for (const JobState known : {JobState::kQueued, JobState::kRunning, JobState::kCancelling,
                               JobState::kSucceeded, JobState::kFailed, JobState::kCancelled}) {
    if (ToProto(known) == state) return known;
  }
  return std::nullopt;
}

v1::SamplingResult ToProto(const JobResult& result,
                           const std::optional<AlternationReport>& last_report) {
  return ccst::ToProto(ResultFigures{.result = result.run,
                                     .record = {.last_report = last_report,
                                                .samples_sha256 = result.samples_sha256,
                                                .samples_bytes = result.samples_bytes,
                                                .queue_seconds = result.queue_seconds,
                                                .decode_seconds = result.decode_seconds,
                                                .total_seconds = result.total_seconds,
                                                .warnings = result.warnings},
                                     .sample_count = result.sample_count,
                                     .sample_mesh_face_count = result.triangle_count});
}

v1::Job ToProto(const Job& job) { return ToProto(job.id(), job.spec(), job.View()); }

v1::Job ToProto(const std::string& id, const JobSpec& spec, const JobView& view) {
  v1::Job job;
  if (!id.empty()) job.set_name(JobName(id));
  job.set_display_name(spec.display_name);
  *job.mutable_effective_options() = ccst::ToProto(spec.options);
  job.set_mesh(MeshName(spec.mesh_sha256));
  if (!spec.texture_sha256.empty()) {
    job.mutable_texture_digest()->set_sha256(spec.texture_sha256);
  }
  job.mutable_labels()->insert(spec.labels.begin(), spec.labels.end());
  job.set_result_cached(view.cached);
  // Ended states never change, and this one will run.
  job.set_state(IsPutBack(spec, view) ? v1::Job::STATE_QUEUED : ToProto(view.state));
  job.set_queue_position(view.queue_position);
  if (view.phase.has_value()) {
    AlternationReport latest;
    latest.alternation_limit = spec.options.max_iterations;
    *job.mutable_progress() = ccst::ToProto(view.last_report.value_or(latest), view.phase);
  }
  if (view.result != nullptr) {
    *job.mutable_result() = ToProto(*view.result, view.last_report);
  }
  if (!view.error.ok()) *job.mutable_error() = ccst::ToProto(view.error);
  *job.mutable_create_time() = TimestampToProto(view.create_time);
  if (view.start_time.has_value()) *job.mutable_start_time() = TimestampToProto(*view.start_time);
  if (view.end_time.has_value() && !IsPutBack(spec, view)) {
    *job.mutable_end_time() = TimestampToProto(*view.end_time);
  }
  if (view.expire_time.has_value()) {
    *job.mutable_expire_time() = TimestampToProto(*view.expire_time);
  }
  if (spec.origin.has_value()) *job.mutable_origin() = ccst::ToProto(*spec.origin);
  CutToFieldLimits(job);
  return job;
}

JobFilter FromProto(const v1::ListJobsRequest& request, const std::string& owner,
                    Violations& violations) {
  JobFilter filter;
  filter.owner = owner;
  for (const int value : request.states()) {
    const auto state = FromProto(static_cast<v1::Job::State>(value));
    if (!state.has_value()) {
      violations.Add("states", std::to_string(value) + " is no state of a job",
                     ErrorReason::kRequestInvalid);
      continue;
    }
    filter.states.push_back(*state);
  }
  if (!request.mesh().empty()) {
    filter.mesh_sha256 = Sha256OfMeshName(request.mesh(), "mesh", violations);
  }
  filter.labels = LabelsFromProto(request.labels(), "labels", violations);
  return filter;
}

}  // namespace ccst::server
