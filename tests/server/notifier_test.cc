#include "server/jobs/notifier.h"

#include <atomic>
#include <chrono>
#include <memory>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/server/fakes.h"

namespace ccst::server {
namespace {

using testing::ElementsAre;

// Longer than any test.
constexpr std::chrono::hours kNever(1000);

TEST(Notifiers, FirstNewsAfterAQuietTimeComeAtOnce) {
  Gate told;
  Notifier notifier(kNever);
  notifier.Post([&] { told.Open(); }, Urgency::kLater);
  told.Wait();
}

TEST(Notifiers, NewsThatFollowWaitForWhatIsUrgentAndKeepTheirOrder) {
  Gate told;
  Gate done;
  std::vector<int> order;
  Notifier notifier(kNever);
  notifier.Post([&] { told.Open(); }, Urgency::kLater);
  told.Wait();
  notifier.Post([&] { order.push_back(1); }, Urgency::kLater);
  notifier.Post([&] { order.push_back(2); }, Urgency::kLater);
  notifier.Post(
      [&] {
        order.push_back(3);
        done.Open();
      },
      Urgency::kNow);
  done.Wait();
  EXPECT_THAT(order, ElementsAre(1, 2, 3));
}

TEST(Notifiers, WhatWaitsIsHurriedWithoutATaskOfItsOwn) {
  Gate told;
  Gate done;
  Notifier notifier(kNever);
  notifier.Post([&] { told.Open(); }, Urgency::kLater);
  told.Wait();
  notifier.Post([&] { done.Open(); }, Urgency::kLater);
  notifier.Post(nullptr, Urgency::kNow);
  done.Wait();
}

TEST(Notifiers, NewsThatFollowComeWithTheNextRound) {
  Notifier notifier(std::chrono::milliseconds(1));
  for (int i = 0; i < 3; ++i) {
    const auto told = std::make_shared<Gate>();
    notifier.Post([told] { told->Open(); }, Urgency::kLater);
    told->Wait();
  }
}

TEST(Notifiers, RunWhatWaitsBeforeTheyEnd) {
  std::atomic<int> ran = 0;
  {
    Notifier notifier(kNever);
    for (int i = 0; i < 100; ++i) notifier.Post([&] { ++ran; }, Urgency::kLater);
  }
  EXPECT_EQ(ran, 100);
}

}  // namespace
}  // namespace ccst::server
