#pragma once

#include <memory>
#include <optional>

#include "ccst/v1/sampling_service.pb.h"
#include "server/rpc/job_events.h"
#include "server/rpc/job_intake.h"
#include "server/rpc/stream_reactor.h"

namespace ccst::server {

/// One `WatchJob` call.
class WatchReactor final : public StreamReactor<v1::WatchJobResponse> {
 public:
  WatchReactor(const StreamSupport& support, const JobSupport& jobs,
               grpc::CallbackServerContext& context, const v1::WatchJobRequest& request);

 protected:
  absl::Status Open(Call& call) override;
  StreamStep Next(v1::WatchJobResponse& message) override;
  StreamStep NextInMemory(v1::WatchJobResponse& message) override {
    return closed_ ? StreamStep::kRead : Next(message);
  }
  bool MoreFollows(const v1::WatchJobResponse& message) override;
  absl::Status end_status() override { return end_status_; }
  bool MakeHeartbeat(v1::WatchJobResponse& message) override;
  void Close() override;

 private:
  bool IsTooSoon();

  const JobSupport& jobs_;
  const v1::WatchJobRequest& request_;
  double min_interval_seconds_ = 0.0;
  std::shared_ptr<Job> job_;
  std::optional<std::int64_t> watcher_;
  std::optional<JobEvents> events_;
  std::optional<double> last_progress_seconds_;
  bool closed_ = false;
  absl::Status end_status_;
};

}  // namespace ccst::server
