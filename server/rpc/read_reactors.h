#pragma once

#include <optional>

#include "ccst/v1/sampling_service.pb.h"
#include "server/rpc/job_intake.h"
#include "server/rpc/sample_chunks.h"
#include "server/rpc/stream_reactor.h"

namespace ccst::server {

/// One `ReadSamples` call.
class ReadSamplesReactor final : public StreamReactor<v1::ReadSamplesResponse> {
 public:
  ReadSamplesReactor(const StreamSupport& support, const JobSupport& jobs,
                     const grpc::CallbackServerContext& context,
                     const v1::ReadSamplesRequest& request);

 protected:
  absl::Status Open(Call& call) override;
  StreamStep Next(v1::ReadSamplesResponse& message) override;
  absl::Status end_status() override { return end_status_; }
  bool MoreFollows(const v1::ReadSamplesResponse& message) override;

 private:
  const JobSupport& jobs_;
  const v1::ReadSamplesRequest& request_;
  std::optional<SampleChunks> chunks_;
  absl::Status end_status_;
};

/// One `ReadSampleMesh` call.
class ReadSampleMeshReactor final : public StreamReactor<v1::ReadSampleMeshResponse> {
 public:
  ReadSampleMeshReactor(const StreamSupport& support, const JobSupport& jobs,
                        const grpc::CallbackServerContext& context,
                        const v1::ReadSampleMeshRequest& request);

 protected:
  absl::Status Open(Call& call) override;
  StreamStep Next(v1::ReadSampleMeshResponse& message) override;
  absl::Status end_status() override { return end_status_; }
  bool MoreFollows(const v1::ReadSampleMeshResponse& message) override;

 private:
  const JobSupport& jobs_;
  const v1::ReadSampleMeshRequest& request_;
  std::optional<SampleChunks> chunks_;
  absl::Status end_status_;
};

}  // namespace ccst::server
