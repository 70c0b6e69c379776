#include "server/rpc/download_reactor.h"

#include <algorithm>

#include "core/base/status.h"
#include "proto/convert/violations.h"
#include "server/rpc/mesh_messages.h"
#include "server/rpc/rpc_executor.h"

namespace ccst::server {

DownloadReactor::DownloadReactor(MeshSupport& support, const grpc::CallbackServerContext& context,
                                 const v1::DownloadMeshRequest& request)
    : support_(support),
      request_(request),
      call_(support.calls, context, "DownloadMesh", Scope::kReadOnly) {
  call_.Received(request);
  if (!call_.admission().ok()) {
    Finish(call_.End(call_.admission()));
    return;
  }
  PostNext();
}

void DownloadReactor::PostNext() {
  if (!support_.disk.Run([this] { Next(); })) Finish(call_.End(ExecutorFull()));
}

void DownloadReactor::Next() {
  const absl::Status status = RunStep([this] {
    if (blob_ == nullptr) CCST_RETURN_IF_ERROR(Open());
    return ReadChunk();
  });
  if (!status.ok() || message_.chunk().data().empty()) {
    Finish(call_.End(status));
    return;
  }
  call_.Sent(message_);
  StartWrite(&message_);
}

absl::Status DownloadReactor::Open() {
  Violations violations;
  const std::string sha256 = Sha256OfMeshName(request_.name(), "name", violations);
  const std::int64_t start = request_.start_offset_bytes();
  if (start < 0) {
    violations.Add("start_offset_bytes", "is " + std::to_string(start) + ", must be at least 0",
                   ErrorReason::kRequestInvalid);
  }
  CCST_RETURN_IF_ERROR(violations.ToStatus());
  CCST_ASSIGN_OR_RETURN(blob_, support_.meshes.Open(call_.caller().visible_owner(), sha256));
  if (start > blob_->size_bytes()) {
    violations.Add("start_offset_bytes",
                   "is " + std::to_string(start) + ", must be at most the mesh's size, " +
                       std::to_string(blob_->size_bytes()),
                   ErrorReason::kRequestInvalid);
  }
  offset_ = start;
  return violations.ToStatus();
}

absl::Status DownloadReactor::ReadChunk() {
  v1::MeshChunk& chunk = *message_.mutable_chunk();
  chunk.set_offset_bytes(offset_);
  std::string& data = *chunk.mutable_data();
  data.resize(static_cast<std::size_t>(
      std::min(support_.options.max_chunk_bytes, blob_->size_bytes() - offset_)));
  offset_ += static_cast<std::int64_t>(data.size());
  return data.empty() ? absl::OkStatus() : blob_->Read(chunk.offset_bytes(), data);
}

void DownloadReactor::OnWriteDone(bool ok) {
  if (ok) return PostNext();
  Finish(call_.End(MakeError(absl::StatusCode::kCancelled, ErrorReason::kCancelled,
                             "the caller went away or its deadline passed")));
}

}  // namespace ccst::server
