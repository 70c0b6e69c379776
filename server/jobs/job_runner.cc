#include "server/jobs/job_runner.h"

#include <algorithm>
#include <utility>

#include "absl/cleanup/cleanup.h"
#include "core/base/limit_error.h"
#include "core/base/status.h"
#include "server/base/deadline.h"

namespace ccst::server {

JobRunner::Place::Place(Place&& other) noexcept
    : runner_(std::exchange(other.runner_, nullptr)), share_(std::move(other.share_)) {}

JobRunner::Place::~Place() {
  if (runner_ != nullptr) runner_->Return(share_);
}

JobRunner::JobRunner(const RunnerOptions& options, std::shared_ptr<MemoryBudget> budget, Run run)
    : options_(options), budget_(std::move(budget)), run_(std::move(run)) {
  budget_->SetOnRelease([this] {
    MutexLock lock(mutex_);
    changed_.notify_all();
  });
  workers_.reserve(static_cast<std::size_t>(options_.max_running_jobs));
  // Where the system has no more threads, those there are must end: to join them would hang.
  const auto close = [this] {
    {
      MutexLock lock(mutex_);
      closed_ = true;
    }
    changed_.notify_all();
    workers_.clear();
    budget_->SetOnRelease(nullptr);
  };
  auto close_unless_all_are_there = absl::MakeCleanup(close);
  for (int i = 0; i < options_.max_running_jobs; ++i) {
    workers_.emplace_back([this] { Work(); });
  }
  std::move(close_unless_all_are_there).Cancel();
}

JobRunner::~JobRunner() {
  StopAll();
  {
    MutexLock lock(mutex_);
    closed_ = true;
  }
  changed_.notify_all();
  workers_.clear();
  budget_->SetOnRelease(nullptr);
}

absl::StatusOr<JobRunner::Place> JobRunner::Reserve(const std::string& share) {
  MutexLock lock(mutex_);
  if (draining_ || closed_) {
    return MakeError(absl::StatusCode::kUnavailable, ErrorReason::kDraining,
                     "the server is going away and takes no new jobs");
  }
  const auto running = static_cast<std::size_t>(options_.max_running_jobs);
  const std::size_t taken =
      queue_.size() + held_.size() + running_.size() + static_cast<std::size_t>(reserved_count_);
  if (taken >= running + static_cast<std::size_t>(options_.max_queued_jobs)) {
    absl::Status full =
        MakeError(absl::StatusCode::kResourceExhausted, ErrorReason::kQueueFull,
                  "all " + std::to_string(running) + " places to run and " +
                      std::to_string(options_.max_queued_jobs) + " to wait are taken");
    SetPassedLimit({"max_queued_jobs", options_.max_queued_jobs, options_.max_queued_jobs + 1},
                   full);
    return full;
  }
  const auto reserved = reserved_.find(share);
  const std::size_t own =
      WaitingOf(share) +
      (reserved == reserved_.end() ? 0 : static_cast<std::size_t>(reserved->second));
  if (own >= running + static_cast<std::size_t>(options_.max_queued_jobs_per_caller)) {
    return OverQuota({"max_queued_jobs_per_caller", options_.max_queued_jobs_per_caller,
                      options_.max_queued_jobs_per_caller + 1},
                     "the caller has " + std::to_string(own) + " jobs waiting, of at most " +
                         std::to_string(options_.max_queued_jobs_per_caller));
  }
  ++reserved_[share];
  ++reserved_count_;
  return Place(*this, share);
}

void JobRunner::Enqueue(Place place, const std::shared_ptr<Job>& job, std::int64_t memory_bytes) {
  bool draining = false;
  {
    MutexLock lock(mutex_);
    // It was accepted before draining began and waits for the next start of the server.
    draining = draining_ && !job->spec().ends_with_caller;
    if (!draining) {
      Add({.job = job, .memory_bytes = memory_bytes});
      // In the same step: who looks in between would find two places taken.
      place.runner_ = nullptr;
      GiveBack(place.share_);
    }
  }
  if (draining) job->Cancel(StopCause::kDrain);
}

void JobRunner::EnqueueAccepted(std::shared_ptr<Job> job, std::int64_t memory_bytes) {
  MutexLock lock(mutex_);
  Add({.job = std::move(job), .memory_bytes = memory_bytes});
}

void JobRunner::Hold(FairQueue::Entry entry) {
  MutexLock lock(mutex_);
  if (draining_ || closed_) entry.job->Cancel(StopCause::kDrain);
  // It may have been cancelled on the way here.
  if (entry.job->View().state == JobState::kQueued) held_.push_back(std::move(entry));
}

void JobRunner::Release(const Job& job) {
  MutexLock lock(mutex_);
  const auto held = std::find_if(held_.begin(), held_.end(),
                                 [&](const auto& entry) { return entry.job.get() == &job; });
  if (held == held_.end()) return;
  FairQueue::Entry entry = std::move(*held);
  held_.erase(held);
  Add(std::move(entry));
}

std::size_t JobRunner::WaitingOf(const std::string& share) const {
  const auto held = std::count_if(held_.begin(), held_.end(), [&](const auto& entry) {
    return entry.job->spec().share == share;
  });
  return queue_.CountOf(share) + static_cast<std::size_t>(held);
}

void JobRunner::Add(FairQueue::Entry entry) {
  queue_.Push(std::move(entry));
  UpdatePositions();
  changed_.notify_all();
}

void JobRunner::Return(const std::string& share) {
  MutexLock lock(mutex_);
  GiveBack(share);
}

void JobRunner::GiveBack(const std::string& share) {
  --reserved_count_;
  const auto it = reserved_.find(share);
  if (--it->second == 0) reserved_.erase(it);
  changed_.notify_all();
}

bool JobRunner::Cancel(Job& job, StopCause cause) {
  MutexLock lock(mutex_);
  if (queue_.Remove(job)) UpdatePositions();
  held_.remove_if([&](const auto& entry) { return entry.job.get() == &job; });
  const bool cancelled = job.Cancel(cause);
  changed_.notify_all();
  return cancelled;
}

void JobRunner::StartDraining() {
  MutexLock lock(mutex_);
  draining_ = true;
  for (const auto& job : queue_.Order()) {
    if (job->spec().ends_with_caller) continue;
    queue_.Remove(*job);
    job->Cancel(StopCause::kDrain);
  }
  for (const auto& entry : std::exchange(held_, {})) entry.job->Cancel(StopCause::kDrain);
  UpdatePositions();
  changed_.notify_all();
}

bool JobRunner::draining() const {
  MutexLock lock(mutex_);
  return draining_;
}

bool JobRunner::WaitUntilIdle(absl::Duration timeout) {
  const auto deadline = DeadlineAfter(timeout);
  MutexLock lock(mutex_);
  while (!queue_.empty() || !running_.empty() || reserved_count_ > 0) {
    if (changed_.wait_until(mutex_, deadline) == std::cv_status::timeout) {
      return queue_.empty() && running_.empty() && reserved_count_ == 0;
    }
  }
  return true;
}

int JobRunner::StopAll() {
  MutexLock lock(mutex_);
  int stopped = 0;
  for (const auto& entry : std::exchange(held_, {})) {
    stopped += entry.job->Cancel(StopCause::kDrain);
  }
  while (!queue_.empty()) stopped += queue_.Pop().job->Cancel(StopCause::kDrain);
  for (const auto& job : running_) stopped += job->Cancel(StopCause::kDrain);
  changed_.notify_all();
  return stopped;
}

RunnerLoad JobRunner::Load() const {
  MutexLock lock(mutex_);
  return {.queued = static_cast<int>(queue_.size() + held_.size()),
          .running = static_cast<int>(running_.size())};
}

void JobRunner::Work() {
  while (true) {
    auto [job, grant] = Next();
    if (job == nullptr) return;
    run_(job, std::move(grant));
    {
      MutexLock lock(mutex_);
      running_.erase(job);
      if (running_.empty()) runs_alone_ = false;
    }
    changed_.notify_all();
  }
}

std::pair<std::shared_ptr<Job>, std::shared_ptr<void>> JobRunner::Next() {
  MutexLock lock(mutex_);
  while (true) {
    if (queue_.empty()) {
      if (closed_) return {};
      changed_.wait(mutex_);
      continue;
    }
    // A job that must run alone, and a large one, is waited for at the front, so that others cannot
    // starve it.
    if (runs_alone_ || (queue_.Front().alone && !running_.empty())) {
      changed_.wait(mutex_);
      continue;
    }
    std::shared_ptr<void> grant = budget_->Take(queue_.Front().memory_bytes);
    if (grant == nullptr) {
      changed_.wait(mutex_);
      continue;
    }
    auto [job, memory_bytes, alone] = queue_.Pop();
    UpdatePositions();
    if (job->Take()) {
      running_.insert(job);
      runs_alone_ = alone;
      return {std::move(job), std::move(grant)};
    }
    // Its release asks for mutex_.
    mutex_.Unlock();
    grant = nullptr;
    mutex_.Lock();
  }
}

void JobRunner::UpdatePositions() {
  int position = 0;
  for (const auto& job : queue_.Order()) job->SetQueuePosition(position++);
}

}  // namespace ccst::server
