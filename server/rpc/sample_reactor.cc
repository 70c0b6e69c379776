#include "server/rpc/sample_reactor.h"

#include <exception>
#include <new>
#include <string>
#include <utility>

#include "core/base/status.h"
#include "server/rpc/grpc_status.h"

namespace ccst::server {
namespace {

absl::Status OutOfMemory() {
  return MakeError(absl::StatusCode::kResourceExhausted, ErrorReason::kOutOfMemory,
                   "the answer needs more memory than there is");
}

}  // namespace

SampleReactor::SampleReactor(JobRunner& runner, ServerLog& log, const Clock& clock)
    : runner_(runner), log_(log), clock_(clock), start_seconds_(clock.seconds()) {
  record_.method = "Sample";
}

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
    record_.request_bytes = static_cast<std::int64_t>(request.inline_mesh().data().size());
    record_.samples_requested = request.options().sample_count();
  }
  SampleCall call;
  CCST_ASSIGN_OR_RETURN(call, FromProto(request, limits));
  call.options.thread_count = threads_per_job;
  CCST_ASSIGN_OR_RETURN(
      job_, runner_.Submit({.mesh = std::move(*request.mutable_inline_mesh()->mutable_data()),
                            .options = call.options,
                            .preview_sample_count = call.preview_sample_count}));
  MutexLock lock(mutex_);
  record_.job = job_->name();
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
  ++record_.messages_sent;
  StartWrite(&message_, options);
}

void SampleReactor::FinishWith(const absl::Status& status) {
  finished_ = true;
  record_.code = absl::StatusCodeToString(status.code());
  if (const auto reason = GetErrorReason(status)) {
    record_.reason = std::string(ErrorReasonName(*reason));
  }
  Finish(ToGrpcStatus(status));
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
    record_.seconds = clock_.seconds() - start_seconds_;
    if (stream_.has_value()) record_.samples_sent = stream_->samples_written();
    log_.Request(record_);
  }
  delete this;
}

}  // namespace ccst::server
