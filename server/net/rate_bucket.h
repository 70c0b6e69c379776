#pragma once

#include <algorithm>

namespace ccst::server {

/// A bound on how often something happens that makes who is too fast wait, each in turn. Not
/// thread-safe.
class RateBucket {
 public:
  /// `burst` at once, and then `per_second`; both > 0.
  RateBucket(double per_second, double burst)
      : interval_(1.0 / per_second), tolerance_((burst - 0.5) / per_second) {}

  /// Takes one at `now` [s]. Returns from when on it may happen: `now`, or a later time, which is
  /// taken: the next gets one after it.
  double Take(double now) {
    next_ = std::max(next_, now);
    const double allowed = std::max(now, next_ - tolerance_);
    next_ += interval_;
    return allowed;
  }

  /// True when `burst` may be taken at once, as from a new one.
  bool IsFull(double now) const { return next_ <= now; }

 private:
  double interval_;
  double tolerance_;   // Half an interval more than `burst` need: they add up to a little more.
  double next_ = 0.0;  // When everything taken so far would have been taken at the even rate.
};

}  // namespace ccst::server
