#include "server/jobs/notifier.h"

#include <utility>

namespace ccst::server {

Notifier::Notifier(std::chrono::steady_clock::duration interval)
    : interval_(interval), thread_([this] { Work(); }) {}

Notifier::~Notifier() {
  {
    MutexLock lock(mutex_);
    closed_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void Notifier::Post(std::function<void()> task, Urgency urgency) {
  {
    MutexLock lock(mutex_);
    if (task != nullptr) tasks_.push_back(std::move(task));
    if (tasks_.empty()) return;
    if (urgency == Urgency::kNow) is_urgent_ = true;
    // It looks at what there is when the next round begins.
    if (!is_urgent_ && !is_idle_) return;
  }
  changed_.notify_one();
}

void Notifier::Work() {
  while (true) {
    const auto round = NextRound();
    if (round.empty()) return;
    for (const auto& task : round) task();
    const auto next = std::chrono::steady_clock::now() + interval_;
    MutexLock lock(mutex_);
    while (!is_urgent_ && !closed_ && std::chrono::steady_clock::now() < next) {
      changed_.wait_until(mutex_, next);
    }
  }
}

std::vector<std::function<void()>> Notifier::NextRound() {
  MutexLock lock(mutex_);
  is_idle_ = true;
  while (tasks_.empty() && !closed_) changed_.wait(mutex_);
  is_idle_ = false;
  is_urgent_ = false;
  return std::exchange(tasks_, {});
}

}  // namespace ccst::server
