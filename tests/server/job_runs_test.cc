// Jobs over a store that fails, and over processes that die.
#include "server/jobs/job_runs.h"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <memory>
#include <new>
#include <span>
#include <string>
#include <string_view>
#include <thread>

#include <gtest/gtest.h>

#include "core/base/status.h"
#include "tests/server/job_manager_fixture.h"

namespace ccst::server {
namespace {

using JobRunsTest = JobManagerTest;

TEST_F(JobRunsTest, ResultThatTheStoreDoesNotTakeWaitsAndIsComputedAgain) {
  const absl::Status broken =
      MakeError(absl::StatusCode::kInternal, ErrorReason::kStorageFailed, "broken");
  std::uint64_t seed = 0;
  for (const std::string_view call : {"CountStart", "NewBlob", "Append", "Commit", "EndJob"}) {
    for (const absl::Status& error : {FullDisk(), broken}) {
      Start(QuickSampler(3));
      const JobSpec spec = Spec(++seed);
      store_->before = Failing(call, error);
      const std::string id = Create(spec)->id();
      jobs_->WaitUntilIdle(absl::InfiniteDuration());
      for (int i = 0; i < 20; ++i) {
        ASSERT_TRUE(jobs_->Sweep().ok());
        jobs_->WaitUntilIdle(absl::InfiniteDuration());
      }
      const JobView waiting = (*jobs_->Find("", id))->View();
      EXPECT_EQ(waiting.state, JobState::kQueued) << call;
      EXPECT_EQ(waiting.error, error) << call;
      EXPECT_EQ(jobs_->Load().queued, 1) << call;
      EXPECT_EQ((*store_->GetJob(id))->starts, 0) << call;
      store_->before = AllIsWell;
      const JobView end = SweepUntil(id, JobState::kSucceeded);
      EXPECT_TRUE(end.error.ok());
      const auto job = *jobs_->Find("", id);
      EXPECT_EQ(job->Reports().size(), 3U);
      EXPECT_TRUE(jobs_->OpenSamples(*job).ok());
      EXPECT_NE(lines().find(job->name()), std::string::npos);
      ASSERT_TRUE(jobs_->Delete("", id).ok());
    }
  }
  EXPECT_TRUE(store_->blobs().List()->empty());
}

TEST_F(JobRunsTest, StoreThatRunsOutOfMemoryFailsNoJob) {
  Start(QuickSampler());
  const JobSpec spec = Spec();
  store_->before = [](std::string_view call) -> absl::Status {
    if (call == "Append") throw std::bad_alloc();
    return absl::OkStatus();
  };
  const std::string id = Create(spec)->id();
  EXPECT_EQ(Finish(id).state, JobState::kQueued);
  store_->before = AllIsWell;
  SweepUntil(id, JobState::kSucceeded);
}

// It is written down on a thread of which nobody takes exceptions.
TEST_F(JobRunsTest, EndThatDoesNotFitTheMemoryIsStoredLater) {
  std::atomic<bool> is_short = true;
  Start(QuickSampler());
  store_->before = [&is_short](std::string_view call) -> absl::Status {
    if (is_short && call == "EndJob") throw std::bad_alloc();
    return absl::OkStatus();
  };
  const std::string id = Create(Spec())->id();
  EXPECT_FALSE(HasEnded(Finish(id).state));
  is_short = false;
  SweepUntil(id, JobState::kSucceeded);
  Start(QuickSampler());
  EXPECT_EQ((*jobs_->Find("", id))->View().state, JobState::kSucceeded);
}

TEST_F(JobRunsTest, InputThatTheStoreDoesNotOpenForNowIsReadLater) {
  Gate go;
  Start(GatedSampler(started_, go));
  const std::string first = Create(Spec(1))->id();
  started_.Wait();
  const std::string second = Create(Spec(2))->id();
  store_->before = Failing("Open", MakeError(absl::StatusCode::kResourceExhausted,
                                             ErrorReason::kQueueFull, "too many open files"));
  go.Open();
  EXPECT_EQ(Finish(first).state, JobState::kSucceeded);
  EXPECT_EQ(Finish(second).state, JobState::kQueued);
  store_->before = AllIsWell;
  SweepUntil(second, JobState::kSucceeded);
}

TEST_F(JobRunsTest, DamagedInputFailsItsJob) {
  Gate go;
  Start(GatedSampler(started_, go));
  Create(Spec(1));
  started_.Wait();
  const std::string second = Create(Spec(2))->id();
  store_->before = Failing(
      "Open", MakeError(absl::StatusCode::kInternal, ErrorReason::kStorageFailed, "damaged"));
  go.Open();
  EXPECT_EQ(Finish(second).state, JobState::kFailed);
}

TEST_F(JobRunsTest, JobThatWaitsForTheStoreCanBeCancelledAndAbandoned) {
  Start(QuickSampler());
  const JobSpec watched = Spec(1);
  JobSpec unwatched = Spec(2);
  unwatched.abandon_seconds = 0.5;  // The clock of this test moves a second a look.
  store_->before = Failing("NewBlob", FullDisk());
  const auto cancelled = Create(watched);
  const auto abandoned = Create(unwatched);
  jobs_->WaitUntilIdle(absl::InfiniteDuration());
  ASSERT_EQ(cancelled->View().state, JobState::kQueued);
  ASSERT_TRUE(jobs_->Cancel(cancelled, StopCause::kCaller).ok());
  EXPECT_EQ(cancelled->View().state, JobState::kCancelled);
  ASSERT_TRUE(jobs_->Sweep().ok());
  EXPECT_EQ(abandoned->View().state, JobState::kCancelled);
  EXPECT_EQ(jobs_->Load().queued, 0);
  EXPECT_TRUE(store_->UnfinishedJobs()->empty());
}

TEST_F(JobRunsTest, CancelWhileTheResultIsRefusedCancels) {
  Start(QuickSampler());
  const JobSpec spec = Spec();
  std::shared_ptr<Job> job;
  Gate created;
  store_->before = [&](std::string_view call) {
    if (call != "Commit") return absl::OkStatus();
    created.Wait();
    EXPECT_TRUE(jobs_->Cancel(job, StopCause::kCaller).ok());
    return FullDisk();
  };
  job = Create(spec);
  created.Open();
  EXPECT_EQ(Finish(job->id()).state, JobState::kCancelled);
  EXPECT_TRUE(store_->UnfinishedJobs()->empty());
}

TEST_F(JobRunsTest, DrainLeavesWhatWaitsForTheStoreToTheNextStart) {
  Start(QuickSampler());
  const JobSpec spec = Spec();
  store_->before = Failing("NewBlob", FullDisk());
  const auto job = Create(spec);
  jobs_->WaitUntilIdle(absl::InfiniteDuration());
  jobs_->StartDraining();
  EXPECT_TRUE(IsPutBack(job->spec(), job->View()));
  EXPECT_TRUE(jobs_->WaitUntilIdle(absl::InfiniteDuration()));
  Start(QuickSampler());
  EXPECT_EQ(Finish(job->id()).state, JobState::kSucceeded);
}

TEST_F(JobRunsTest, JobThatEndsWithItsCallerFailsAsTheStoreDoes) {
  Start(QuickSampler());
  JobSpec spec = Spec();
  spec.ends_with_caller = true;
  for (const std::string_view call : {"NewBlob", "Commit"}) {
    store_->before = Failing(call, FullDisk());
    const JobView end = Finish(Create(spec)->id());
    EXPECT_EQ(end.state, JobState::kFailed);
    EXPECT_EQ(GetErrorReason(end.error), ErrorReason::kStorageFull);
  }
  EXPECT_TRUE(store_->UnfinishedJobs()->empty());
}

TEST_F(JobRunsTest, EndThatTheDiskDoesNotTakeIsStoredLater) {
  Start([](auto&&...) -> absl::StatusOr<SamplingResult> {
    return absl::InvalidArgumentError("broken mesh");
  });
  store_->before = Failing("EndJob", FullDisk());
  const std::string id = Create(Spec())->id();
  EXPECT_EQ(Finish(id).state, JobState::kFailed);
  EXPECT_EQ(GetErrorReason(jobs_->Delete("", id)), ErrorReason::kStorageFull);
  EXPECT_FALSE(jobs_->Sweep().ok());
  EXPECT_EQ(store_->UnfinishedJobs()->size(), 1U);
  store_->before = AllIsWell;
  EXPECT_TRUE(jobs_->Sweep().ok());
  EXPECT_TRUE(store_->UnfinishedJobs()->empty());
  EXPECT_EQ((*jobs_->Find("", id))->View().state, JobState::kFailed);
  EXPECT_TRUE(jobs_->Delete("", id).ok());
}

TEST_F(JobRunsTest, SweepGoesOnAfterAnErrorAndSaysIt) {
  Start(QuickSampler());
  for (std::uint64_t seed = 0; seed < 3; ++seed) Finish(Create(Spec(seed))->id());
  now_ += absl::Hours(25);
  store_->before = Failing("DropExpiredJobs", FullDisk());
  EXPECT_EQ(jobs_->Sweep(), FullDisk());
  EXPECT_EQ(jobs_->List({}, 10, "")->records.size(), 3U);
  int removals = 0;
  store_->before = [&](std::string_view call) {
    return call == "Remove" && ++removals == 1 ? FullDisk() : absl::OkStatus();
  };
  EXPECT_EQ(jobs_->Sweep(), FullDisk());
  EXPECT_GT(removals, 1);
  EXPECT_TRUE(jobs_->List({}, 10, "")->records.empty());
  EXPECT_TRUE(jobs_->Sweep().ok());
}

TEST_F(JobRunsTest, SweepDropsWhatExpiredWhereAnEndCannotBeStored) {
  Start([](auto&&...) -> absl::StatusOr<SamplingResult> {
    return absl::InvalidArgumentError("broken mesh");
  });
  const std::string expired = Create(Spec(1))->id();
  Finish(expired);
  now_ += absl::Hours(25);
  store_->before = Failing("EndJob", FullDisk());
  Finish(Create(Spec(2))->id());
  EXPECT_EQ(jobs_->Sweep(), FullDisk());
  EXPECT_TRUE(absl::IsNotFound(jobs_->Find("", expired).status()));
}

TEST_F(JobRunsTest, StartsWhereNoEndCanBeStored) {
  Start(GatedSampler(started_, never_));
  const auto cancelled = Create(Spec());
  started_.Wait();
  JobSpec spec = Spec(1);
  spec.ends_with_caller = true;
  const std::string with_caller = Create(spec)->id();
  ASSERT_TRUE(jobs_->Cancel(cancelled, StopCause::kCaller).ok());
  Die();
  before_start_ = Failing("EndJob", FullDisk());
  Start(QuickSampler());
  EXPECT_EQ((*jobs_->Find("", cancelled->id()))->View().state, JobState::kCancelled);
  EXPECT_EQ((*jobs_->Find("", with_caller))->View().state, JobState::kCancelled);
  store_->before = AllIsWell;
  ASSERT_TRUE(jobs_->Sweep().ok());
  EXPECT_TRUE(store_->UnfinishedJobs()->empty());
}

TEST_F(JobRunsTest, JobOfWhichTheProcessDiedTwiceIsFailed) {
  std::string id;
  for (int death = 1; death <= 2; ++death) {
    Gate running;
    Start(GatedSampler(running, never_));
    if (death == 1) id = Create(Spec())->id();
    if (death == 2) {
      // It waits a little, then runs again.
      EXPECT_EQ((*jobs_->Find("", id))->View().state, JobState::kQueued);
      EXPECT_NE(lines().find("jobs/" + id), std::string::npos);
      for (int i = 0; i < 10; ++i) jobs_->Resume();
    }
    running.Wait();
    EXPECT_EQ((*store_->GetJob(id))->starts, death);
    Die();
  }
  lines_.clear();
  Start(QuickSampler());
  const JobView end = Finish(id);
  EXPECT_EQ(end.state, JobState::kFailed);
  EXPECT_EQ(GetErrorReason(end.error), ErrorReason::kInternal);
  EXPECT_NE(end.error.message().find("died 2 times while it ran"), std::string::npos);
  EXPECT_NE(lines().find("jobs/" + id + " is FAILED"), std::string::npos);
  // For good.
  Start(QuickSampler());
  EXPECT_EQ(Finish(id).state, JobState::kFailed);
}

TEST_F(JobRunsTest, JobThatRunsWellAfterADeathSucceeds) {
  Start(GatedSampler(started_, never_));
  const std::string id = Create(Spec())->id();
  started_.Wait();
  Die();
  Start(QuickSampler());
  SweepUntil(id, JobState::kSucceeded);
}

TEST_F(JobRunsTest, DeathWhileAJobWaitsIsNotItsFault) {
  Start(GatedSampler(started_, never_));
  Create(Spec(1));
  const std::string waiting = Create(Spec(2))->id();
  started_.Wait();
  EXPECT_EQ((*store_->GetJob(waiting))->starts, 0);
  Die();
  Start(QuickSampler());
  EXPECT_EQ(Finish(waiting).state, JobState::kSucceeded);
}

TEST_F(JobRunsTest, OrderlyStopsAreNotCounted) {
  std::string id;
  for (int i = 0; i < 4; ++i) {
    Gate running;
    Start(GatedSampler(running, never_));
    if (i == 0) id = Create(Spec())->id();
    running.Wait();
  }
  Start(QuickSampler());
  EXPECT_EQ(Finish(id).state, JobState::kSucceeded);
}

TEST_F(JobRunsTest, DeathDuringADrainIsNotCounted) {
  Start(GatedSampler(started_, never_));
  const std::string id = Create(Spec())->id();
  started_.Wait();
  EXPECT_EQ((*store_->GetJob(id))->starts, 1);
  jobs_->StartDraining();
  EXPECT_EQ((*store_->GetJob(id))->starts, 0);  // Before the next start counts it again.
  Die();
  Start(QuickSampler());
  EXPECT_EQ(Finish(id).state, JobState::kSucceeded);
}

TEST_F(JobRunsTest, SuspectsOfADeathRunAloneOneAfterTheOther) {
  JobManagerOptions options;
  options.runner.max_running_jobs = 3;
  Gate second;
  std::atomic<int> running = 0;
  Start(
      [&](const TriangleMesh&, const SamplingOptions&,
          const RunControl& run) -> absl::StatusOr<SamplingResult> {
        if (++running == 2) second.Open();
        EXPECT_FALSE(never_.WaitOrStop(run.stop));
        return absl::CancelledError("stopped");
      },
      options);
  const std::string first = Create(Spec(1))->id();
  const std::string other = Create(Spec(2))->id();
  second.Wait();
  Die();
  std::atomic<int> now = 0;
  std::atomic<int> most = 0;
  Start(
      [&](const TriangleMesh&, const SamplingOptions& sampling,
          const RunControl&) -> absl::StatusOr<SamplingResult> {
        const int current = ++now;
        most = std::max(most.load(), current);
        for (int i = 0; i < 100; ++i) std::this_thread::yield();
        --now;
        return MakeResult(sampling.sample_count);
      },
      options);
  SweepUntil(first, JobState::kSucceeded);
  SweepUntil(other, JobState::kSucceeded);
  EXPECT_EQ(most, 1);
}

}  // namespace
}  // namespace ccst::server
