#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <grpcpp/channel.h>

#include "absl/status/statusor.h"
#include "ccst/v1/mesh_service.grpc.pb.h"
#include "ccst/v1/sampling_service.grpc.pb.h"
#include "ccst/v1/server_info_service.grpc.pb.h"
#include "client/lib/connection.h"
#include "client/lib/outcome.h"
#include "core/mesh/triangle_mesh.h"
#include "core/sampling/sampling.h"

namespace ccst {

/// What to sample and how.
struct SampleJob {
  std::string draco;  ///< The encoded mesh to send.
  TriangleMesh mesh;  ///< What the server decodes from `draco`: positions relative to `origin`.
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  SamplingOptions options;       ///< `thread_count` does not travel.
  int preview_sample_count = 0;  ///< 0: no previews.
  std::string display_name;      ///< For people, of the job and of the mesh if it is uploaded.
  std::map<std::string, std::string> labels;
  bool skip_cache_lookup = false;  ///< Compute even what the server has computed before.
};

/// Bytes of an upload that were sent, and of how many.
using UploadProgress = std::function<void(std::int64_t sent, std::int64_t total)>;

/// Called on the thread that called Sample(), in the order of the stream; any may be empty.
struct SampleCallbacks {
  std::function<void(const v1::Job&)> on_snapshot;  ///< Every change of state or queue position.
  std::function<void(const AlternationReport&)> on_progress;  ///< Every alternation, in order.
  std::function<void(const v1::SamplePreview&)> on_preview;   ///< Relative to the job's origin.
  UploadProgress on_upload;  ///< Where the mesh has to be stored first.
};

/// How a job is watched.
struct WatchOptions {
  SampleCallbacks callbacks;
  std::function<void(const absl::Status&)> on_lost;  ///< The stream broke; it is tried again.
  double patience_seconds = 60.0;  ///< How long a server that has answered may be away.
};

/// The samples of a job as they are stored.
struct FetchedJob {
  v1::Job job;
  /// Checked like the outcome of Sample(), but for the positions: floats, relative to `job.origin`.
  SampleOutcome outcome;
};

/// A server, as its callers see it. Thread-safe; blocking.
class Client {
 public:
  /// A client of the server at `connection`. Connects at first use.
  /// @errors those of OpenChannel()
  static absl::StatusOr<Client> Connect(const Connection& connection);

  /// Samples a mesh: calls back while the run goes on, then returns all of it, checked: as many
  /// samples as asked for, indices in range, the digest that the server announced. Positions are
  /// those of PlaceSamples(). A call that the server was not there for is repeated a few times;
  /// one that had begun is not. Meshes over 1 MiB, or larger than the server takes in a request,
  /// are stored first unless the server has them.
  /// @param stop  cancels the job and the call.
  /// @errors what the server answered, reason and details inside (proto/docs/errors.md);
  ///         UNAVAILABLE  the server cannot be reached, or the connection was lost
  ///         CANCELLED    `stop`, or the server cancelled the job
  ///         DATA_LOSS    the answer is incomplete or contradicts itself
  absl::StatusOr<SampleOutcome> Sample(const SampleJob& job, const SampleCallbacks& callbacks = {},
                                       const std::stop_token& stop = {});

  /// Stores the mesh, unless the server has it, and starts a job that goes on without the caller.
  /// Made once, however often the call has to be repeated.
  /// @return the job as it was accepted
  /// @errors as Sample()
  absl::StatusOr<v1::Job> CreateJob(const SampleJob& job, const UploadProgress& on_upload = {},
                                    const std::stop_token& stop = {});

  /// Follows a job until it has ended, from its first alternation on. Where the stream breaks, also
  /// because the server restarts, it goes on where it was.
  /// @return the ended job, see EndOf()
  /// @errors NOT_FOUND | UNAVAILABLE the server did not come back in time | CANCELLED `stop`,
  ///         which leaves the job alone | what else the server answered
  absl::StatusOr<v1::Job> WatchJob(const std::string& name, const WatchOptions& options = {},
                                   const std::stop_token& stop = {});

  /// The samples of a job that succeeded. Goes on where it was when the stream breaks.
  /// @errors `Job.error` of a failed job | CANCELLED the job or `stop` | FAILED_PRECONDITION
  ///         JOB_NOT_ENDED | NOT_FOUND | DATA_LOSS as Sample() | UNAVAILABLE
  absl::StatusOr<FetchedJob> FetchJob(const std::string& name, const std::stop_token& stop = {});

  /// All jobs of the caller in one of `states` (empty: any) and with all `labels`, newest first.
  /// @errors RESOURCE_EXHAUSTED over 256 MiB of them | DATA_LOSS | what the server answered
  absl::StatusOr<std::vector<v1::Job>> ListJobs(
      const std::vector<v1::Job::State>& states = {},
      const std::map<std::string, std::string>& labels = {}, const std::stop_token& stop = {});

  /// Asks a job to stop; returns it, usually not stopped yet.
  absl::StatusOr<v1::Job> CancelJob(const std::string& name);

  /// Drops an ended job with its samples.
  absl::Status DeleteJob(const std::string& name);

  /// Stores an encoded mesh, in chunks. Started again, a few times, when the stream breaks.
  /// @errors what the server answered | UNAVAILABLE | CANCELLED `stop`
  absl::StatusOr<v1::Mesh> UploadMesh(const std::string& draco, const std::string& display_name,
                                      const UploadProgress& on_upload = {},
                                      const std::stop_token& stop = {});

  /// The bytes of `meshes/{sha256}`, checked against the name. Goes on where it was when the
  /// stream breaks.
  /// @errors NOT_FOUND | DATA_LOSS | UNAVAILABLE | CANCELLED `stop`
  ///       | INVALID_ARGUMENT LIMIT_EXCEEDED over 1 GiB
  absl::StatusOr<std::string> DownloadMesh(const std::string& name,
                                           const std::stop_token& stop = {});

  /// All meshes of the caller, newest first. Errors as ListJobs().
  absl::StatusOr<std::vector<v1::Mesh>> ListMeshes(const std::stop_token& stop = {});

  /// Drops a mesh. FAILED_PRECONDITION MESH_IN_USE while a job needs it.
  absl::Status DeleteMesh(const std::string& name);

  /// Version, limits and load. Waits for an answer for at most ten seconds.
  /// @errors UNAVAILABLE | DEADLINE_EXCEEDED the server cannot be reached | UNIMPLEMENTED
  absl::StatusOr<v1::GetServerInfoResponse> GetServerInfo();

 private:
  explicit Client(const std::shared_ptr<grpc::Channel>& channel);

  // The name of the job's mesh, which the server has then.
  absl::StatusOr<std::string> StoreMesh(const SampleJob& job, const UploadProgress& on_upload,
                                        const std::stop_token& stop);
  // Makes `call` with the name of the job's mesh, twice when the server dropped the mesh between.
  absl::Status OnStoredMesh(const SampleJob& job, const UploadProgress& on_upload,
                            const std::stop_token& stop,
                            const std::function<absl::Status(const std::string&)>& call);

  std::unique_ptr<v1::SamplingService::StubInterface> sampling_;
  std::unique_ptr<v1::MeshService::StubInterface> meshes_;
  std::unique_ptr<v1::ServerInfoService::StubInterface> info_;
};

}  // namespace ccst
