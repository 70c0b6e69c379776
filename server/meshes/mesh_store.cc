#include "server/meshes/mesh_store.h"

#include <algorithm>
#include <utility>

#include "core/base/status.h"

namespace ccst::server {
namespace {

// Expired meshes dropped without a pause for other callers.
constexpr int kDropBatch = 32;

absl::Status Mismatch(const std::string& message) {
  return MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kDigestMismatch, message);
}

absl::Status NotFound(const std::string& sha256) {
  return MakeError(absl::StatusCode::kNotFound, ErrorReason::kNotFound,
                   "there is no mesh meshes/" + sha256);
}

absl::Status QuotaExceeded(std::int64_t bytes, std::int64_t limit) {
  return MakeError(absl::StatusCode::kResourceExhausted, ErrorReason::kQuotaExceeded,
                   "a mesh of " + std::to_string(bytes) +
                       " bytes does not fit beside those in use "
                       "within " +
                       std::to_string(limit) + " bytes; delete meshes or wait for jobs");
}

}  // namespace

MeshStore::MeshStore(Store& store, BlobPins& pins, const MeshStoreOptions& options,
                     MeshDependencies dependencies)
    : store_(store), pins_(pins), options_(options), dependencies_(std::move(dependencies)) {}

absl::StatusOr<std::vector<MeshDigest>> MeshStore::FindMissing(
    const std::string& owner, const std::vector<MeshDigest>& digests) {
  std::vector<MeshDigest> missing;
  for (const MeshDigest& digest : digests) {
    // Not for all of them: others shall not wait for long lists.
    MutexLock lock(changes_);
    std::optional<MeshRecord> record;
    CCST_ASSIGN_OR_RETURN(record, Touch(owner, digest.sha256));
    if (!record.has_value() || record->size_bytes != digest.size_bytes) missing.push_back(digest);
  }
  return missing;
}

absl::StatusOr<std::unique_ptr<BlobWriter>> MeshStore::Begin(const MeshUpload& upload) {
  if (upload.size_bytes > options_.max_mesh_bytes) {
    return MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kLimitExceeded,
                     "the mesh has " + std::to_string(upload.size_bytes) + " bytes; at most " +
                         std::to_string(options_.max_mesh_bytes) + " are accepted");
  }
  CCST_RETURN_IF_ERROR(InTheWayOf(upload.owner, upload.size_bytes).status());
  return store_.blobs().NewBlob();
}

absl::StatusOr<StoredMesh> MeshStore::Finish(const MeshUpload& upload, BlobWriter& writer) {
  if (writer.size_bytes() != upload.size_bytes) {
    return Mismatch("announced are " + std::to_string(upload.size_bytes) + " bytes, " +
                    std::to_string(writer.size_bytes()) + " came");
  }
  if (const std::string& sha256 = writer.Seal(); sha256 != upload.sha256) {
    return Mismatch("announced is the digest " + upload.sha256 + ", the bytes have " + sha256);
  }
  const BlobPins::Pin pin(pins_, upload.sha256);
  // Goes with the pin, unless a record refers to it by then.
  CCST_RETURN_IF_ERROR(pins_.Drop(upload.sha256));
  CCST_RETURN_IF_ERROR(writer.Commit());
  std::string facts;
  CCST_ASSIGN_OR_RETURN(facts, Measure(upload.sha256));
  MutexLock lock(changes_);
  std::optional<MeshRecord> record;
  CCST_ASSIGN_OR_RETURN(record, Touch(upload.owner, upload.sha256));
  if (record.has_value()) return WithFacts(*std::move(record));
  std::vector<MeshRecord> in_the_way;
  CCST_ASSIGN_OR_RETURN(in_the_way, InTheWayOf(upload.owner, upload.size_bytes));
  for (const MeshRecord& mesh : in_the_way) CCST_RETURN_IF_ERROR(Drop(mesh));
  const absl::Time now = Now();
  record = {.owner = upload.owner,
            .sha256 = upload.sha256,
            .size_bytes = upload.size_bytes,
            .display_name = upload.display_name,
            .create_time = now,
            .expire_time = now + options_.retention,
            .facts = std::move(facts)};
  CCST_RETURN_IF_ERROR(store_.PutMesh(*record));
  return WithFacts(*std::move(record));
}

absl::StatusOr<std::string> MeshStore::Measure(const std::string& sha256) const {
  std::shared_ptr<void> memory;  // Before what it is for, and so given back after it.
  TriangleMesh mesh;
  {
    std::string bytes;
    CCST_ASSIGN_OR_RETURN(bytes, ReadWhole(store_.blobs(), sha256));
    if (dependencies_.take_memory) {
      CCST_ASSIGN_OR_RETURN(memory, dependencies_.take_memory(bytes));
    }
    CCST_ASSIGN_OR_RETURN(mesh, dependencies_.decode(bytes, options_.decode_limits));
  }
  MeshFacts facts;
  CCST_ASSIGN_OR_RETURN(facts, dependencies_.measure(mesh));
  return dependencies_.encode_facts(facts);
}

absl::StatusOr<StoredMesh> MeshStore::Get(const std::string& owner, const std::string& sha256) {
  std::optional<MeshRecord> record;
  CCST_ASSIGN_OR_RETURN(record, Find(owner, sha256));
  if (!record.has_value()) return NotFound(sha256);
  return WithFacts(*std::move(record));
}

absl::StatusOr<StoredMesh> MeshStore::Use(const std::string& owner, const std::string& sha256) {
  std::optional<MeshRecord> record;
  {
    MutexLock lock(changes_);
    CCST_ASSIGN_OR_RETURN(record, Touch(owner, sha256));
  }
  if (!record.has_value()) return NotFound(sha256);
  return WithFacts(*std::move(record));
}

absl::StatusOr<std::shared_ptr<const Blob>> MeshStore::Open(const std::string& owner,
                                                            const std::string& sha256) {
  CCST_RETURN_IF_ERROR(Use(owner, sha256).status());
  return store_.blobs().Open(sha256);
}

absl::StatusOr<Page<StoredMesh>> MeshStore::List(const std::string& owner, int page_size,
                                                 const std::string& page_token) {
  Page<MeshRecord> records;
  CCST_ASSIGN_OR_RETURN(records, store_.ListMeshes(owner, page_size, page_token));
  const absl::Time now = Now();
  Page<StoredMesh> page;
  page.next_token = std::move(records.next_token);
  for (MeshRecord& record : records.records) {
    if (record.expire_time < now) continue;
    StoredMesh mesh;
    CCST_ASSIGN_OR_RETURN(mesh, WithFacts(std::move(record)));
    page.records.push_back(std::move(mesh));
  }
  return page;
}

absl::Status MeshStore::Delete(const std::string& owner, const std::string& sha256) {
  MutexLock lock(changes_);
  std::optional<MeshRecord> record;
  CCST_ASSIGN_OR_RETURN(record, Find(owner, sha256));
  if (!record.has_value()) return NotFound(sha256);
  bool in_use = false;
  CCST_ASSIGN_OR_RETURN(in_use, store_.IsMeshInUse(owner, sha256));
  if (in_use) {
    return MakeError(
        absl::StatusCode::kFailedPrecondition, ErrorReason::kMeshInUse,
        "a job that has not ended needs meshes/" + sha256 + "; cancel it or wait for its end");
  }
  return Drop(*record);
}

absl::Status MeshStore::DropExpired() {
  std::vector<MeshRecord> expired;
  do {
    MutexLock lock(changes_);
    CCST_ASSIGN_OR_RETURN(expired, store_.ExpiredMeshes(Now(), kDropBatch));
    for (const MeshRecord& mesh : expired) CCST_RETURN_IF_ERROR(Drop(mesh));
  } while (!expired.empty());
  return absl::OkStatus();
}

absl::Time MeshStore::Now() const {
  return absl::FromUnixMicros(absl::ToUnixMicros(dependencies_.clock.now()));
}

absl::StatusOr<std::optional<MeshRecord>> MeshStore::Find(const std::string& owner,
                                                          const std::string& sha256) {
  std::optional<MeshRecord> record;
  CCST_ASSIGN_OR_RETURN(record, store_.GetMesh(owner, sha256));
  if (record.has_value() && record->expire_time < Now()) record.reset();
  return record;
}

absl::StatusOr<std::optional<MeshRecord>> MeshStore::Touch(const std::string& owner,
                                                           const std::string& sha256) {
  std::optional<MeshRecord> record;
  CCST_ASSIGN_OR_RETURN(record, Find(owner, sha256));
  if (!record.has_value()) return record;
  const absl::Time expire_time = Now() + options_.retention;
  CCST_RETURN_IF_ERROR(store_.TouchMesh(owner, sha256, expire_time));
  record->expire_time = std::max(record->expire_time, expire_time);
  return record;
}

absl::StatusOr<StoredMesh> MeshStore::WithFacts(MeshRecord record) const {
  StoredMesh mesh;
  mesh.record = std::move(record);
  CCST_ASSIGN_OR_RETURN(mesh.facts, dependencies_.decode_facts(mesh.record.facts));
  return mesh;
}

absl::StatusOr<std::vector<MeshRecord>> MeshStore::InTheWayOf(const std::string& owner,
                                                              std::int64_t bytes) {
  std::int64_t used = 0;
  CCST_ASSIGN_OR_RETURN(used, store_.MeshBytes(owner));
  std::int64_t missing = used + bytes - options_.max_stored_bytes;
  std::vector<MeshRecord> dropped;
  if (missing <= 0) return dropped;
  std::vector<MeshRecord> idle;
  CCST_ASSIGN_OR_RETURN(idle, store_.IdleMeshes(owner));
  for (auto mesh = idle.begin(); mesh != idle.end() && missing > 0; ++mesh) {
    missing -= mesh->size_bytes;
    dropped.push_back(std::move(*mesh));
  }
  if (missing > 0) return QuotaExceeded(bytes, options_.max_stored_bytes);
  return dropped;
}

absl::Status MeshStore::Drop(const MeshRecord& mesh) {
  CCST_RETURN_IF_ERROR(store_.DeleteMesh(mesh.owner, mesh.sha256));
  return pins_.Drop(mesh.sha256);
}

}  // namespace ccst::server
