#pragma once

#include <functional>

#include "absl/time/time.h"

namespace ccst::server {

/// Where jobs take the time from; injected so that tests need not wait.
struct Clock {
  /// Time of day, for what people read.
  std::function<absl::Time()> now;
  /// Seconds since a fixed moment, never going back, for durations.
  std::function<double()> seconds;
};

}  // namespace ccst::server
