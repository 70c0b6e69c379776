#include "server/jobs/job_runner.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "core/base/status.h"

namespace ccst::server {
namespace {

constexpr absl::Duration kLongestWait = absl::Hours(24 * 365 * 10);

absl::Status QueueFull(const std::string& message) {
  return MakeError(absl::StatusCode::kResourceExhausted, ErrorReason::kQueueFull, message);
}

}  // namespace

JobRunner::JobRunner(const RunnerOptions& options, RunDependencies dependencies,
                     std::function<std::string()> new_id)
    : options_(options), dependencies_(std::move(dependencies)), new_id_(std::move(new_id)) {
  workers_.reserve(static_cast<std::size_t>(options_.max_running_jobs));
  for (int i = 0; i < options_.max_running_jobs; ++i) {
    workers_.emplace_back([this] { Work(); });
  }
}

JobRunner::~JobRunner() {
  StopAll();
  {
    MutexLock lock(mutex_);
    closed_ = true;
  }
  changed_.notify_all();
  workers_.clear();
}

absl::StatusOr<std::shared_ptr<Job>> JobRunner::Submit(JobSpec spec) {
  MutexLock lock(mutex_);
  if (draining_ || closed_) {
    return MakeError(absl::StatusCode::kUnavailable, ErrorReason::kDraining,
                     "the server is going away and takes no new jobs");
  }
  const auto places =
      static_cast<std::size_t>(options_.max_running_jobs) + options_.max_queued_jobs;
  // A released job may still occupy its worker for a moment.
  const std::size_t taken =
      std::max(held_.size(), queue_.size() + static_cast<std::size_t>(running_));
  if (taken >= places) {
    return QueueFull("all " + std::to_string(options_.max_running_jobs) + " places to run and " +
                     std::to_string(options_.max_queued_jobs) + " to wait are taken");
  }
  const auto bytes = static_cast<std::int64_t>(spec.mesh.size());
  if (!queue_.empty() && queued_bytes_ + bytes > options_.max_queued_bytes) {
    return QueueFull("the meshes that wait already take " + std::to_string(queued_bytes_) + " of " +
                     std::to_string(options_.max_queued_bytes) + " bytes");
  }
  auto job = std::make_shared<Job>("jobs/" + new_id_(), std::move(spec), dependencies_.clock);
  held_.push_back(job);
  queue_.push_back(job);
  queued_bytes_ += bytes;
  UpdatePositions();
  changed_.notify_all();
  return job;
}

void JobRunner::Cancel(Job& job, StopCause cause) {
  MutexLock lock(mutex_);
  RemoveFromQueue(job);
  job.Cancel(cause);
  changed_.notify_all();
}

void JobRunner::Release(Job& job) {
  job.SetWatcher(nullptr);
  MutexLock lock(mutex_);
  RemoveFromQueue(job);
  job.Cancel(StopCause::kCaller);
  held_.remove_if([&](const auto& held) { return held.get() == &job; });
  changed_.notify_all();
}

void JobRunner::StartDraining() {
  MutexLock lock(mutex_);
  draining_ = true;
}

bool JobRunner::draining() const {
  MutexLock lock(mutex_);
  return draining_;
}

bool JobRunner::WaitUntilIdle(absl::Duration timeout) {
  // An infinite timeout would overflow the clock.
  const absl::Duration bounded = std::min(timeout, kLongestWait);
  const auto deadline = std::chrono::steady_clock::now() + absl::ToChronoNanoseconds(bounded);
  MutexLock lock(mutex_);
  while (!held_.empty() || running_ > 0) {
    if (changed_.wait_until(mutex_, deadline) == std::cv_status::timeout) {
      return held_.empty() && running_ == 0;
    }
  }
  return true;
}

void JobRunner::StopAll() {
  MutexLock lock(mutex_);
  queue_.clear();
  queued_bytes_ = 0;
  for (const auto& job : held_) job->Cancel(StopCause::kDrain);
  changed_.notify_all();
}

RunnerLoad JobRunner::Load() const {
  MutexLock lock(mutex_);
  return {.queued = static_cast<int>(queue_.size()), .running = running_};
}

void JobRunner::Work() {
  while (const std::shared_ptr<Job> job = Next()) {
    RunJob(*job, dependencies_);
    {
      MutexLock lock(mutex_);
      --running_;
    }
    changed_.notify_all();
  }
}

std::shared_ptr<Job> JobRunner::Next() {
  MutexLock lock(mutex_);
  while (true) {
    while (queue_.empty() && !closed_) changed_.wait(mutex_);
    if (queue_.empty()) return nullptr;
    const std::shared_ptr<Job> job = queue_.front();
    RemoveFromQueue(*job);
    if (!job->Take()) continue;
    ++running_;
    return job;
  }
}

void JobRunner::RemoveFromQueue(const Job& job) {
  const auto it = std::find_if(queue_.begin(), queue_.end(),
                               [&](const auto& queued) { return queued.get() == &job; });
  if (it == queue_.end()) return;
  queued_bytes_ -= static_cast<std::int64_t>(job.mesh_bytes());
  queue_.erase(it);
  UpdatePositions();
}

void JobRunner::UpdatePositions() {
  int position = 0;
  for (const auto& job : queue_) job->SetQueuePosition(position++);
}

}  // namespace ccst::server
