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
/// Errors of every call: RESOURCE_EXHAUSTED STORAGE_FULL | RESOURCE_EXHAUSTED QUEUE_FULL short of
/// descriptors or memory | INTERNAL STORAGE_FAILED; nothing was changed then. What deletes, cancels
/// or ends a job without samples goes on when the disk is full. A record that is
/// damaged is no error: it is `damaged`.
class Store {
 public:
  virtual ~Store() = default;

  virtual BlobStore& blobs() = 0;

  // Meshes; the blob must be there before its record.

  /// Adds or replaces the record of (owner, sha256).
  virtual absl::Status PutMesh(const MeshRecord& mesh) = 0;
  virtual absl::StatusOr<std::optional<MeshRecord>> GetMesh(const std::string& owner,
                                                            const std::string& sha256) = 0;
  /// Moves the expiry of those of the owner's meshes to `expire_time` where that is later, all in
  /// one step.
  virtual absl::Status TouchMeshes(const std::string& owner,
                                   const std::vector<std::string>& sha256s,
                                   absl::Time expire_time) = 0;
  /// The same for one mesh.
  absl::Status TouchMesh(const std::string& owner, const std::string& sha256,
                         absl::Time expire_time) {
    return TouchMeshes(owner, {sha256}, expire_time);
  }
  /// INVALID_ARGUMENT REQUEST_INVALID for a token that is not one.
  virtual absl::StatusOr<Page<MeshRecord>> ListMeshes(const std::string& owner, int page_size,
                                                      const std::string& page_token) = 0;
  virtual absl::Status DeleteMesh(const std::string& owner, const std::string& sha256) = 0;
  /// Sum of the sizes of the owner's meshes.
  virtual absl::StatusOr<std::int64_t> MeshBytes(const std::string& owner) = 0;
  /// Drops at most `limit` meshes that expired before `now` and that no job that has not ended
  /// needs, earliest first, in one change, and returns them.
  virtual absl::StatusOr<std::vector<MeshRecord>> DropExpiredMeshes(absl::Time now, int limit) = 0;
  /// The owner's meshes that no job that has not ended needs, least lately used first.
  virtual absl::StatusOr<std::vector<MeshRecord>> IdleMeshes(const std::string& owner) = 0;
  /// True when a job of the owner that has not ended needs it.
  virtual absl::StatusOr<bool> IsMeshInUse(const std::string& owner, const std::string& sha256) = 0;

  // Jobs.

  /// Adds a job. Where the owner has a job of the same request_id, that is returned instead and
  /// nothing is added. Not durable for a record that `may_be_lost`.
  virtual absl::StatusOr<JobRecord> AddJob(const JobRecord& job) = 0;
  /// The same for a job that has ended already, with its `history` (opaque): all of it or nothing.
  virtual absl::StatusOr<JobRecord> AddEndedJob(const JobRecord& job,
                                                const std::string& history) = 0;
  /// QUEUED -> CANCELLING; nothing happens to a job in another state.
  virtual absl::Status MarkCancelling(const std::string& id) = 0;
  /// A run of the job begins: one more in `starts`, which tells the next process how often one died
  /// while the job ran. Nothing happens to a job that is not there.
  virtual absl::Status CountStart(const std::string& id) = 0;
  /// The run is over without an end of the job, in good order: one less.
  virtual absl::Status GiveBackStart(const std::string& id) = 0;
  /// Writes state, times, outcome, samples and `history` (opaque) of a job that ends; nothing
  /// happens to one that has ended. NOT_FOUND NOT_FOUND when it is not there.
  virtual absl::Status EndJob(const JobRecord& job, const std::string& history) = 0;
  virtual absl::StatusOr<std::optional<JobRecord>> GetJob(const std::string& id) = 0;
  /// The owner's job of that request_id.
  virtual absl::StatusOr<std::optional<JobRecord>> FindRequest(const std::string& owner,
                                                               const std::string& request_id) = 0;
  /// Empty when there is none; DATA_LOSS STORAGE_FAILED when it is damaged.
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
  /// Drops at most `limit` ended jobs that expired before `now`, earliest first, in one change, and
  /// returns them.
  virtual absl::StatusOr<std::vector<DroppedJob>> DropExpiredJobs(absl::Time now, int limit) = 0;

  // Both kinds.

  /// What the records of the owner's jobs and meshes take: BytesOf() of each, and the history of
  /// each job as if it were alone; of one that has not ended, the room for it.
  virtual absl::StatusOr<std::int64_t> RecordBytes(const std::string& owner) = 0;
  /// The same of all owners.
  virtual absl::StatusOr<std::int64_t> AllRecordBytes() = 0;

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
