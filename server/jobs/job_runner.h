#pragma once

#include <functional>
#include <list>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "server/jobs/fair_queue.h"
#include "server/jobs/job.h"
#include "server/jobs/memory_budget.h"

namespace ccst::server {

/// How much is computed at once and may wait.
struct RunnerOptions {
  int max_running_jobs = 1;              ///< >= 1; as many worker threads.
  int max_queued_jobs = 1024;            ///< >= 0.
  int max_queued_jobs_per_caller = 768;  ///< >= 0; leaves room for others.
};

/// A look at the queue.
struct RunnerLoad {
  int queued = 0;
  int running = 0;
};

/// Runs jobs on its own threads, at most `max_running_jobs` at once and within the memory budget;
/// callers take turns. Thread-safe.
class JobRunner {
 public:
  /// Computes a job and ends it; the memory counts as used until the grant is gone. Must not
  /// throw.
  using Run = std::function<void(const std::shared_ptr<Job>&, std::shared_ptr<void> grant)>;

  /// Room for one job to come, given back unless it is used.
  class Place {
   public:
    Place(JobRunner& runner, std::string share) : runner_(&runner), share_(std::move(share)) {}
    Place(Place&& other) noexcept;
    Place& operator=(Place&&) = delete;
    ~Place();

   private:
    friend class JobRunner;
    JobRunner* runner_;  // Null once moved from or used.
    std::string share_;
  };

  JobRunner(const RunnerOptions& options, std::shared_ptr<MemoryBudget> budget, Run run);
  /// Stops and joins what still runs.
  ~JobRunner();
  JobRunner(const JobRunner&) = delete;
  JobRunner& operator=(const JobRunner&) = delete;

  /// Room for a job of `share`.
  /// @errors RESOURCE_EXHAUSTED QUEUE_FULL | QUOTA_EXCEEDED the caller's | UNAVAILABLE DRAINING
  absl::StatusOr<Place> Reserve(const std::string& share);

  /// Takes a job that may need `memory_bytes`, at most the budget's limit.
  void Enqueue(Place place, const std::shared_ptr<Job>& job, std::int64_t memory_bytes);
  /// One that was accepted by an earlier process: there is always room.
  void EnqueueAccepted(std::shared_ptr<Job> job, std::int64_t memory_bytes);

  /// Takes a job that is not to run yet: it waits, and counts as waiting, until Release(). It need
  /// not fit, as it was accepted before.
  void Hold(FairQueue::Entry entry);
  /// Lets a job of Hold() wait for a worker; nothing happens to one that is gone.
  void Release(const Job& job);

  /// Asks a job to stop; one that waits ends at once and frees its place. As Job::Cancel().
  bool Cancel(Job& job, StopCause cause);

  /// From now on Reserve() refuses with DRAINING. Jobs that survive the server and wait are told
  /// to stop by kDrain; what runs and what ends with its caller goes on.
  void StartDraining();
  bool draining() const;

  /// Waits until nothing waits for a worker or runs; false when `timeout` passed before.
  bool WaitUntilIdle(absl::Duration timeout);

  /// Asks all jobs to stop, for the reason that draining cannot wait longer. @return how many did
  /// not stop already.
  int StopAll();

  RunnerLoad Load() const;

 private:
  void Work();
  // The next job, RUNNING, and its memory; null when the runner goes away.
  std::pair<std::shared_ptr<Job>, std::shared_ptr<void>> Next();
  void Add(FairQueue::Entry entry) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  std::size_t WaitingOf(const std::string& share) const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void UpdatePositions() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void Return(const std::string& share);
  void GiveBack(const std::string& share) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  const RunnerOptions options_;
  const std::shared_ptr<MemoryBudget> budget_;
  const Run run_;

  // Taken before any lock of a job or its watchers.
  mutable Mutex mutex_;
  CondVar changed_;
  FairQueue queue_ ABSL_GUARDED_BY(mutex_);
  std::list<FairQueue::Entry> held_ ABSL_GUARDED_BY(mutex_);
  std::map<std::string, int> reserved_ ABSL_GUARDED_BY(mutex_);  // By share.
  int reserved_count_ ABSL_GUARDED_BY(mutex_) = 0;
  std::set<std::shared_ptr<Job>> running_ ABSL_GUARDED_BY(mutex_);
  bool runs_alone_ ABSL_GUARDED_BY(mutex_) = false;  // What runs, beside which nothing may.
  bool draining_ ABSL_GUARDED_BY(mutex_) = false;
  bool closed_ ABSL_GUARDED_BY(mutex_) = false;

  std::vector<std::jthread> workers_;
};

}  // namespace ccst::server
