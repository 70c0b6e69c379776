#include <cstdio>
#include <cstdlib>
#include <memory>
#include <random>
#include <set>
#include <sstream>
#include <string>

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/server/store/store_fixture.h"

namespace ccst::server {
namespace {

// The job a child process adds in its `step`th step, and what belongs to it.
JobRecord JobOf(int round, int step) {
  JobRecord job = SomeJob(std::to_string(round) + "-" + std::to_string(step), At(step));
  job.mesh_sha256.clear();
  job.texture_sha256.clear();
  return job;
}
std::string SamplesOf(const JobRecord& job) { return "samples of " + job.id; }
std::string HistoryOf(const JobRecord& job) { return std::string(10000, 'h') + job.id; }

// Adds and ends jobs until the process is killed; writes a line to `pipe` after every call that
// was acknowledged.
[[noreturn]] void WorkUntilKilled(const std::string& directory, int round, int pipe) {
  const auto say = [pipe](const std::string& line) {
    if (write(pipe, line.data(), line.size()) < 0) _exit(2);
  };
  auto store = OpenEmbeddedStore(directory);
  if (!store.ok()) _exit(3);
  say("open\n");
  for (int step = 0;; ++step) {
    const JobRecord job = JobOf(round, step);
    if (!(*store)->AddJob(job).ok()) _exit(4);
    say("added " + job.id + "\n");
    if (!PutWhole((*store)->blobs(), SamplesOf(job)).ok()) _exit(5);
    if (!(*store)->EndJob(Ended(job), HistoryOf(job)).ok()) _exit(6);
    say("ended " + job.id + "\n");
  }
}

// Runs a child until it has said `line_count` lines and `microseconds` more; gives all it said.
std::string KillAfter(const std::string& directory, int round, int line_count, int microseconds) {
  int ends[2];
  if (pipe(ends) != 0) std::abort();
  const pid_t child = fork();
  if (child == 0) WorkUntilKilled(directory, round, ends[1]);
  close(ends[1]);
  std::string said;
  char c = 0;
  while (line_count > 0 && read(ends[0], &c, 1) == 1) {
    said += c;
    if (c == '\n') --line_count;
  }
  usleep(microseconds);
  kill(child, SIGKILL);
  while (read(ends[0], &c, 1) == 1) said += c;
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_TRUE(WIFSIGNALED(status)) << "the child gave up with " << WEXITSTATUS(status);
  return said;
}

TEST(Crash, NothingAcknowledgedIsLostAndNothingIsHalf) {
  const TestFolder folder(testing::TempDir());
  std::mt19937 random(3);
  std::set<std::string> added;
  std::set<std::string> ended;
  for (int round = 0; round < 50; ++round) {
    const int line_count = 1 + static_cast<int>(random() % 8);
    // Where in a step the kill falls; steps take some milliseconds.
    const int microseconds = static_cast<int>(random() % 8000);
    std::istringstream said(KillAfter(folder.path(), round, line_count, microseconds));
    for (std::string verb, id; said >> verb;) {
      if (verb == "open") continue;
      said >> id;
      (verb == "added" ? added : ended).insert(id);
    }

    auto store = OpenEmbeddedStore(folder.path());
    ASSERT_TRUE(store.ok()) << store.status();
    std::set<std::string> stored;
    std::size_t ended_count = 0;
    const Page<JobRecord> page = *(*store)->ListJobs({}, 100000, "");
    for (const JobRecord& job : page.records) {
      stored.insert(job.id);
      // Whole, whether acknowledged or not.
      int job_round = 0;
      int step = 0;
      ASSERT_EQ(sscanf(job.id.c_str(), "%d-%d", &job_round, &step), 2);
      const JobRecord expected = JobOf(job_round, step);
      if (HasEnded(job.state)) {
        ++ended_count;
        ExpectSame(job, Ended(expected));
        EXPECT_EQ(*(*store)->GetHistory(job.id), HistoryOf(job));
        EXPECT_EQ(*ReadWhole((*store)->blobs(), job.samples_sha256), SamplesOf(job));
      } else {
        ExpectSame(job, expected);
        EXPECT_EQ(ended.count(job.id), 0) << job.id << " is not ended any more";
        EXPECT_EQ(*(*store)->GetHistory(job.id), "");
      }
    }
    for (const std::string& id : added) EXPECT_EQ(stored.count(id), 1) << id << " is lost";
    // Blobs of jobs that were not ended are gone.
    EXPECT_EQ((*store)->blobs().List()->size(), ended_count);
  }
  EXPECT_GT(ended.size(), 50);
}

TEST(Crash, AKilledProcessLeavesNoLock) {
  const TestFolder folder;
  KillAfter(folder.path(), 0, 1, 0);
  EXPECT_TRUE(OpenEmbeddedStore(folder.path()).ok());
}

TEST(Crash, ASecondProcessIsLockedOutWhileTheFirstLives) {
  const TestFolder folder;
  const auto store = OpenEmbeddedStore(folder.path());
  ASSERT_TRUE(store.ok());
  const pid_t child = fork();
  if (child == 0) {
    const auto second = OpenEmbeddedStore(folder.path());
    _exit(second.status().code() == absl::StatusCode::kFailedPrecondition ? 0 : 1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

}  // namespace
}  // namespace ccst::server
