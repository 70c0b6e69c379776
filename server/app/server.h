#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include <grpcpp/channel.h>
#include <grpcpp/server.h>
#include <grpcpp/server_builder.h>

#include "absl/status/statusor.h"
#include "server/app/backend.h"
#include "server/app/server_options.h"
#include "server/auth/authenticator.h"
#include "server/auth/peers.h"
#include "server/jobs/job_runner.h"
#include "server/log/server_log.h"
#include "server/metrics/metrics.h"
#include "server/net/gate.h"
#include "server/net/self_check.h"
#include "server/rpc/call.h"
#include "server/rpc/mesh_service.h"
#include "server/rpc/sampling_service.h"
#include "server/rpc/server_info_service.h"

namespace ccst::server {

/// A listening server: services, health, reflection, and the jobs behind them.
class Server {
 public:
  /// What tests replace.
  struct Dependencies {
    RunDependencies run;
    std::function<std::string()> new_id;
    std::function<void(const std::string&)> write_log;  ///< Whole lines, one at a time.
    /// The server cannot be reached through its own port any more, and has said why; empty: it does
    /// not look.
    std::function<void()> on_unreachable = {};
    /// Called every few seconds, for what waits to be logged; may be empty.
    std::function<void()> tend_log = {};
  };

  /// The real ones: the core, random ids, a log on standard error; the process ends when it cannot
  /// be reached, so that whoever watches it starts it again.
  static Dependencies RealDependencies(const ServerOptions& options);

  /// Listens and serves until destroyed. INVALID_ARGUMENT, NOT_FOUND for `options` and the files
  /// they name | UNAVAILABLE when an address cannot be bound.
  static absl::StatusOr<std::unique_ptr<Server>> Start(const ServerOptions& options,
                                                       Dependencies dependencies);
  /// Stops everything at once.
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  /// HOST:PORT with the port really listened on.
  const std::string& address() const { return address_; }
  /// A channel to this server within the process, for programs that have a server of their own.
  std::shared_ptr<grpc::Channel> InProcessChannel();
  /// HOST:PORT of the metrics; empty when they are off.
  const std::string& metrics_address() const { return metrics_address_; }

  /// Reports NOT_SERVING and refuses new jobs with UNAVAILABLE DRAINING; lets jobs finish for at
  /// most `drain_timeout_seconds`, then stops them; returns when all callers have their answers.
  void Drain();

 private:
  Server(const ServerOptions& options, Dependencies dependencies);
  absl::Status Listen();
  absl::Status ServeMetrics();
  absl::Status UseTokens();
  absl::Status OpenGate();
  void StopTakingCallers();
  void SetServing(bool serving);
  absl::Status OpenBackend();
  void Tend();
  void TellOfLostLines();

  const ServerOptions options_;
  const Clock clock_;
  ServerLog log_;
  const std::function<void()> tend_log_;
  std::int64_t told_lost_lines_ = 0;  // Of the thread that tends, then of the one that drains.
  Metrics metrics_;
  Authenticator authenticator_;
  OpenStreams streams_;
  Peers peers_;
  StreamMemory stream_memory_;
  CallSupport calls_ = {authenticator_, peers_, log_, metrics_, clock_};
  Backend::Dependencies backend_dependencies_;  // Until Listen().
  std::unique_ptr<Backend> backend_;
  std::unique_ptr<SamplingService> sampling_service_;
  std::unique_ptr<MeshService> mesh_service_;
  std::unique_ptr<ServerInfoService> server_info_service_;
  std::string address_;
  std::string metrics_address_;
  std::function<void()> on_unreachable_;
  std::unique_ptr<grpc::experimental::ExternalConnectionAcceptor> acceptor_;
  std::unique_ptr<ConnectionGate> gate_;
  std::unique_ptr<grpc::Server> server_;
  std::unique_ptr<SelfCheck> self_check_;  // Last: goes first.
};

}  // namespace ccst::server
