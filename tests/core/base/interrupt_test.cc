#include "core/base/interrupt.h"

#include <limits>
#include <stop_token>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/status.h"

namespace ccst {
namespace {

using Clock = Interrupt::Clock;
using testing::HasSubstr;

constexpr std::chrono::hours kHour(1);

TEST(Interrupt, PastDeadlineIsATimeLimit) {
  Interrupt interrupt({}, Clock::now() - kHour);
  EXPECT_TRUE(interrupt.Requested());
  EXPECT_EQ(interrupt.cause(), Interrupt::Cause::kTimeLimit);
}

TEST(Interrupt, StopComesBeforeADeadline) {
  std::stop_source stop;
  stop.request_stop();
  Interrupt interrupt(stop.get_token(), Clock::now() - kHour);
  EXPECT_TRUE(interrupt.Requested());
  EXPECT_EQ(interrupt.cause(), Interrupt::Cause::kStopped);
}

TEST(Interrupt, FutureDeadlineIsNone) {
  EXPECT_FALSE(Interrupt({}, Clock::now() + kHour).Requested());
}

TEST(Interrupt, LooksOnceInAThousandUnitsOfWork) {
  Interrupt interrupt({}, Clock::now() - kHour);
  EXPECT_FALSE(interrupt.RequestedAfter(1000));
  EXPECT_FALSE(interrupt.RequestedAfter(23));
  EXPECT_TRUE(interrupt.RequestedAfter(1));
  EXPECT_TRUE(interrupt.RequestedAfter(0));
}

TEST(Interrupt, LooksAfterEachStepOfMuchWork) {
  Interrupt interrupt({}, Clock::now() - kHour);
  EXPECT_TRUE(interrupt.RequestedAfter(std::int64_t{1} << 40));
}

TEST(Interrupt, EarlierBringsTheDeadlineForward) {
  const Interrupt whole({}, Clock::now() + kHour);
  EXPECT_FALSE(Interrupt(whole.Earlier(kHour / 2)).Requested());
  EXPECT_TRUE(Interrupt(whole.Earlier(kHour)).Requested());
  EXPECT_FALSE(Interrupt(Interrupt().Earlier(kHour)).Requested());
}

TEST(Interrupt, WithoutDeadlineHearsTheStopOnly) {
  std::stop_source stop;
  Interrupt rest = Interrupt(stop.get_token(), Clock::now() - kHour).WithoutDeadline();
  EXPECT_FALSE(rest.Requested());
  stop.request_stop();
  EXPECT_TRUE(rest.Requested());
}

TEST(Interrupt, DeadlineOfMoreThanAYearIsNone) {
  const Clock::time_point start = Clock::now();
  EXPECT_EQ(Interrupt::DeadlineAfter(start, 1e300), std::nullopt);
  EXPECT_EQ(Interrupt::DeadlineAfter(start, std::numeric_limits<double>::infinity()), std::nullopt);
  EXPECT_EQ(Interrupt::DeadlineAfter(start, 2.0), start + std::chrono::seconds(2));
}

TEST(Interrupt, ErrorSaysWhatWasGoingOnAndWhatToDo) {
  Interrupt interrupt({}, Clock::now() - kHour);
  interrupt.Requested();
  const absl::Status late = interrupt.Error("the mesh was repaired");
  EXPECT_EQ(late.code(), absl::StatusCode::kDeadlineExceeded);
  EXPECT_EQ(GetErrorReason(late), ErrorReason::kTimeLimitExceeded);
  EXPECT_THAT(std::string(late.message()), HasSubstr("while the mesh was repaired"));
  EXPECT_THAT(std::string(late.message()), HasSubstr("allow more time"));
}

TEST(Interrupt, ErrorOfAStopIsCancelled) {
  std::stop_source stop;
  stop.request_stop();
  Interrupt interrupt(stop.get_token());
  interrupt.Requested();
  const absl::Status stopped = interrupt.Error("the mesh was repaired");
  EXPECT_EQ(stopped.code(), absl::StatusCode::kCancelled);
  EXPECT_EQ(GetErrorReason(stopped), ErrorReason::kCancelled);
  EXPECT_EQ(stopped.message(), "stopped while the mesh was repaired");
}

}  // namespace
}  // namespace ccst
