#include "server/meshes/mesh_store.h"

#include <algorithm>
#include <map>
#include <utility>

#include "core/base/limit_error.h"
#include "core/base/printable_text.h"
#include "core/base/status.h"
#include "server/meshes/pinned_blob.h"

namespace ccst::server {
namespace {

// Expired meshes dropped without a pause for other callers.
constexpr int kDropBatch = 100;

absl::Status Mismatch(const std::string& message) {
  return MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kDigestMismatch, message);
}

absl::Status NotFound(const std::string& sha256) {
  return MakeError(absl::StatusCode::kNotFound, ErrorReason::kNotFound,
                   "there is no mesh meshes/" + sha256);
}

absl::Status Damaged(const std::string& sha256) {
  return MakeError(absl::StatusCode::kDataLoss, ErrorReason::kStorageFailed,
                   "what is stored of meshes/" + sha256 + " is damaged; upload it again");
}

absl::Status QuotaExceeded(std::int64_t bytes, std::int64_t limit) {
  return OverQuota({"max_stored_mesh_bytes", limit, bytes},
                   "a mesh of " + std::to_string(bytes) +
                       " bytes does not fit beside those in use "
                       "within " +
                       std::to_string(limit) + " bytes; delete meshes or wait for jobs");
}

absl::Status TooLarge(std::int64_t bytes, const std::string& limit, std::int64_t value) {
  return OverLimit({limit, value, bytes}, "the mesh has " + std::to_string(bytes) +
                                              " bytes; at most " + std::to_string(value) +
                                              " are accepted (" + limit + ")");
}

}  // namespace

MeshStore::MeshStore(Store& store, BlobPins& pins, const MeshStoreOptions& options,
                     MeshDependencies dependencies)
    : store_(store), pins_(pins), options_(options), dependencies_(std::move(dependencies)) {}

absl::StatusOr<std::vector<MeshDigest>> MeshStore::FindMissing(
    const std::string& owner, const std::vector<MeshDigest>& digests, bool is_use) {
  std::vector<MeshDigest> missing;
  std::map<std::string, std::optional<MeshRecord>> looked_up;
  for (const MeshDigest& digest : digests) {
    const auto [found, is_new] = looked_up.try_emplace(digest.sha256);
    if (is_new) {
      CCST_ASSIGN_OR_RETURN(found->second, Find(owner, digest.sha256));
    }
    const auto& record = found->second;
    const bool fits = record.has_value() && record->size_bytes == digest.size_bytes;
    const absl::Status whole = fits ? CheckWhole(*record) : absl::OkStatus();
    if (!whole.ok() && !absl::IsDataLoss(whole)) return whole;
    if (!fits || !whole.ok()) missing.push_back(digest);
  }
  if (!is_use) return missing;
  std::vector<std::string> touched;
  for (const auto& [sha256, record] : looked_up) {
    if (record.has_value()) touched.push_back(sha256);
  }
  // On a disk that is full or read-only they expire as if they had not been asked for.
  if (!touched.empty()) {
    store_.TouchMeshes(owner, touched, Now() + options_.retention).IgnoreError();
  }
  return missing;
}

absl::StatusOr<std::unique_ptr<BlobWriter>> MeshStore::Begin(const MeshUpload& upload) {
  if (upload.size_bytes > options_.max_mesh_bytes) {
    return TooLarge(upload.size_bytes, "max_mesh_bytes", options_.max_mesh_bytes);
  }
  std::optional<MeshRecord> record;
  CCST_ASSIGN_OR_RETURN(record, store_.GetMesh(upload.owner, upload.sha256));
  // What replaces a damaged one counts already.
  if (!record.has_value()) {
    CCST_RETURN_IF_ERROR(InTheWayOf(upload.owner, upload.size_bytes).status());
    CCST_RETURN_IF_ERROR(
        CheckRecordRoom(store_, upload.owner, BytesOf(RecordOf(upload, "")), options_.records));
  }
  CCST_RETURN_IF_ERROR(store_.blobs().CheckRoom(upload.size_bytes));
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
  if (record.has_value() && IsReadable(*record)) return WithFacts(*std::move(record));
  if (!record.has_value()) {
    std::vector<MeshRecord> in_the_way;
    CCST_ASSIGN_OR_RETURN(in_the_way, InTheWayOf(upload.owner, upload.size_bytes));
    for (const MeshRecord& mesh : in_the_way) CCST_RETURN_IF_ERROR(Drop(mesh));
    CCST_RETURN_IF_ERROR(
        CheckRecordRoom(store_, upload.owner, BytesOf(RecordOf(upload, facts)), options_.records));
  }
  record = RecordOf(upload, std::move(facts));
  CCST_RETURN_IF_ERROR(store_.PutMesh(*record));
  return WithFacts(*std::move(record));
}

MeshRecord MeshStore::RecordOf(const MeshUpload& upload, std::string facts) const {
  const absl::Time now = Now();
  return {.owner = upload.owner,
          .sha256 = upload.sha256,
          .size_bytes = upload.size_bytes,
          .display_name = upload.display_name,
          .create_time = now,
          .expire_time = now + options_.retention,
          .facts = std::move(facts)};
}

absl::StatusOr<std::string> MeshStore::Measure(const std::string& sha256) const {
  std::shared_ptr<void> memory;  // Before what it is for, and so given back after it.
  TriangleMesh mesh;
  if (dependencies_.take_memory) {
    std::shared_ptr<const Blob> blob;
    CCST_ASSIGN_OR_RETURN(blob, store_.blobs().Open(sha256));
    const ByteSource source = {.size = blob->size_bytes(),
                               .read = [&blob](std::int64_t offset, std::span<char> out) {
                                 return blob->Read(offset, out);
                               }};
    CCST_ASSIGN_OR_RETURN(memory, dependencies_.take_memory(source));
  }
  {
    std::string bytes;
    CCST_ASSIGN_OR_RETURN(bytes, ReadWhole(store_.blobs(), sha256));
    CCST_ASSIGN_OR_RETURN(mesh, dependencies_.decode(bytes, options_.decode_limits));
  }
  MeshFacts facts;
  CCST_ASSIGN_OR_RETURN(facts, dependencies_.measure(mesh));
  return EncodeFacts(facts);
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
  CCST_RETURN_IF_ERROR(CheckWhole(*record));
  return WithFacts(*std::move(record));
}

absl::StatusOr<std::shared_ptr<const Blob>> MeshStore::Open(const std::string& owner,
                                                            const std::string& sha256) {
  std::optional<MeshRecord> record;
  CCST_ASSIGN_OR_RETURN(record, Find(owner, sha256));
  if (!record.has_value()) return NotFound(sha256);
  auto blob = OpenPinned(store_.blobs(), pins_, sha256);
  if (absl::IsNotFound(blob.status())) return Damaged(sha256);
  if (!blob.ok()) return blob;
  // No mesh is empty, so that one which is would end a download before anything is checked.
  const std::int64_t size = (*blob)->size_bytes();
  if (size == 0 || (!record->damaged && size != record->size_bytes)) return Damaged(sha256);
  return blob;
}

bool MeshStore::IsReadable(const MeshRecord& record) const {
  return !record.damaged && DecodeFacts(record.facts).ok();
}

absl::Status MeshStore::CheckWhole(const MeshRecord& record) const {
  if (!IsReadable(record)) return Damaged(record.sha256);
  const absl::Status bytes = store_.blobs().Check(record.sha256);
  return absl::IsNotFound(bytes) || absl::IsDataLoss(bytes) ? Damaged(record.sha256) : bytes;
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
    page.records.push_back(WithFacts(std::move(record)));
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
  absl::Status first;
  std::vector<MeshRecord> expired;
  do {
    MutexLock lock(changes_);
    CCST_ASSIGN_OR_RETURN(expired, store_.DropExpiredMeshes(Now(), kDropBatch));
    for (const MeshRecord& mesh : expired) first.Update(pins_.Drop(mesh.sha256));
  } while (!expired.empty());
  return first;
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
  // On a disk that is full or read-only it expires as if it had not been used, but can be read.
  if (!store_.TouchMesh(owner, sha256, expire_time).ok()) return record;
  record->expire_time = std::max(record->expire_time, expire_time);
  return record;
}

StoredMesh MeshStore::WithFacts(MeshRecord record) const {
  MeshFacts facts;
  if (IsReadable(record)) {
    facts = *DecodeFacts(record.facts);
  } else {
    // Damaged text may be no UTF-8, which would damage the whole answer.
    record.sha256 = PrintableText(record.sha256);
    record.display_name = PrintableText(record.display_name);
    facts.warnings = {"what the server has stored of this mesh is damaged; upload it again"};
  }
  return {.record = std::move(record), .facts = std::move(facts)};
}

absl::StatusOr<std::vector<MeshRecord>> MeshStore::InTheWayOf(const std::string& owner,
                                                              std::int64_t bytes) {
  if (bytes > options_.max_stored_bytes) {
    return TooLarge(bytes, "max_stored_mesh_bytes", options_.max_stored_bytes);
  }
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
