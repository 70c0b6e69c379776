#include "core/base/assert.h"

#include <gtest/gtest.h>

namespace ccst {
namespace {

TEST(Assertions, WhatHoldsGoesOn) {
  CCST_ASSERT(1 + 1 == 2);
  CCST_ASSERT_NO_FAULT(std::string());
}

TEST(Assertions, AreNotEvaluatedWhereTheyAreOff) {
  int looked = 0;
  CCST_ASSERT(++looked > 0);
  const auto find_fault = [&] {
    ++looked;
    return std::string();
  };
  CCST_ASSERT_NO_FAULT(find_fault());
  EXPECT_EQ(looked, kAssertions ? 2 : 0);
}

TEST(AssertionsDeathTest, EndTheProgramWithWhatDoesNotHold) {
  const auto break_both = [](bool first) {
    if (first) CCST_ASSERT(1 + 1 == 3);
    CCST_ASSERT_NO_FAULT(std::string("a twin is missing"));
  };
  if (kAssertions) {
    EXPECT_DEATH(break_both(true), "assert_test.cc:[0-9]+: .*: 1 \\+ 1 == 3");
    EXPECT_DEATH(break_both(false), "a twin is missing");
  } else {
    break_both(true);
  }
}

}  // namespace
}  // namespace ccst
