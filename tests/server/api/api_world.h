#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/base/sha256.h"
#include "core/io/draco_mesh.h"
#include "tests/server/test_server.h"
#include "tests/support/shapes.h"

namespace ccst::server {

/// No job has this name.
inline constexpr char kNoJob[] = "jobs/00000000-0000-4000-8000-000000000000";
/// Jobs of this seed run until they are cancelled.
inline constexpr std::uint64_t kEndlessSeed = 7;

/// A server with a stored mesh, a job that has ended, one that runs and one that was cancelled,
/// asked through a channel within the process or over a connection of loopback.
struct World {
  explicit World(bool in_process)
      : server(
            [this](const TriangleMesh& input, const SamplingOptions& options,
                   const RunControl& run) -> absl::StatusOr<SamplingResult> {
              if (options.seed != kEndlessSeed) return QuickSampler()(input, options, run);
              return GatedSampler(started, never)(input, options, run);
            },
            Options()) {
    const auto channel = in_process ? server->InProcessChannel() : server.NewChannel();
    meshes = v1::MeshService::NewStub(channel);
    sampling = v1::SamplingService::NewStub(channel);
    info = v1::ServerInfoService::NewStub(channel);
    v1::CreateMeshResponse stored;
    const grpc::Status status = Call(*meshes, &v1::MeshService::Stub::CreateMesh, Create(), stored);
    if (!status.ok()) throw std::runtime_error(status.error_message());
    mesh = stored.mesh().name();
    cancelled = CreateJob(kEndlessSeed);
    Cancel(cancelled);
    ended = CreateJob(1);
    WaitFor(cancelled);
    WaitFor(ended);
    running = CreateJob(kEndlessSeed);
  }

  static ServerOptions Options() {
    ServerOptions options;
    options.runner.max_running_jobs = 2;
    options.request_limits.max_sample_count = 1000;
    return options;
  }

  template <typename Stub, typename Method, typename Request, typename Response>
  static grpc::Status Call(Stub& stub, Method method, const Request& request, Response& response) {
    grpc::ClientContext context;
    return (stub.*method)(&context, request, &response);
  }

  // Reads to the end.
  template <typename Response, typename Stub, typename Method, typename Request>
  static grpc::Status Stream(Stub& stub, Method method, const Request& request,
                             std::vector<Response>* messages = nullptr) {
    grpc::ClientContext context;
    const auto reader = (stub.*method)(&context, request);
    for (Response message; reader->Read(&message);) {
      if (messages != nullptr) messages->push_back(message);
    }
    return reader->Finish();
  }

  v1::MeshUploadHeader Header(const std::string& data) const {
    v1::MeshUploadHeader header;
    header.mutable_digest()->set_sha256(Sha256Of(data));
    header.mutable_digest()->set_size_bytes(static_cast<std::int64_t>(data.size()));
    header.set_format(v1::MESH_FORMAT_DRACO);
    return header;
  }
  v1::CreateMeshRequest Create() const {
    v1::CreateMeshRequest request;
    *request.mutable_header() = Header(bytes);
    request.set_data(bytes);
    return request;
  }
  grpc::Status Upload(const v1::MeshUploadHeader* header, const std::string& data,
                      std::int64_t offset, v1::UploadMeshResponse& response) const {
    grpc::ClientContext context;
    const auto writer = meshes->UploadMesh(&context, &response);
    v1::UploadMeshRequest message;
    if (header != nullptr) {
      *message.mutable_header() = *header;
      writer->Write(message);
    }
    message.mutable_chunk()->set_offset_bytes(offset);
    message.mutable_chunk()->set_data(data);
    writer->Write(message);
    writer->WritesDone();
    return writer->Finish();
  }

  v1::CreateJobRequest JobOf(std::uint64_t seed) const {
    v1::CreateJobRequest request;
    request.mutable_spec()->set_mesh(mesh);
    request.mutable_spec()->mutable_options()->set_sample_count(10);
    request.mutable_spec()->mutable_options()->set_seed(seed);
    request.set_skip_cache_lookup(true);
    return request;
  }
  std::string CreateJob(std::uint64_t seed) const {
    v1::CreateJobResponse response;
    Call(*sampling, &v1::SamplingService::Stub::CreateJob, JobOf(seed), response);
    return response.job().name();
  }
  void Cancel(const std::string& name) const {
    v1::CancelJobRequest request;
    request.set_name(name);
    v1::CancelJobResponse response;
    Call(*sampling, &v1::SamplingService::Stub::CancelJob, request, response);
  }
  void WaitFor(const std::string& name) const {
    v1::WatchJobRequest request;
    request.set_name(name);
    Stream<v1::WatchJobResponse>(*sampling, &v1::SamplingService::Stub::WatchJob, request);
  }

  const std::string bytes = *EncodeDraco(shapes::Cube());
  Gate started;
  Gate never;
  TestServer server;
  std::unique_ptr<v1::MeshService::Stub> meshes;
  std::unique_ptr<v1::SamplingService::Stub> sampling;
  std::unique_ptr<v1::ServerInfoService::Stub> info;
  std::string mesh;
  std::string ended;
  std::string running;
  std::string cancelled;
};

/// Calls a method of one request and one answer about something by its name; `check` looks at the
/// answer.
template <typename Stub, typename Request, typename Response>
std::function<grpc::Status(World&)> Named(
    std::unique_ptr<Stub> World::*stub,
    grpc::Status (Stub::*method)(grpc::ClientContext*, const Request&, Response*),
    const std::function<std::string(World&)>& name,
    const std::function<void(World&, const Response&)>& check = {}) {
  return [=](World& world) {
    Request request;
    request.set_name(name(world));
    Response response;
    const grpc::Status status = World::Call(*(world.*stub), method, request, response);
    if (check) check(world, response);
    return status;
  };
}

/// The same of one that streams its answer.
template <typename Response, typename Stub, typename Request>
std::function<grpc::Status(World&)> NamedStream(
    std::unique_ptr<Stub> World::*stub,
    std::unique_ptr<grpc::ClientReader<Response>> (Stub::*method)(grpc::ClientContext*,
                                                                  const Request&),
    const std::function<std::string(World&)>& name,
    const std::function<void(World&, const std::vector<Response>&)>& check = {}) {
  return [=](World& world) {
    Request request;
    request.set_name(name(world));
    std::vector<Response> messages;
    const grpc::Status status = World::Stream(*(world.*stub), method, request, &messages);
    if (check) check(world, messages);
    return status;
  };
}

inline std::string Mesh(World& world) { return world.mesh; }
inline std::string EndedJob(World& world) { return world.ended; }
inline std::string RunningJob(World& world) { return world.running; }
inline std::string CancelledJob(World& world) { return world.cancelled; }
inline std::string NoJob(World& /*world*/) { return kNoJob; }
inline std::string NoMesh(World& /*world*/) { return "meshes/" + std::string(64, '0'); }
inline std::string NoName(World& /*world*/) { return "what"; }

}  // namespace ccst::server
