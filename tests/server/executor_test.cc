#include "server/base/executor.h"

#include <atomic>
#include <system_error>

#include <gtest/gtest.h>

#include "tests/server/few_threads.h"

namespace ccst::server {
namespace {

TEST(Executor, RunsWhatWaitsBeforeItEnds) {
  std::atomic<int> ran = 0;
  {
    Executor executor(3, 100);
    for (int i = 0; i < 100; ++i) executor.Run([&] { ++ran; });
  }
  EXPECT_EQ(ran, 100);
}

// Would hang where the threads there are were joined before they are told to end.
TEST(Executor, ThatCannotHaveItsThreadsThrows) {
  for (const int threads : {0, 1, 3}) {
    const int answer = WithFewThreads(threads, [] {
      try {
        const Executor executor(10, 1);
        return 2;
      } catch (const std::system_error&) {
        return 0;
      }
    });
    EXPECT_EQ(answer, 0) << threads;
  }
}

}  // namespace
}  // namespace ccst::server
