#include "server/log/limited_log.h"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace ccst::server {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class LimitedLogTest : public testing::Test {
 protected:
  std::vector<std::string> TakeSaid() { return std::exchange(said_, {}); }

  double now_ = 1000.0;
  std::vector<std::string> said_;
  LimitedLog log_{[this](const std::string& text) { said_.push_back(text); },
                  [this] { return now_; }};
};

TEST_F(LimitedLogTest, FewMessagesArePassedOn) {
  log_.Message("tls", "first");
  log_.Message("tls", "second");
  now_ += 3600;
  log_.Tend();
  EXPECT_THAT(TakeSaid(), ElementsAre("first", "second"));
}

TEST_F(LimitedLogTest, ManyMessagesAreCounted) {
  for (int i = 0; i < 1000; ++i) log_.Message("tls", "bad handshake");
  EXPECT_EQ(TakeSaid().size(), 5U);
  now_ += 59;
  log_.Tend();
  EXPECT_THAT(TakeSaid(), IsEmpty());
  now_ += 1;
  log_.Tend();
  EXPECT_THAT(TakeSaid(), ElementsAre("tls: 995 more within a minute"));
  log_.Tend();
  EXPECT_THAT(TakeSaid(), IsEmpty());
}

TEST_F(LimitedLogTest, TheNextMinuteBeginsAnew) {
  for (int i = 0; i < 7; ++i) log_.Message("tls", "early");
  TakeSaid();
  now_ += 61;
  log_.Message("tls", "late");
  EXPECT_THAT(TakeSaid(), ElementsAre("tls: 2 more within a minute", "late"));
}

TEST_F(LimitedLogTest, KindsDoNotHideEachOther) {
  for (int i = 0; i < 1000; ++i) log_.Message("tls", "bad handshake");
  TakeSaid();
  log_.Message("listener", "out of descriptors");
  EXPECT_THAT(TakeSaid(), ElementsAre("out of descriptors"));
}

}  // namespace
}  // namespace ccst::server
