#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "server/store/blob_store.h"
#include "server/store/records.h"

namespace ccst::server {

/// Where meshes, jobs and their results live, behind one interface for every engine. A call that
/// returned OK is durable: it survives the loss of the process and of power. Thread-safe; calls
/// block for as long as the disk takes.
///
/// Errors of every call: RESOURCE_EXHAUSTED STORAGE_FULL | INTERNAL STORAGE_FAILED; nothing was
/// changed then.
class Store {
 public:
  virtual ~Store() = default;

  virtual BlobStore& blobs() = 0;

  // Meshes; the blob must be there before its record.

  /// Adds or replaces the record of (owner, sha256).
  virtual absl::Status PutMesh(const MeshRecord& mesh) = 0;
  virtual absl::StatusOr<std::optional<MeshRecord>> GetMesh(const std::string& owner,
                                                            const std::string& sha256) = 0;
  /// Moves the expiry to `expire_time` where that is later.
  virtual absl::Status TouchMesh(const std::string& owner, const std::string& sha256,
                                 absl::Time expire_time) = 0;
  /// INVALID_ARGUMENT REQUEST_INVALID for a token that is not one.
  virtual absl::StatusOr<Page<MeshRecord>> ListMeshes(const std::string& owner, int page_size,
                                                      const std::string& page_token) = 0;
  virtual absl::Status DeleteMesh(const std::string& owner, const std::string& sha256) = 0;
  /// Sum of the sizes of the owner's meshes.
  virtual absl::StatusOr<std::int64_t> MeshBytes(const std::string& owner) = 0;
  /// At most `limit` meshes that expired before `now` and that no job that has not ended needs.
  virtual absl::StatusOr<std::vector<MeshRecord>> ExpiredMeshes(absl::Time now, int limit) = 0;
  /// The owner's meshes that no job that has not ended needs, least lately used first.
  virtual absl::StatusOr<std::vector<MeshRecord>> IdleMeshes(const std::string& owner) = 0;
  /// True when a job of the owner that has not ended needs it.
  virtual absl::StatusOr<bool> IsMeshInUse(const std::string& owner, const std::string& sha256) = 0;

  // Jobs.

  /// Adds a job. Where the owner has a job of the same request_id, that is returned instead and
  /// nothing is added.
  virtual absl::StatusOr<JobRecord> AddJob(const JobRecord& job) = 0;
  /// QUEUED -> CANCELLING; nothing happens to a job in another state.
  virtual absl::Status MarkCancelling(const std::string& id) = 0;
  /// Writes state, times, outcome, samples and `history` (opaque) of a job that ends; nothing
  /// happens to one that has ended. NOT_FOUND NOT_FOUND when it is not there.
  virtual absl::Status EndJob(const JobRecord& job, const std::string& history) = 0;
  virtual absl::StatusOr<std::optional<JobRecord>> GetJob(const std::string& id) = 0;
  /// The owner's job of that request_id.
  virtual absl::StatusOr<std::optional<JobRecord>> FindRequest(const std::string& owner,
                                                               const std::string& request_id) = 0;
  /// Empty when there is none.
  virtual absl::StatusOr<std::string> GetHistory(const std::string& id) = 0;
  /// INVALID_ARGUMENT REQUEST_INVALID for a token that is not one.
  virtual absl::StatusOr<Page<JobRecord>> ListJobs(const JobFilter& filter, int page_size,
                                                   const std::string& page_token) = 0;
  /// Jobs that have not ended, oldest first.
  virtual absl::StatusOr<std::vector<JobRecord>> UnfinishedJobs() = 0;
  /// The latest reusable job of an equal spec that has not expired.
  virtual absl::StatusOr<std::optional<JobRecord>> FindReusable(const std::string& spec_digest,
                                                                absl::Time now) = 0;
  virtual absl::Status DeleteJob(const std::string& id) = 0;
  /// Ids of at most `limit` ended jobs that expired before `now`.
  virtual absl::StatusOr<std::vector<std::string>> ExpiredJobs(absl::Time now, int limit) = 0;

  /// True when a mesh or job refers to the blob.
  virtual absl::StatusOr<bool> IsReferenced(const std::string& sha256) = 0;
};

/// Opens, or makes, the embedded store in `directory`: SQLite for records, files for blobs. Blobs
/// that nothing refers to are removed. All blobs together may have `max_blob_bytes`.
/// @errors FAILED_PRECONDITION STORAGE_FAILED when another process has it open or a newer version
///         wrote it | INTERNAL STORAGE_FAILED when it cannot be made, read or written; says why
absl::StatusOr<std::unique_ptr<Store>> OpenEmbeddedStore(
    const std::string& directory,
    std::int64_t max_blob_bytes = std::numeric_limits<std::int64_t>::max());

}  // namespace ccst::server
