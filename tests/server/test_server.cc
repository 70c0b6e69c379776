#include "tests/server/test_server.h"

#include <stdexcept>
#include <utility>

#include <grpcpp/create_channel.h>
#include <grpcpp/security/credentials.h>

#include "server/app/system.h"

namespace ccst::server {

RunDependencies RunWith(SampleFunction sample) {
  RunDependencies run = FakeDependencies(std::move(sample));
  run.clock = SystemClock();
  return run;
}

TestServer::TestServer(SampleFunction sample, ServerOptions options)
    : TestServer(RunWith(std::move(sample)), std::move(options)) {}

TestServer::TestServer(RunDependencies run, ServerOptions options) {
  if (options.listen == ServerOptions().listen) options.listen = "127.0.0.1:0";
  if (options.data_dir.empty()) options.data_dir = folder_.Path("data");
  auto server = Server::Start(
      options,
      {.run = std::move(run), .new_id = NewUuid, .write_log = [this](const std::string& line) {
         const std::lock_guard lock(mutex_);
         log_.push_back(line);
       }});
  if (!server.ok()) throw std::runtime_error(server.status().ToString());
  server_ = *std::move(server);
  channel_ = NewChannel();
  sampling_ = v1::SamplingService::NewStub(channel_);
  meshes_ = v1::MeshService::NewStub(channel_);
  info_ = v1::ServerInfoService::NewStub(channel_);
}

std::shared_ptr<grpc::Channel> TestServer::NewChannel() const {
  grpc::ChannelArguments arguments;
  // A connection of its own, so that no test leans on another's.
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  return grpc::CreateCustomChannel(server_->address(), grpc::InsecureChannelCredentials(),
                                   arguments);
}

std::vector<std::string> TestServer::LogLines() {
  const std::lock_guard lock(mutex_);
  return log_;
}

v1::SampleRequest Request(std::int64_t count) {
  v1::SampleRequest request;
  request.mutable_inline_mesh()->set_format(v1::MESH_FORMAT_DRACO);
  request.mutable_inline_mesh()->set_data("mesh");
  request.mutable_options()->set_sample_count(count);
  request.set_skip_cache_lookup(true);
  return request;
}

v1::Status Answer::details() const {
  v1::Status message;
  message.ParseFromString(status.error_details());
  return message;
}

std::string Answer::reason() const {
  v1::ErrorInfo info;
  Unpack(details(), info);
  return info.reason();
}

Answer ReadAll(grpc::ClientReader<v1::SampleResponse>& reader) {
  Answer answer;
  v1::SampleResponse event;
  while (reader.Read(&event)) answer.events.push_back(std::move(event));
  answer.status = reader.Finish();
  return answer;
}

Answer Sample(v1::SamplingService::Stub& stub, const v1::SampleRequest& request) {
  grpc::ClientContext context;
  return ReadAll(*stub.Sample(&context, request));
}

}  // namespace ccst::server
