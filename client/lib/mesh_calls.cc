#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <grpcpp/client_context.h>

#include "absl/strings/str_cat.h"
#include "client/lib/answer_bounds.h"
#include "client/lib/checked_outcome.h"
#include "client/lib/client.h"
#include "client/lib/grpc_error.h"
#include "client/lib/retry.h"
#include "client/lib/unary_call.h"
#include "core/base/sha256.h"
#include "core/base/status.h"
#include "proto/convert/names.h"

namespace ccst {
namespace {

constexpr std::int64_t kMaxChunkBytes = std::int64_t{1} << 20;
constexpr int kPageSize = 1000;
// Of a mesh that is downloaded; the densest encoding of the largest mesh that is read is smaller.
constexpr std::int64_t kMaxDownloadBytes = std::int64_t{1} << 30;
// How long a server that has answered may be away while a mesh travels.
constexpr double kPatienceSeconds = 30.0;

v1::Digest DigestOf(const std::string& bytes) {
  v1::Digest digest;
  digest.set_sha256(Sha256Of(bytes));
  digest.set_size_bytes(static_cast<std::int64_t>(bytes.size()));
  return digest;
}

absl::StatusOr<v1::Mesh> AttemptUpload(v1::MeshService::StubInterface& stub,
                                       const v1::MeshUploadHeader& header, const std::string& bytes,
                                       std::int64_t chunk_bytes, const UploadProgress& on_upload,
                                       const std::stop_token& stop) {
  grpc::ClientContext context;
  const std::stop_callback cancel(stop, [&context] { context.TryCancel(); });
  v1::UploadMeshResponse response;
  const auto writer = stub.UploadMesh(&context, &response);
  v1::UploadMeshRequest message;
  *message.mutable_header() = header;
  bool is_wanted = writer->Write(message);  // A server that has the mesh answers early.
  const auto total = static_cast<std::int64_t>(bytes.size());
  for (std::int64_t sent = 0; is_wanted && sent < total;) {
    const std::int64_t size = std::min(chunk_bytes, total - sent);
    v1::MeshChunk& chunk = *message.mutable_chunk();
    chunk.set_offset_bytes(sent);
    chunk.set_data(bytes.data() + sent, static_cast<std::size_t>(size));
    is_wanted = writer->Write(message);
    sent += size;
    if (is_wanted && on_upload) on_upload(sent, total);
  }
  if (is_wanted) writer->WritesDone();
  const grpc::Status status = writer->Finish();
  if (!status.ok()) return FromGrpcStatus(status, CallStage::kStreaming);
  return std::move(*response.mutable_mesh());
}

absl::Status AppendChunk(const v1::MeshChunk& chunk, std::int64_t most, std::string& bytes) {
  if (chunk.offset_bytes() != static_cast<std::int64_t>(bytes.size())) {
    return BrokenAnswer(
        absl::StrCat("a chunk at byte ", chunk.offset_bytes(), " after ", bytes.size(), " bytes"));
  }
  if (static_cast<std::int64_t>(bytes.size() + chunk.data().size()) > most) {
    return BrokenAnswer(absl::StrCat("more than the ", most, " bytes of the mesh"));
  }
  bytes += chunk.data();
  return absl::OkStatus();
}

// Appends what arrives to `bytes`, which are at most `most`.
absl::Status AttemptDownload(v1::MeshService::StubInterface& stub, const std::string& name,
                             std::int64_t most, std::string& bytes, Retry& retry,
                             const std::stop_token& stop) {
  grpc::ClientContext context;
  const std::stop_callback cancel(stop, [&context] { context.TryCancel(); });
  v1::DownloadMeshRequest request;
  request.set_name(name);
  request.set_start_offset_bytes(static_cast<std::int64_t>(bytes.size()));
  const auto reader = stub.DownloadMesh(&context, request);
  v1::DownloadMeshResponse message;
  absl::Status taken;
  while (taken.ok() && reader->Read(&message)) {
    retry.Heard();
    taken = AppendChunk(message.chunk(), most, bytes);
  }
  if (!taken.ok()) context.TryCancel();
  const grpc::Status status = reader->Finish();
  return taken.ok() ? FromGrpcStatus(status, CallStage::kStreaming) : taken;
}

}  // namespace

absl::StatusOr<std::string> Client::StoreMesh(const SampleJob& job, const UploadProgress& on_upload,
                                              const std::stop_token& stop) {
  v1::FindMissingMeshesRequest request;
  *request.add_digests() = DigestOf(job.draco);
  CCST_ASSIGN_OR_RETURN(
      const auto response,
      RepeatableCall<v1::FindMissingMeshesResponse>(stop, [&](auto& context, auto& answer) {
        return meshes_->FindMissingMeshes(&context, request, &answer);
      }));
  if (!response.missing_digests().empty()) {
    CCST_RETURN_IF_ERROR(UploadMesh(job.draco, job.display_name, on_upload, stop).status());
  }
  return MeshName(request.digests(0).sha256());
}

absl::Status Client::OnStoredMesh(const SampleJob& job, const UploadProgress& on_upload,
                                  const std::stop_token& stop,
                                  const std::function<absl::Status(const std::string&)>& call) {
  CCST_ASSIGN_OR_RETURN(std::string mesh, StoreMesh(job, on_upload, stop));
  const absl::Status status = call(mesh);
  if (GetErrorReason(status) != ErrorReason::kMeshMissing) return status;
  CCST_ASSIGN_OR_RETURN(mesh, StoreMesh(job, on_upload, stop));
  return call(mesh);
}

absl::StatusOr<v1::Mesh> Client::UploadMesh(const std::string& draco,
                                            const std::string& display_name,
                                            const UploadProgress& on_upload,
                                            const std::stop_token& stop) {
  CCST_ASSIGN_OR_RETURN(const auto info, RepeatableCall<v1::GetServerInfoResponse>(
                                             stop, [&](auto& context, auto& answer) {
                                               return info_->GetServerInfo(&context, {}, &answer);
                                             }));
  const std::int64_t limit = info.limits().max_chunk_bytes();
  const std::int64_t chunk_bytes = limit > 0 ? std::min(limit, kMaxChunkBytes) : kMaxChunkBytes;
  v1::MeshUploadHeader header;
  *header.mutable_digest() = DigestOf(draco);
  header.set_format(v1::MESH_FORMAT_DRACO);
  header.set_display_name(display_name);
  Retry retry(stop, kPatienceSeconds);
  retry.Heard();
  for (;;) {
    auto mesh = AttemptUpload(*meshes_, header, draco, chunk_bytes, on_upload, stop);
    if (mesh.ok() && mesh->name() != MeshName(header.digest().sha256())) {
      return BrokenAnswer("another mesh than was sent");
    }
    if (mesh.ok()) return mesh;
    CCST_RETURN_IF_ERROR(retry.Wait(mesh.status()));
  }
}

absl::StatusOr<std::string> Client::DownloadMesh(const std::string& name,
                                                 const std::stop_token& stop) {
  v1::GetMeshRequest get;
  get.set_name(name);
  CCST_ASSIGN_OR_RETURN(const auto stored,
                        RepeatableCall<v1::GetMeshResponse>(stop, [&](auto& context, auto& answer) {
                          return meshes_->GetMesh(&context, get, &answer);
                        }));
  const std::int64_t size = stored.mesh().digest().size_bytes();
  if (stored.mesh().name() != name || size < 0) return BrokenAnswer("another mesh than asked for");
  if (size > kMaxDownloadBytes) {
    return MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kLimitExceeded,
                     absl::StrCat(name, " has ", size, " bytes, over ", kMaxDownloadBytes,
                                  ", the most that are downloaded; name the file it came from"));
  }
  std::string bytes;
  Retry retry(stop, kPatienceSeconds);
  for (;;) {
    const absl::Status status = AttemptDownload(*meshes_, name, size, bytes, retry, stop);
    if (status.ok()) break;
    CCST_RETURN_IF_ERROR(retry.Wait(status));
  }
  if (MeshName(Sha256Of(bytes)) != name) {
    return BrokenAnswer(absl::StrCat(bytes.size(), " bytes that are not ", name));
  }
  return bytes;
}

absl::StatusOr<std::vector<v1::Mesh>> Client::ListMeshes(const std::stop_token& stop) {
  std::vector<v1::Mesh> meshes;
  ListBounds bounds(kPageSize);
  v1::ListMeshesRequest request;
  request.set_page_size(kPageSize);
  do {
    CCST_ASSIGN_OR_RETURN(
        const auto page,
        RepeatableCall<v1::ListMeshesResponse>(stop, [&](auto& context, auto& answer) {
          return meshes_->ListMeshes(&context, request, &answer);
        }));
    CCST_RETURN_IF_ERROR(bounds.Take(page.meshes_size(), page.ByteSizeLong(), request.page_token(),
                                     page.next_page_token()));
    meshes.insert(meshes.end(), page.meshes().begin(), page.meshes().end());
    request.set_page_token(page.next_page_token());
  } while (!request.page_token().empty());
  return meshes;
}

absl::Status Client::DeleteMesh(const std::string& name) {
  v1::DeleteMeshRequest request;
  request.set_name(name);
  return RepeatableCall<v1::DeleteMeshResponse>(
             {}, [&](auto& context,
                     auto& answer) { return meshes_->DeleteMesh(&context, request, &answer); })
      .status();
}

}  // namespace ccst
