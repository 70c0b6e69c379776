#include "server/rpc/sample_reactor.h"

#include <exception>
#include <new>
#include <utility>

#include "core/base/status.h"

namespace ccst::server {
namespace {

absl::Status OutOfMemory() {
  return MakeError(absl::StatusCode::kResourceExhausted, ErrorReason::kOutOfMemory,
                   "the answer needs more memory than there is");
}

}  // namespace

SampleReactor::SampleReactor(JobRunner& runner, const CallSupport& support,
                             const grpc::CallbackServerContext& context)
    : runner_(runner), call_(support, context, "Sample", Scope::kFull) {}

void SampleReactor::Start(v1::SampleRequest& request, const RequestLimits& limits,
                          int threads_per_job) {
  absl::Status status;
  try {
    status = Submit(request, limits, threads_per_job);
  } catch (const std::bad_alloc&) {
    status = OutOfMemory();
  }
  if (!status.ok()) {
    MutexLock lock(mutex_);
    FinishWith(status);
    return;
  }
  job_->SetWatcher([this] { Pump(); });
  Pump();
}

absl::Status SampleReactor::Submit(v1::SampleRequest& request, const RequestLimits& limits,
                                   int threads_per_job) {
  {
    MutexLock lock(mutex_);
    call_.Received(request);
    CCST_RETURN_IF_ERROR(call_.admission());
    call_.record().samples_requested = request.options().sample_count();
  }
  SampleCall call;
  CCST_ASSIGN_OR_RETURN(call, FromProto(request, limits));
  call.options.thread_count = threads_per_job;
  CCST_ASSIGN_OR_RETURN(
      job_, runner_.Submit({.mesh = std::move(*request.mutable_inline_mesh()->mutable_data()),
                            .options = call.options,
                            .preview_sample_count = call.preview_sample_count}));
  MutexLock lock(mutex_);
  call_.record().job = job_->name();
  stream_.emplace(job_, call.has_origin ? std::optional(call.origin) : std::nullopt);
  return absl::OkStatus();
}

void SampleReactor::Pump() {
  MutexLock lock(mutex_);
  if (writing_ || finished_) return;
  if (caller_gone_) {
    FinishWith(MakeError(absl::StatusCode::kCancelled, ErrorReason::kCancelled,
                         "the caller went away or its deadline passed"));
    return;
  }
  try {
    switch (stream_->Next(message_)) {
      case SampleStream::Step::kWait:
        return;
      case SampleStream::Step::kEnd:
        FinishWith(stream_->end_status());
        return;
      case SampleStream::Step::kWrite:
        break;
    }
  } catch (const std::bad_alloc&) {
    FinishWith(OutOfMemory());
    return;
  }
  grpc::WriteOptions options;
  // More follows at once after a chunk: let the transport fill its frames.
  if (message_.has_samples() || message_.has_sample_mesh()) options.set_buffer_hint();
  writing_ = true;
  call_.Sent(message_);
  StartWrite(&message_, options);
}

void SampleReactor::FinishWith(const absl::Status& status) {
  finished_ = true;
  Finish(call_.End(status));
}

void SampleReactor::OnWriteDone(bool ok) {
  {
    MutexLock lock(mutex_);
    writing_ = false;
    if (!ok) caller_gone_ = true;
  }
  Pump();
}

void SampleReactor::OnCancel() {
  {
    MutexLock lock(mutex_);
    caller_gone_ = true;
  }
  // Outside the lock: the job tells its watcher, which takes it.
  if (job_ != nullptr) runner_.Cancel(*job_, StopCause::kCaller);
  Pump();
}

void SampleReactor::OnDone() {
  if (job_ != nullptr) runner_.Release(*job_);
  {
    MutexLock lock(mutex_);
    if (stream_.has_value()) call_.record().samples_sent = stream_->samples_written();
  }
  delete this;
}

}  // namespace ccst::server
