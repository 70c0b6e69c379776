#include "client/lib/retry.h"

#include <stop_token>

#include <gtest/gtest.h>

#include "core/base/status.h"

namespace ccst {
namespace {

const absl::Status kAway = absl::UnavailableError("away");

TEST(Retry, ThreeAttemptsInARow) {
  Retry retry({});
  EXPECT_TRUE(retry.Wait(kAway).ok());
  EXPECT_TRUE(retry.Wait(kAway).ok());
  EXPECT_EQ(retry.Wait(kAway), kAway);
}

TEST(Retry, AnAnswerCountsAnew) {
  Retry retry({});
  EXPECT_TRUE(retry.Wait(kAway).ok());
  EXPECT_TRUE(retry.Wait(kAway).ok());
  retry.Heard();
  EXPECT_TRUE(retry.Wait(kAway).ok());
}

TEST(Retry, OtherErrorsAreFinal) {
  Retry retry({}, 60.0);
  retry.Heard();
  EXPECT_EQ(retry.Wait(absl::NotFoundError("gone")), absl::NotFoundError("gone"));
  EXPECT_EQ(retry.Wait(absl::ResourceExhaustedError("full")), absl::ResourceExhaustedError("full"));
}

TEST(Retry, PatienceWithoutAnAnswerIsNone) {
  Retry retry({}, 3600.0);
  EXPECT_TRUE(retry.Wait(kAway).ok());
  EXPECT_TRUE(retry.Wait(kAway).ok());
  EXPECT_EQ(retry.Wait(kAway), kAway);
}

TEST(Retry, StopEndsTheWaitAndWhatFollows) {
  std::stop_source stop;
  Retry retry(stop.get_token(), 3600.0);
  stop.request_stop();
  EXPECT_EQ(GetErrorReason(retry.Wait(kAway)), ErrorReason::kCancelled);
  EXPECT_EQ(GetErrorReason(retry.Wait(kAway)), ErrorReason::kCancelled);
}

}  // namespace
}  // namespace ccst
