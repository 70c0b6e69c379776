#include "server/rpc/mesh_service.h"

#include <string>
#include <utility>

#include "core/base/status.h"
#include "proto/convert/violations.h"
#include "server/rpc/download_reactor.h"
#include "server/rpc/mesh_messages.h"
#include "server/rpc/page.h"
#include "server/rpc/unary.h"
#include "server/rpc/upload_reactor.h"

namespace ccst::server {
namespace {

absl::StatusOr<std::string> Sha256FromName(const std::string& name) {
  Violations violations;
  std::string sha256 = Sha256OfMeshName(name, "name", violations);
  CCST_RETURN_IF_ERROR(violations.ToStatus());
  return sha256;
}

absl::Status FindMissing(MeshStore& meshes, const Caller& caller,
                         const v1::FindMissingMeshesRequest& request,
                         v1::FindMissingMeshesResponse& response) {
  std::vector<MeshDigest> digests;
  CCST_ASSIGN_OR_RETURN(digests, FromProto(request));
  // Who may only look does not keep meshes from expiring.
  const bool is_use = caller.scope == Scope::kFull;
  CCST_ASSIGN_OR_RETURN(digests, meshes.FindMissing(caller.visible_owner(), digests, is_use));
  for (const MeshDigest& digest : digests) *response.add_missing_digests() = ToProto(digest);
  return absl::OkStatus();
}

absl::Status Create(MeshSupport& support, const std::string& owner,
                    const v1::CreateMeshRequest& request, v1::CreateMeshResponse& response) {
  MeshStore& meshes = support.meshes;
  MeshUpload upload;
  CCST_ASSIGN_OR_RETURN(
      upload, FromProto(request, owner, meshes.options(), support.options.max_inline_mesh_bytes));
  bool held = false;
  CCST_ASSIGN_OR_RETURN(held, FindHeld(meshes, upload, *response.mutable_mesh()));
  response.set_already_present(held);
  if (held) return absl::OkStatus();
  std::unique_ptr<BlobWriter> writer;
  CCST_ASSIGN_OR_RETURN(writer, meshes.Begin(upload));
  CCST_RETURN_IF_ERROR(writer->Append(request.data()));
  StoredMesh mesh;
  CCST_ASSIGN_OR_RETURN(mesh, meshes.Finish(upload, *writer));
  *response.mutable_mesh() = ToProto(mesh);
  return absl::OkStatus();
}

absl::Status List(MeshStore& meshes, const std::string& owner, const v1::ListMeshesRequest& request,
                  v1::ListMeshesResponse& response) {
  Violations violations;
  const int page_size = PageSize(request.page_size(), violations);
  CCST_RETURN_IF_ERROR(violations.ToStatus());
  return FillPage(
      page_size, [&](int size) { return meshes.List(owner, size, request.page_token()); },
      [](const StoredMesh& mesh) { return ToProto(mesh); }, *response.mutable_meshes(),
      *response.mutable_next_page_token());
}

}  // namespace

MeshService::MeshService(MeshStore& meshes, Executor& disk, Executor& decoding,
                         const StreamSupport& streams, const MeshServiceOptions& options)
    : streams_(streams),
      support_{.meshes = meshes,
               .disk = disk,
               .decoding = decoding,
               .calls = streams.calls,
               .options = options} {}

grpc::ServerUnaryReactor* MeshService::FindMissingMeshes(
    grpc::CallbackServerContext* context, const v1::FindMissingMeshesRequest* request,
    v1::FindMissingMeshesResponse* response) {
  return ServeUnaryOn(support_.disk, support_.calls, *context, "FindMissingMeshes",
                      Scope::kReadOnly, *request, *response, [this, request, response](Call& call) {
                        return FindMissing(support_.meshes, call.caller(), *request, *response);
                      });
}

grpc::ServerReadReactor<v1::UploadMeshRequest>* MeshService::UploadMesh(
    grpc::CallbackServerContext* context, v1::UploadMeshResponse* response) {
  return UploadReactor::Start(support_, *context, *response);
}

grpc::ServerUnaryReactor* MeshService::CreateMesh(grpc::CallbackServerContext* context,
                                                  const v1::CreateMeshRequest* request,
                                                  v1::CreateMeshResponse* response) {
  return ServeUnaryOn(support_.decoding, support_.calls, *context, "CreateMesh", Scope::kFull,
                      *request, *response, [this, request, response](Call& call) {
                        return Create(support_, call.caller().visible_owner(), *request, *response);
                      });
}

grpc::ServerUnaryReactor* MeshService::GetMesh(grpc::CallbackServerContext* context,
                                               const v1::GetMeshRequest* request,
                                               v1::GetMeshResponse* response) {
  return ServeUnaryOn(support_.disk, support_.calls, *context, "GetMesh", Scope::kReadOnly,
                      *request, *response, [this, request, response](Call& call) -> absl::Status {
                        std::string sha256;
                        CCST_ASSIGN_OR_RETURN(sha256, Sha256FromName(request->name()));
                        StoredMesh mesh;
                        CCST_ASSIGN_OR_RETURN(
                            mesh, support_.meshes.Get(call.caller().visible_owner(), sha256));
                        *response->mutable_mesh() = ToProto(mesh);
                        return absl::OkStatus();
                      });
}

grpc::ServerUnaryReactor* MeshService::ListMeshes(grpc::CallbackServerContext* context,
                                                  const v1::ListMeshesRequest* request,
                                                  v1::ListMeshesResponse* response) {
  return ServeUnaryOn(support_.disk, support_.calls, *context, "ListMeshes", Scope::kReadOnly,
                      *request, *response, [this, request, response](Call& call) {
                        return List(support_.meshes, call.caller().visible_owner(), *request,
                                    *response);
                      });
}

grpc::ServerWriteReactor<v1::DownloadMeshResponse>* MeshService::DownloadMesh(
    grpc::CallbackServerContext* context, const v1::DownloadMeshRequest* request) {
  return DownloadReactor::Make<DownloadReactor>(streams_, support_, *context, *request);
}

grpc::ServerUnaryReactor* MeshService::DeleteMesh(grpc::CallbackServerContext* context,
                                                  const v1::DeleteMeshRequest* request,
                                                  v1::DeleteMeshResponse* response) {
  return ServeUnaryOn(support_.disk, support_.calls, *context, "DeleteMesh", Scope::kFull, *request,
                      *response, [this, request](Call& call) -> absl::Status {
                        std::string sha256;
                        CCST_ASSIGN_OR_RETURN(sha256, Sha256FromName(request->name()));
                        return support_.meshes.Delete(call.caller().visible_owner(), sha256);
                      });
}

}  // namespace ccst::server
