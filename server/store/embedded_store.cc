#include "server/store/embedded_store.h"

#include <utility>

#include "core/base/status.h"
#include "server/store/storage_error.h"

namespace ccst::server {

EmbeddedStore::EmbeddedStore(FileDescriptor lock, std::unique_ptr<SpaceReserve> reserve,
                             std::unique_ptr<FileBlobs> blobs, std::unique_ptr<Database> database)
    : lock_(std::move(lock)),
      reserve_(std::move(reserve)),
      blobs_(std::move(blobs)),
      database_(std::move(database)),
      meshes_(*database_),
      jobs_(*database_) {}

bool EmbeddedStore::MendsDamage(const absl::Status& status) {
  return GetErrorReason(status) == ErrorReason::kStorageFailed &&
         database_->RunScript("REINDEX").ok();
}

bool EmbeddedStore::Mends(const absl::Status& status) {
  if (MendsDamage(status)) return true;
  if (GetErrorReason(status) != ErrorReason::kStorageFull) return false;
  reserve_->GiveUp();
  return true;
}

absl::Status EmbeddedStore::Freed(absl::Status status) {
  if (status.ok() && !reserve_->is_whole()) {
    // From the log back into the records, which have the pages already: the next change finds the
    // room that this one took. Where it fails, the log grows a little further.
    database_->Checkpoint().IgnoreError();
    reserve_->Restore();
  }
  return status;
}

absl::Status EmbeddedStore::CheckGrowth() const {
  return reserve_->Restore() ? absl::OkStatus() : NoSpace("cannot write the records");
}

absl::Status EmbeddedStore::PutMesh(const MeshRecord& mesh) {
  CCST_RETURN_IF_ERROR(CheckGrowth());
  const MutexLock lock(mutex_);
  absl::Status status = meshes_.Put(mesh);
  if (MendsDamage(status)) status = meshes_.Put(mesh);
  return status;
}

absl::StatusOr<std::optional<MeshRecord>> EmbeddedStore::GetMesh(const std::string& owner,
                                                                 const std::string& sha256) {
  const MutexLock lock(mutex_);
  return meshes_.Get(owner, sha256);
}

absl::Status EmbeddedStore::TouchMeshes(const std::string& owner,
                                        const std::vector<std::string>& sha256s,
                                        absl::Time expire_time) {
  CCST_RETURN_IF_ERROR(CheckGrowth());
  const MutexLock lock(mutex_);
  absl::Status status = meshes_.Touch(owner, sha256s, expire_time);
  if (MendsDamage(status)) status = meshes_.Touch(owner, sha256s, expire_time);
  return status;
}

absl::StatusOr<Page<MeshRecord>> EmbeddedStore::ListMeshes(const std::string& owner, int page_size,
                                                           const std::string& page_token) {
  const MutexLock lock(mutex_);
  return meshes_.List(owner, page_size, page_token);
}

absl::Status EmbeddedStore::DeleteMesh(const std::string& owner, const std::string& sha256) {
  const MutexLock lock(mutex_);
  absl::Status status = meshes_.Delete(owner, sha256);
  if (Mends(status)) status = meshes_.Delete(owner, sha256);
  return Freed(std::move(status));
}

absl::StatusOr<std::int64_t> EmbeddedStore::MeshBytes(const std::string& owner) {
  const MutexLock lock(mutex_);
  return meshes_.SumOfBytes(owner);
}

absl::StatusOr<std::vector<MeshRecord>> EmbeddedStore::DropExpiredMeshes(absl::Time now,
                                                                         int limit) {
  const MutexLock lock(mutex_);
  auto dropped = meshes_.DropExpired(now, limit);
  // The reserve has room for little.
  if (Mends(dropped.status())) dropped = meshes_.DropExpired(now, 1);
  if (dropped.ok() && !dropped->empty()) Freed(absl::OkStatus()).IgnoreError();
  return dropped;
}

absl::StatusOr<std::vector<MeshRecord>> EmbeddedStore::IdleMeshes(const std::string& owner) {
  const MutexLock lock(mutex_);
  return meshes_.Idle(owner);
}

absl::StatusOr<bool> EmbeddedStore::IsMeshInUse(const std::string& owner,
                                                const std::string& sha256) {
  const MutexLock lock(mutex_);
  return meshes_.IsInUse(owner, sha256);
}

absl::StatusOr<JobRecord> EmbeddedStore::AddJob(const JobRecord& job) {
  CCST_RETURN_IF_ERROR(CheckGrowth());
  const MutexLock lock(mutex_);
  if (!job.may_be_lost) return jobs_.Add(job, "");
  CCST_RETURN_IF_ERROR(database_->SetSynchronized(false));
  auto added = jobs_.Add(job, "");
  CCST_RETURN_IF_ERROR(database_->SetSynchronized(true));
  return added;
}

absl::StatusOr<JobRecord> EmbeddedStore::AddEndedJob(const JobRecord& job,
                                                     const std::string& history) {
  CCST_RETURN_IF_ERROR(CheckGrowth());
  const MutexLock lock(mutex_);
  return jobs_.Add(job, history);
}

absl::Status EmbeddedStore::MarkCancelling(const std::string& id) {
  const MutexLock lock(mutex_);
  absl::Status status = jobs_.MarkCancelling(id);
  if (Mends(status)) status = jobs_.MarkCancelling(id);
  return Freed(std::move(status));
}

absl::Status EmbeddedStore::CountStart(const std::string& id) {
  CCST_RETURN_IF_ERROR(CheckGrowth());
  const MutexLock lock(mutex_);
  return jobs_.AddToStarts(id, 1);
}

absl::Status EmbeddedStore::GiveBackStart(const std::string& id) {
  const MutexLock lock(mutex_);
  absl::Status status = jobs_.AddToStarts(id, -1);
  if (Mends(status)) status = jobs_.AddToStarts(id, -1);
  return Freed(std::move(status));
}

absl::Status EmbeddedStore::EndJob(const JobRecord& job, const std::string& history) {
  const MutexLock lock(mutex_);
  if (!job.samples_sha256.empty()) {
    CCST_RETURN_IF_ERROR(CheckGrowth());
    absl::Status status = jobs_.End(job, history);
    if (MendsDamage(status)) status = jobs_.End(job, history);
    return status;
  }
  // It is little, and what was cancelled or failed must not hang on a full disk.
  absl::Status status = jobs_.End(job, history);
  if (Mends(status)) status = jobs_.End(job, history);
  return Freed(std::move(status));
}

absl::StatusOr<std::optional<JobRecord>> EmbeddedStore::GetJob(const std::string& id) {
  const MutexLock lock(mutex_);
  return jobs_.Get(id);
}

absl::StatusOr<std::optional<JobRecord>> EmbeddedStore::FindRequest(const std::string& owner,
                                                                    const std::string& request_id) {
  const MutexLock lock(mutex_);
  return jobs_.FindRequest(owner, request_id);
}

absl::StatusOr<std::string> EmbeddedStore::GetHistory(const std::string& id) {
  const MutexLock lock(mutex_);
  return jobs_.GetHistory(id);
}

absl::StatusOr<Page<JobRecord>> EmbeddedStore::ListJobs(const JobFilter& filter, int page_size,
                                                        const std::string& page_token) {
  const MutexLock lock(mutex_);
  return jobs_.List(filter, page_size, page_token);
}

absl::StatusOr<std::vector<JobRecord>> EmbeddedStore::UnfinishedJobs() {
  const MutexLock lock(mutex_);
  return jobs_.Unfinished();
}

absl::StatusOr<std::optional<JobRecord>> EmbeddedStore::FindReusable(const std::string& spec_digest,
                                                                     absl::Time now) {
  const MutexLock lock(mutex_);
  return jobs_.FindReusable(spec_digest, now);
}

absl::Status EmbeddedStore::DeleteJob(const std::string& id) {
  const MutexLock lock(mutex_);
  absl::Status status = jobs_.Delete(id);
  if (Mends(status)) status = jobs_.Delete(id);
  return Freed(std::move(status));
}

absl::StatusOr<std::vector<DroppedJob>> EmbeddedStore::DropExpiredJobs(absl::Time now, int limit) {
  const MutexLock lock(mutex_);
  auto dropped = jobs_.DropExpired(now, limit);
  if (Mends(dropped.status())) dropped = jobs_.DropExpired(now, 1);
  if (dropped.ok() && !dropped->empty()) Freed(absl::OkStatus()).IgnoreError();
  return dropped;
}

absl::StatusOr<std::int64_t> EmbeddedStore::RecordBytes(const std::string& owner) {
  const MutexLock lock(mutex_);
  Statement statement =
      database_->Cached("SELECT coalesce(sum(bytes), 0) FROM record_totals WHERE owner = ?");
  if (statement.Bind(owner).Next()) return statement.Int(0);
  return statement.status();
}

absl::StatusOr<std::int64_t> EmbeddedStore::AllRecordBytes() {
  const MutexLock lock(mutex_);
  Statement statement = database_->Cached("SELECT coalesce(sum(bytes), 0) FROM record_totals");
  if (statement.Next()) return statement.Int(0);
  return statement.status();
}

absl::StatusOr<bool> EmbeddedStore::IsReferenced(const std::string& sha256) {
  const MutexLock lock(mutex_);
  absl::StatusOr<bool> mesh = meshes_.RefersTo(sha256);
  if (!mesh.ok() || *mesh) return mesh;
  return jobs_.RefersTo(sha256);
}

}  // namespace ccst::server
