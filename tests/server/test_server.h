#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <grpcpp/channel.h>

#include "ccst/v1/error.pb.h"
#include "ccst/v1/mesh_service.grpc.pb.h"
#include "ccst/v1/sampling_service.grpc.pb.h"
#include "ccst/v1/server_info_service.grpc.pb.h"
#include "server/app/server.h"
#include "tests/server/fakes.h"
#include "tests/server/temp_folder.h"

namespace ccst::server {

/// A real server with unencrypted stubs, on a free port of the loopback interface unless the
/// options name another address.
class TestServer {
 public:
  /// The real clock and log; `sample` samples, and bytes decode to an empty mesh.
  explicit TestServer(SampleFunction sample, ServerOptions options = {});
  /// Everything given.
  TestServer(RunDependencies run, ServerOptions options);

  Server& operator*() { return *server_; }
  Server* operator->() { return server_.get(); }

  std::shared_ptr<grpc::Channel> NewChannel() const;
  v1::SamplingService::Stub& sampling() { return *sampling_; }
  v1::ServerInfoService::Stub& info() { return *info_; }
  v1::MeshService::Stub& meshes() { return *meshes_; }
  const std::shared_ptr<grpc::Channel>& channel() const { return channel_; }

  std::vector<std::string> LogLines();

 private:
  TempFolder folder_;
  std::mutex mutex_;
  std::vector<std::string> log_;
  std::unique_ptr<Server> server_;
  std::shared_ptr<grpc::Channel> channel_;
  std::unique_ptr<v1::SamplingService::Stub> sampling_;
  std::unique_ptr<v1::ServerInfoService::Stub> info_;
  std::unique_ptr<v1::MeshService::Stub> meshes_;
};

/// The real clock with fakes otherwise.
RunDependencies RunWith(SampleFunction sample);

/// A right request for `count` samples, never answered from the cache.
v1::SampleRequest Request(std::int64_t count = 10);

/// The whole answer to a call.
struct Answer {
  std::vector<v1::SampleResponse> events;
  grpc::Status status;

  v1::Status details() const;
  std::string reason() const;
};

Answer ReadAll(grpc::ClientReader<v1::SampleResponse>& reader);
Answer Sample(v1::SamplingService::Stub& stub, const v1::SampleRequest& request);

/// Reads the detail of T's type into `detail`; false when there is none.
template <typename T>
bool Unpack(const v1::Status& status, T& detail) {
  for (const auto& any : status.details()) {
    if (any.UnpackTo(&detail)) return true;
  }
  return false;
}

}  // namespace ccst::server
