#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "server/base/executor.h"
#include "server/base/mutex.h"
#include "server/jobs/job.h"
#include "server/jobs/job_records.h"
#include "server/jobs/job_runner.h"
#include "server/jobs/memory_budget.h"
#include "server/jobs/run_job.h"
#include "server/jobs/stored_samples.h"
#include "server/meshes/blob_pins.h"
#include "server/store/store.h"

namespace ccst::server {

/// Bounds on jobs.
struct JobManagerOptions {
  RunnerOptions runner;
  int max_watchers_per_job = 1024;
  absl::Duration retention = absl::Hours(24);  ///< Of an ended job.
  std::int64_t memory_budget_bytes = std::int64_t{4} << 30;
};

/// What jobs are made of beside the store.
struct JobManagerDependencies {
  RunDependencies run;
  JobCodec codec;
  std::function<std::string()> new_id;
  JobObserver* observer = nullptr;  ///< Not owned.
  /// Shared with others that need memory; null: one of its own, with `memory_budget_bytes`.
  std::shared_ptr<MemoryBudget> budget = nullptr;
};

/// A job as it is listed.
struct JobSummary {
  std::string id;
  JobSpec spec;
  JobView view;
};

/// Accepts, runs, stores and finds jobs. What Create() returned is durable: a job that has not
/// ended is run again by the next Start() on the same store, and gives the same samples. Calls
/// block on the disk unless said otherwise. Thread-safe.
class JobManager {
 public:
  /// Takes up what an earlier process left. Errors as Store.
  static absl::StatusOr<std::unique_ptr<JobManager>> Start(Store& store, BlobPins& pins,
                                                           const JobManagerOptions& options,
                                                           JobManagerDependencies dependencies);
  ~JobManager();
  JobManager(const JobManager&) = delete;
  JobManager& operator=(const JobManager&) = delete;

  const JobManagerOptions& options() const { return options_; }

  /// Accepts a job, or returns the one accepted before for the same request_id. The caller holds
  /// pins on mesh and texture.
  /// @errors INVALID_ARGUMENT LIMIT_EXCEEDED it needs more memory than the budget | what the mesh
  ///         announces is over the limits | FAILED_PRECONDITION MESH_MISSING
  ///       | RESOURCE_EXHAUSTED QUEUE_FULL | QUOTA_EXCEEDED | UNAVAILABLE DRAINING
  ///       | those of Store
  absl::StatusOr<std::shared_ptr<Job>> Create(JobSpec spec);

  /// What Create() would refuse of the spec itself.
  absl::Status Check(const JobSpec& spec) const;

  /// NOT_FOUND when it is unknown, dropped or another owner's.
  absl::StatusOr<std::shared_ptr<Job>> Find(const std::string& owner, const std::string& id);

  /// INVALID_ARGUMENT REQUEST_INVALID for a token that is not one.
  absl::StatusOr<Page<JobSummary>> List(const JobFilter& filter, int page_size,
                                        const std::string& page_token);

  /// Asks a job to stop, durably; nothing happens to one that has ended.
  absl::Status Cancel(const std::shared_ptr<Job>& job, StopCause cause);

  /// Asks a job to stop; does not block, and does not survive a crash without Cancel().
  void Stop(Job& job, StopCause cause);

  /// NOT_FOUND | FAILED_PRECONDITION JOB_NOT_ENDED.
  absl::Status Delete(const std::string& owner, const std::string& id);

  /// FAILED_PRECONDITION JOB_NOT_ENDED | JOB_HAS_NO_SAMPLES | those of Store.
  absl::StatusOr<StoredSamples> OpenSamples(const Job& job) const;

  /// Watches `job`, see Job::AddWatcher(). Does not block.
  /// @errors RESOURCE_EXHAUSTED QUOTA_EXCEEDED
  absl::StatusOr<std::int64_t> Watch(Job& job, std::function<void()> watcher,
                                     int preview_sample_count);
  void Unwatch(Job& job, std::int64_t watcher);

  /// Cancels what nobody watches any more, drops what has expired and stores the ends that the
  /// disk did not take before; called now and then.
  absl::Status Sweep();

  void StartDraining() { runner_->StartDraining(); }
  bool draining() const { return runner_->draining(); }
  /// Waits until nothing waits, runs or is being stored or watched; false when `timeout` passed
  /// before.
  bool WaitUntilIdle(absl::Duration timeout);
  /// Asks all jobs to stop; those that do not end with their caller are run by the next Start().
  void StopAll() {
    for (int i = runner_->StopAll(); i > 0; --i) dependencies_.observer->OnCancel("drain");
  }

  RunnerLoad Load() const { return runner_->Load(); }
  const MemoryBudget& memory() const { return *budget_; }
  int watcher_count() const;

 private:
  JobManager(Store& store, BlobPins& pins, const JobManagerOptions& options,
             JobManagerDependencies dependencies);

  absl::Status TakeUp(const JobRecord& record);
  absl::StatusOr<std::int64_t> MemoryOf(const JobSpec& spec) const;
  // MemoryOf() where the budget allows it.
  absl::StatusOr<std::int64_t> AdmittedMemory(const JobSpec& spec) const;
  std::shared_ptr<Job> NewJob(std::string id, JobSpec spec);
  absl::StatusOr<std::shared_ptr<Job>> AnswerFromCache(const JobRecord& record,
                                                       const JobSpec& spec);
  absl::StatusOr<std::shared_ptr<Job>> Restore(const JobRecord& record);

  void Run(const std::shared_ptr<Job>& job, std::shared_ptr<void> grant);
  void Finish(const std::shared_ptr<Job>& job, absl::StatusOr<JobResult> outcome);
  absl::StatusOr<std::string> StoreSamples(const SampleSet& samples, JobView& end);
  absl::Status StoreEnd(const Job& job, const JobView& end);
  absl::Status DeleteRecord(const JobRecord& record);

  Store& store_;
  BlobPins& pins_;
  const JobManagerOptions options_;
  const JobManagerDependencies dependencies_;
  const JobRecords records_;
  const std::shared_ptr<MemoryBudget> budget_;

  mutable Mutex mutex_;
  CondVar changed_;
  // Jobs that have not ended, and those ended ones that somebody looks at.
  std::map<std::string, std::shared_ptr<Job>> live_ ABSL_GUARDED_BY(mutex_);
  std::map<std::string, std::weak_ptr<Job>> ended_ ABSL_GUARDED_BY(mutex_);
  // Ended, but the disk did not take it: their records say that they wait.
  std::map<std::string, std::shared_ptr<Job>> unstored_ ABSL_GUARDED_BY(mutex_);
  int watchers_ ABSL_GUARDED_BY(mutex_) = 0;
  int storing_ ABSL_GUARDED_BY(mutex_) = 0;

  // In this order: what goes first is used by what was made before it.
  Executor notifier_;
  Executor decoders_;
  Executor storers_;
  std::unique_ptr<JobRunner> runner_;
};

}  // namespace ccst::server
