#include "core/base/index.h"

#include <type_traits>
#include <vector>

#include <gtest/gtest.h>

namespace ccst {
namespace {

using Apple = Index<struct AppleTag>;
using Pear = Index<struct PearTag>;

TEST(Index, IsNoneByDefault) { EXPECT_EQ(Apple(), -1); }

TEST(Index, IsANumberForSubscripts) {
  const std::vector<int> weights = {10, 20, 30};
  EXPECT_EQ(weights[Apple(2)], 30);
  EXPECT_EQ(3 * Apple(4) + 1, 13);
}

TEST(Index, NumbersAndOtherKindsAreNotTakenForIt) {
  static_assert(!std::is_convertible_v<std::int32_t, Apple>);
  static_assert(!std::is_convertible_v<Pear, Apple>);
  static_assert(std::is_convertible_v<Apple, std::int32_t>);
}

TEST(Index, TakesNoMoreRoomThanTheNumber) {
  static_assert(sizeof(Apple) == sizeof(std::int32_t));
  static_assert(std::is_trivially_copyable_v<Apple>);
}

}  // namespace
}  // namespace ccst
