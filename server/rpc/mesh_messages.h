#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "ccst/v1/mesh.pb.h"
#include "ccst/v1/mesh_service.pb.h"
#include "proto/convert/names.h"
#include "proto/convert/violations.h"
#include "server/meshes/mesh_store.h"

namespace ccst::server {

/// Page sizes of lists.
inline constexpr int kDefaultPageSize = 50;
inline constexpr int kMaxPageSize = 1000;
/// The page size asked for, with its default and its limit; adds to `violations` when negative.
int PageSize(std::int32_t page_size, Violations& violations);

v1::Digest ToProto(const MeshDigest& digest);
/// INVALID_ARGUMENT with all violations, as the following.
absl::StatusOr<std::vector<MeshDigest>> FromProto(const v1::FindMissingMeshesRequest& request);

/// Checks what an upload announces; LIMIT_EXCEEDED with a `LimitViolation` when that is too much.
absl::StatusOr<MeshUpload> FromProto(const v1::MeshUploadHeader& header, const std::string& owner,
                                     const MeshStoreOptions& limits);
/// As the above; the data may have `max_inline_mesh_bytes`.
absl::StatusOr<MeshUpload> FromProto(const v1::CreateMeshRequest& request, const std::string& owner,
                                     const MeshStoreOptions& limits,
                                     std::int64_t max_inline_mesh_bytes);

/// The mesh as callers see it.
v1::Mesh ToProto(const StoredMesh& mesh);

/// True when the owner has stored what is to be uploaded; fills `mesh` then and moves its expiry
/// later.
/// @errors INVALID_ARGUMENT DIGEST_MISMATCH it is held with another size
absl::StatusOr<bool> FindHeld(MeshStore& meshes, const MeshUpload& upload, v1::Mesh& mesh);

/// Decodes Draco, measures with the core.
MeshDependencies RealMeshDependencies(const Clock& clock);

}  // namespace ccst::server
