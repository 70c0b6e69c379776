#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include <grpcpp/server_context.h>
#include <grpcpp/support/server_callback.h>

#include "absl/status/status.h"
#include "ccst/v1/mesh_service.pb.h"
#include "server/rpc/call.h"
#include "server/rpc/mesh_support.h"

namespace ccst::server {

/// One `DownloadMesh` call: a chunk is read from the disk when the one before has left. Deletes
/// itself when done.
class DownloadReactor final : public grpc::ServerWriteReactor<v1::DownloadMeshResponse> {
 public:
  DownloadReactor(MeshSupport& support, const grpc::CallbackServerContext& context,
                  const v1::DownloadMeshRequest& request);

  void OnWriteDone(bool ok) override;
  void OnDone() override { delete this; }

 private:
  void PostNext();
  // Runs on the disk's threads; starts a write or ends the call.
  void Next();
  absl::Status Open();
  absl::Status ReadChunk();

  // One thread at a time has the turn: gRPC's, which posts the next step, then the disk's, which
  // starts the next write.
  MeshSupport& support_;
  const v1::DownloadMeshRequest& request_;
  Call call_;
  std::shared_ptr<const Blob> blob_;
  std::int64_t offset_ = 0;
  v1::DownloadMeshResponse message_;
};

}  // namespace ccst::server
