#pragma once

#include <memory>
#include <string>
#include <vector>

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>

#include "ccst/v1/mesh_service.grpc.pb.h"
#include "ccst/v1/sampling_service.grpc.pb.h"
#include "tests/interleavings/server_process.h"
#include "tests/interleavings/service.h"

namespace ccst::interleavings {

/// A real `ccst-server` at the other end of connections, with a token for each owner.
class RemoteService : public Service {
 public:
  /// @param program  path of `ccst-server`
  /// @param folder   an empty one of its own, for tokens and data
  /// @param flags    further flags of the server
  static absl::StatusOr<std::unique_ptr<RemoteService>> Start(std::string program,
                                                              std::string folder, int owners,
                                                              std::vector<std::string> flags);

  absl::StatusOr<v1::Job> CreateJob(int owner, const v1::CreateJobRequest& request) override;
  absl::StatusOr<Sampled> Sample(int owner, const v1::SampleRequest& request, bool leave) override;
  absl::StatusOr<v1::Job> GetJob(int owner, const std::string& name) override;
  absl::StatusOr<std::vector<v1::Job>> ListJobs(int owner) override;
  absl::StatusOr<Watched> WatchJob(int owner, const std::string& name) override;
  absl::StatusOr<v1::Job> CancelJob(int owner, const std::string& name) override;
  absl::Status DeleteJob(int owner, const std::string& name) override;
  absl::StatusOr<std::string> ReadSamples(int owner, const std::string& name) override;
  absl::Status UploadMesh(int owner, const std::string& bytes) override;
  absl::StatusOr<std::string> DownloadMesh(int owner, const std::string& name) override;
  absl::Status DeleteMesh(int owner, const std::string& name) override;
  absl::StatusOr<std::vector<std::string>> ListMeshes(int owner) override;

  absl::Time Now() const override;
  absl::Duration retention() const override;
  absl::Status Tend(absl::Duration /*passes*/) override { return absl::OkStatus(); }
  absl::Status WaitUntilIdle() override;
  absl::StatusOr<Holdings> Look() override;
  absl::Status Restart() override;

 private:
  // What one owner calls through.
  struct Caller {
    std::string token;
    std::unique_ptr<v1::SamplingService::Stub> jobs;
    std::unique_ptr<v1::MeshService::Stub> meshes;
  };

  RemoteService(std::string program, std::string folder, std::vector<std::string> flags)
      : program_(std::move(program)), folder_(std::move(folder)), flags_(std::move(flags)) {}
  absl::Status Open();
  std::unique_ptr<grpc::ClientContext> Context(int owner) const;
  v1::SamplingService::Stub& jobs(int owner) { return *callers_[Index(owner)].jobs; }
  v1::MeshService::Stub& meshes(int owner) { return *callers_[Index(owner)].meshes; }
  static std::size_t Index(int owner) { return static_cast<std::size_t>(owner); }

  const std::string program_;
  const std::string folder_;
  const std::vector<std::string> flags_;
  std::unique_ptr<ServerProcess> server_;
  std::vector<Caller> callers_;
};

}  // namespace ccst::interleavings
