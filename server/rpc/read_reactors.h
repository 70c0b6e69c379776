#pragma once

#include <optional>
#include <string_view>

#include "ccst/v1/sampling_service.pb.h"
#include "server/rpc/job_intake.h"
#include "server/rpc/sample_chunks.h"
#include "server/rpc/stream_reactor.h"

namespace ccst::server {

/// One call that streams what an ended job left, from `request.start_index` on, in chunks under
/// 1 MiB: `ReadSamples` or `ReadSampleMesh`.
template <typename Request, typename Response>
class ReadReactor final : public StreamReactor<Response> {
 public:
  ReadReactor(const StreamSupport& support, const JobSupport& jobs,
              grpc::CallbackServerContext& context, const Request& request);

 protected:
  absl::Status Open(Call& call) override;
  StreamStep Next(Response& message) override;
  absl::Status end_status() override { return end_status_; }
  bool MoreFollows(const Response& message) override;
  void Close() override { chunks_.reset(); }

 private:
  const JobSupport& jobs_;
  const Request& request_;
  std::optional<SampleChunks> chunks_;
  absl::Status end_status_;
};

using ReadSamplesReactor = ReadReactor<v1::ReadSamplesRequest, v1::ReadSamplesResponse>;
using ReadSampleMeshReactor = ReadReactor<v1::ReadSampleMeshRequest, v1::ReadSampleMeshResponse>;

}  // namespace ccst::server
