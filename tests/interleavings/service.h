#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "ccst/v1/mesh.pb.h"
#include "ccst/v1/sampling_service.pb.h"

namespace ccst::interleavings {

/// What a watcher saw of a job.
struct Watched {
  v1::Job end;           ///< The last snapshot.
  int report_count = 0;  ///< Reports before it, each with the next sequence number.
};

/// What a caller of `Sample` got.
struct Sampled {
  v1::Job end;          ///< The last snapshot that arrived; unfinished when the caller left.
  std::string samples;  ///< SamplesDigest() of what arrived; empty when there was none.
};

/// What a service holds when nothing is under way.
struct Holdings {
  std::map<std::string, std::int64_t> blobs;  ///< Size of each stored blob, by its digest.
  std::int64_t counted_bytes = 0;             ///< What the service believes they have together.
  std::int64_t memory_bytes = 0;              ///< In use, of the budget of jobs.
  std::int64_t watchers = 0;
};

/// The calls that the clients of the bench make, whatever is behind them: the rooms of the server
/// in this process, or a server at the other end of a connection. Calls block; errors are those of
/// the API with their reasons. Owners are 0, 1, ... Thread-safe.
class Service {
 public:
  virtual ~Service() = default;

  virtual absl::StatusOr<v1::Job> CreateJob(int owner, const v1::CreateJobRequest& request) = 0;
  /// @param leave  the caller goes away after the first message.
  virtual absl::StatusOr<Sampled> Sample(int owner, const v1::SampleRequest& request,
                                         bool leave) = 0;
  virtual absl::StatusOr<v1::Job> GetJob(int owner, const std::string& name) = 0;
  /// All pages.
  virtual absl::StatusOr<std::vector<v1::Job>> ListJobs(int owner) = 0;
  /// Until the job has ended.
  virtual absl::StatusOr<Watched> WatchJob(int owner, const std::string& name) = 0;
  virtual absl::StatusOr<v1::Job> CancelJob(int owner, const std::string& name) = 0;
  virtual absl::Status DeleteJob(int owner, const std::string& name) = 0;
  /// SamplesDigest() of all samples and triangles.
  virtual absl::StatusOr<std::string> ReadSamples(int owner, const std::string& name) = 0;

  virtual absl::Status UploadMesh(int owner, const std::string& bytes) = 0;
  virtual absl::StatusOr<std::string> DownloadMesh(int owner, const std::string& name) = 0;
  virtual absl::Status DeleteMesh(int owner, const std::string& name) = 0;
  /// The names on all pages.
  virtual absl::StatusOr<std::vector<std::string>> ListMeshes(int owner) = 0;

  /// The clock by which jobs expire, and how long after their end.
  virtual absl::Time Now() const = 0;
  virtual absl::Duration retention() const = 0;
  /// Lets time pass where the clock is the bench's, and drops what has expired.
  virtual absl::Status Tend(absl::Duration passes) = 0;

  /// Waits until no job waits or runs; an error when that takes too long.
  virtual absl::Status WaitUntilIdle() = 0;
  virtual absl::StatusOr<Holdings> Look() = 0;
  /// Goes away without a farewell and comes back on the same store.
  virtual absl::Status Restart() = 0;
};

}  // namespace ccst::interleavings
