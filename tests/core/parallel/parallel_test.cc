#include "core/parallel/parallel.h"

#include <atomic>
#include <latch>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace ccst {
namespace {

TEST(Parallel, EveryPieceRunsOnce) {
  for (const int threads : {1, 2, 3, 8}) {
    const Parallel parallel(threads);
    std::vector<std::atomic<int>> runs(1000);
    parallel.For(1000, [&](std::int64_t i) { ++runs[static_cast<std::size_t>(i)]; });
    for (const std::atomic<int>& count : runs) EXPECT_EQ(count, 1);
  }
}

TEST(Parallel, NoPiecesIsNoWork) {
  const Parallel parallel(3);
  parallel.For(0, [](std::int64_t) { ADD_FAILURE(); });
}

TEST(Parallel, RangesAreCutBySizeAlone) {
  for (const int threads : {1, 2, 3, 8}) {
    std::vector<std::int64_t> ends(10, 0);
    Parallel(threads).ForRanges(10, 4, [&](std::int64_t first, std::int64_t end) {
      ends[static_cast<std::size_t>(first)] = end;
    });
    EXPECT_EQ(ends, (std::vector<std::int64_t>{4, 0, 0, 0, 8, 0, 0, 0, 10, 0}));
  }
}

TEST(Parallel, OneThreadRunsInOrder) {
  std::vector<std::int64_t> order;
  Parallel().For(5, [&](std::int64_t i) { order.push_back(i); });
  EXPECT_EQ(order, (std::vector<std::int64_t>{0, 1, 2, 3, 4}));
}

// Each piece waits for the other.
TEST(Parallel, TwoThreadsRunSideBySide) {
  if (std::thread::hardware_concurrency() < 2) GTEST_SKIP() << "one processor";
  std::latch both(2);
  Parallel(2).For(2, [&](std::int64_t) { both.arrive_and_wait(); });
  EXPECT_TRUE(both.try_wait());
}

}  // namespace
}  // namespace ccst
