#include "server/jobs/job_runner.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "core/base/status.h"

namespace ccst::server {
namespace {

constexpr absl::Duration kLongestWait = absl::Hours(24 * 365 * 10);

}  // namespace

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
      queue_.size() + running_.size() + static_cast<std::size_t>(reserved_count_);
  if (taken >= running + static_cast<std::size_t>(options_.max_queued_jobs)) {
    return MakeError(absl::StatusCode::kResourceExhausted, ErrorReason::kQueueFull,
                     "all " + std::to_string(running) + " places to run and " +
                         std::to_string(options_.max_queued_jobs) + " to wait are taken");
  }
  const auto reserved = reserved_.find(share);
  const std::size_t own =
      queue_.CountOf(share) +
      (reserved == reserved_.end() ? 0 : static_cast<std::size_t>(reserved->second));
  if (own >= running + static_cast<std::size_t>(options_.max_queued_jobs_per_caller)) {
    return MakeError(absl::StatusCode::kResourceExhausted, ErrorReason::kQuotaExceeded,
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
  UpdatePositions();
  changed_.notify_all();
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
  while (!queue_.empty()) stopped += queue_.Pop().job->Cancel(StopCause::kDrain);
  for (const auto& job : running_) stopped += job->Cancel(StopCause::kDrain);
  changed_.notify_all();
  return stopped;
}

RunnerLoad JobRunner::Load() const {
  MutexLock lock(mutex_);
  return {.queued = static_cast<int>(queue_.size()), .running = static_cast<int>(running_.size())};
}

void JobRunner::Work() {
  while (true) {
    auto [job, grant] = Next();
    if (job == nullptr) return;
    run_(job, std::move(grant));
    {
      MutexLock lock(mutex_);
      running_.erase(job);
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
    // A large job at the front is waited for, so that small ones cannot starve it.
    std::shared_ptr<void> grant = budget_->Take(queue_.Front().memory_bytes);
    if (grant == nullptr) {
      changed_.wait(mutex_);
      continue;
    }
    std::shared_ptr<Job> job = queue_.Pop().job;
    UpdatePositions();
    if (job->Take()) {
      running_.insert(job);
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
