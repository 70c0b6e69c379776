#include "server/jobs/job.h"

#include <algorithm>
#include <utility>

#include "core/base/status.h"

namespace ccst::server {
namespace {

// Evenly spread over the samples, which are in spatial order.
std::shared_ptr<const JobPreview> MakePreview(const AlternationReport& report, int most) {
  auto preview = std::make_shared<JobPreview>();
  preview->alternation = report.alternation;
  const std::size_t total = report.positions.size();
  const std::size_t count = std::min(total, static_cast<std::size_t>(most));
  preview->positions.reserve(3 * count);
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d& position = report.positions[i * total / count];
    for (int axis = 0; axis < 3; ++axis) {
      preview->positions.push_back(static_cast<float>(position[axis]));
    }
  }
  return preview;
}

}  // namespace

Job::Job(std::string name, JobSpec spec, const Clock& clock)
    : name_(std::move(name)),
      options_(spec.options),
      preview_sample_count_(spec.preview_sample_count),
      mesh_bytes_(spec.mesh.size()),
      clock_(clock),
      create_seconds_(clock.seconds()),
      mesh_(std::move(spec.mesh)) {
  view_.name = name_;
  view_.options = options_;
  view_.create_time = clock_.now();
}

JobView Job::View() const {
  MutexLock lock(mutex_);
  return view_;
}

std::int64_t Job::Version() const {
  MutexLock lock(mutex_);
  return view_.version;
}

std::optional<AlternationReport> Job::Report(std::size_t index) const {
  MutexLock lock(mutex_);
  if (index >= reports_.size()) return std::nullopt;
  return reports_[index];
}

std::shared_ptr<const JobPreview> Job::Preview() const {
  MutexLock lock(mutex_);
  return preview_;
}

void Job::SetWatcher(std::function<void()> watcher) {
  MutexLock lock(watcher_mutex_);
  watcher_ = std::move(watcher);
}

void Job::Cancel(StopCause cause) {
  {
    MutexLock lock(mutex_);
    if (HasEnded(view_.state)) return;
    if (view_.stop_cause == StopCause::kNone) view_.stop_cause = cause;
    Advance(cause == StopCause::kDrain ? JobEvent::kDrainEnds : JobEvent::kCancel);
    if (HasEnded(view_.state)) {
      view_.end_time = clock_.now();
      view_.queue_position = 0;
      mesh_ = std::string();
    }
  }
  stop_.request_stop();
  Notify();
}

void Job::SetQueuePosition(int position) {
  {
    MutexLock lock(mutex_);
    if (view_.queue_position == position || view_.state != JobState::kQueued) return;
    view_.queue_position = position;
    ++view_.version;
  }
  Notify();
}

bool Job::Take() {
  {
    MutexLock lock(mutex_);
    if (!Advance(JobEvent::kTaken)) return false;
    view_.queue_position = 0;
    view_.phase = Phase::kPreparing;
    view_.start_time = clock_.now();
    start_seconds_ = clock_.seconds();
  }
  Notify();
  return true;
}

std::string Job::TakeMesh() {
  MutexLock lock(mutex_);
  return std::exchange(mesh_, std::string());
}

double Job::queue_seconds() const {
  MutexLock lock(mutex_);
  return start_seconds_ - create_seconds_;
}

void Job::AddPhase(Phase phase) {
  {
    MutexLock lock(mutex_);
    if (view_.phase == phase) return;
    view_.phase = phase;
    ++view_.version;
  }
  Notify();
}

void Job::AddReport(const AlternationReport& report) {
  std::shared_ptr<const JobPreview> preview;
  if (preview_sample_count_ > 0) preview = MakePreview(report, preview_sample_count_);
  AlternationReport kept = report;
  kept.positions = {};
  {
    MutexLock lock(mutex_);
    view_.last_report = kept;
    reports_.push_back(kept);
    if (preview != nullptr) preview_ = std::move(preview);
  }
  Notify();
}

void Job::End(absl::StatusOr<JobResult> outcome) {
  const bool stopped = outcome.ok() ? outcome->run.termination == Termination::kStopped
                                    : absl::IsCancelled(outcome.status());
  const absl::Status status = outcome.status();
  std::shared_ptr<const JobResult> result;
  if (status.ok() && !stopped) result = std::make_shared<const JobResult>(*std::move(outcome));
  {
    MutexLock lock(mutex_);
    if (stopped) {
      // Nobody asked: the run misbehaved, and the caller must not take it for an answer.
      if (!Advance(JobEvent::kStopped)) {
        view_.error = MakeError(absl::StatusCode::kInternal, ErrorReason::kInternal,
                                "the run stopped without having been asked to");
        Advance(JobEvent::kFailed);
      }
    } else if (result != nullptr) {
      view_.result = std::move(result);
      Advance(JobEvent::kFinished);
    } else {
      view_.error = status;
      Advance(JobEvent::kFailed);
    }
    view_.end_time = clock_.now();
    preview_ = nullptr;
  }
  Notify();
}

bool Job::Advance(JobEvent event) {
  const auto next = NextState(view_.state, event);
  if (!next.has_value()) return false;
  view_.state = *next;
  ++view_.version;
  return true;
}

void Job::Notify() {
  MutexLock lock(watcher_mutex_);
  if (watcher_) watcher_();
}

}  // namespace ccst::server
