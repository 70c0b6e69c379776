#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <thread>
#include <unordered_map>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "server/base/mutex.h"
#include "server/net/file_descriptor.h"

namespace ccst::server {

/// A thread that waits for sockets and times. What it calls must neither block nor throw. All but
/// Post() and the destructor is for that thread alone.
class EventLoop {
 public:
  using Id = std::uint64_t;

  /// @errors UNAVAILABLE  the system has no descriptors left
  static absl::StatusOr<std::unique_ptr<EventLoop>> Start();
  /// Stops it, then drops what it watched and waited for, uncalled. Not on its own thread.
  ~EventLoop();
  EventLoop(const EventLoop&) = delete;
  EventLoop& operator=(const EventLoop&) = delete;

  /// Ends the thread after the task that it runs; what is posted later is never run. May be called
  /// again; not on its own thread. For owners whose tasks use the loop through the owner: the
  /// pointer to it must stay until no task runs any more.
  void Stop() ABSL_LOCKS_EXCLUDED(mutex_);

  /// Runs `task` on the thread, soon.
  void Post(std::function<void()> task) ABSL_LOCKS_EXCLUDED(mutex_);

  /// Calls `on_events` with those of the epoll `events` that are so, and errors, again and again
  /// until told otherwise. 0 when the system refuses.
  Id Watch(int descriptor, std::uint32_t events, std::function<void(std::uint32_t)> on_events);
  void Change(Id watch, std::uint32_t events);
  /// Before the descriptor is closed. No call comes any more.
  void Forget(Id watch);

  /// Calls `task` once, at `seconds` of Now() or a little later.
  Id RunAt(double seconds, std::function<void()> task);
  void Cancel(Id timer);

  /// Seconds since a fixed moment; for any thread.
  static double Now();

 private:
  struct Watched {
    int descriptor = -1;
    std::uint32_t events = 0;
    // Shared: it may be forgotten while it is called.
    std::shared_ptr<std::function<void(std::uint32_t)>> on_events;
  };

  EventLoop(FileDescriptor epoll, FileDescriptor wake);
  void Run();
  int MillisecondsToWait() const;
  void RunPosted();
  void RunTimers();

  const FileDescriptor epoll_;
  const FileDescriptor wake_;
  Id next_id_ = 1;
  std::unordered_map<Id, Watched> watched_;
  std::map<std::pair<double, Id>, std::function<void()>> timers_;
  std::unordered_map<Id, double> timer_times_;
  Mutex mutex_;
  std::vector<std::function<void()>> posted_ ABSL_GUARDED_BY(mutex_);
  bool stopped_ ABSL_GUARDED_BY(mutex_) = false;
  std::thread thread_;
};

}  // namespace ccst::server
