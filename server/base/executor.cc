#include "server/base/executor.h"

#include <utility>

namespace ccst::server {

Executor::Executor(int thread_count, std::size_t max_waiting) : max_waiting_(max_waiting) {
  try {
    for (int i = 0; i < thread_count; ++i) threads_.emplace_back([this] { Work(); });
  } catch (...) {
    // The system has no more threads. Those there are must end: to join them would hang.
    {
      MutexLock lock(mutex_);
      closed_ = true;
    }
    changed_.notify_all();
    threads_.clear();
    throw;
  }
}

Executor::~Executor() {
  {
    MutexLock lock(mutex_);
    closed_ = true;
  }
  changed_.notify_all();
  threads_.clear();
}

bool Executor::Run(std::function<void()> task) {
  {
    MutexLock lock(mutex_);
    if (closed_ || tasks_.size() >= max_waiting_) return false;
    tasks_.push_back(std::move(task));
  }
  changed_.notify_one();
  return true;
}

void Executor::Work() {
  while (true) {
    std::function<void()> task;
    {
      MutexLock lock(mutex_);
      while (tasks_.empty() && !closed_) changed_.wait(mutex_);
      if (tasks_.empty()) return;
      task = std::move(tasks_.front());
      tasks_.pop_front();
    }
    task();
  }
}

}  // namespace ccst::server
