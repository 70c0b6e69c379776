#pragma once

#include "ccst/v1/sampling_service.grpc.pb.h"
#include "proto/convert/options.h"
#include "server/jobs/job_runner.h"
#include "server/rpc/call.h"

namespace ccst::server {

/// ccst.v1.SamplingService over a JobRunner. Nothing is computed on gRPC's threads.
class SamplingService final : public v1::SamplingService::CallbackService {
 public:
  SamplingService(JobRunner& runner, const CallSupport& support, const RequestLimits& limits,
                  int threads_per_job);

  grpc::ServerWriteReactor<v1::SampleResponse>* Sample(grpc::CallbackServerContext* context,
                                                       const v1::SampleRequest* request) override;

 private:
  JobRunner& runner_;
  const CallSupport support_;
  const RequestLimits limits_;
  const int threads_per_job_;
};

}  // namespace ccst::server
