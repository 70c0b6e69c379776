#include "core/density/share_out.h"

#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

namespace ccst {
namespace {

TEST(ShareOut, LargestRemaindersGetTheRest) {
  // Exact shares of 10: 4.6, 3.3, 2.1.
  EXPECT_EQ(ShareOut(10, {4.6, 3.3, 2.1}), (std::vector<std::int64_t>{5, 3, 2}));
  EXPECT_EQ(ShareOut(4, {1.0, 1.0, 1.0}), (std::vector<std::int64_t>{2, 1, 1}));
  EXPECT_EQ(ShareOut(2, {1.0, 0.0, 1.0, 1.0}), (std::vector<std::int64_t>{1, 0, 1, 0}));
}

TEST(ShareOut, SumsToTheCountForAwkwardSizes) {
  std::vector<double> sizes;
  for (int i = 0; i < 1000; ++i) sizes.push_back(std::pow(10.0, i % 17 - 8) / 3.0);
  for (const std::int64_t count : {4, 999, 123457}) {
    const std::vector<std::int64_t> shares = ShareOut(count, sizes);
    EXPECT_EQ(std::accumulate(shares.begin(), shares.end(), std::int64_t{0}), count);
  }
}

}  // namespace
}  // namespace ccst
