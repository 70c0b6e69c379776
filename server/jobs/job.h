#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "core/sampling/sampling.h"
#include "server/base/clock.h"
#include "server/jobs/job_state.h"
#include "server/base/mutex.h"

namespace ccst::server {

/// What to compute.
struct JobSpec {
  std::string mesh;  ///< Draco bytes.
  SamplingOptions options;
  int preview_sample_count = 0;  ///< 0: no previews.
};

/// What came out of a whole run.
struct JobResult {
  SamplingResult run;
  std::string samples_sha256;
  std::int64_t samples_bytes = 0;  ///< Length of what the digest is of.
  double queue_seconds = 0.0;
  double decode_seconds = 0.0;
  double total_seconds = 0.0;  ///< Decoding and the run.
  std::vector<std::string> warnings;
};

/// A thinned-out look at the samples after one alternation.
struct JobPreview {
  int alternation = 0;
  std::vector<float> positions;  ///< P x 3, row major [mesh unit].
};

/// Why a job was asked to stop.
enum class StopCause { kNone, kCaller, kDrain };

/// A job at one moment. Plain values.
struct JobView {
  std::int64_t version = 1;  ///< Grows with every change here except of `last_report`.
  std::string name;
  SamplingOptions options;
  JobState state = JobState::kQueued;
  int queue_position = 0;
  std::optional<Phase> phase;                    ///< Empty before a worker took it.
  std::optional<AlternationReport> last_report;  ///< Without positions.
  absl::Status error;                            ///< Not OK when FAILED.
  StopCause stop_cause = StopCause::kNone;
  std::shared_ptr<const JobResult> result;  ///< Set when SUCCEEDED.
  absl::Time create_time;
  std::optional<absl::Time> start_time;
  std::optional<absl::Time> end_time;
};

/// One run and everything that happened in it. The history of progress is append-only and a
/// watcher is only a cursor into it, so a slow watcher costs the worker nothing and the memory is
/// bounded by `max_iterations` small reports, one preview and the result. Thread-safe.
class Job {
 public:
  Job(std::string name, JobSpec spec, const Clock& clock);
  Job(const Job&) = delete;
  Job& operator=(const Job&) = delete;

  /// The job now.
  JobView View() const;
  /// `View().version`, cheaper.
  std::int64_t Version() const;

  /// Report number `index` of the run; empty when there are not so many yet.
  std::optional<AlternationReport> Report(std::size_t index) const;
  /// The latest preview; null before the first.
  std::shared_ptr<const JobPreview> Preview() const;
  std::size_t mesh_bytes() const { return mesh_bytes_; }
  const std::string& name() const { return name_; }
  const SamplingOptions& options() const { return options_; }

  /// `watcher` is called after every change, on the thread that made it; it must neither block
  /// nor throw, nor call SetWatcher. At most one. After SetWatcher(nullptr) returned, no call
  /// runs any more.
  void SetWatcher(std::function<void()> watcher);

  /// Asks the run to stop. Nothing happens to a job that has ended; the first cause counts.
  void Cancel(StopCause cause);

  // For the queue and the worker.

  void SetQueuePosition(int position);
  /// QUEUED -> RUNNING; false when the job was cancelled before.
  bool Take();
  /// The mesh's bytes, once; the job holds them no longer.
  std::string TakeMesh();
  std::stop_token stop_token() const { return stop_.get_token(); }
  double queue_seconds() const;
  void AddPhase(Phase phase);
  /// Keeps the report without its positions, and a preview of them where one was asked for.
  void AddReport(const AlternationReport& report);
  /// The run is over: with a whole result, stopped (CANCELLED when that was asked for), or failed.
  void End(absl::StatusOr<JobResult> outcome);

 private:
  // The state after `event` where it may happen; counts as a change.
  bool Advance(JobEvent event) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void Notify() ABSL_LOCKS_EXCLUDED(mutex_);

  const std::string name_;
  const SamplingOptions options_;
  const int preview_sample_count_;
  const std::size_t mesh_bytes_;
  const Clock& clock_;
  const double create_seconds_;
  std::stop_source stop_;

  mutable Mutex mutex_;
  std::string mesh_ ABSL_GUARDED_BY(mutex_);
  JobView view_ ABSL_GUARDED_BY(mutex_);
  double start_seconds_ ABSL_GUARDED_BY(mutex_) = 0.0;
  std::vector<AlternationReport> reports_ ABSL_GUARDED_BY(mutex_);
  std::shared_ptr<const JobPreview> preview_ ABSL_GUARDED_BY(mutex_);

  // Held while the watcher runs; always taken before mutex_.
  Mutex watcher_mutex_;
  std::function<void()> watcher_ ABSL_GUARDED_BY(watcher_mutex_);
};

}  // namespace ccst::server
