#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <thread>
#include <vector>

#include "server/base/mutex.h"

namespace ccst::server {

/// Runs tasks on threads of its own, in order of arrival: what may block or take long must not run
/// on gRPC's few threads. Tasks must not throw. Thread-safe.
class Executor {
 public:
  /// `thread_count` >= 1; at most `max_waiting` tasks wait.
  Executor(int thread_count, std::size_t max_waiting);
  /// Runs what waits, then ends.
  ~Executor();
  Executor(const Executor&) = delete;
  Executor& operator=(const Executor&) = delete;

  /// False when too many wait already; the task is not run then.
  bool Run(std::function<void()> task);

 private:
  void Work();

  const std::size_t max_waiting_;
  Mutex mutex_;
  CondVar changed_;
  std::deque<std::function<void()>> tasks_ ABSL_GUARDED_BY(mutex_);
  bool closed_ ABSL_GUARDED_BY(mutex_) = false;
  std::vector<std::jthread> threads_;
};

}  // namespace ccst::server
