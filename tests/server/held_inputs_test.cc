#include "server/jobs/held_inputs.h"

#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace ccst::server {
namespace {

TEST(HeldInputs, TakeTheBytesAndReadAsABlob) {
  HeldInputs inputs(1600);
  std::string bytes = "some bytes";
  const auto held = inputs.Hold("digest", bytes);
  ASSERT_NE(held, nullptr);
  EXPECT_EQ(held->sha256, "digest");
  EXPECT_EQ(held->bytes, "some bytes");
  const auto blob = HeldInput::AsBlob(held);
  EXPECT_EQ(blob->size_bytes(), 10);
  std::string read(5, '\0');
  ASSERT_TRUE(blob->Read(5, read).ok());
  EXPECT_EQ(read, "bytes");
}

TEST(HeldInputs, OneMayHaveASixteenthOfAll) {
  HeldInputs inputs(1600);
  std::string fits(100, 'x');
  std::string does_not(101, 'x');
  EXPECT_NE(inputs.Hold("fits", fits), nullptr);
  EXPECT_EQ(inputs.Hold("does not", does_not), nullptr);
  EXPECT_EQ(does_not.size(), 101u);
}

TEST(HeldInputs, RoomComesBackWithTheLastCopy) {
  HeldInputs inputs(160);
  std::vector<std::shared_ptr<const HeldInput>> held;
  for (int i = 0; i < 16; ++i) {
    std::string bytes(10, 'x');
    held.push_back(inputs.Hold("digest", bytes));
    ASSERT_NE(held.back(), nullptr);
  }
  std::string more(10, 'x');
  const auto copy = held.back();
  held.pop_back();
  EXPECT_EQ(inputs.Hold("digest", more), nullptr);
  held.pop_back();
  EXPECT_NE(inputs.Hold("digest", more), nullptr);
}

TEST(HeldInputs, MayOutliveWhatHoldsThem) {
  std::shared_ptr<const HeldInput> held;
  {
    HeldInputs inputs(160);
    std::string bytes = "x";
    held = inputs.Hold("digest", bytes);
  }
  EXPECT_EQ(held->bytes, "x");
}

}  // namespace
}  // namespace ccst::server
