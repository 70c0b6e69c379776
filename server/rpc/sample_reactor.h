#pragma once

#include <memory>
#include <optional>

#include <grpcpp/server_context.h>
#include <grpcpp/support/server_callback.h>

#include "absl/status/status.h"
#include "ccst/v1/sampling_service.pb.h"
#include "proto/convert/options.h"
#include "server/jobs/job_runner.h"
#include "server/base/mutex.h"
#include "server/rpc/call.h"
#include "server/rpc/sample_stream.h"

namespace ccst::server {

/// One `Sample` call: submits the job, writes its stream one message after the other as fast as
/// the caller reads, and stops the job when the caller goes away. Deletes itself when done.
class SampleReactor final : public grpc::ServerWriteReactor<v1::SampleResponse> {
 public:
  SampleReactor(JobRunner& runner, const CallSupport& support,
                const grpc::CallbackServerContext& context);

  /// Takes the mesh's bytes out of `request`.
  void Start(v1::SampleRequest& request, const RequestLimits& limits, int threads_per_job);

  void OnWriteDone(bool ok) override;
  void OnCancel() override;
  void OnDone() override;

 private:
  absl::Status Submit(v1::SampleRequest& request, const RequestLimits& limits, int threads_per_job);
  // Starts the next write or ends the call, unless a write is under way or nothing is new.
  void Pump() ABSL_LOCKS_EXCLUDED(mutex_);
  void FinishWith(const absl::Status& status) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  JobRunner& runner_;
  std::shared_ptr<Job> job_;  // Null when the request was refused; set before any reaction.

  Mutex mutex_;
  std::optional<SampleStream> stream_ ABSL_GUARDED_BY(mutex_);
  v1::SampleResponse message_ ABSL_GUARDED_BY(mutex_);  // The one being written.
  bool writing_ ABSL_GUARDED_BY(mutex_) = false;
  bool caller_gone_ ABSL_GUARDED_BY(mutex_) = false;
  bool finished_ ABSL_GUARDED_BY(mutex_) = false;
  Call call_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace ccst::server
