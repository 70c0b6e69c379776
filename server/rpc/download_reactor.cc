#include "server/rpc/download_reactor.h"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "core/base/status.h"
#include "proto/convert/names.h"
#include "proto/convert/samples.h"
#include "proto/convert/violations.h"

namespace ccst::server {
namespace {

// What a chunk has beside its data.
constexpr std::int64_t kChunkOverhead = 64;
// Of what the caller has already, which is hashed in pieces.
constexpr std::int64_t kSkippedBytes = std::int64_t{1} << 20;

}  // namespace

DownloadReactor::DownloadReactor(const StreamSupport& support, MeshSupport& meshes,
                                 grpc::CallbackServerContext& context,
                                 const v1::DownloadMeshRequest& request)
    : StreamReactor(support, context, "DownloadMesh", Scope::kReadOnly, kMaxChunkBytes),
      support_(meshes),
      request_(request) {}

absl::Status DownloadReactor::Open(Call& call) {
  CCST_RETURN_IF_ERROR(call.Received(request_));
  Violations violations;
  const std::string sha256 = Sha256OfMeshName(request_.name(), "name", violations);
  start_ = request_.start_offset_bytes();
  if (start_ < 0) {
    violations.Add("start_offset_bytes", "is " + std::to_string(start_) + ", must be at least 0",
                   ErrorReason::kRequestInvalid);
  }
  CCST_RETURN_IF_ERROR(violations.ToStatus());
  std::shared_ptr<const Blob> blob;
  CCST_ASSIGN_OR_RETURN(blob, support_.meshes.Open(call.caller().visible_owner(), sha256));
  bytes_.emplace(std::move(blob), sha256);
  if (start_ > bytes_->size_bytes()) {
    violations.Add("start_offset_bytes",
                   "is " + std::to_string(start_) + ", must be at most the mesh's size, " +
                       std::to_string(bytes_->size_bytes()),
                   ErrorReason::kRequestInvalid);
  }
  return violations.ToStatus();
}

StreamStep DownloadReactor::Next(v1::DownloadMeshResponse& message) {
  end_status_ = Skip();
  if (!end_status_.ok() || bytes_->at_end()) return StreamStep::kEnd;
  v1::MeshChunk& chunk = *message.mutable_chunk();
  chunk.set_offset_bytes(bytes_->offset());
  std::string& data = *chunk.mutable_data();
  data.resize(static_cast<std::size_t>(
      std::min({support_.options.max_chunk_bytes, kMaxChunkBytes - kChunkOverhead,
                bytes_->size_bytes() - bytes_->offset()})));
  end_status_ = bytes_->Next(data);
  return end_status_.ok() ? StreamStep::kWrite : StreamStep::kEnd;
}

absl::Status DownloadReactor::Skip() {
  std::string skipped;
  while (bytes_->offset() < start_) {
    skipped.resize(static_cast<std::size_t>(std::min(kSkippedBytes, start_ - bytes_->offset())));
    CCST_RETURN_IF_ERROR(bytes_->Next(skipped));
  }
  return absl::OkStatus();
}

bool DownloadReactor::MoreFollows(const v1::DownloadMeshResponse& /*message*/) {
  return !bytes_->at_end();
}

}  // namespace ccst::server
