#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>

#include "server/base/mutex.h"

namespace ccst::server {

/// Messages that others can cause as often as they like, such as a handshake that fails: of each
/// kind a few a minute are passed on, and then how many there were besides. Thread-safe.
class LimitedLog {
 public:
  /// @param say      gets the messages
  /// @param seconds  a clock that never goes back [s]
  LimitedLog(std::function<void(const std::string&)> say, std::function<double()> seconds);

  /// Passes `message` on, or counts it. There should be few kinds: each takes a little memory.
  void Message(const std::string& kind, const std::string& message);
  /// Tells of minutes that are over; called now and then.
  void Tend();

 private:
  struct Window {
    double start = 0.0;
    std::int64_t messages = 0;
  };
  // The minute of `kind` is over: tells how many messages were left out.
  void Close(const std::string& kind, const Window& window) const;

  const std::function<void(const std::string&)> say_;
  const std::function<double()> seconds_;
  Mutex mutex_;
  std::map<std::string, Window> windows_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace ccst::server
