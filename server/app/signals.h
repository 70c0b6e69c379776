#pragma once

#include <condition_variable>
#include <mutex>
#include <thread>

namespace ccst::server {

/// Takes SIGTERM, SIGINT and, unless it is ignored, SIGHUP on a thread of its own: the first wakes
/// Wait(), the second ends the process at once. Create one, before any other thread starts, so that
/// all inherit the mask.
class Signals {
 public:
  Signals();
  ~Signals();
  Signals(const Signals&) = delete;
  Signals& operator=(const Signals&) = delete;

  /// Returns after the first signal.
  void Wait();

 private:
  void Listen();

  std::mutex mutex_;
  std::condition_variable changed_;
  int received_ = 0;
  bool closed_ = false;
  std::thread thread_;
};

}  // namespace ccst::server
