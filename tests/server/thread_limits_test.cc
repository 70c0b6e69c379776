#include "server/app/thread_limits.h"

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <system_error>

#include <gtest/gtest.h>

#include "tests/server/few_threads.h"
#include "tests/server/test_server.h"

namespace ccst::server {
namespace {

namespace fs = std::filesystem;

// Control groups as files.
class ControlGroup : public testing::Test {
 protected:
  void Group(const std::string& path, const std::string& limit, int used) {
    fs::create_directories(folder_.Path("root" + path));
    folder_.Write("root" + path + "/pids.max", limit + "\n");
    folder_.Write("root" + path + "/pids.current", std::to_string(used) + "\n");
  }
  std::optional<std::int64_t> Left(const std::string& groups) {
    return ThreadsLeftInControlGroup(folder_.Write("cgroup", groups), folder_.Path("root"));
  }

  TempFolder folder_;
};

TEST_F(ControlGroup, ContainerSeesItsLimit) {
  Group("", "512", 3);
  EXPECT_EQ(Left("0::/\n"), 509);
}

TEST_F(ControlGroup, SmallestLimitOfTheGroupsAboveHolds) {
  Group("/system.slice", "100", 60);
  Group("/system.slice/ccst.service", "80", 10);
  EXPECT_EQ(Left("0::/system.slice/ccst.service\n"), 40);
  Group("/system.slice", "max", 60);
  EXPECT_EQ(Left("0::/system.slice/ccst.service\n"), 70);
  Group("/system.slice/ccst.service", "80", 90);
  EXPECT_EQ(Left("0::/system.slice/ccst.service\n"), 0);
}

TEST_F(ControlGroup, FirstVersionHasAFolderForTheLimit) {
  Group("/pids/docker/7", "64", 4);
  EXPECT_EQ(Left("12:cpu,cpuacct:/docker/7\n9:pids:/docker/7\n"), 60);
}

TEST_F(ControlGroup, WithoutALimitThereIsNone) {
  Group("", "max", 3);
  EXPECT_EQ(Left("0::/\n"), std::nullopt);
  EXPECT_EQ(Left("0::/elsewhere\n"), std::nullopt);
  EXPECT_EQ(Left("nonsense\n"), std::nullopt);
  EXPECT_EQ(Left(""), std::nullopt);
  EXPECT_EQ(ThreadsLeftInControlGroup(folder_.Path("missing"), folder_.Path("root")), std::nullopt);
}

ServerOptions WithJobs(int jobs) {
  ServerOptions options;
  options.runner.max_running_jobs = jobs;
  return options;
}

TEST(ThreadLimits, JobsCostOneThreadEachInTheEnd) {
  EXPECT_EQ(ThreadsOf(WithJobs(500)) - ThreadsOf(WithJobs(300)), 200);
}

TEST(ThreadLimits, JobsFitTheThreadsThereAre) {
  for (const int threads : {1, 30, 64, 100, 512, 10'000}) {
    const int jobs = MaxRunningJobsWithin(WithJobs(1), threads);
    if (jobs > 0) {
      EXPECT_LE(ThreadsOf(WithJobs(jobs)), threads);
    }
    if (jobs < kMaxRunningJobs) {
      EXPECT_GT(ThreadsOf(WithJobs(jobs + 1)), threads);
    }
  }
  EXPECT_EQ(MaxRunningJobsWithin(WithJobs(1), 1), 0);
  EXPECT_EQ(MaxRunningJobsWithin(WithJobs(1), 10'000), kMaxRunningJobs);
}

TEST(ThreadLimits, ThreadsThatThereAreSuffice) { EXPECT_TRUE(CheckThreads(50).ok()); }

TEST(ThreadLimits, TooFewThreadsAreAnErrorInWords) {
  for (const int threads : {0, 1, 5}) {
    const int answer = WithFewThreads(threads, [] {
      const absl::Status status = CheckThreads(50);
      const std::string message(status.message());
      const bool says_so = absl::IsResourceExhausted(status) &&
                           message.find("may need 50 threads") != std::string::npos &&
                           message.find("--max-running-jobs") != std::string::npos;
      return says_so ? 0 : 1;
    });
    EXPECT_EQ(answer, 0) << threads;
  }
}

// Would hang where the workers there are were joined before they are told to end.
TEST(ThreadLimits, RunnerThatCannotHaveItsWorkersThrows) {
  const int answer = WithFewThreads(2, [] {
    try {
      const JobRunner runner({.max_running_jobs = 10}, std::make_shared<MemoryBudget>(1),
                             [](const auto& /*job*/, const auto& /*grant*/) {});
      return 2;
    } catch (const std::system_error&) {
      return 0;
    }
  });
  EXPECT_EQ(answer, 0);
}

int ThreadsOfThisProcess() {
  int count = 0;
  for ([[maybe_unused]] const auto& task : fs::directory_iterator("/proc/self/task")) ++count;
  return count;
}

TEST(ThreadLimits, AServerHasNoMoreThreadsThanItSays) {
  const int before = ThreadsOfThisProcess();
  for (const int jobs : {1, 40}) {
    ServerOptions options = WithJobs(jobs);
    options.metrics_listen = "127.0.0.1:0";
    TestServer server(QuickSampler(), options);
    for (int i = 0; i < 20; ++i) Sample(server.sampling(), Request());
    EXPECT_LE(ThreadsOfThisProcess() - before, ThreadsOf(options)) << jobs;
  }
}

}  // namespace
}  // namespace ccst::server
