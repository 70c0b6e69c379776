#include "server/rpc/mesh_messages.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include "core/base/sha256.h"
#include "core/base/status.h"
#include "core/io/draco_mesh.h"
#include "proto/convert/field_limits.h"
#include "proto/convert/scalars.h"
#include "proto/convert/status.h"
#include "server/meshes/measure_mesh.h"

namespace ccst::server {
namespace {

MeshDigest DigestFromProto(const v1::Digest& digest, const std::string& path,
                           Violations& violations) {
  if (!IsSha256(digest.sha256())) {
    violations.Add(path + ".sha256", "must be 64 lowercase hexadecimal digits",
                   ErrorReason::kRequestInvalid);
  }
  if (digest.size_bytes() < 1) {
    violations.Add(path + ".size_bytes",
                   "is " + std::to_string(digest.size_bytes()) + ", must be at least 1",
                   ErrorReason::kRequestInvalid);
  }
  return {.sha256 = digest.sha256(), .size_bytes = digest.size_bytes()};
}

MeshUpload UploadFromProto(const v1::MeshUploadHeader& header, const std::string& owner,
                           const MeshStoreOptions& limits, Violations& violations) {
  MeshDigest digest = DigestFromProto(header.digest(), "header.digest", violations);
  if (digest.size_bytes > limits.max_mesh_bytes) {
    violations.AddLimit("header.digest.size_bytes", "max_mesh_bytes", limits.max_mesh_bytes,
                        digest.size_bytes);
  }
  if (header.format() != v1::MESH_FORMAT_DRACO) {
    violations.Add("header.format", "must be MESH_FORMAT_DRACO", ErrorReason::kRequestInvalid);
  }
  CheckText(header.display_name(), kMaxDisplayName, "header.display_name", violations);
  return {.owner = owner,
          .sha256 = std::move(digest.sha256),
          .size_bytes = digest.size_bytes,
          .display_name = header.display_name()};
}

// The fields of `mesh` that are facts.
v1::Mesh ToProto(const MeshFacts& facts) {
  v1::Mesh mesh;
  mesh.set_vertex_count(facts.vertices);
  mesh.set_face_count(facts.file_faces);
  mesh.set_component_count(facts.components);
  mesh.set_boundary_loop_count(facts.boundary_loops);
  mesh.set_surface_area(facts.area);
  *mesh.mutable_bounds_min() = ccst::ToProto(facts.bounds_min);
  *mesh.mutable_bounds_max() = ccst::ToProto(facts.bounds_max);
  for (const MeshAttributeFacts& attribute : facts.attributes) {
    v1::MeshAttribute& message = *mesh.add_attributes();
    message.set_attribute_name(attribute.name);
    message.set_min_value(attribute.min_value);
    message.set_max_value(attribute.max_value);
    message.set_component_count(attribute.components);
  }
  mesh.mutable_warnings()->Assign(facts.warnings.begin(), facts.warnings.end());
  return mesh;
}

}  // namespace

int PageSize(std::int32_t page_size, Violations& violations) {
  if (page_size < 0) {
    violations.Add("page_size", "is " + std::to_string(page_size) + ", must be at least 0",
                   ErrorReason::kRequestInvalid);
  }
  return page_size == 0 ? kDefaultPageSize : std::min(page_size, kMaxPageSize);
}

v1::Digest ToProto(const MeshDigest& digest) {
  v1::Digest message;
  message.set_sha256(digest.sha256);
  message.set_size_bytes(digest.size_bytes);
  return message;
}

absl::StatusOr<std::vector<MeshDigest>> FromProto(const v1::FindMissingMeshesRequest& request) {
  Violations violations;
  std::vector<MeshDigest> digests;
  digests.reserve(static_cast<std::size_t>(request.digests_size()));
  for (int i = 0; i < request.digests_size(); ++i) {
    digests.push_back(
        DigestFromProto(request.digests(i), "digests[" + std::to_string(i) + "]", violations));
  }
  CCST_RETURN_IF_ERROR(violations.ToStatus());
  return digests;
}

absl::StatusOr<MeshUpload> FromProto(const v1::MeshUploadHeader& header, const std::string& owner,
                                     const MeshStoreOptions& limits) {
  Violations violations;
  MeshUpload upload = UploadFromProto(header, owner, limits, violations);
  CCST_RETURN_IF_ERROR(violations.ToStatus());
  return upload;
}

absl::StatusOr<MeshUpload> FromProto(const v1::CreateMeshRequest& request, const std::string& owner,
                                     const MeshStoreOptions& limits,
                                     std::int64_t max_inline_mesh_bytes) {
  Violations violations;
  MeshUpload upload = UploadFromProto(request.header(), owner, limits, violations);
  const auto bytes = static_cast<std::int64_t>(request.data().size());
  if (bytes > max_inline_mesh_bytes) {
    violations.AddLimit("data", "max_inline_mesh_bytes", max_inline_mesh_bytes, bytes);
  }
  CCST_RETURN_IF_ERROR(violations.ToStatus());
  return upload;
}

v1::Mesh ToProto(const StoredMesh& mesh) {
  v1::Mesh message = ToProto(mesh.facts);
  const MeshRecord& record = mesh.record;
  message.set_name(MeshName(record.sha256));
  *message.mutable_digest() =
      ToProto(MeshDigest{.sha256 = record.sha256, .size_bytes = record.size_bytes});
  message.set_format(v1::MESH_FORMAT_DRACO);
  message.set_display_name(record.display_name);
  *message.mutable_create_time() = TimestampToProto(record.create_time);
  *message.mutable_expire_time() = TimestampToProto(record.expire_time);
  CutToFieldLimits(message);
  return message;
}

absl::StatusOr<bool> FindHeld(MeshStore& meshes, const MeshUpload& upload, v1::Mesh& mesh) {
  const auto held = meshes.Use(upload.owner, upload.sha256);
  // What is damaged is healed by what is about to come.
  if (absl::IsNotFound(held.status()) || absl::IsDataLoss(held.status())) return false;
  CCST_RETURN_IF_ERROR(held.status());
  if (held->record.size_bytes != upload.size_bytes) {
    return MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kDigestMismatch,
                     "announced are " + std::to_string(upload.size_bytes) +
                         " bytes; what has this digest has " +
                         std::to_string(held->record.size_bytes));
  }
  mesh = ToProto(*held);
  return true;
}

MeshDependencies RealMeshDependencies(const Clock& clock) {
  return {.decode = DecodeDraco, .take_memory = nullptr, .measure = MeasureMesh, .clock = clock};
}

}  // namespace ccst::server
