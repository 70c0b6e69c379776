#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <stop_token>

#include "absl/time/time.h"
#include "server/base/mutex.h"

namespace ccst::server {

/// Memory shared out to jobs by estimate. Thread-safe.
class MemoryBudget : public std::enable_shared_from_this<MemoryBudget> {
 public:
  explicit MemoryBudget(std::int64_t limit_bytes) : limit_bytes_(limit_bytes) {}

  std::int64_t limit_bytes() const { return limit_bytes_; }
  std::int64_t used_bytes() const;

  /// The memory is taken until the last copy of the grant is gone; null when it is not free. What
  /// a large grant was for is then given back to the system, on the thread that let go of it.
  std::shared_ptr<void> Take(std::int64_t bytes);

  /// Take(), waiting for at most `timeout` or until `stop` is requested.
  std::shared_ptr<void> TakeWithin(absl::Duration timeout, std::int64_t bytes,
                                   const std::stop_token& stop = {});

  /// Called after memory became free, on any thread; an empty function takes it back, and once
  /// that returned no call runs any more.
  void SetOnRelease(std::function<void()> on_release);

 private:
  void Release(std::int64_t bytes);

  const std::int64_t limit_bytes_;
  mutable Mutex mutex_;
  StoppableCondVar released_;
  std::int64_t used_bytes_ ABSL_GUARDED_BY(mutex_) = 0;
  // Held while it runs; never together with mutex_.
  Mutex listener_mutex_;
  std::function<void()> on_release_ ABSL_GUARDED_BY(listener_mutex_);
};

}  // namespace ccst::server
