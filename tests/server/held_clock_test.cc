#include "server/base/held_clock.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace ccst::server {
namespace {

constexpr absl::Duration kMonth = absl::Hours(24 * 30);

class HeldClockTest : public testing::Test {
 protected:
  void Pass(absl::Duration duration) {
    wall_ += duration;
    seconds_ += absl::ToDoubleSeconds(duration);
  }
  // How far the held clock is from `expected`.
  void ExpectNow(absl::Time expected) {
    EXPECT_LT(absl::AbsDuration(clock_.now() - expected), absl::Milliseconds(1))
        << clock_.now() << " " << expected;
  }

  const absl::Time begin_ = absl::FromUnixSeconds(1'700'000'000);
  absl::Time wall_ = begin_;
  double seconds_ = 1234.5;
  std::vector<std::string> said_;
  Clock clock_ =
      HoldJumps({.now = [this] { return wall_; }, .seconds = [this] { return seconds_; }},
                [this](const std::string& text) { said_.push_back(text); });
};

TEST_F(HeldClockTest, FollowsAClockThatGoes) {
  ExpectNow(begin_);
  for (int day = 1; day <= 3; ++day) {
    Pass(absl::Hours(24));
    ExpectNow(begin_ + absl::Hours(24 * day));
  }
  EXPECT_EQ(clock_.seconds(), seconds_);
  EXPECT_TRUE(said_.empty());
}

TEST_F(HeldClockTest, FollowsSmallCorrectionsHoweverMany) {
  for (int i = 1; i <= 100; ++i) {
    wall_ += absl::Seconds(9);
    Pass(absl::Seconds(5));
    ExpectNow(begin_ + i * absl::Seconds(14));
  }
  EXPECT_TRUE(said_.empty());
}

TEST_F(HeldClockTest, DoesNotFollowAShortJumpEitherWay) {
  for (const absl::Duration jump : {kMonth, -kMonth, absl::Seconds(11), absl::Hours(24 * 36500)}) {
    const absl::Time before = wall_;
    wall_ += jump;
    ExpectNow(before);
    for (int i = 1; i <= 5; ++i) {
      Pass(absl::Seconds(1));
      ExpectNow(before + absl::Seconds(i));
    }
    wall_ -= jump;
    ExpectNow(before + absl::Seconds(5));
  }
  EXPECT_EQ(said_.size(), 8U);
}

TEST_F(HeldClockTest, FollowsATimeThatStandsForAnHour) {
  wall_ += kMonth;
  ExpectNow(begin_);
  Pass(absl::Minutes(59));
  ExpectNow(begin_ + absl::Minutes(59));
  Pass(absl::Minutes(1));
  ExpectNow(begin_ + kMonth + absl::Hours(1));
  Pass(absl::Hours(24));
  ExpectNow(begin_ + kMonth + absl::Hours(25));
  EXPECT_EQ(said_.size(), 2U);
}

TEST_F(HeldClockTest, TheHourBeginsAnewWithEveryJump) {
  for (int i = 0; i < 10; ++i) {
    wall_ += kMonth;
    ExpectNow(begin_ + i * absl::Minutes(50));
    Pass(absl::Minutes(50));
    ExpectNow(begin_ + (i + 1) * absl::Minutes(50));
  }
}

TEST_F(HeldClockTest, ManyLooksDuringAJumpAreOneMessage) {
  wall_ += kMonth;
  for (int i = 0; i < 100; ++i) {
    Pass(absl::Seconds(1));
    clock_.now();
  }
  EXPECT_EQ(said_.size(), 1U);
}

}  // namespace
}  // namespace ccst::server
