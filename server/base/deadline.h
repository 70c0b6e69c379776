#pragma once

#include <algorithm>
#include <chrono>

#include "absl/time/time.h"

namespace ccst::server {

/// When `timeout` from now has passed, but at most ten years from now: an infinite timeout would
/// overflow the clock.
inline std::chrono::steady_clock::time_point DeadlineAfter(absl::Duration timeout) {
  constexpr absl::Duration kLongest = absl::Hours(24 * 365 * 10);
  return std::chrono::steady_clock::now() + absl::ToChronoNanoseconds(std::min(timeout, kLongest));
}

}  // namespace ccst::server
