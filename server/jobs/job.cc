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

// Previews of this many points at least: what one watcher asks for should not cost others theirs.
int MostDemanding(const auto& watchers) {
  int most = 0;
  for (const auto& [id, watcher] : watchers) most = std::max(most, watcher.preview_sample_count);
  return most;
}

}  // namespace

bool IsPutBack(const JobSpec& spec, const JobView& view) {
  return view.stop_cause == StopCause::kDrain && !spec.ends_with_caller &&
         (view.state == JobState::kCancelling || view.state == JobState::kCancelled);
}

Job::Job(std::string id, JobSpec spec, const Clock& clock, Post post,
         std::shared_ptr<const HeldInput> held)
    : id_(std::move(id)),
      spec_(std::move(spec)),
      clock_(clock),
      post_(std::move(post)),
      create_seconds_(clock.seconds()),
      held_(std::move(held)),
      unwatched_since_(create_seconds_) {
  view_.create_time = clock_.now();
}

Job::Job(std::string id, JobSpec spec, const Clock& clock, JobView view,
         absl::StatusOr<std::vector<AlternationReport>> reports)
    : id_(std::move(id)),
      spec_(std::move(spec)),
      clock_(clock),
      create_seconds_(clock.seconds()),
      history_status_(reports.status()),
      view_(std::move(view)),
      sealed_(true),
      published_(true),
      reports_(std::move(reports).value_or(std::vector<AlternationReport>())),
      unwatched_since_(create_seconds_) {
  if (!reports_.empty()) view_.last_report = reports_.back();
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

std::vector<AlternationReport> Job::Reports() const {
  MutexLock lock(mutex_);
  return reports_;
}

std::shared_ptr<const JobPreview> Job::Preview() const {
  MutexLock lock(mutex_);
  return preview_;
}

std::optional<std::int64_t> Job::AddWatcher(std::function<void()> watcher, int preview_sample_count,
                                            int most) {
  MutexLock lock(watcher_mutex_);
  if (static_cast<int>(watchers_.size()) >= most) return std::nullopt;
  watchers_[next_watcher_] = {std::move(watcher), preview_sample_count};
  preview_sample_count_ = MostDemanding(watchers_);
  return next_watcher_++;
}

void Job::RemoveWatcher(std::int64_t id) {
  MutexLock lock(watcher_mutex_);
  watchers_.erase(id);
  preview_sample_count_ = MostDemanding(watchers_);
  if (watchers_.empty()) unwatched_since_ = clock_.seconds();
}

int Job::watcher_count() const {
  MutexLock lock(watcher_mutex_);
  return static_cast<int>(watchers_.size());
}

double Job::UnwatchedSeconds() const {
  MutexLock lock(watcher_mutex_);
  return watchers_.empty() ? clock_.seconds() - unwatched_since_ : 0.0;
}

bool Job::Cancel(StopCause cause) {
  {
    MutexLock lock(mutex_);
    if (view_.stop_cause == StopCause::kDrain && cause != StopCause::kDrain && !published_) {
      // It stops already, to be run again; now it is not to be.
      view_.stop_cause = cause;
      ++view_.version;
      return true;
    }
    if (sealed_ && !published_ && late_cause_ != StopCause::kCaller) late_cause_ = cause;
    if (sealed_ || HasEnded(view_.state) || view_.stop_cause != StopCause::kNone) return false;
    view_.stop_cause = cause;
    Advance(cause == StopCause::kDrain ? JobEvent::kDrainEnds : JobEvent::kCancel);
    if (HasEnded(view_.state)) {
      sealed_ = true;
      view_.end_time = clock_.now();
      view_.queue_position = 0;
      held_ = nullptr;
    }
  }
  stop_.request_stop();
  Notify(Urgency::kNow);
  return true;
}

void Job::SetQueuePosition(int position) {
  {
    MutexLock lock(mutex_);
    if (view_.queue_position == position || view_.state != JobState::kQueued) return;
    view_.queue_position = position;
    ++view_.version;
  }
  Notify(Urgency::kLater);
}

bool Job::Take() {
  {
    MutexLock lock(mutex_);
    if (!Advance(JobEvent::kTaken)) return false;
    view_.queue_position = 0;
    view_.error = absl::OkStatus();
    view_.phase = Phase::kPreparing;
    view_.start_time = clock_.now();
    start_seconds_ = clock_.seconds();
  }
  Notify(Urgency::kLater);
  return true;
}

std::shared_ptr<const HeldInput> Job::held_input() const {
  MutexLock lock(mutex_);
  return held_;
}

double Job::QueueSeconds() const {
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
  Notify(Urgency::kLater);
}

void Job::AddReport(const AlternationReport& report) {
  std::shared_ptr<const JobPreview> preview;
  if (const int most = preview_sample_count_; most > 0) preview = MakePreview(report, most);
  AlternationReport kept = report;
  kept.positions = {};
  {
    MutexLock lock(mutex_);
    view_.last_report = kept;
    reports_.push_back(kept);
    if (preview != nullptr) preview_ = std::move(preview);
  }
  Notify(Urgency::kLater);
}

JobView Job::Seal(absl::StatusOr<JobResult> outcome) {
  const bool stopped = outcome.ok() ? outcome->run.termination == Termination::kStopped
                                    : absl::IsCancelled(outcome.status());
  const absl::Status status = outcome.status();
  MutexLock lock(mutex_);
  sealed_ = true;
  JobView end = view_;
  JobEvent event = JobEvent::kFinished;
  if (stopped) {
    event = JobEvent::kStopped;
    if (!NextState(end.state, event).has_value()) {
      // Nobody asked: the run misbehaved, and the caller must not take it for an answer.
      event = JobEvent::kFailed;
      end.error = MakeError(absl::StatusCode::kInternal, ErrorReason::kInternal,
                            "the run stopped without having been asked to");
    }
  } else if (status.ok()) {
    end.result = std::make_shared<const JobResult>(*std::move(outcome));
  } else {
    event = JobEvent::kFailed;
    end.error = status;
  }
  end.state = NextState(end.state, event).value_or(JobState::kFailed);
  end.end_time = clock_.now();
  return end;
}

int Job::PutOff(const absl::Status& why) {
  int count = 0;
  {
    MutexLock lock(mutex_);
    sealed_ = false;
    if (view_.stop_cause == StopCause::kNone && late_cause_ != StopCause::kNone) {
      view_.stop_cause = late_cause_;
      Advance(late_cause_ == StopCause::kDrain ? JobEvent::kDrainEnds : JobEvent::kCancel);
    }
    if (view_.stop_cause != StopCause::kNone) return 0;
    Advance(JobEvent::kPutOff);
    view_.error = why;
    view_.phase.reset();
    view_.start_time.reset();
    view_.last_report.reset();
    reports_.clear();
    preview_ = nullptr;
    count = ++put_off_count_;
  }
  Notify(Urgency::kNow);
  return count;
}

void Job::Publish(JobView end) {
  {
    MutexLock lock(mutex_);
    end.version = view_.version + 1;
    view_ = std::move(end);
    published_ = true;
    preview_ = nullptr;
    held_ = nullptr;
  }
  Notify(Urgency::kNow);
}

bool Job::Advance(JobEvent event) {
  if (sealed_) return false;
  const auto next = NextState(view_.state, event);
  if (!next.has_value()) return false;
  view_.state = *next;
  ++view_.version;
  return true;
}

void Job::Notify(Urgency urgency) {
  // What is new while a call is under way goes with the next one.
  if (!news_.exchange(true)) {
    post_([self = shared_from_this()] { self->CallWatchers(); }, urgency);
  } else if (urgency == Urgency::kNow) {
    post_(nullptr, urgency);
  }
}

void Job::CallWatchers() {
  MutexLock lock(watcher_mutex_);
  news_ = false;
  for (const auto& [id, watcher] : watchers_) watcher.call();
}

}  // namespace ccst::server
