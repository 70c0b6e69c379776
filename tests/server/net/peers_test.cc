#include "server/auth/peers.h"

#include <set>

#include <gtest/gtest.h>

namespace ccst::server {
namespace {

TEST(Peers, AreFoundByNameAsLongAsTheyAreThere) {
  Peers peers;
  auto alice = peers.Add({.address = "10.0.0.1"});
  const auto bob = peers.Add({.address = "10.0.0.2"});
  const std::string name = alice->name();
  ASSERT_NE(peers.Find(name), nullptr);
  EXPECT_EQ(peers.Find(name)->address, "10.0.0.1");
  EXPECT_EQ(peers.Find(bob->name())->address, "10.0.0.2");
  alice.reset();
  EXPECT_EQ(peers.Find(name), nullptr);
  EXPECT_EQ(peers.Find(""), nullptr);
  EXPECT_EQ(peers.Find("ccst-1"), nullptr);
}

TEST(Peers, NamesFitASocketAndAreGivenOutOnce) {
  Peers peers;
  std::set<std::string> names;
  for (int i = 0; i < 1000; ++i) {
    const auto entry = peers.Add({.address = "a"});
    EXPECT_LT(entry->name().size(), 64U);
    EXPECT_TRUE(names.insert(entry->name()).second);
  }
}

}  // namespace
}  // namespace ccst::server
