#include "server/rpc/sampling_service.h"

#include "server/rpc/sample_reactor.h"

namespace ccst::server {

SamplingService::SamplingService(JobRunner& runner, const CallSupport& support,
                                 const RequestLimits& limits, int threads_per_job)
    : runner_(runner), support_(support), limits_(limits), threads_per_job_(threads_per_job) {}

grpc::ServerWriteReactor<v1::SampleResponse>* SamplingService::Sample(
    grpc::CallbackServerContext* context, const v1::SampleRequest* request) {
  auto* reactor = new SampleReactor(runner_, support_, *context);
  // The request is this call's alone, and no const object: gRPC parsed it and keeps it until the
  // call is done. Moving the mesh out lets go of it after decoding and saves a copy.
  reactor->Start(const_cast<v1::SampleRequest&>(*request), limits_, threads_per_job_);
  return reactor;
}

}  // namespace ccst::server
