#include "server/app/server.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <system_error>
#include <utility>

#include <grpcpp/ext/proto_server_reflection_plugin.h>
#include <grpcpp/health_check_service_interface.h>
#include <grpcpp/impl/server_builder_option.h>
#include <grpcpp/impl/server_builder_plugin.h>
#include <grpcpp/resource_quota.h>
#include <grpcpp/security/server_credentials.h>
#include <grpcpp/server_builder.h>

#include "core/base/loopback.h"
#include "core/base/status.h"
#include "grpc/health/v1/health.pb.h"
#include "server/app/system.h"
#include "server/app/tls_credentials.h"

namespace ccst::server {
namespace {

constexpr int kMebibyte = 1 << 20;
// What a request holds beside its mesh.
constexpr int kRequestOverhead = kMebibyte;
// Chunks are under 1 MiB, previews too.
constexpr int kMaxSendBytes = 4 * kMebibyte;
// What gRPC may use for messages on their way in and out, in largest requests.
constexpr std::size_t kQuotaRequests = 8;
constexpr std::size_t kMinQuotaBytes = std::size_t{256} << 20;
constexpr int kMaxStreamsPerConnection = 1024;
// Finds callers whose machine is gone; lets clients ping as often as every 10 s.
constexpr int kKeepaliveMs = 30'000;
constexpr int kKeepaliveTimeoutMs = 10'000;
constexpr int kMinClientPingMs = 10'000;
// Stopped jobs end within 100 ms; this is for their answers to leave.
constexpr absl::Duration kStopGrace = absl::Seconds(2);
constexpr std::chrono::milliseconds kShutdownGrace(100);
constexpr char kReflectionPlugin[] = "proto_server_reflection";

std::string WithPort(const std::string& listen, int port) {
  return listen.substr(0, listen.rfind(':') + 1) + std::to_string(port);
}

void SetLimits(const ServerOptions& options, grpc::ServerBuilder& builder) {
  const int receive = static_cast<int>(options.request_limits.max_inline_mesh_bytes +
                                       options.request_limits.max_texture_bytes) +
                      kRequestOverhead;
  builder.SetMaxReceiveMessageSize(receive);
  builder.SetMaxSendMessageSize(kMaxSendBytes);
  grpc::ResourceQuota quota("ccst");
  quota.Resize(std::max(kMinQuotaBytes, kQuotaRequests * static_cast<std::size_t>(receive)));
  builder.SetResourceQuota(quota);
  builder.AddChannelArgument(GRPC_ARG_MAX_CONCURRENT_STREAMS, kMaxStreamsPerConnection);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIME_MS, kKeepaliveMs);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, kKeepaliveTimeoutMs);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_PERMIT_WITHOUT_CALLS, 1);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS,
                             kMinClientPingMs);
  // Two servers on one port would share its callers by chance.
  builder.AddChannelArgument(GRPC_ARG_ALLOW_REUSEPORT, 0);
}

// Takes reflection away again: its library puts it into every server of the process. What the
// services look like is no secret, but strangers need not be told.
class WithoutReflection final : public grpc::ServerBuilderOption {
 public:
  void UpdateArguments(grpc::ChannelArguments* /*arguments*/) override {}
  void UpdatePlugins(std::vector<std::unique_ptr<grpc::ServerBuilderPlugin>>* plugins) override {
    std::erase_if(*plugins, [](const auto& plugin) { return plugin->name() == kReflectionPlugin; });
  }
};

}  // namespace

Server::Dependencies Server::RealDependencies(const ServerOptions& options) {
  return {.run = RealRunDependencies(SystemClock(), options.mesh_limits),
          .new_id = NewUuid,
          .write_log = WriteToStandardError};
}

absl::StatusOr<std::unique_ptr<Server>> Server::Start(const ServerOptions& options,
                                                      Dependencies dependencies) {
  CCST_RETURN_IF_ERROR(options.Validate());
  std::unique_ptr<Server> server(new Server(options, std::move(dependencies)));
  CCST_RETURN_IF_ERROR(server->Listen());
  return server;
}

Server::Server(const ServerOptions& options, Dependencies dependencies)
    : options_(options),
      clock_(dependencies.run.clock),
      log_(options.log_format, clock_.now, std::move(dependencies.write_log)),
      backend_dependencies_{.run = std::move(dependencies.run),
                            .new_id = std::move(dependencies.new_id),
                            .observer = &metrics_,
                            .report = [this](const std::string& text) { log_.Message(text); }} {}

Server::~Server() {
  metrics_.SetLoadReader({});
  if (backend_ != nullptr) {
    backend_->StopSweeping();
    backend_->jobs().StartDraining();
    backend_->jobs().StopAll();
  }
  if (server_ != nullptr) server_->Shutdown(std::chrono::system_clock::now() + kShutdownGrace);
}

absl::Status Server::OpenBackend() {
  CCST_ASSIGN_OR_RETURN(backend_, Backend::Open(options_, std::move(backend_dependencies_)));
  JobManager& jobs = backend_->jobs();
  sampling_service_ = std::make_unique<SamplingService>(
      StreamSupport{.calls = calls_, .executor = backend_->streams(), .open = streams_},
      JobSupport{.jobs = jobs,
                 .meshes = backend_->meshes(),
                 .blobs = backend_->store().blobs(),
                 .pins = backend_->pins(),
                 .analyst = backend_->analyst(),
                 .disk = backend_->disk(),
                 .analyses = backend_->analyses(),
                 .limits = options_.request_limits});
  const MeshServiceOptions meshes = {.max_inline_mesh_bytes =
                                         options_.request_limits.max_inline_mesh_bytes};
  mesh_service_ = std::make_unique<MeshService>(backend_->meshes(), backend_->disk(),
                                                backend_->decoding(), calls_, meshes);
  server_info_service_ = std::make_unique<ServerInfoService>(
      jobs, calls_,
      LimitsToProto(options_.request_limits, options_.MeshOptions(), meshes, jobs.options()));
  backend_->StartSweeping([this] { streams_.PulseAll(); });
  return absl::OkStatus();
}

absl::Status Server::Listen() {
  // Puts health's descriptor into the pool; reflection cannot list the services without it.
  grpc::health::v1::HealthCheckRequest::descriptor();
  grpc::EnableDefaultHealthCheckService(true);
  grpc::reflection::InitProtoReflectionServerBuilderPlugin();
  CCST_ASSIGN_OR_RETURN(credentials_, Credentials());
  CCST_RETURN_IF_ERROR(OpenBackend());
  grpc::ServerBuilder builder;
  if (!IsLoopback(options_.listen) && !options_.security.reflection) {
    builder.SetOption(std::make_unique<WithoutReflection>());
  }
  int port = 0;
  builder.AddListeningPort(options_.listen, credentials_, &port);
  builder.RegisterService(sampling_service_.get());
  builder.RegisterService(mesh_service_.get());
  builder.RegisterService(server_info_service_.get());
  SetLimits(options_, builder);
  server_ = builder.BuildAndStart();
  if (server_ == nullptr || port == 0) {
    return absl::UnavailableError("cannot listen on " + options_.listen +
                                  "; the address may be in use or not of this machine");
  }
  address_ = WithPort(options_.listen, port);
  CCST_RETURN_IF_ERROR(ServeMetrics());
  SetServing(true);
  log_.Message("listening on " + address_);
  return absl::OkStatus();
}

absl::StatusOr<std::shared_ptr<grpc::ServerCredentials>> Server::Credentials() {
  const SecurityOptions& security = options_.security;
  const auto report = [this](const std::string& message) { log_.Message(message); };
  if (!security.auth_token_file.empty()) {
    CCST_RETURN_IF_ERROR(authenticator_.UseTokens(security.auth_token_file, report));
  }
  if (security.has_tls()) return WatchedTlsCredentials(security.tls, report);
  return grpc::InsecureServerCredentials();
}

absl::Status Server::ServeMetrics() {
  if (options_.metrics_listen.empty()) return absl::OkStatus();
  metrics_.SetLoadReader([this] {
    const JobManager& jobs = backend_->jobs();
    const RunnerLoad load = jobs.Load();
    std::error_code unknown;  // Then both are -1: no alarm over a failed look.
    const std::filesystem::space_info disk = std::filesystem::space(backend_->data_dir(), unknown);
    return LoadSample{.queued_jobs = load.queued,
                      .queued_jobs_limit = jobs.options().runner.max_queued_jobs,
                      .running_jobs = load.running,
                      .watchers = jobs.watcher_count(),
                      .memory_bytes = jobs.memory().used_bytes(),
                      .memory_limit_bytes = jobs.memory().limit_bytes(),
                      .storage_bytes = static_cast<std::int64_t>(disk.capacity),
                      .storage_free_bytes = static_cast<std::int64_t>(disk.available)};
  });
  CCST_ASSIGN_OR_RETURN(metrics_address_, metrics_.Serve(options_.metrics_listen));
  log_.Message("metrics on " + metrics_address_);
  return absl::OkStatus();
}

std::shared_ptr<grpc::Channel> Server::InProcessChannel() {
  return server_->InProcessChannel(grpc::ChannelArguments());
}

void Server::SetServing(bool serving) {
  grpc::HealthCheckServiceInterface* health = server_->GetHealthCheckService();
  for (const char* name :
       {v1::SamplingService::service_full_name(), v1::MeshService::service_full_name(),
        v1::ServerInfoService::service_full_name()}) {
    health->SetServingStatus(name, serving);
  }
  health->SetServingStatus("", serving);
}

void Server::Drain() {
  log_.Message("draining");
  // In this order: who reads NOT_SERVING finds new jobs refused.
  JobManager& jobs = backend_->jobs();
  jobs.StartDraining();
  SetServing(false);
  if (!jobs.WaitUntilIdle(absl::Seconds(options_.drain_timeout_seconds))) {
    log_.Message("drain timeout passed, stopping jobs");
    jobs.StopAll();
    jobs.WaitUntilIdle(kStopGrace);
  }
  server_->Shutdown(std::chrono::system_clock::now() + kShutdownGrace);
  log_.Message("drained");
}

}  // namespace ccst::server
