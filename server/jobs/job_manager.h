#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "server/base/mutex.h"
#include "server/jobs/held_inputs.h"
#include "server/jobs/job.h"
#include "server/jobs/job_manager_options.h"
#include "server/jobs/job_runner.h"
#include "server/jobs/job_runs.h"
#include "server/jobs/live_jobs.h"
#include "server/jobs/memory_budget.h"
#include "server/jobs/notifier.h"
#include "server/jobs/stored_samples.h"
#include "server/meshes/blob_pins.h"
#include "server/store/store.h"

namespace ccst::server {

/// A job as it is listed.
struct JobSummary {
  std::string id;
  JobSpec spec;
  JobView view;
};

/// Accepts, runs, stores and finds jobs. What Create() returned is durable: a job that has not
/// ended is run again by the next Start() on the same store, and gives the same samples; one that
/// ran twice when the process died is FAILED instead. Calls block on the disk unless said
/// otherwise. Thread-safe.
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

  /// Takes the mesh of a job that ends with its caller into memory, for Create(); null where it is
  /// to be stored instead. See HeldInputs::Hold().
  std::shared_ptr<const HeldInput> Hold(const std::string& sha256, std::string& bytes) {
    return held_inputs_.Hold(sha256, bytes);
  }

  /// Accepts a job, or returns the one accepted before for the same request_id. The caller holds
  /// pins on mesh and texture. A mesh that is `held` need not be stored: it is when the job ends
  /// with samples.
  /// @errors INVALID_ARGUMENT LIMIT_EXCEEDED it needs more memory than the budget | what the mesh
  ///         announces is over the limits | FAILED_PRECONDITION MESH_MISSING | as FindRequest()
  ///       | RESOURCE_EXHAUSTED QUEUE_FULL | QUOTA_EXCEEDED | STORAGE_FULL | UNAVAILABLE DRAINING
  ///       | those of Store
  absl::StatusOr<std::shared_ptr<Job>> Create(
      const JobSpec& spec, const std::shared_ptr<const HeldInput>& held = nullptr);

  /// The job accepted before for the request_id of `spec`; null when there is none. It is found
  /// whatever has become of its mesh and of the room for new jobs.
  /// @errors INVALID_ARGUMENT REQUEST_INVALID that job is of another spec | those of Store
  absl::StatusOr<std::shared_ptr<Job>> FindRequest(const JobSpec& spec);

  /// What Create() would refuse of the spec itself.
  absl::Status Check(const JobSpec& spec) const;

  /// NOT_FOUND when it is unknown, dropped or another owner's.
  absl::StatusOr<std::shared_ptr<Job>> Find(const std::string& owner, const std::string& id);

  /// INVALID_ARGUMENT REQUEST_INVALID for a token that is not one.
  absl::StatusOr<Page<JobSummary>> List(const JobFilter& filter, int page_size,
                                        const std::string& page_token);

  /// Asks a job to stop, durably; nothing happens to one that has ended. It stops also where that
  /// cannot be stored, which is an error.
  absl::Status Cancel(const std::shared_ptr<Job>& job, StopCause cause);

  /// Asks a job to stop; does not block, and does not survive a crash without Cancel().
  void Stop(Job& job, StopCause cause);

  /// NOT_FOUND | FAILED_PRECONDITION JOB_NOT_ENDED.
  absl::Status Delete(const std::string& owner, const std::string& id);

  /// FAILED_PRECONDITION JOB_NOT_ENDED | JOB_HAS_NO_SAMPLES | NOT_FOUND it was dropped meanwhile
  /// | DATA_LOSS STORAGE_FAILED they are damaged or gone | those of Store.
  absl::StatusOr<StoredSamples> OpenSamples(const Job& job) const;

  /// Watches `job`, see Job::AddWatcher(). Does not block.
  /// @errors RESOURCE_EXHAUSTED QUOTA_EXCEEDED
  absl::StatusOr<std::int64_t> Watch(Job& job, std::function<void()> watcher,
                                     int preview_sample_count);
  void Unwatch(Job& job, std::int64_t watcher);

  /// Drops what has expired, stores the ends that the disk did not take before, cancels what nobody
  /// watches any more, and lets jobs run that wait for the store; called now and then. Each is done
  /// whatever becomes of the others; the first error.
  absl::Status Sweep();
  /// The last of it, which costs little; called every second or so.
  void Resume() { runs_.Resume(); }

  void StartDraining() { runs_.StartDraining(); }
  bool draining() const { return runs_.runner().draining(); }
  /// Waits until nothing waits for a worker, runs or is being stored or watched; false when
  /// `timeout` passed before.
  bool WaitUntilIdle(absl::Duration timeout);
  /// Asks all jobs to stop; those that do not end with their caller are run by the next Start().
  void StopAll();

  RunnerLoad Load() const { return runs_.runner().Load(); }
  const MemoryBudget& memory() const { return *budget_; }
  int watcher_count() const;

 private:
  JobManager(Store& store, BlobPins& pins, const JobManagerOptions& options,
             JobManagerDependencies dependencies);

  void TakeUp(const JobRecord& record);
  // JobRuns::MemoryOf() where the budget allows it.
  absl::StatusOr<std::int64_t> AdmittedMemory(const JobSpec& spec,
                                              const std::shared_ptr<const HeldInput>& held) const;
  std::shared_ptr<Job> NewJob(std::string id, JobSpec spec,
                              std::shared_ptr<const HeldInput> held = nullptr);
  // A new job; null when another call with its request_id was first, or when the job, answered from
  // the cache, is dropped at once.
  absl::StatusOr<std::shared_ptr<Job>> Accept(const JobSpec& spec,
                                              const std::shared_ptr<const HeldInput>& held);
  // `record` as it is stored when an equal spec answers it, or the job that was first with its
  // request_id; empty when nothing answers it.
  absl::StatusOr<std::optional<JobRecord>> AnswerFromCache(
      const JobRecord& record, const std::shared_ptr<const HeldInput>& held);
  // The ended job of `record`, with its history; NOT_FOUND when it is dropped meanwhile.
  absl::StatusOr<std::shared_ptr<Job>> Restore(const JobRecord& record);

  absl::Status DeleteRecord(const JobRecord& record);
  // Whatever has expired, in batches.
  absl::Status DropExpired();

  Store& store_;
  BlobPins& pins_;
  const JobManagerOptions options_;
  const JobManagerDependencies dependencies_;
  const std::shared_ptr<MemoryBudget> budget_;

  HeldInputs held_inputs_;
  LiveJobs live_;

  mutable Mutex mutex_;
  CondVar changed_;
  int watchers_ ABSL_GUARDED_BY(mutex_) = 0;

  // In this order: what goes first is used by what was made before it.
  Notifier notifier_;
  JobRuns runs_;
};

}  // namespace ccst::server
