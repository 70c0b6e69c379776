#pragma once

#include <cstdint>
#include <optional>

#include "absl/status/status.h"
#include "ccst/v1/mesh_service.pb.h"
#include "server/rpc/mesh_support.h"
#include "server/rpc/stream_reactor.h"
#include "server/store/blob_store.h"

namespace ccst::server {

/// One `DownloadMesh` call: a chunk is read from the disk when the one before has left, and hashed
/// on its way; the last one leaves only when all bytes were those of the digest.
class DownloadReactor final : public StreamReactor<v1::DownloadMeshResponse> {
 public:
  DownloadReactor(const StreamSupport& support, MeshSupport& meshes,
                  grpc::CallbackServerContext& context, const v1::DownloadMeshRequest& request);

 protected:
  absl::Status Open(Call& call) override;
  StreamStep Next(v1::DownloadMeshResponse& message) override;
  absl::Status end_status() override { return end_status_; }
  bool MoreFollows(const v1::DownloadMeshResponse& message) override;
  void Close() override { bytes_.reset(); }

 private:
  // Hashes what the caller has already.
  absl::Status Skip();

  MeshSupport& support_;
  const v1::DownloadMeshRequest& request_;
  std::optional<CheckedReader> bytes_;
  std::int64_t start_ = 0;
  absl::Status end_status_;
};

}  // namespace ccst::server
