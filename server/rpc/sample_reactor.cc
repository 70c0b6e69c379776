#include "server/rpc/sample_reactor.h"

#include <algorithm>
#include <utility>

#include "core/base/status.h"
#include "proto/convert/samples.h"
#include "server/rpc/job_messages.h"

namespace ccst::server {
namespace {

// True for errors that say what is wrong with the request, or that the server has no room for its
// result just now, which is worth another try; these end the call, while a run that broke for
// another reason is a failed job of a call that went well.
bool EndsCall(const absl::Status& error) {
  const auto reason = GetErrorReason(error);
  return absl::IsInvalidArgument(error) || absl::IsFailedPrecondition(error) ||
         reason == ErrorReason::kStorageFull || reason == ErrorReason::kQueueFull;
}

}  // namespace

SampleReactor::SampleReactor(const StreamSupport& support, const JobSupport& jobs,
                             grpc::CallbackServerContext& context, v1::SampleRequest& request)
    : StreamReactor(support, context, "Sample", Scope::kFull,
                    std::max(kMaxChunkBytes, EventBytes(request.preview_sample_count()))),
      jobs_(jobs),
      request_(request) {}

absl::Status SampleReactor::Open(Call& call) {
  CCST_RETURN_IF_ERROR(call.Received(request_));
  call.record().samples_requested = request_.options().sample_count();
  JobCall asked;
  CCST_ASSIGN_OR_RETURN(asked, FromProto(request_, jobs_.limits));
  const int preview_count = asked.preview_sample_count;
  CCST_ASSIGN_OR_RETURN(job_, Submit(jobs_, call.caller(), std::move(asked), request_));
  call.record().job = job_->name();
  events_.emplace(job_, 0, preview_count);
  has_job_ = true;
  CCST_ASSIGN_OR_RETURN(watcher_, jobs_.jobs.Watch(
                                      *job_, [this] { Pump(); }, preview_count));
  return absl::OkStatus();
}

StreamStep SampleReactor::Next(v1::SampleResponse& message) {
  if (closed_) return StreamStep::kEnd;
  const StreamStep step = NextInMemory(message);
  return step == StreamStep::kRead ? AfterEvents(message) : step;
}

StreamStep SampleReactor::NextInMemory(v1::SampleResponse& message) {
  if (closed_) return StreamStep::kRead;
  switch (events_->Next()) {
    case JobEvents::Kind::kNothing:
      return StreamStep::kWait;
    case JobEvents::Kind::kSnapshot:
      *message.mutable_snapshot() = events_->snapshot();
      return StreamStep::kWrite;
    case JobEvents::Kind::kProgress:
      *message.mutable_progress() = events_->progress();
      return StreamStep::kWrite;
    case JobEvents::Kind::kPreview:
      *message.mutable_preview() = events_->preview();
      return StreamStep::kWrite;
    case JobEvents::Kind::kEnd:
      break;
  }
  return StreamStep::kRead;
}

StreamStep SampleReactor::AfterEvents(v1::SampleResponse& message) {
  const JobView& end = events_->end();
  if (end.state == JobState::kCancelled) {
    return End(end.stop_cause == StopCause::kDrain
                   ? GoingAway()
                   : MakeError(absl::StatusCode::kCancelled, ErrorReason::kCancelled,
                               "stopped on request"));
  }
  if (EndsCall(end.error)) return End(end.error);
  if (end.result != nullptr) {
    if (!chunks_.has_value()) {
      auto stored = jobs_.jobs.OpenSamples(*job_);
      if (!stored.ok()) return End(stored.status());
      chunks_.emplace(*std::move(stored), 0, 0);
    }
    absl::Status read;
    if (chunks_->has_sample()) {
      read = chunks_->NextSamples(*message.mutable_samples());
      return read.ok() ? StreamStep::kWrite : End(read);
    }
    if (chunks_->has_triangle()) {
      read = chunks_->NextTriangles(*message.mutable_sample_mesh());
      return read.ok() ? StreamStep::kWrite : End(read);
    }
  }
  *message.mutable_snapshot() = ToProto(job_->id(), job_->spec(), end);
  closed_ = true;
  return StreamStep::kWrite;
}

StreamStep SampleReactor::End(absl::Status status) {
  end_status_ = std::move(status);
  closed_ = true;
  return StreamStep::kEnd;
}

bool SampleReactor::MakeHeartbeat(v1::SampleResponse& message) {
  message.mutable_heartbeat();
  return true;
}

bool SampleReactor::MoreFollows(const v1::SampleResponse& message) {
  // Of reports all but the last that are there.
  return message.has_samples() || message.has_sample_mesh() ||
         (message.has_progress() && events_->has_report());
}

void SampleReactor::OnGone() {
  // At once, for the worker's sake; Close() writes it down.
  if (has_job_) jobs_.jobs.Stop(*job_, StopCause::kCaller);
}

void SampleReactor::Close() {
  if (chunks_.has_value()) call().record().samples_sent = chunks_->next_sample();
  chunks_.reset();
  if (job_ == nullptr) return;
  if (watcher_.has_value()) jobs_.jobs.Unwatch(*job_, *watcher_);
  // What cannot be written down now is cancelled when the server starts next.
  jobs_.jobs.Cancel(job_, StopCause::kCaller).IgnoreError();
}

}  // namespace ccst::server
