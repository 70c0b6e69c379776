#include "server/base/deadline.h"

#include <chrono>

#include <gtest/gtest.h>

namespace ccst::server {
namespace {

using std::chrono::hours;
using std::chrono::steady_clock;

TEST(DeadlineAfter, IsTheTimeoutFromNow) {
  const auto before = steady_clock::now();
  const auto deadline = DeadlineAfter(absl::Hours(2));
  EXPECT_GE(deadline, before + hours(2));
  EXPECT_LE(deadline, steady_clock::now() + hours(2));
}

TEST(DeadlineAfter, AnInfiniteTimeoutIsFarAhead) {
  EXPECT_GT(DeadlineAfter(absl::InfiniteDuration()), steady_clock::now() + hours(24 * 365));
}

}  // namespace
}  // namespace ccst::server
