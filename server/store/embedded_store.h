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
#include "server/store/sqlite.h"
#include "server/store/store.h"

namespace ccst::server {

/// The engine of one server: records in an SQLite database behind one lock, blobs as files.
class EmbeddedStore : public Store {
 public:
  /// What OpenEmbeddedStore() has opened; `lock` keeps others out.
  EmbeddedStore(FileDescriptor lock, std::unique_ptr<FileBlobs> blobs,
                std::unique_ptr<Database> database);

  BlobStore& blobs() override { return *blobs_; }

  absl::Status PutMesh(const MeshRecord& mesh) override;
  absl::StatusOr<std::optional<MeshRecord>> GetMesh(const std::string& owner,
                                                    const std::string& sha256) override;
  absl::Status TouchMesh(const std::string& owner, const std::string& sha256,
                         absl::Time expire_time) override;
  absl::StatusOr<Page<MeshRecord>> ListMeshes(const std::string& owner, int page_size,
                                              const std::string& page_token) override;
  absl::Status DeleteMesh(const std::string& owner, const std::string& sha256) override;
  absl::StatusOr<std::int64_t> MeshBytes(const std::string& owner) override;
  absl::StatusOr<std::vector<MeshRecord>> ExpiredMeshes(absl::Time now, int limit) override;
  absl::StatusOr<std::vector<MeshRecord>> IdleMeshes(const std::string& owner) override;
  absl::StatusOr<bool> IsMeshInUse(const std::string& owner, const std::string& sha256) override;

  absl::StatusOr<JobRecord> AddJob(const JobRecord& job) override;
  absl::Status MarkCancelling(const std::string& id) override;
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
  absl::StatusOr<std::vector<std::string>> ExpiredJobs(absl::Time now, int limit) override;

  absl::StatusOr<bool> IsReferenced(const std::string& sha256) override;

 private:
  const FileDescriptor lock_;
  const std::unique_ptr<FileBlobs> blobs_;
  const std::unique_ptr<Database> database_;
  Mutex mutex_;
  MeshTable meshes_ ABSL_GUARDED_BY(mutex_);
  JobTable jobs_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace ccst::server
