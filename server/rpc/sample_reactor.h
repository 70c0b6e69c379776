#pragma once

#include <memory>
#include <optional>

#include "ccst/v1/sampling_service.pb.h"
#include "server/rpc/job_events.h"
#include "server/rpc/job_intake.h"
#include "server/rpc/sample_chunks.h"
#include "server/rpc/stream_reactor.h"

namespace ccst::server {

/// One `Sample` call: a job that ends with its caller, its events, then samples and sample mesh,
/// and last the ended job.
class SampleReactor final : public StreamReactor<v1::SampleResponse> {
 public:
  /// Takes the mesh's bytes out of `request`.
  SampleReactor(const StreamSupport& support, const JobSupport& jobs,
                grpc::CallbackServerContext& context, v1::SampleRequest& request);

 protected:
  absl::Status Open(Call& call) override;
  StreamStep Next(v1::SampleResponse& message) override;
  StreamStep NextInMemory(v1::SampleResponse& message) override;
  absl::Status end_status() override { return end_status_; }
  bool MakeHeartbeat(v1::SampleResponse& message) override;
  bool MoreFollows(const v1::SampleResponse& message) override;
  void OnGone() override;
  void Close() override;

 private:
  StreamStep AfterEvents(v1::SampleResponse& message);
  StreamStep End(absl::Status status);

  const JobSupport& jobs_;
  v1::SampleRequest& request_;
  // Set once, by Open(), before anything else is told of the job.
  std::shared_ptr<Job> job_;
  std::atomic<bool> has_job_ = false;
  std::optional<std::int64_t> watcher_;
  std::optional<JobEvents> events_;
  std::optional<SampleChunks> chunks_;
  bool closed_ = false;
  absl::Status end_status_;
};

}  // namespace ccst::server
