#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "core/sampling/sampling.h"
#include "server/base/clock.h"
#include "server/base/mutex.h"
#include "server/formats/job_outcome.h"
#include "server/jobs/held_inputs.h"
#include "server/jobs/job_spec.h"
#include "server/jobs/job_state.h"
#include "server/jobs/notifier.h"

namespace ccst::server {

/// A thinned-out look at the samples after one alternation.
struct JobPreview {
  int alternation = 0;
  std::vector<float> positions;  ///< P x 3, row major [mesh unit].
};

/// Why a job was asked to stop.
enum class StopCause { kNone, kCaller, kDrain, kAbandoned };

/// A job at one moment. Plain values.
struct JobView {
  std::int64_t version = 1;  ///< Grows with every change here except of `last_report`.
  JobState state = JobState::kQueued;
  int queue_position = 0;
  std::optional<Phase> phase;                    ///< Empty before a worker took it.
  std::optional<AlternationReport> last_report;  ///< Without positions.
  absl::Status error;                            ///< Not OK when FAILED, or QUEUED by PutOff().
  StopCause stop_cause = StopCause::kNone;
  std::shared_ptr<const JobResult> result;  ///< Set when SUCCEEDED.
  std::string samples_blob;                 ///< SHA-256 of the blob with the samples.
  bool cached = false;                      ///< The result was taken from an equal spec.
  absl::Time create_time;
  std::optional<absl::Time> start_time;
  std::optional<absl::Time> end_time;
  std::optional<absl::Time> expire_time;
};

/// True for a job that stops, or has, because its server goes away, and that the next start runs:
/// to its owner it waits.
bool IsPutBack(const JobSpec& spec, const JobView& view);

/// One job and everything that happened in it. The history of progress is append-only and a
/// watcher is only a cursor into it, so a slow watcher costs the worker nothing and the memory is
/// bounded by `max_iterations` small reports and one preview. Thread-safe.
class Job : public std::enable_shared_from_this<Job> {
 public:
  /// Runs a task on another thread, as Notifier::Post().
  using Post = std::function<void(std::function<void()>, Urgency)>;

  /// A new job, QUEUED. `post` carries news to watchers; `held` is its mesh where the store does
  /// not have that, else null.
  Job(std::string id, JobSpec spec, const Clock& clock, Post post,
      std::shared_ptr<const HeldInput> held = nullptr);
  /// One that has ended, as it was stored; an error in place of reports that are damaged.
  Job(std::string id, JobSpec spec, const Clock& clock, JobView view,
      absl::StatusOr<std::vector<AlternationReport>> reports);
  Job(const Job&) = delete;
  Job& operator=(const Job&) = delete;

  const std::string& id() const { return id_; }
  /// `jobs/{id}`.
  std::string name() const { return "jobs/" + id_; }
  const JobSpec& spec() const { return spec_; }

  /// The job now.
  JobView View() const;
  /// `View().version`, cheaper.
  std::int64_t Version() const;
  /// Report number `index` of the run; empty when there are not so many yet.
  std::optional<AlternationReport> Report(std::size_t index) const;
  std::vector<AlternationReport> Reports() const;
  /// DATA_LOSS STORAGE_FAILED where the reports of the run are damaged: there are none then.
  const absl::Status& history_status() const { return history_status_; }
  /// The latest preview; null before the first.
  std::shared_ptr<const JobPreview> Preview() const;

  /// `watcher` is called soon after changes, at once where they end the job or ask it to stop, and
  /// after some milliseconds for the others; on any thread, never concurrently; it must neither
  /// block nor throw, nor add or remove watchers. Previews have as many points as the most
  /// demanding watcher asked for. Empty when there are `most` already. After RemoveWatcher()
  /// returned, no call runs any more.
  std::optional<std::int64_t> AddWatcher(std::function<void()> watcher, int preview_sample_count,
                                         int most);
  void RemoveWatcher(std::int64_t id);
  int watcher_count() const;
  /// Seconds for which nobody has watched; 0 while somebody does.
  double UnwatchedSeconds() const;

  /// Asks the run to stop, true when it has not ended and was not asked before; the first cause
  /// counts, but that a caller's replaces kDrain. A job that waits is CANCELLED at once, one that
  /// runs becomes CANCELLING.
  bool Cancel(StopCause cause);

  // For the queue and the worker.

  void SetQueuePosition(int position);
  /// QUEUED -> RUNNING; false when the job was cancelled before.
  bool Take();
  std::stop_token stop_token() const { return stop_.get_token(); }
  /// Its mesh where only the job has it, until its end is shown; else null.
  std::shared_ptr<const HeldInput> held_input() const;
  double QueueSeconds() const;
  void AddPhase(Phase phase);
  /// Keeps the report without its positions, and a preview of them where somebody wants one.
  void AddReport(const AlternationReport& report);
  /// The run is over: with a whole result, stopped (CANCELLED when that was asked for), or failed.
  /// Decides how the job ends and returns it; what comes later changes nothing any more. Watchers
  /// learn of it from Publish().
  JobView Seal(absl::StatusOr<JobResult> outcome);
  /// The store fails the run, sealed or not, for the reason `why`: the job is QUEUED again, without
  /// what the run reported, and shows `why` until it is taken. @return how often that has happened;
  /// 0 when it was asked to stop meanwhile, and its end is to be sealed as that.
  int PutOff(const absl::Status& why);
  /// The end is stored: shows it.
  void Publish(JobView end);

 private:
  // The state after `event` where it may happen; counts as a change.
  bool Advance(JobEvent event) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void Notify(Urgency urgency) ABSL_LOCKS_EXCLUDED(mutex_);
  void CallWatchers();

  const std::string id_;
  const JobSpec spec_;
  const Clock& clock_;
  const Post post_;
  const double create_seconds_;
  const absl::Status history_status_;
  std::stop_source stop_;
  std::atomic<int> preview_sample_count_ = 0;
  std::atomic<bool> news_ = false;

  mutable Mutex mutex_;
  JobView view_ ABSL_GUARDED_BY(mutex_);
  bool sealed_ ABSL_GUARDED_BY(mutex_) = false;     // How it ends is decided,
  bool published_ ABSL_GUARDED_BY(mutex_) = false;  // and shown.
  // Why it was asked to stop when how it ends was decided already.
  StopCause late_cause_ ABSL_GUARDED_BY(mutex_) = StopCause::kNone;
  int put_off_count_ ABSL_GUARDED_BY(mutex_) = 0;
  double start_seconds_ ABSL_GUARDED_BY(mutex_) = 0.0;
  std::vector<AlternationReport> reports_ ABSL_GUARDED_BY(mutex_);
  std::shared_ptr<const JobPreview> preview_ ABSL_GUARDED_BY(mutex_);
  std::shared_ptr<const HeldInput> held_ ABSL_GUARDED_BY(mutex_);

  struct Watcher {
    std::function<void()> call;
    int preview_sample_count = 0;
  };
  // Held while watchers run; always taken before mutex_.
  mutable Mutex watcher_mutex_;
  std::map<std::int64_t, Watcher> watchers_ ABSL_GUARDED_BY(watcher_mutex_);
  std::int64_t next_watcher_ ABSL_GUARDED_BY(watcher_mutex_) = 1;
  double unwatched_since_ ABSL_GUARDED_BY(watcher_mutex_);
};

}  // namespace ccst::server
