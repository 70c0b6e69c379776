#pragma once

#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "server/jobs/job.h"
#include "server/base/mutex.h"
#include "server/jobs/run_job.h"

namespace ccst::server {

/// How much is computed and kept at once.
struct RunnerOptions {
  int max_running_jobs = 1;                               ///< >= 1; as many worker threads.
  int max_queued_jobs = 64;                               ///< >= 0.
  std::int64_t max_queued_bytes = std::int64_t{1} << 30;  ///< Encoded meshes that may wait.
};

/// A look at the queue.
struct RunnerLoad {
  int queued = 0;
  int running = 0;
};

/// Runs jobs on its own threads, first come first served, at most `max_running_jobs` at once.
///
/// A job is held from Submit() to Release(), and a job whose watcher has not yet read its result
/// keeps its place in the count, so that slow readers cannot pile results up. Thread-safe.
class JobRunner {
 public:
  JobRunner(const RunnerOptions& options, RunDependencies dependencies,
            std::function<std::string()> new_id);
  /// Stops and joins what still runs.
  ~JobRunner();
  JobRunner(const JobRunner&) = delete;
  JobRunner& operator=(const JobRunner&) = delete;

  /// Takes a job. RESOURCE_EXHAUSTED QUEUE_FULL | UNAVAILABLE DRAINING.
  absl::StatusOr<std::shared_ptr<Job>> Submit(JobSpec spec);

  /// Asks a job to stop; one that waits ends at once and frees its place.
  void Cancel(Job& job, StopCause cause);

  /// The watcher is done with a job that was submitted; once a job. Stops it where it still runs.
  void Release(Job& job);

  /// From now on Submit() refuses with DRAINING; jobs taken go on.
  void StartDraining();
  bool draining() const;

  /// Waits until every job is released and no worker computes; false when `timeout` passed before.
  bool WaitUntilIdle(absl::Duration timeout);

  /// Asks all jobs to stop, for the reason that draining cannot wait longer.
  void StopAll();

  RunnerLoad Load() const;

 private:
  void Work();
  // The next job, RUNNING; null when the runner goes away.
  std::shared_ptr<Job> Next();
  void RemoveFromQueue(const Job& job) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void UpdatePositions() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  const RunnerOptions options_;
  const RunDependencies dependencies_;
  const std::function<std::string()> new_id_;

  // Taken before any lock of a job or its watcher.
  mutable Mutex mutex_;
  CondVar changed_;
  std::list<std::shared_ptr<Job>> held_ ABSL_GUARDED_BY(mutex_);   // Submitted, not released.
  std::list<std::shared_ptr<Job>> queue_ ABSL_GUARDED_BY(mutex_);  // Waiting, in order.
  std::int64_t queued_bytes_ ABSL_GUARDED_BY(mutex_) = 0;
  int running_ ABSL_GUARDED_BY(mutex_) = 0;
  bool draining_ ABSL_GUARDED_BY(mutex_) = false;
  bool closed_ ABSL_GUARDED_BY(mutex_) = false;

  std::vector<std::jthread> workers_;
};

}  // namespace ccst::server
