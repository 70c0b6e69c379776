#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>

#include "server/base/mutex.h"

namespace ccst::server {

/// Tells an operator of connections that came to nothing, at most once in a while for each reason:
/// a stranger may make thousands a second. Thread-safe.
class Complaints {
 public:
  /// For one reason a line comes this often [s] at most.
  static constexpr double kInterval = 10.0;

  /// @param count   is told of every one, by its reason.
  /// @param report  writes a line.
  Complaints(std::function<void(std::string_view reason)> count,
             std::function<void(const std::string& line)> report);

  /// @param reason  one of a few fixed words
  /// @param detail  what happened, in words that no stranger chose
  void Note(std::string_view reason, std::string_view detail, double now)
      ABSL_LOCKS_EXCLUDED(mutex_);

 private:
  struct Kind {
    double next_line = 0.0;
    std::int64_t untold = 0;
  };

  const std::function<void(std::string_view)> count_;
  const std::function<void(const std::string&)> report_;
  Mutex mutex_;
  std::map<std::string, Kind, std::less<>> kinds_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace ccst::server
