#include "core/base/field_count.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace ccst {
namespace {

enum class Colour { kRed };

struct Empty {};
struct Inner {
  Colour colour = Colour::kRed;
  int number = 0;
};
struct Outer {
  bool flag = false;
  Inner inner;
  std::optional<double> limit;
  std::optional<int> number;
  std::string text;
  std::shared_ptr<const Inner> shared;
  std::vector<int> list;
  const char* pointer = nullptr;
  double last = 1.0;
};

TEST(FieldCount, CountsFieldsOfEveryKindAndNotThoseWithin) {
  EXPECT_EQ(FieldCount<Empty>(), 0U);
  EXPECT_EQ(FieldCount<Inner>(), 2U);
  EXPECT_EQ(FieldCount<Outer>(), 9U);
}

}  // namespace
}  // namespace ccst
