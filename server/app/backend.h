#pragma once

#include <memory>
#include <string>
#include <thread>

#include "absl/status/statusor.h"
#include "server/app/server_options.h"
#include "server/base/executor.h"
#include "server/jobs/job_analyst.h"
#include "server/jobs/job_manager.h"
#include "server/meshes/mesh_store.h"
#include "server/store/store.h"

namespace ccst::server {

/// What the services work on: the store, meshes and jobs in it, and the threads for what blocks.
class Backend {
 public:
  /// What tests replace.
  struct Dependencies {
    RunDependencies run;
    std::function<std::string()> new_id;
    JobObserver* observer = nullptr;                 ///< Not owned.
    std::function<void(const std::string&)> report;  ///< What an operator should know.
  };

  /// Opens the store in `options.data_dir` and takes up the jobs in it.
  /// @errors those of OpenEmbeddedStore() and JobManager::Start()
  static absl::StatusOr<std::unique_ptr<Backend>> Open(const ServerOptions& options,
                                                       Dependencies dependencies);
  /// Stops everything; no call may be under way any more, except on the executors.
  ~Backend();
  Backend(const Backend&) = delete;
  Backend& operator=(const Backend&) = delete;

  JobManager& jobs() { return *jobs_; }
  JobAnalyst& analyst() { return *analyst_; }
  MeshStore& meshes() { return *meshes_; }
  Store& store() { return *store_; }
  /// Where the store is, once it is open.
  const std::string& data_dir() const { return data_dir_; }
  BlobPins& pins() { return *pins_; }
  Executor& disk() { return disk_; }
  Executor& streams() { return streams_; }
  Executor& decoding() { return decoding_; }
  Executor& analyses() { return analyses_; }

  /// Calls `every_tick` every few seconds from now on, and drops what has expired now and then.
  void StartSweeping(std::function<void()> every_tick);
  void StopSweeping();

 private:
  Backend();

  std::function<void(const std::string&)> report_;
  std::string data_dir_;
  std::unique_ptr<Store> store_;
  std::unique_ptr<BlobPins> pins_;
  std::unique_ptr<MeshStore> meshes_;
  std::unique_ptr<JobManager> jobs_;
  std::unique_ptr<JobAnalyst> analyst_;
  // What they run uses all of the above.
  Executor decoding_;
  Executor analyses_;  // Of its own, so that who measures does not hold up who uploads.
  Executor disk_;
  Executor streams_;  // Of its own, so that many watchers do not delay calls.
  std::jthread sweeper_;
};

}  // namespace ccst::server
