#include "server/app/backend.h"

#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <mutex>
#include <utility>

#include "core/base/limit_error.h"
#include "core/base/status.h"
#include "server/base/without_throwing.h"
#include "server/jobs/memory_estimate.h"
#include "server/rpc/mesh_messages.h"

namespace ccst::server {
namespace {

// Enough that one slow write does not hold up who only reads.
constexpr int kDiskThreads = 4;
constexpr int kDecodingThreads = 2;
constexpr int kAnalysisThreads = 2;
constexpr std::size_t kMaxWaitingCalls = 10'000;
constexpr std::size_t kMaxWaitingHeavy = 64;
constexpr std::chrono::seconds kTick(1);
constexpr int kTicksPerSweep = 5;
// Of an upload that is whole, or of samples to be measured; the caller waits as long.
constexpr absl::Duration kLongestWaitForMemory = absl::Seconds(30);
// Servers without a directory of their own on one machine.
constexpr int kMaxDefaultDirectories = 64;

// $XDG_STATE_HOME/ccst, by default in the home directory.
std::string StateDirectory() {
  if (const char* state = std::getenv("XDG_STATE_HOME"); state != nullptr && *state != '\0') {
    return std::string(state) + "/ccst";
  }
  const char* home = std::getenv("HOME");
  return std::string(home != nullptr ? home : "") + "/.local/state/ccst";
}

// Memory for a mesh that is uploaded, from the same budget as that of jobs.
auto MemoryForMeshes(std::shared_ptr<MemoryBudget> budget, decltype(RunDependencies::count) count,
                     const MeshLimits& limits) {
  return [budget = std::move(budget), count = std::move(count),
          limits](const ByteSource& bytes) -> absl::StatusOr<std::shared_ptr<void>> {
    MeshCounts counts;
    CCST_ASSIGN_OR_RETURN(counts, count(bytes, limits));
    const std::int64_t wanted = EstimateUpload(counts);
    if (wanted > budget->limit_bytes()) {
      return OverLimit({"max_job_memory_bytes", budget->limit_bytes(), wanted},
                       "the mesh may need " + std::to_string(wanted) +
                           " bytes of memory, over max_job_memory_bytes, " +
                           std::to_string(budget->limit_bytes()));
    }
    auto grant = budget->TakeWithin(kLongestWaitForMemory, wanted);
    if (grant != nullptr) return grant;
    return MakeError(absl::StatusCode::kResourceExhausted, ErrorReason::kQueueFull,
                     "jobs use the memory that the mesh needs, " + std::to_string(wanted) +
                         " bytes; upload again later");
  };
}

// The first directory of the user's that no other server has open, where `directory` is empty; says
// there which it is.
absl::StatusOr<std::unique_ptr<Store>> OpenStore(
    std::string& directory, std::int64_t max_bytes,
    const std::function<void(const std::string&)>& report) {
  if (!directory.empty()) return OpenEmbeddedStore(directory, max_bytes);
  absl::Status last;
  for (int i = 1; i <= kMaxDefaultDirectories; ++i) {
    const std::string name = i == 1 ? "server" : "server-" + std::to_string(i);
    const std::string candidate = StateDirectory() + "/" + name;
    auto store = OpenEmbeddedStore(candidate, max_bytes);
    if (store.ok() && i > 1) {
      report("another server has the default data directory; this one keeps its jobs in " + name +
             " beside it; set --data-dir to say where");
    }
    if (store.ok()) directory = candidate;
    if (store.ok() || !absl::IsFailedPrecondition(store.status())) return store;
    last = store.status();
  }
  return last;
}

}  // namespace

Backend::Backend()
    : decoding_(kDecodingThreads, kMaxWaitingHeavy),
      analyses_(kAnalysisThreads, kMaxWaitingHeavy),
      disk_(kDiskThreads, kMaxWaitingCalls),
      streams_(kDiskThreads, kMaxWaitingCalls) {}

absl::StatusOr<std::unique_ptr<Backend>> Backend::Open(const ServerOptions& options,
                                                       Dependencies dependencies) {
  std::unique_ptr<Backend> backend(new Backend);
  backend->report_ = dependencies.report;
  backend->data_dir_ = options.data_dir;
  CCST_ASSIGN_OR_RETURN(backend->store_,
                        OpenStore(backend->data_dir_, options.MaxDataBytes(), dependencies.report));
  backend->pins_ = std::make_unique<BlobPins>(*backend->store_);
  const JobManagerOptions jobs = options.JobOptions();
  const auto budget = std::make_shared<MemoryBudget>(jobs.memory_budget_bytes);
  MeshDependencies meshes = RealMeshDependencies(dependencies.run.clock);
  meshes.take_memory = MemoryForMeshes(budget, dependencies.run.count, options.mesh_limits);
  backend->meshes_ = std::make_unique<MeshStore>(*backend->store_, *backend->pins_,
                                                 options.MeshOptions(), std::move(meshes));
  RunDependencies run = std::move(dependencies.run);
  run.mesh_limits = options.mesh_limits;
  run.threads_per_job = options.threads_per_job;
  run.max_seconds = options.request_limits.max_job_seconds;
  CCST_ASSIGN_OR_RETURN(backend->jobs_, JobManager::Start(*backend->store_, *backend->pins_, jobs,
                                                          {.run = run,
                                                           .new_id = std::move(dependencies.new_id),
                                                           .observer = dependencies.observer,
                                                           .budget = budget,
                                                           .report = dependencies.report}));
  backend->analyst_ =
      std::make_unique<JobAnalyst>(*backend->jobs_, backend->store_->blobs(), budget,
                                   std::move(run), kAnalysisThreads, kLongestWaitForMemory);
  return backend;
}

Backend::~Backend() { StopSweeping(); }

void Backend::StartSweeping(std::function<void()> every_tick) {
  sweeper_ = std::jthread([this, every_tick = std::move(every_tick)](std::stop_token stop) {
    std::mutex mutex;
    std::condition_variable_any wake;
    std::unique_lock lock(mutex);
    int ticks = 0;
    while (!wake.wait_for(lock, stop, kTick, [&] { return stop.stop_requested(); })) {
      if (stop.stop_requested()) return;
      WithoutThrowing("resuming jobs", [this] {
        jobs_->Resume();
        return absl::OkStatus();
      }).IgnoreError();
      if (++ticks % kTicksPerSweep != 0) continue;
      every_tick();
      const absl::Status jobs = WithoutThrowing("sweeping", [this] { return jobs_->Sweep(); });
      const absl::Status meshes =
          WithoutThrowing("sweeping", [this] { return meshes_->DropExpired(); });
      for (const absl::Status& status : {jobs, meshes}) {
        if (!status.ok()) report_("sweeping failed: " + std::string(status.message()));
      }
    }
  });
}

void Backend::StopSweeping() {
  sweeper_.request_stop();
  if (sweeper_.joinable()) sweeper_.join();
}

}  // namespace ccst::server
