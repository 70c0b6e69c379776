#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "server/base/mutex.h"
#include "server/store/file_blobs.h"
#include "server/store/files.h"
#include "server/store/job_table.h"
#include "server/store/mesh_table.h"
#include "server/store/space_reserve.h"
#include "server/store/sqlite.h"
#include "server/store/store.h"

namespace ccst::server {

/// The engine of one server: records in an SQLite database behind one lock, blobs as files.
class EmbeddedStore : public Store {
 public:
  /// What OpenEmbeddedStore() has opened; `lock` keeps others out.
  EmbeddedStore(FileDescriptor lock, std::unique_ptr<SpaceReserve> reserve,
                std::unique_ptr<FileBlobs> blobs, std::unique_ptr<Database> database);

  BlobStore& blobs() override { return *blobs_; }

  absl::Status PutMesh(const MeshRecord& mesh) override;
  absl::StatusOr<std::optional<MeshRecord>> GetMesh(const std::string& owner,
                                                    const std::string& sha256) override;
  absl::Status TouchMeshes(const std::string& owner, const std::vector<std::string>& sha256s,
                           absl::Time expire_time) override;
  absl::StatusOr<Page<MeshRecord>> ListMeshes(const std::string& owner, int page_size,
                                              const std::string& page_token) override;
  absl::Status DeleteMesh(const std::string& owner, const std::string& sha256) override;
  absl::StatusOr<std::int64_t> MeshBytes(const std::string& owner) override;
  absl::StatusOr<std::vector<MeshRecord>> DropExpiredMeshes(absl::Time now, int limit) override;
  absl::StatusOr<std::vector<MeshRecord>> IdleMeshes(const std::string& owner) override;
  absl::StatusOr<bool> IsMeshInUse(const std::string& owner, const std::string& sha256) override;

  absl::StatusOr<JobRecord> AddJob(const JobRecord& job) override;
  absl::StatusOr<JobRecord> AddEndedJob(const JobRecord& job, const std::string& history) override;
  absl::Status MarkCancelling(const std::string& id) override;
  absl::Status CountStart(const std::string& id) override;
  absl::Status GiveBackStart(const std::string& id) override;
  absl::Status EndJob(const JobRecord& job, const std::string& history) override;
  absl::StatusOr<std::optional<JobRecord>> GetJob(const std::string& id) override;
  absl::StatusOr<std::optional<JobRecord>> FindRequest(const std::string& owner,
                                                       const std::string& request_id) override;
  absl::StatusOr<std::string> GetHistory(const std::string& id) override;
  absl::StatusOr<Page<JobRecord>> ListJobs(const JobFilter& filter, int page_size,
                                           const std::string& page_token) override;
  absl::StatusOr<std::vector<JobRecord>> UnfinishedJobs() override;
  absl::StatusOr<std::optional<JobRecord>> FindReusable(const std::string& spec_digest,
                                                        absl::Time now) override;
  absl::Status DeleteJob(const std::string& id) override;
  absl::StatusOr<std::vector<DroppedJob>> DropExpiredJobs(absl::Time now, int limit) override;

  absl::StatusOr<std::int64_t> RecordBytes(const std::string& owner) override;
  absl::StatusOr<std::int64_t> AllRecordBytes() override;

  absl::StatusOr<bool> IsReferenced(const std::string& sha256) override;

 private:
  // True when the change that failed with `status` is to be tried again: an entry of an index that
  // damage has changed keeps its row from being changed or deleted, so that the indexes are made
  // anew, which takes time in proportion to all records.
  bool MendsDamage(const absl::Status& status) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // The same, also for changes that free more than they take: on a full disk they have the space of
  // the reserve.
  bool Mends(const absl::Status& status) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // After such a change: what it took of the reserve comes back. Returns `status`.
  absl::Status Freed(absl::Status status) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // STORAGE_FULL while the reserve is not whole: its space is for those changes alone.
  absl::Status CheckGrowth() const;

  const FileDescriptor lock_;
  const std::unique_ptr<SpaceReserve> reserve_;
  const std::unique_ptr<FileBlobs> blobs_;
  const std::unique_ptr<Database> database_;
  Mutex mutex_;
  MeshTable meshes_ ABSL_GUARDED_BY(mutex_);
  JobTable jobs_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace ccst::server
