#include "tests/interleavings/schedule.h"

#include <chrono>

namespace ccst::interleavings {
namespace {

constexpr auto kLongestHold = std::chrono::milliseconds(3);
// Somebody must be there to pass.
constexpr int kMostHeld = 6;
constexpr int kMostToPass = 12;

}  // namespace

void Schedule::Pass(std::string_view call, Side side) {
  std::unique_lock lock(mutex_);
  std::int64_t& arrived = arrived_[{std::string(call), side}];
  ++arrived;
  ++passed_;
  changed_.notify_all();
  const std::uint64_t draw = random_() % 8;
  if (released_ || held_ >= kMostHeld || draw >= 4) return;
  ++held_;
  const std::int64_t others = arrived + 1;
  const std::int64_t pass =
      passed_ + 1 + static_cast<std::int64_t>(random_() % static_cast<std::uint64_t>(kMostToPass));
  changed_.wait_for(lock, kLongestHold,
                    [&] { return released_ || (draw < 2 ? arrived >= others : passed_ >= pass); });
  --held_;
}

void Schedule::Release() {
  const std::lock_guard lock(mutex_);
  released_ = true;
  changed_.notify_all();
}

}  // namespace ccst::interleavings
