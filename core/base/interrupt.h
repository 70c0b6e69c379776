#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <stop_token>
#include <string_view>
#include <utility>

#include "absl/status/status.h"

namespace ccst {

/// Tells long work that it should end: because its caller asked for it or because its time is up.
/// Sticky. Used by one thread.
class Interrupt {
 public:
  using Clock = std::chrono::steady_clock;
  enum class Cause { kStopped, kTimeLimit };

  Interrupt() = default;
  explicit Interrupt(std::stop_token stop, std::optional<Clock::time_point> deadline = {})
      : stop_(std::move(stop)), deadline_(deadline) {}

  /// Looks at the token and the clock.
  bool Requested() {
    if (cause_.has_value()) return true;
    if (stop_.stop_requested()) {
      cause_ = Cause::kStopped;
    } else if (deadline_.has_value() && Clock::now() >= *deadline_) {
      cause_ = Cause::kTimeLimit;
    }
    return cause_.has_value();
  }

  /// The same, looking only once in 1024 values of a loop's counter: cheap enough for inner loops
  /// and often enough for steps of up to 10 microseconds.
  bool RequestedAt(std::int64_t counter) {
    return (counter & 1023) == 0 ? Requested() : cause_.has_value();
  }

  /// The same for loops whose steps differ: looks once in 1024 units of work, of up to 10
  /// microseconds each.
  /// @param work  units that the step before took, >= 0.
  bool RequestedAfter(std::int64_t work) {
    work_ += work;
    if (work_ < 1024) return cause_.has_value();
    work_ = 0;
    return Requested();
  }

  /// The moment `seconds` > 0 after `start`: none where that is more than a year away, which is no
  /// limit and might not fit the clock.
  static std::optional<Clock::time_point> DeadlineAfter(Clock::time_point start, double seconds) {
    if (!(seconds < 3.2e7)) return std::nullopt;
    return start +
           std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  }

  /// Why, once requested.
  std::optional<Cause> cause() const { return cause_; }

  /// The same without a deadline, for what has to be finished once it was begun.
  Interrupt WithoutDeadline() const { return Interrupt(stop_); }

  /// The same with the deadline brought forward by `reserve`, the time that what comes after takes.
  Interrupt Earlier(Clock::duration reserve) const {
    return Interrupt(stop_,
                     deadline_.has_value() ? std::optional(*deadline_ - reserve) : deadline_);
  }

  /// The error of work that ended without a result because this was requested: CANCELLED
  /// CANCELLED, or DEADLINE_EXCEEDED TIME_LIMIT_EXCEEDED where the time was up.
  /// @param activity  what was going on, as a clause: "the mesh was repaired".
  absl::Status Error(std::string_view activity) const;

 private:
  std::stop_token stop_;
  std::optional<Clock::time_point> deadline_;
  std::optional<Cause> cause_;
  std::int64_t work_ = 0;  // Since the last look.
};

}  // namespace ccst
