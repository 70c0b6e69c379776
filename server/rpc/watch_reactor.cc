#include "server/rpc/watch_reactor.h"

#include <string>

#include "core/base/status.h"
#include "proto/convert/names.h"
#include "proto/convert/scalars.h"
#include "server/rpc/job_messages.h"

namespace ccst::server {

WatchReactor::WatchReactor(const StreamSupport& support, const JobSupport& jobs,
                           grpc::CallbackServerContext& context, const v1::WatchJobRequest& request)
    : StreamReactor(support, context, "WatchJob", Scope::kReadOnly,
                    EventBytes(request.preview_sample_count())),
      jobs_(jobs),
      request_(request) {}

absl::Status WatchReactor::Open(Call& call) {
  CCST_RETURN_IF_ERROR(call.Received(request_));
  Violations violations;
  const std::string id = IdOfJobName(request_.name(), "name", violations);
  if (request_.after_sequence() < 0) {
    violations.Add("after_sequence", "must be at least 0", ErrorReason::kRequestInvalid);
  }
  if (request_.has_min_progress_interval()) {
    if (!IsPositiveDuration(request_.min_progress_interval())) {
      violations.Add("min_progress_interval", "must be a valid duration above 0",
                     ErrorReason::kRequestInvalid);
    }
    min_interval_seconds_ = SecondsFromProto(request_.min_progress_interval());
  }
  CheckPreview(request_.preview_sample_count(), violations);
  CCST_RETURN_IF_ERROR(violations.ToStatus());
  CCST_ASSIGN_OR_RETURN(job_, jobs_.jobs.Find(call.caller().visible_owner(), id));
  call.record().job = job_->name();
  CCST_RETURN_IF_ERROR(job_->history_status());
  events_.emplace(job_, request_.after_sequence(), request_.preview_sample_count());
  CCST_ASSIGN_OR_RETURN(watcher_, jobs_.jobs.Watch(
                                      *job_, [this] { Pump(); }, request_.preview_sample_count()));
  return absl::OkStatus();
}

StreamStep WatchReactor::Next(v1::WatchJobResponse& message) {
  while (!closed_) {
    switch (events_->Next()) {
      case JobEvents::Kind::kNothing:
        return StreamStep::kWait;
      case JobEvents::Kind::kSnapshot:
        *message.mutable_snapshot() = events_->snapshot();
        return StreamStep::kWrite;
      case JobEvents::Kind::kProgress:
        if (IsTooSoon()) continue;
        message.set_sequence(events_->sequence());
        *message.mutable_progress() = events_->progress();
        return StreamStep::kWrite;
      case JobEvents::Kind::kPreview:
        *message.mutable_preview() = events_->preview();
        return StreamStep::kWrite;
      case JobEvents::Kind::kEnd:
        break;
    }
    closed_ = true;
    const JobView& end = events_->end();
    if (IsPutBack(job_->spec(), end)) {
      end_status_ = GoingAway();
      return StreamStep::kEnd;
    }
    message.set_sequence(events_->sequence());
    *message.mutable_snapshot() = ToProto(job_->id(), job_->spec(), end);
    return StreamStep::kWrite;
  }
  return StreamStep::kEnd;
}

bool WatchReactor::MoreFollows(const v1::WatchJobResponse& message) {
  // Of the reports that are there all but the last, where none of them is left out.
  return message.has_progress() && min_interval_seconds_ == 0.0 && events_->has_report();
}

bool WatchReactor::IsTooSoon() {
  const double now = events_->elapsed_seconds();
  if (last_progress_seconds_.has_value() && now - *last_progress_seconds_ < min_interval_seconds_) {
    return true;
  }
  last_progress_seconds_ = now;
  return false;
}

bool WatchReactor::MakeHeartbeat(v1::WatchJobResponse& message) {
  message.mutable_heartbeat();
  return true;
}

void WatchReactor::Close() {
  if (watcher_.has_value()) jobs_.jobs.Unwatch(*job_, *watcher_);
}

}  // namespace ccst::server
