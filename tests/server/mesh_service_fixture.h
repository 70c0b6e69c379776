#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>
#include <grpcpp/server.h>
#include <gtest/gtest.h>

#include "ccst/v1/error.pb.h"
#include "ccst/v1/mesh_service.grpc.pb.h"
#include "server/rpc/mesh_messages.h"
#include "server/rpc/mesh_service.h"
#include "tests/server/store/store_fixture.h"

namespace ccst::server {

/// An answer to a call that is not streamed back.
template <typename Response>
struct Reply {
  grpc::Status status;
  Response response;
};

/// A real server on loopback with this service alone, over an embedded store. Callers are `ann`,
/// `bob` and `eve`, who may only read; `ann-reads` is ann with a token that may only read.
class MeshServiceTest : public StoreTest {
 protected:
  MeshServiceTest();
  ~MeshServiceTest() override;

  // Set before the first call, which starts the server.
  MeshStoreOptions store_options_;
  MeshServiceOptions options_;
  StreamLimits stream_limits_;
  std::size_t max_waiting_ = 64;
  /// Whatever the bytes are, they decode to a cube.
  void AcceptAnyBytes();

  v1::MeshService::Stub& stub();
  MeshStore& meshes() { return *meshes_; }

  /// A context of a caller's.
  std::unique_ptr<grpc::ClientContext> As(const std::string& caller) const;

  /// Uploads in chunks of `chunk_bytes`; `header` or else what `bytes` are.
  Reply<v1::UploadMeshResponse> Upload(const std::string& bytes, const std::string& caller = "ann",
                                       std::size_t chunk_bytes = 1000);
  /// Sends these messages and no more, but does not say so unless `close`.
  Reply<v1::UploadMeshResponse> Send(const std::vector<v1::UploadMeshRequest>& messages,
                                     bool close = true);
  Reply<v1::CreateMeshResponse> Create(const v1::CreateMeshRequest& request,
                                       const std::string& caller = "ann");
  Reply<v1::GetMeshResponse> Get(const std::string& name, const std::string& caller = "ann");

  /// Waits until `count` calls are over, with all that they leave behind.
  void WaitForCalls(std::size_t count);
  std::vector<std::string> LogLines();
  /// Files that hold bytes of meshes, whole ones or parts.
  std::size_t FileCount() const;

  absl::Time now_ = At(0);

 private:
  void StartServer();
  void WriteLog(const std::string& line);

  const Clock clock_;
  MeshDependencies dependencies_;
  Authenticator authenticator_;
  Peers peers_;
  std::mutex mutex_;
  std::condition_variable logged_;
  std::vector<std::string> log_lines_;
  ServerLog log_;
  Metrics metrics_;
  BlobPins pins_;
  std::optional<MeshStore> meshes_;
  std::optional<CallSupport> calls_;
  OpenStreams streams_;
  std::optional<StreamMemory> stream_memory_;
  std::optional<Executor> disk_;
  std::optional<Executor> decoding_;
  std::optional<MeshService> service_;
  std::unique_ptr<grpc::Server> server_;
  std::unique_ptr<v1::MeshService::Stub> stub_;
};

/// A mesh as a Draco stream of some 10 kB.
std::string SphereBytes();

v1::MeshUploadHeader HeaderOf(const std::string& bytes);
v1::UploadMeshRequest HeaderMessage(const std::string& bytes);
v1::UploadMeshRequest ChunkMessage(std::int64_t offset, const std::string& data);

/// The reason inside an error.
std::string ReasonOf(const grpc::Status& status);

/// Reads the detail of T's type; empty when there is none.
template <typename T>
std::optional<T> DetailOf(const grpc::Status& status) {
  v1::Status message;
  message.ParseFromString(status.error_details());
  T detail;
  for (const auto& any : message.details()) {
    if (any.UnpackTo(&detail)) return detail;
  }
  return std::nullopt;
}

void ExpectStatus(const grpc::Status& status, grpc::StatusCode code, const std::string& reason);

/// The fields that an error says are wrong.
std::vector<std::string> WrongFields(const grpc::Status& status);

}  // namespace ccst::server
