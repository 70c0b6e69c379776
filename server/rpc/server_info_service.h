#pragma once

#include <cstdint>

#include "ccst/v1/server_info_service.grpc.pb.h"
#include "core/io/mesh_limits.h"
#include "proto/convert/options.h"
#include "server/jobs/job_runner.h"
#include "server/rpc/call.h"

namespace ccst::server {

/// The limits as advertised.
v1::ServerLimits ToProto(const RequestLimits& request, const MeshLimits& mesh,
                         const RunnerOptions& runner);

/// ccst.v1.ServerInfoService.
class ServerInfoService final : public v1::ServerInfoService::CallbackService {
 public:
  ServerInfoService(const JobRunner& runner, const CallSupport& support, v1::ServerLimits limits);

  grpc::ServerUnaryReactor* GetServerInfo(grpc::CallbackServerContext* context,
                                          const v1::GetServerInfoRequest* request,
                                          v1::GetServerInfoResponse* response) override;

 private:
  void Fill(v1::GetServerInfoResponse& response) const;

  const JobRunner& runner_;
  const CallSupport support_;
  const v1::ServerLimits limits_;
};

}  // namespace ccst::server
