#include "server/jobs/memory_budget.h"

#include <utility>

namespace ccst::server {

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

void MemoryBudget::SetOnRelease(std::function<void()> on_release) {
  MutexLock lock(listener_mutex_);
  on_release_ = std::move(on_release);
}

void MemoryBudget::Release(std::int64_t bytes) {
  {
    MutexLock lock(mutex_);
    used_bytes_ -= bytes;
  }
  MutexLock lock(listener_mutex_);
  if (on_release_) on_release_();
}

}  // namespace ccst::server
