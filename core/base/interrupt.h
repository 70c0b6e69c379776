#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <stop_token>

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

  /// Why, once requested.
  std::optional<Cause> cause() const { return cause_; }

 private:
  std::stop_token stop_;
  std::optional<Clock::time_point> deadline_;
  std::optional<Cause> cause_;
};

}  // namespace ccst
