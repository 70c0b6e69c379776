#include "server/app/server.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>
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

#include "absl/strings/str_cat.h"
#include "core/base/loopback.h"
#include "core/base/status.h"
#include "grpc/health/v1/health.pb.h"
#include "server/app/system.h"
#include "server/base/held_clock.h"
#include "server/base/lost_log_lines.h"
#include "server/net/descriptor_limit.h"

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
// Without a call for so long a connection gives its place back; clients connect again by
// themselves.
constexpr int kIdleMs = 600'000;
// For the last answers to leave.
constexpr double kFarewellSeconds = 1.0;
// Exit status of a process that nobody can reach.
constexpr int kUnreachableStatus = 3;
constexpr char kReflectionPlugin[] = "proto_server_reflection";

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
  builder.AddChannelArgument(GRPC_ARG_MAX_CONNECTION_IDLE_MS, kIdleMs);
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
          .write_log = WriteToStandardError,
          .on_unreachable =
              [] {
                FinishLog();  // It says why.
                std::_Exit(kUnreachableStatus);
              },
          .tend_log = TendLog};
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
      tend_log_(std::move(dependencies.tend_log)),
      stream_memory_(options.streams),
      backend_dependencies_{.run = std::move(dependencies.run),
                            .new_id = std::move(dependencies.new_id),
                            .observer = &metrics_,
                            .report = [this](const std::string& text) { log_.Message(text); }},
      on_unreachable_(std::move(dependencies.on_unreachable)) {
  // The lines of the log alone say what the machine's clock says.
  backend_dependencies_.run.clock =
      HoldJumps(clock_, [this](const std::string& text) { log_.Message(text); });
}

Server::~Server() {
  metrics_.SetLoadReader({});
  if (backend_ != nullptr) {
    backend_->StopSweeping();
    backend_->jobs().StartDraining();
    backend_->jobs().StopAll();
  }
  StopTakingCallers();
  if (server_ != nullptr) server_->Shutdown(std::chrono::system_clock::now() + kShutdownGrace);
  gate_.reset();
  // In this order: the last tasks of calls, which the backend runs, use their services.
  server_.reset();
  backend_.reset();
}

void Server::StopTakingCallers() {
  self_check_.reset();
  if (gate_ != nullptr) gate_->Close();
}

absl::Status Server::OpenBackend() {
  CCST_ASSIGN_OR_RETURN(backend_, Backend::Open(options_, std::move(backend_dependencies_)));
  JobManager& jobs = backend_->jobs();
  const StreamSupport streams = {
      .calls = calls_, .executor = backend_->streams(), .open = streams_, .memory = stream_memory_};
  sampling_service_ =
      std::make_unique<SamplingService>(streams, JobSupport{.jobs = jobs,
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
                                                backend_->decoding(), streams, meshes);
  server_info_service_ = std::make_unique<ServerInfoService>(
      jobs, calls_,
      LimitsToProto(options_.request_limits, options_.MeshOptions(), meshes, jobs.options(),
                    options_.streams, options_.MaxDataBytes()));
  backend_->StartSweeping([this] { Tend(); });
  return absl::OkStatus();
}

void Server::Tend() {
  streams_.PulseAll();
  if (tend_log_) tend_log_();
  TellOfLostLines();
}

void Server::TellOfLostLines() {
  const std::int64_t lost = lost_log_lines;
  if (lost == told_lost_lines_) return;
  log_.Message("lost " + std::to_string(lost - told_lost_lines_) +
               " lines of the log, which nobody read");
  // Told again, with more, where this line was lost too.
  if (lost_log_lines == lost) told_lost_lines_ = lost;
}

absl::Status Server::Listen() {
  // Puts health's descriptor into the pool; reflection cannot list the services without it.
  grpc::health::v1::HealthCheckRequest::descriptor();
  grpc::EnableDefaultHealthCheckService(true);
  grpc::reflection::InitProtoReflectionServerBuilderPlugin();
  CCST_RETURN_IF_ERROR(options_.security.CheckFiles());
  CCST_RETURN_IF_ERROR(UseTokens());
  CCST_RETURN_IF_ERROR(OpenBackend());
  CCST_RETURN_IF_ERROR(OpenGate());
  grpc::ServerBuilder builder;
  if (!IsLoopback(options_.listen) && !options_.security.reflection) {
    builder.SetOption(std::make_unique<WithoutReflection>());
  }
  // TLS, where there is any, has ended at the gate.
  acceptor_ = builder.experimental().AddExternalConnectionAcceptor(
      grpc::ServerBuilder::experimental_type::ExternalConnectionType::FROM_FD,
      grpc::InsecureServerCredentials());
  builder.RegisterService(sampling_service_.get());
  builder.RegisterService(mesh_service_.get());
  builder.RegisterService(server_info_service_.get());
  SetLimits(options_, builder);
  server_ = builder.BuildAndStart();
  if (server_ == nullptr) return absl::UnavailableError("gRPC does not start");
  address_ = gate_->address();
  CCST_RETURN_IF_ERROR(ServeMetrics());
  SetServing(true);
  gate_->Accept();
  if (on_unreachable_) {
    self_check_ = std::make_unique<SelfCheck>(
        SelfCheck::Options{}, [this](double seconds) { return ReachOneself(*gate_, seconds); },
        [this](const std::string& reason) {
          log_.Message(
              absl::StrCat("cannot be reached through its own port, so it ends: ", reason));
          on_unreachable_();
        });
  }
  log_.Message("listening on " + address_);
  return absl::OkStatus();
}

absl::Status Server::UseTokens() {
  const SecurityOptions& security = options_.security;
  if (security.auth_token_file.empty()) return absl::OkStatus();
  return authenticator_.UseTokens(security.auth_token_file,
                                  [this](const std::string& message) { log_.Message(message); });
}

absl::Status Server::OpenGate() {
  const std::int64_t descriptors = DescriptorLimit();
  const GateOptions gate = options_.ConnectionOptions(descriptors);
  if (gate.max_connections < options_.max_connections) {
    log_.Message(absl::StrCat("at most ", gate.max_connections, " connections instead of ",
                              options_.max_connections, ": the process may open ", descriptors,
                              " descriptors"));
  }
  CCST_ASSIGN_OR_RETURN(
      gate_,
      ConnectionGate::Open(
          gate,
          {.peers = peers_,
           .hand_over =
               [this](int socket) {
                 grpc::experimental::ExternalConnectionAcceptor::NewConnectionParameters connection;
                 connection.fd = socket;
                 acceptor_->HandleNewConnection(&connection);
                 return true;
               },
           .count = [this](std::string_view why) { metrics_.CountRefusedConnection(why); },
           .report = [this](const std::string& line) { log_.Message(line); }}));
  return absl::OkStatus();
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
                      .connections = gate_->open(),
                      .connections_limit = gate_->max_connections(),
                      .data_bytes = backend_->store().blobs().used_bytes(),
                      .data_limit_bytes = options_.max_data_bytes,
                      .record_bytes = backend_->store().AllRecordBytes().value_or(-1),
                      .record_limit_bytes = options_.records.max_bytes,
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
  StopTakingCallers();
  server_->Shutdown(std::chrono::system_clock::now() + kShutdownGrace);
  gate_->WaitUntilQuiet(kFarewellSeconds);
  backend_->StopSweeping();
  Tend();
  log_.Message("drained");
}

}  // namespace ccst::server
