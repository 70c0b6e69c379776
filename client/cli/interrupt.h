#pragma once

#include <atomic>
#include <csignal>
#include <stop_token>
#include <string>
#include <thread>

namespace ccst::cli {

/// Turns SIGINT and SIGTERM into a stop request; a second one ends the process at once with
/// kCancelled. Signals are taken by a thread, so that nothing runs in a handler. Make it before
/// any other thread starts: they inherit the blocked signals. A first SIGINT prints `notice` where
/// people read standard error.
class Interrupt {
 public:
  explicit Interrupt(const std::string& notice = "cancelling; Ctrl-C again leaves at once");
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  std::stop_token token() const { return stop_.get_token(); }

 private:
  void Wait();

  std::string notice_;
  sigset_t signals_;
  sigset_t before_;
  std::stop_source stop_;
  std::atomic<bool> done_ = false;
  std::thread waiter_;
};

}  // namespace ccst::cli
