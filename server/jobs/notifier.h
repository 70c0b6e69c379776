#pragma once

#include <chrono>
#include <functional>
#include <thread>
#include <vector>

#include "server/base/mutex.h"

namespace ccst::server {

/// When a task of a Notifier runs.
enum class Urgency {
  kLater,  ///< With the next round, which begins within the interval.
  kNow,    ///< At once, and with it all that waits.
};

/// Runs tasks on a thread of its own, in order of arrival, in rounds: a small run makes a report
/// each millisecond, and to wake several threads for each of them takes longer than what they say.
/// A round begins at once where the last one is the interval ago. Tasks must neither block nor
/// throw. Thread-safe.
class Notifier {
 public:
  explicit Notifier(std::chrono::steady_clock::duration interval);
  /// Runs what waits, then ends.
  ~Notifier();
  Notifier(const Notifier&) = delete;
  Notifier& operator=(const Notifier&) = delete;

  /// A null task is none; with kNow what waits runs at once nevertheless.
  void Post(std::function<void()> task, Urgency urgency);

 private:
  void Work();
  // What is to run next; empty when there will be no more.
  std::vector<std::function<void()>> NextRound();

  const std::chrono::steady_clock::duration interval_;
  Mutex mutex_;
  CondVar changed_;
  std::vector<std::function<void()>> tasks_ ABSL_GUARDED_BY(mutex_);
  bool is_urgent_ ABSL_GUARDED_BY(mutex_) = false;
  bool is_idle_ ABSL_GUARDED_BY(mutex_) = false;  // Waits for a task, not for the next round.
  bool closed_ ABSL_GUARDED_BY(mutex_) = false;
  std::jthread thread_;
};

}  // namespace ccst::server
