#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "server/base/executor.h"
#include "server/jobs/job_analyst.h"
#include "server/jobs/job_manager.h"
#include "server/meshes/mesh_store.h"
#include "server/rpc/job_intake.h"
#include "server/store/store.h"
#include "tests/interleavings/schedule.h"
#include "tests/interleavings/service.h"
#include "tests/server/watched_store.h"

namespace ccst::interleavings {

/// The rooms of the server below its calls, over a store of any engine, in this process: the job
/// manager, the mesh store and the intake of jobs are the real ones; the sampler takes no time but
/// what the schedule holds it for, and gives samples that its request determines. Time passes when
/// the bench says so.
class LocalService : public Service {
 public:
  using OpenStore = std::function<absl::StatusOr<std::unique_ptr<server::Store>>()>;

  /// @param open  opens the store, anew after it was closed.
  static absl::StatusOr<std::unique_ptr<LocalService>> Start(OpenStore open, std::uint64_t seed);
  ~LocalService() override;

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

  absl::Time Now() const override { return absl::FromUnixSeconds(seconds_); }
  absl::Duration retention() const override;
  absl::Status Tend(absl::Duration passes) override;
  absl::Status WaitUntilIdle() override;
  absl::StatusOr<Holdings> Look() override;
  absl::Status Restart() override;

 private:
  LocalService(OpenStore open, std::uint64_t seed);
  absl::Status Open();
  void Close();
  server::RunDependencies Run();
  absl::StatusOr<SamplingResult> SampleMesh(const TriangleMesh& mesh,
                                            const SamplingOptions& options, const RunControl& run);
  absl::StatusOr<std::shared_ptr<server::Job>> Find(int owner, const std::string& name);
  absl::StatusOr<Watched> Watch(server::Job& job);
  absl::StatusOr<std::string> Read(const server::Job& job);

  const OpenStore open_;
  std::atomic<std::int64_t> seconds_ = 1'700'000'000;
  std::atomic<std::int64_t> next_id_ = 1;
  const std::uint64_t seed_;
  int openings_ = 0;

  // In this order: what goes first is used by what was made before it.
  std::unique_ptr<Schedule> schedule_;
  std::unique_ptr<server::WatchedStore> store_;
  std::unique_ptr<server::BlobPins> pins_;
  std::unique_ptr<server::MeshStore> meshes_;
  std::unique_ptr<server::JobManager> jobs_;
  std::unique_ptr<server::JobAnalyst> analyst_;
  std::unique_ptr<server::Executor> unused_;
  std::unique_ptr<server::JobSupport> support_;
};

}  // namespace ccst::interleavings
