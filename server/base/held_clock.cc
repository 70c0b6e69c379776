#include "server/base/held_clock.h"

#include <memory>
#include <optional>
#include <utility>

#include "server/base/mutex.h"

namespace ccst::server {
namespace {

constexpr absl::Duration kLargestCorrection = absl::Seconds(10);
constexpr double kHoldSeconds = 3600.0;

class HeldClock {
 public:
  HeldClock(Clock clock, std::function<void(const std::string&)> report)
      : clock_(std::move(clock)), report_(std::move(report)), start_(Start()) {}

  absl::Time Now() {
    MutexLock lock(mutex_);
    const absl::Time wall = clock_.now();
    const double seconds = clock_.seconds();
    const absl::Time start = wall - absl::Seconds(seconds);
    if (IsNear(start, start_)) {
      if (candidate_.has_value()) Say("the machine's clock is right again");
      candidate_.reset();
      start_ = start;
    } else if (!candidate_.has_value() || !IsNear(start, candidate_->start)) {
      Say("the machine's clock jumped by " + absl::FormatDuration(start - start_) +
          "; expiry goes by the time before until that has stood for an hour");
      candidate_ = Candidate{.start = start, .since = seconds};
    } else if (seconds - candidate_->since >= kHoldSeconds) {
      Say("the machine's clock is taken as it is, after a jump by " +
          absl::FormatDuration(start - start_));
      candidate_.reset();
      start_ = start;
    } else {
      candidate_->start = start;
    }
    return start_ + absl::Seconds(seconds);
  }

 private:
  // A time of day that was not there before.
  struct Candidate {
    absl::Time start;
    double since = 0.0;
  };

  absl::Time Start() const { return clock_.now() - absl::Seconds(clock_.seconds()); }
  static bool IsNear(absl::Time a, absl::Time b) {
    return absl::AbsDuration(a - b) <= kLargestCorrection;
  }
  void Say(const std::string& text) const {
    if (report_) report_(text);
  }

  const Clock clock_;
  const std::function<void(const std::string&)> report_;
  Mutex mutex_;
  // What the time of day was when `seconds` were 0.
  absl::Time start_ ABSL_GUARDED_BY(mutex_);
  std::optional<Candidate> candidate_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace

Clock HoldJumps(const Clock& clock, std::function<void(const std::string&)> report) {
  auto held = std::make_shared<HeldClock>(clock, std::move(report));
  return {.now = [held] { return held->Now(); }, .seconds = clock.seconds};
}

}  // namespace ccst::server
