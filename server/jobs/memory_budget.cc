#include "server/jobs/memory_budget.h"

#include <utility>

#include "server/base/deadline.h"
#include "server/base/free_memory.h"

namespace ccst::server {
namespace {

// Less than this is soon used again.
constexpr std::int64_t kWorthReturning = std::int64_t{16} << 20;

}  // namespace

std::int64_t MemoryBudget::used_bytes() const {
  MutexLock lock(mutex_);
  return used_bytes_;
}

std::shared_ptr<void> MemoryBudget::Take(std::int64_t bytes) {
  {
    MutexLock lock(mutex_);
    if (used_bytes_ + bytes > limit_bytes_) return nullptr;
    used_bytes_ += bytes;
  }
  // The pointer stands for the grant alone; the budget outlives it.
  return {this, [self = shared_from_this(), bytes](void*) { self->Release(bytes); }};
}

std::shared_ptr<void> MemoryBudget::TakeWithin(absl::Duration timeout, std::int64_t bytes,
                                               const std::stop_token& stop) {
  const auto deadline = DeadlineAfter(timeout);
  while (true) {
    if (auto grant = Take(bytes); grant != nullptr) return grant;
    MutexLock lock(mutex_);
    const auto is_free = [&] { return used_bytes_ + bytes <= limit_bytes_; };
    if (!released_.wait_until(mutex_, stop, deadline, is_free)) return nullptr;
  }
}

void MemoryBudget::SetOnRelease(std::function<void()> on_release) {
  MutexLock lock(listener_mutex_);
  on_release_ = std::move(on_release);
}

void MemoryBudget::Release(std::int64_t bytes) {
  {
    MutexLock lock(mutex_);
    used_bytes_ -= bytes;
  }
  released_.notify_all();
  if (bytes >= kWorthReturning) ReturnFreeMemory();
  MutexLock lock(listener_mutex_);
  if (on_release_) on_release_();
}

}  // namespace ccst::server
