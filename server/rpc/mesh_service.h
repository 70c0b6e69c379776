#pragma once

#include "ccst/v1/mesh_service.grpc.pb.h"
#include "server/rpc/mesh_support.h"
#include "server/rpc/stream_reactor.h"

namespace ccst::server {

/// ccst.v1.MeshService over a MeshStore. Nothing that blocks runs on gRPC's threads.
class MeshService final : public v1::MeshService::CallbackService {
 public:
  /// All arguments outlive the gRPC server, the executors too: what they still run ends calls.
  /// `disk` should let `max_uploads` tasks wait, and what other calls there are.
  MeshService(MeshStore& meshes, Executor& disk, Executor& decoding, const StreamSupport& streams,
              const MeshServiceOptions& options);

  grpc::ServerUnaryReactor* FindMissingMeshes(grpc::CallbackServerContext* context,
                                              const v1::FindMissingMeshesRequest* request,
                                              v1::FindMissingMeshesResponse* response) override;
  grpc::ServerReadReactor<v1::UploadMeshRequest>* UploadMesh(
      grpc::CallbackServerContext* context, v1::UploadMeshResponse* response) override;
  grpc::ServerUnaryReactor* CreateMesh(grpc::CallbackServerContext* context,
                                       const v1::CreateMeshRequest* request,
                                       v1::CreateMeshResponse* response) override;
  grpc::ServerUnaryReactor* GetMesh(grpc::CallbackServerContext* context,
                                    const v1::GetMeshRequest* request,
                                    v1::GetMeshResponse* response) override;
  grpc::ServerUnaryReactor* ListMeshes(grpc::CallbackServerContext* context,
                                       const v1::ListMeshesRequest* request,
                                       v1::ListMeshesResponse* response) override;
  grpc::ServerWriteReactor<v1::DownloadMeshResponse>* DownloadMesh(
      grpc::CallbackServerContext* context, const v1::DownloadMeshRequest* request) override;
  grpc::ServerUnaryReactor* DeleteMesh(grpc::CallbackServerContext* context,
                                       const v1::DeleteMeshRequest* request,
                                       v1::DeleteMeshResponse* response) override;

 private:
  const StreamSupport streams_;
  MeshSupport support_;
};

}  // namespace ccst::server
