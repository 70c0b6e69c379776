// Bounds on connections, and what is told of those that are refused.
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "server/net/complaints.h"
#include "server/net/connection_limits.h"
#include "server/net/rate_bucket.h"

namespace ccst::server {
namespace {

using Place = std::unique_ptr<ConnectionLimits::Place>;

Place Charged(ConnectionLimits& limits, const std::string& network) {
  auto place = limits.Take();
  if (!place.ok() || !(*place)->Charge(network, 0.0).ok()) return nullptr;
  return *std::move(place);
}

TEST(RateBucket, BurstPassesAtOnceAndTheRestAtTheRate) {
  RateBucket bucket(10.0, 5.0);
  for (int i = 0; i < 5; ++i) EXPECT_EQ(bucket.Take(100.0), 100.0);
  for (int i = 1; i <= 20; ++i) EXPECT_NEAR(bucket.Take(100.0), 100.0 + i / 10.0, 0.06);
}

TEST(RateBucket, FillsAgainWithTimeAndNeverHoldsMoreThanABurst) {
  RateBucket bucket(10.0, 5.0);
  for (int i = 0; i < 5; ++i) bucket.Take(100.0);
  EXPECT_FALSE(bucket.IsFull(100.4));
  EXPECT_TRUE(bucket.IsFull(100.5));
  for (int i = 0; i < 5; ++i) EXPECT_EQ(bucket.Take(1000.0), 1000.0);
  EXPECT_GT(bucket.Take(1000.0), 1000.0);
}

TEST(RateBucket, WhoWaitsHasATimeOfItsOwn) {
  RateBucket bucket(10.0, 1.0);
  bucket.Take(0.0);
  const double first = bucket.Take(0.0);
  const double second = bucket.Take(0.0);
  EXPECT_NEAR(second - first, 0.1, 1e-9);
}

TEST(ConnectionLimits, SoManyInAll) {
  ConnectionLimits limits(2, 2);
  Place first = Charged(limits, "a");
  const Place second = Charged(limits, "b");
  EXPECT_EQ(limits.Take().status().code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(limits.open(), 2);
  first.reset();
  EXPECT_NE(Charged(limits, "c"), nullptr);
}

TEST(ConnectionLimits, SoManyOfOneAddress) {
  ConnectionLimits limits(100, 2);
  Place first = Charged(limits, "a");
  const Place second = Charged(limits, "a");
  EXPECT_EQ(Charged(limits, "a"), nullptr);
  EXPECT_NE(Charged(limits, "b"), nullptr);
  first.reset();
  EXPECT_NE(Charged(limits, "a"), nullptr);
}

TEST(ConnectionLimits, ServersOwnConnectionHasAlwaysAPlace) {
  ConnectionLimits limits(1, 1);
  const Place first = Charged(limits, "a");
  const Place own = limits.TakeBeyond();
  EXPECT_EQ(own->TakeReset(7.0), 7.0);
  EXPECT_FALSE(limits.Take().ok());
}

TEST(ConnectionLimits, ConnectingAnewGivesNoOtherBurstOfResets) {
  ConnectionLimits limits(100, 10);
  double latest = 0.0;
  const int resets = static_cast<int>(ConnectionLimits::kResetBurst) + 4000;
  for (int i = 0; i < resets; ++i) {
    latest = std::max(latest, Charged(limits, "a")->TakeReset(0.0));
  }
  EXPECT_NEAR(latest, 4000 / ConnectionLimits::kResetsPerSecond, 0.01);
  EXPECT_EQ(Charged(limits, "b")->TakeReset(0.0), 0.0);
}

TEST(ConnectionLimits, ManyAddressesTakeNoMoreMemoryThanConnections) {
  ConnectionLimits limits(10, 10);
  const Place stays = Charged(limits, "stays");
  for (int i = 0; i < 1000; ++i) Charged(limits, std::to_string(i))->TakeReset(0.0);
  EXPECT_LE(limits.known_addresses(), 21U);
  EXPECT_EQ(limits.open(), 1);
}

struct Notes {
  std::vector<std::string> counted;
  std::vector<std::string> lines;
  Complaints complaints{[this](std::string_view reason) { counted.emplace_back(reason); },
                        [this](const std::string& line) { lines.push_back(line); }};
};

TEST(Complaints, EachIsCountedAndTheFirstOfAKindWritten) {
  Notes notes;
  for (int i = 0; i < 1000; ++i) notes.complaints.Note("handshake", "no certificate", 0.001 * i);
  notes.complaints.Note("all", "there are 5 already", 1.0);
  EXPECT_EQ(notes.counted.size(), 1001U);
  EXPECT_EQ(notes.lines, (std::vector<std::string>{"connection refused: no certificate",
                                                   "connection refused: there are 5 already"}));
}

TEST(Complaints, LaterLineSaysHowManyThereWere) {
  Notes notes;
  for (int i = 0; i < 5; ++i) notes.complaints.Note("all", "full", 0.0);
  notes.complaints.Note("all", "full", Complaints::kInterval);
  ASSERT_EQ(notes.lines.size(), 2U);
  EXPECT_EQ(notes.lines[1], "connection refused: full (and 4 like it before)");
}

}  // namespace
}  // namespace ccst::server
