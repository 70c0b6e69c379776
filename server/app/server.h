#pragma once

#include <functional>
#include <memory>
#include <string>

#include <grpcpp/channel.h>
#include <grpcpp/security/server_credentials.h>
#include <grpcpp/server.h>

#include "absl/status/statusor.h"
#include "server/app/backend.h"
#include "server/app/server_options.h"
#include "server/auth/authenticator.h"
#include "server/jobs/job_runner.h"
#include "server/log/server_log.h"
#include "server/metrics/metrics.h"
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
  };

  /// The real ones: the core, random ids, a log on standard error.
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
  absl::StatusOr<std::shared_ptr<grpc::ServerCredentials>> Credentials();
  void SetServing(bool serving);
  absl::Status OpenBackend();

  const ServerOptions options_;
  const Clock clock_;
  ServerLog log_;
  Metrics metrics_;
  Authenticator authenticator_;
  OpenStreams streams_;
  CallSupport calls_ = {authenticator_, log_, metrics_, clock_};
  Backend::Dependencies backend_dependencies_;  // Until Listen().
  std::unique_ptr<Backend> backend_;
  std::unique_ptr<SamplingService> sampling_service_;
  std::unique_ptr<MeshService> mesh_service_;
  std::unique_ptr<ServerInfoService> server_info_service_;
  std::string address_;
  std::string metrics_address_;
  std::shared_ptr<grpc::ServerCredentials> credentials_;
  std::unique_ptr<grpc::Server> server_;  // Last: goes first.
};

}  // namespace ccst::server
