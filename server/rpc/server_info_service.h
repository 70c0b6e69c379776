#pragma once

#include <cstdint>

#include "ccst/v1/server_info_service.grpc.pb.h"
#include "core/io/mesh_limits.h"
#include "proto/convert/options.h"
#include "server/jobs/job_manager.h"
#include "server/rpc/call.h"
#include "server/rpc/mesh_support.h"
#include "server/rpc/stream_memory.h"

namespace ccst::server {

/// The limits as advertised.
v1::ServerLimits LimitsToProto(const RequestLimits& request, const MeshStoreOptions& meshes,
                               const MeshServiceOptions& transfers, const JobManagerOptions& jobs,
                               const StreamLimits& streams, std::int64_t max_data_bytes);

/// ccst.v1.ServerInfoService.
class ServerInfoService final : public v1::ServerInfoService::CallbackService {
 public:
  ServerInfoService(const JobManager& jobs, const CallSupport& support, v1::ServerLimits limits);

  grpc::ServerUnaryReactor* GetServerInfo(grpc::CallbackServerContext* context,
                                          const v1::GetServerInfoRequest* request,
                                          v1::GetServerInfoResponse* response) override;

 private:
  void Fill(v1::GetServerInfoResponse& response) const;

  const JobManager& jobs_;
  const CallSupport support_;
  const v1::ServerLimits limits_;
};

}  // namespace ccst::server
