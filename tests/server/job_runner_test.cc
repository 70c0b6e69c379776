#include "server/jobs/job_runner.h"

#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/status.h"
#include "tests/server/fakes.h"

namespace ccst::server {
namespace {

JobSpec Spec(std::string mesh = "mesh") {
  JobSpec spec;
  spec.mesh = std::move(mesh);
  spec.options.sample_count = 10;
  return spec;
}

// One worker that a first job keeps busy until `go`.
class BusyRunner : public testing::Test {
 protected:
  void Occupy(int queued, std::int64_t bytes = 1 << 20) {
    runner_ = std::make_unique<JobRunner>(
        RunnerOptions{.max_running_jobs = 1, .max_queued_jobs = queued, .max_queued_bytes = bytes},
        FakeDependencies(GatedSampler(started_, go_)), CountingIds());
    first_ = *runner_->Submit(Spec());
    started_.Wait();
  }

  Gate started_;
  Gate go_;
  std::unique_ptr<JobRunner> runner_;
  std::shared_ptr<Job> first_;
};

TEST_F(BusyRunner, WaitingJobsKnowTheirPosition) {
  Occupy(3);
  const auto a = *runner_->Submit(Spec());
  const auto b = *runner_->Submit(Spec());
  const auto c = *runner_->Submit(Spec());
  EXPECT_EQ(a->View().queue_position, 0);
  EXPECT_EQ(c->View().queue_position, 2);
  EXPECT_EQ(runner_->Load().queued, 3);
  EXPECT_EQ(runner_->Load().running, 1);
  runner_->Cancel(*a, StopCause::kCaller);
  EXPECT_EQ(a->View().state, JobState::kCancelled);
  EXPECT_EQ(b->View().queue_position, 0);
  EXPECT_EQ(c->View().queue_position, 1);
}

TEST_F(BusyRunner, FullQueueRefusesUntilAPlaceIsFree) {
  Occupy(1);
  const auto waiting = *runner_->Submit(Spec());
  const auto refused = runner_->Submit(Spec());
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.status().code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(GetErrorReason(refused.status()), ErrorReason::kQueueFull);
  runner_->Release(*waiting);
  EXPECT_TRUE(runner_->Submit(Spec()).ok());
}

TEST_F(BusyRunner, WaitingBytesAreBounded) {
  Occupy(10, 10);
  ASSERT_TRUE(runner_->Submit(Spec("123456")).ok());
  EXPECT_EQ(GetErrorReason(runner_->Submit(Spec("123456")).status()), ErrorReason::kQueueFull);
  EXPECT_TRUE(runner_->Submit(Spec("1234")).ok());
}

TEST_F(BusyRunner, UnreadResultsKeepTheirPlace) {
  Occupy(0);
  go_.Open();
  EXPECT_FALSE(runner_->WaitUntilIdle(absl::ZeroDuration()));
  EXPECT_EQ(GetErrorReason(runner_->Submit(Spec()).status()), ErrorReason::kQueueFull);
  runner_->Release(*first_);
  EXPECT_TRUE(runner_->WaitUntilIdle(absl::InfiniteDuration()));
  EXPECT_TRUE(runner_->Submit(Spec()).ok());
}

TEST_F(BusyRunner, DrainingRefusesNewJobsAndFinishesOldOnes) {
  Occupy(2);
  const auto waiting = *runner_->Submit(Spec());
  runner_->StartDraining();
  const auto refused = runner_->Submit(Spec());
  EXPECT_EQ(refused.status().code(), absl::StatusCode::kUnavailable);
  EXPECT_EQ(GetErrorReason(refused.status()), ErrorReason::kDraining);
  Gate ended;
  waiting->SetWatcher([&] {
    if (HasEnded(waiting->View().state)) ended.Open();
  });
  go_.Open();
  ended.Wait();
  EXPECT_EQ(first_->View().state, JobState::kSucceeded);
  EXPECT_EQ(waiting->View().state, JobState::kSucceeded);
  runner_->Release(*first_);
  runner_->Release(*waiting);
  EXPECT_TRUE(runner_->WaitUntilIdle(absl::InfiniteDuration()));
}

TEST_F(BusyRunner, StopAllEndsRunningAndWaitingJobs) {
  Occupy(2);
  const auto waiting = *runner_->Submit(Spec());
  Gate ended;
  first_->SetWatcher([&] {
    if (HasEnded(first_->View().state)) ended.Open();
  });
  runner_->StopAll();
  ended.Wait();
  EXPECT_EQ(first_->View().state, JobState::kCancelled);
  EXPECT_EQ(waiting->View().state, JobState::kCancelled);
  EXPECT_EQ(waiting->View().stop_cause, StopCause::kDrain);
}

TEST_F(BusyRunner, DestructionStopsWhatRuns) {
  Occupy(2);
  const auto waiting = *runner_->Submit(Spec());
  runner_.reset();
  EXPECT_TRUE(HasEnded(first_->View().state));
  EXPECT_TRUE(HasEnded(waiting->View().state));
}

TEST(JobRunner, AtMostSoManyRunAtOnce) {
  std::atomic<int> now = 0;
  std::atomic<int> most = 0;
  const SampleFunction quick = QuickSampler();
  JobRunner runner({.max_running_jobs = 3, .max_queued_jobs = 100, .max_queued_bytes = 1 << 20},
                   FakeDependencies([&](const TriangleMesh& mesh, const SamplingOptions& options,
                                        const RunControl& run) {
                     const int current = ++now;
                     int seen = most.load();
                     while (current > seen && !most.compare_exchange_weak(seen, current)) {
                     }
                     auto result = quick(mesh, options, run);
                     --now;
                     return result;
                   }),
                   CountingIds());
  std::vector<std::shared_ptr<Job>> jobs;
  std::vector<std::unique_ptr<Gate>> ended;
  for (int i = 0; i < 100; ++i) {
    jobs.push_back(*runner.Submit(Spec()));
    Job* job = jobs.back().get();
    Gate* gate = ended.emplace_back(std::make_unique<Gate>()).get();
    job->SetWatcher([job, gate] {
      if (HasEnded(job->View().state)) gate->Open();
    });
    if (HasEnded(job->View().state)) gate->Open();
  }
  for (const auto& gate : ended) gate->Wait();
  for (const auto& job : jobs) {
    EXPECT_EQ(job->View().state, JobState::kSucceeded);
    runner.Release(*job);
  }
  EXPECT_LE(most.load(), 3);
  EXPECT_TRUE(runner.WaitUntilIdle(absl::InfiniteDuration()));
}

}  // namespace
}  // namespace ccst::server
