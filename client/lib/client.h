#pragma once

#include <functional>
#include <memory>
#include <stop_token>
#include <string>

#include <Eigen/Core>

#include "absl/status/statusor.h"
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
};

/// Called on the thread that called Sample(), in the order of the stream; any may be empty.
struct SampleCallbacks {
  std::function<void(const v1::Job&)> on_snapshot;  ///< Every change of state or queue position.
  std::function<void(const AlternationReport&)> on_progress;  ///< Every alternation, in order.
  std::function<void(const v1::SamplePreview&)> on_preview;   ///< Relative to the job's origin.
};

/// A server, as its callers see it. Thread-safe; blocking.
class Client {
 public:
  /// A client of the server at `connection`. Connects at first use.
  /// @errors those of OpenChannel()
  static absl::StatusOr<Client> Connect(const Connection& connection);

  Client(std::unique_ptr<v1::SamplingService::StubInterface> sampling,
         std::unique_ptr<v1::ServerInfoService::StubInterface> info);

  /// Samples a mesh: calls back while the run goes on, then returns all of it, checked: as many
  /// samples as asked for, indices in range, the digest that the server announced. Positions are
  /// those of PlaceSamples(). A call that the server was not there for is repeated a few times;
  /// one that had begun is not.
  /// @param stop  cancels the job and the call.
  /// @errors what the server answered, reason and details inside (proto/docs/errors.md);
  ///         UNAVAILABLE  the server cannot be reached, or the connection was lost
  ///         CANCELLED    `stop`, or the server cancelled the job
  ///         DATA_LOSS    the answer is incomplete or contradicts itself
  absl::StatusOr<SampleOutcome> Sample(const SampleJob& job, const SampleCallbacks& callbacks = {},
                                       const std::stop_token& stop = {});

  /// Version, limits and load. Waits for an answer for at most ten seconds.
  /// @errors UNAVAILABLE | DEADLINE_EXCEEDED the server cannot be reached | UNIMPLEMENTED
  absl::StatusOr<v1::GetServerInfoResponse> GetServerInfo();

 private:
  std::unique_ptr<v1::SamplingService::StubInterface> sampling_;
  std::unique_ptr<v1::ServerInfoService::StubInterface> info_;
};

}  // namespace ccst
