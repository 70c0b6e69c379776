#include "server/store/embedded_store.h"

#include <utility>

#include "core/base/status.h"

namespace ccst::server {

EmbeddedStore::EmbeddedStore(FileDescriptor lock, std::unique_ptr<FileBlobs> blobs,
                             std::unique_ptr<Database> database)
    : lock_(std::move(lock)),
      blobs_(std::move(blobs)),
      database_(std::move(database)),
      meshes_(*database_),
      jobs_(*database_) {}

absl::Status EmbeddedStore::PutMesh(const MeshRecord& mesh) {
  const MutexLock lock(mutex_);
  return meshes_.Put(mesh);
}

absl::StatusOr<std::optional<MeshRecord>> EmbeddedStore::GetMesh(const std::string& owner,
                                                                 const std::string& sha256) {
  const MutexLock lock(mutex_);
  return meshes_.Get(owner, sha256);
}

absl::Status EmbeddedStore::TouchMesh(const std::string& owner, const std::string& sha256,
                                      absl::Time expire_time) {
  const MutexLock lock(mutex_);
  return meshes_.Touch(owner, sha256, expire_time);
}

absl::StatusOr<Page<MeshRecord>> EmbeddedStore::ListMeshes(const std::string& owner, int page_size,
                                                           const std::string& page_token) {
  const MutexLock lock(mutex_);
  return meshes_.List(owner, page_size, page_token);
}

absl::Status EmbeddedStore::DeleteMesh(const std::string& owner, const std::string& sha256) {
  const MutexLock lock(mutex_);
  return meshes_.Delete(owner, sha256);
}

absl::StatusOr<std::int64_t> EmbeddedStore::MeshBytes(const std::string& owner) {
  const MutexLock lock(mutex_);
  return meshes_.SumOfBytes(owner);
}

absl::StatusOr<std::vector<MeshRecord>> EmbeddedStore::ExpiredMeshes(absl::Time now, int limit) {
  const MutexLock lock(mutex_);
  return meshes_.Expired(now, limit);
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
  const MutexLock lock(mutex_);
  return jobs_.Add(job);
}

absl::Status EmbeddedStore::MarkCancelling(const std::string& id) {
  const MutexLock lock(mutex_);
  return jobs_.MarkCancelling(id);
}

absl::Status EmbeddedStore::EndJob(const JobRecord& job, const std::string& history) {
  const MutexLock lock(mutex_);
  return jobs_.End(job, history);
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
  return jobs_.Delete(id);
}

absl::StatusOr<std::vector<std::string>> EmbeddedStore::ExpiredJobs(absl::Time now, int limit) {
  const MutexLock lock(mutex_);
  return jobs_.Expired(now, limit);
}

absl::StatusOr<bool> EmbeddedStore::IsReferenced(const std::string& sha256) {
  const MutexLock lock(mutex_);
  absl::StatusOr<bool> mesh = meshes_.RefersTo(sha256);
  if (!mesh.ok() || *mesh) return mesh;
  return jobs_.RefersTo(sha256);
}

}  // namespace ccst::server
