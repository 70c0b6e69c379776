#include "server/rpc/sample_stream.h"

#include <algorithm>
#include <utility>

#include "core/base/status.h"
#include "proto/convert/progress.h"
#include "proto/convert/samples.h"
#include "server/rpc/job_messages.h"

namespace ccst::server {
namespace {

// True for errors that say what is wrong with the request; these end the call, while a run that
// broke for another reason is a failed job of a call that went well.
bool LiesInRequest(const absl::Status& error) {
  return absl::IsInvalidArgument(error) || absl::IsFailedPrecondition(error);
}

absl::Status StopError(StopCause cause) {
  if (cause == StopCause::kDrain) {
    return MakeError(absl::StatusCode::kUnavailable, ErrorReason::kDraining,
                     "the server went away before the run was done");
  }
  return MakeError(absl::StatusCode::kCancelled, ErrorReason::kCancelled, "stopped on request");
}

}  // namespace

SampleStream::SampleStream(std::shared_ptr<const Job> job,
                           const std::optional<Eigen::Vector3d>& origin)
    : job_(std::move(job)), origin_(origin) {}

SampleStream::Step SampleStream::Next(v1::SampleResponse& message) {
  message.Clear();
  if (closed_) return Step::kEnd;
  if (WriteSnapshot(message) || WriteReport(message)) return Step::kWrite;
  if (ended_.has_value()) return Close(message);
  return WritePreview(message) ? Step::kWrite : Step::kWait;
}

bool SampleStream::WriteSnapshot(v1::SampleResponse& message) {
  if (ended_.has_value() || job_->Version() == seen_version_) return false;
  const bool first = seen_version_ == 0;
  JobView view = job_->View();
  seen_version_ = view.version;
  if (HasEnded(view.state)) {
    ended_ = view;
    if (!first) return false;
    // A run faster than its first message: say that it runs; how it ended comes last.
    view.state = JobState::kRunning;
    view.result = nullptr;
    view.error = absl::OkStatus();
    view.end_time.reset();
  }
  *message.mutable_snapshot() = ToProto(view, origin_);
  return true;
}

bool SampleStream::WriteReport(v1::SampleResponse& message) {
  const auto report = job_->Report(next_report_);
  if (!report.has_value()) return false;
  *message.mutable_progress() = ccst::ToProto(*report, Phase::kRelaxing);
  ++next_report_;
  return true;
}

bool SampleStream::WritePreview(v1::SampleResponse& message) {
  std::shared_ptr<const JobPreview> preview = job_->Preview();
  if (preview == nullptr || preview == seen_preview_) return false;
  v1::SamplePreview& out = *message.mutable_preview();
  out.set_iteration(preview->alternation);
  out.mutable_positions()->Add(preview->positions.begin(), preview->positions.end());
  seen_preview_ = std::move(preview);
  return true;
}

bool SampleStream::WriteSamples(v1::SampleResponse& message) {
  const SampleSet& samples = ended_->result->run.samples;
  const auto sample_count = static_cast<std::int64_t>(samples.faces.size());
  if (next_sample_ < sample_count) {
    const std::int64_t count = std::min(SamplesPerChunk(samples), sample_count - next_sample_);
    *message.mutable_samples() = SampleChunkToProto(samples, next_sample_, count);
    next_sample_ += count;
    return true;
  }
  const auto triangle_count = static_cast<std::int64_t>(samples.triangles.size());
  if (next_triangle_ < triangle_count) {
    const std::int64_t count = std::min(kMaxChunkLength, triangle_count - next_triangle_);
    *message.mutable_sample_mesh() = SampleMeshChunkToProto(samples, next_triangle_, count);
    next_triangle_ += count;
    return true;
  }
  return false;
}

SampleStream::Step SampleStream::Close(v1::SampleResponse& message) {
  if (ended_->state == JobState::kSucceeded && WriteSamples(message)) return Step::kWrite;
  closed_ = true;
  if (ended_->state == JobState::kCancelled) {
    end_status_ = StopError(ended_->stop_cause);
    return Step::kEnd;
  }
  if (ended_->state == JobState::kFailed && LiesInRequest(ended_->error)) {
    end_status_ = ended_->error;
    return Step::kEnd;
  }
  *message.mutable_snapshot() = ToProto(*ended_, origin_);
  return Step::kWrite;
}

}  // namespace ccst::server
