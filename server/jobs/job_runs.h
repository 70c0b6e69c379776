#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "server/base/executor.h"
#include "server/base/mutex.h"
#include "server/jobs/job.h"
#include "server/jobs/job_manager_options.h"
#include "server/jobs/job_runner.h"
#include "server/jobs/live_jobs.h"
#include "server/jobs/memory_budget.h"
#include "server/meshes/blob_pins.h"
#include "server/store/store.h"

namespace ccst::server {

/// Computes jobs and stores how they end. A job is not FAILED because the store fails: one whose
/// mesh cannot be read or whose result cannot be written just now is QUEUED again, and runs anew
/// when its time has come and the store takes something; only a job that ends with its caller fails
/// then. One that ran when an earlier process died is suspected of that: it runs alone.
/// Thread-safe.
class JobRuns {
 public:
  /// All but `options` outlive it.
  JobRuns(Store& store, BlobPins& pins, const JobManagerOptions& options,
          const JobManagerDependencies& dependencies, LiveJobs& live,
          std::shared_ptr<MemoryBudget> budget);
  JobRuns(const JobRuns&) = delete;
  JobRuns& operator=(const JobRuns&) = delete;

  JobRunner& runner() { return *runner_; }
  const JobRunner& runner() const { return *runner_; }

  /// The memory a job may need, from what its mesh, `held` or stored, and image announce. Errors as
  /// CountInput().
  absl::StatusOr<std::int64_t> MemoryOf(
      const JobSpec& spec, const std::shared_ptr<const HeldInput>& held = nullptr) const;

  /// Takes a job that an earlier process left, and that ran `starts` times when one died.
  /// @errors those of CountInput(), where the job can never run
  absl::Status TakeUp(const std::shared_ptr<Job>& job, int starts);

  /// Ends a job that cannot run, for the reason `error`.
  void EndUnrun(const std::shared_ptr<Job>& job, const absl::Status& error);

  /// Writes down how `job` ended where it has, which is nothing to do when that is stored. Errors
  /// as Store.
  absl::Status StoreEnd(const std::shared_ptr<Job>& job);
  /// StoreEnd() of all jobs, for those that the disk did not take before. The first error.
  absl::Status StoreEnds();

  /// Lets those jobs run again whose time has come, as far as the store takes something; called
  /// every second or so.
  void Resume();

  /// From now on no new jobs; what runs may end, and does not count as having been running should
  /// the process be killed.
  void StartDraining();

  /// Waits until nothing waits for a worker, runs or is being stored; false when `timeout` passed
  /// before. Jobs that wait for the store are not waited for.
  bool WaitUntilIdle(absl::Duration timeout);

 private:
  struct Held {
    std::shared_ptr<Job> job;
    double ready_seconds = 0.0;
  };

  void Run(const std::shared_ptr<Job>& job, std::shared_ptr<void> grant);
  // Whether the store has room for what comes out; counts the start.
  absl::Status Begin(const Job& job);
  void Finish(const std::shared_ptr<Job>& job, absl::StatusOr<JobResult> outcome);
  absl::Status StoreEndAs(const std::shared_ptr<Job>& job, const JobView& end);
  absl::Status StoreResult(const std::shared_ptr<Job>& job, const SampleSet& samples, JobView& end);
  absl::Status StoreHeldInput(const Job& job);
  absl::StatusOr<std::string> StoreSamples(const SampleSet& samples,
                                           std::optional<BlobPins::Pin>& pin);
  // The store failed `job`: it waits to run again, unless it was asked to stop, or ends with its
  // caller; then it ends.
  void FinishUnlessPutOff(const std::shared_ptr<Job>& job, const absl::Status& why);
  void HoldBack(const std::shared_ptr<Job>& job, double seconds);
  bool StoreTakes(const JobSpec& spec) const;
  void GiveBackStart(const std::string& id);
  void Report(const std::string& text) const;

  Store& store_;
  BlobPins& pins_;
  const JobManagerOptions options_;
  const JobManagerDependencies& dependencies_;
  LiveJobs& live_;
  const std::shared_ptr<MemoryBudget> budget_;

  mutable Mutex mutex_;
  CondVar changed_;
  int storing_ ABSL_GUARDED_BY(mutex_) = 0;
  // Jobs whose starts are counted in the store and not given back.
  std::set<std::string> started_ ABSL_GUARDED_BY(mutex_);
  std::set<std::string> suspects_ ABSL_GUARDED_BY(mutex_);
  // Jobs that the runner holds back, with the time to ask the store again.
  std::map<std::string, Held> held_ ABSL_GUARDED_BY(mutex_);

  // In this order: what goes first is used by what was made before it.
  Executor decoders_;
  Executor storers_;
  std::unique_ptr<JobRunner> runner_;
};

}  // namespace ccst::server
