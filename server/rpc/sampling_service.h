#pragma once

#include "ccst/v1/sampling_service.grpc.pb.h"
#include "server/rpc/job_intake.h"
#include "server/rpc/stream_reactor.h"

namespace ccst::server {

/// ccst.v1.SamplingService over a JobManager. Nothing is computed, and nothing waits for the disk,
/// on gRPC's threads.
class SamplingService final : public v1::SamplingService::CallbackService {
 public:
  /// `support` and `jobs` outlive it.
  SamplingService(const StreamSupport& support, const JobSupport& jobs);

  grpc::ServerWriteReactor<v1::SampleResponse>* Sample(grpc::CallbackServerContext* context,
                                                       const v1::SampleRequest* request) override;
  grpc::ServerUnaryReactor* CreateJob(grpc::CallbackServerContext* context,
                                      const v1::CreateJobRequest* request,
                                      v1::CreateJobResponse* response) override;
  grpc::ServerUnaryReactor* GetJob(grpc::CallbackServerContext* context,
                                   const v1::GetJobRequest* request,
                                   v1::GetJobResponse* response) override;
  grpc::ServerUnaryReactor* ListJobs(grpc::CallbackServerContext* context,
                                     const v1::ListJobsRequest* request,
                                     v1::ListJobsResponse* response) override;
  grpc::ServerWriteReactor<v1::WatchJobResponse>* WatchJob(
      grpc::CallbackServerContext* context, const v1::WatchJobRequest* request) override;
  grpc::ServerUnaryReactor* CancelJob(grpc::CallbackServerContext* context,
                                      const v1::CancelJobRequest* request,
                                      v1::CancelJobResponse* response) override;
  grpc::ServerWriteReactor<v1::ReadSamplesResponse>* ReadSamples(
      grpc::CallbackServerContext* context, const v1::ReadSamplesRequest* request) override;
  grpc::ServerWriteReactor<v1::ReadSampleMeshResponse>* ReadSampleMesh(
      grpc::CallbackServerContext* context, const v1::ReadSampleMeshRequest* request) override;
  grpc::ServerUnaryReactor* AnalyzeJob(grpc::CallbackServerContext* context,
                                       const v1::AnalyzeJobRequest* request,
                                       v1::AnalyzeJobResponse* response) override;
  grpc::ServerUnaryReactor* DeleteJob(grpc::CallbackServerContext* context,
                                      const v1::DeleteJobRequest* request,
                                      v1::DeleteJobResponse* response) override;

 private:
  const StreamSupport support_;
  const JobSupport jobs_;
};

}  // namespace ccst::server
