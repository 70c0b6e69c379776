#include <cstdint>
#include <string>

#include <grpcpp/client_context.h>

#include "client/lib/checked_outcome.h"
#include "client/lib/client.h"
#include "client/lib/grpc_error.h"
#include "client/lib/retry.h"
#include "core/base/status.h"
#include "proto/convert/progress.h"

namespace ccst {
namespace {

// What was seen of a job, over all its streams.
class Watcher {
 public:
  Watcher(const SampleCallbacks& callbacks, Retry& retry) : callbacks_(callbacks), retry_(retry) {}

  void Take(const v1::WatchJobResponse& message) {
    retry_.Heard();
    if (message.has_snapshot()) {
      job_ = message.snapshot();
      if (callbacks_.on_snapshot) callbacks_.on_snapshot(job_);
    } else if (message.has_progress() && message.sequence() > sequence_) {
      sequence_ = message.sequence();
      if (callbacks_.on_progress) callbacks_.on_progress(FromProto(message.progress()));
    } else if (message.has_preview() && callbacks_.on_preview) {
      callbacks_.on_preview(message.preview());
    }
  }

  const v1::Job& job() const { return job_; }
  std::int64_t sequence() const { return sequence_; }

 private:
  const SampleCallbacks& callbacks_;
  Retry& retry_;
  v1::Job job_;
  std::int64_t sequence_ = 0;  // Of the last progress.
};

absl::Status Follow(v1::SamplingService::StubInterface& stub, const std::string& name,
                    Watcher& watcher, const std::stop_token& stop) {
  grpc::ClientContext context;
  const std::stop_callback cancel(stop, [&context] { context.TryCancel(); });
  v1::WatchJobRequest request;
  request.set_name(name);
  request.set_after_sequence(watcher.sequence());
  const auto reader = stub.WatchJob(&context, request);
  v1::WatchJobResponse message;
  while (reader->Read(&message)) watcher.Take(message);
  const grpc::Status status = reader->Finish();
  if (HasEnded(watcher.job())) return absl::OkStatus();
  if (status.ok()) return absl::UnavailableError("the stream ended before the job did");
  return FromGrpcStatus(status, CallStage::kStreaming);
}

}  // namespace

absl::StatusOr<v1::Job> Client::WatchJob(const std::string& name, const WatchOptions& options,
                                         const std::stop_token& stop) {
  Retry retry(stop, options.patience_seconds);
  Watcher watcher(options.callbacks, retry);
  for (;;) {
    const absl::Status status = Follow(*sampling_, name, watcher, stop);
    if (status.ok()) return watcher.job();
    if (absl::IsUnavailable(status) && options.on_lost && !stop.stop_requested()) {
      options.on_lost(status);
    }
    CCST_RETURN_IF_ERROR(retry.Wait(status));
  }
}

}  // namespace ccst
