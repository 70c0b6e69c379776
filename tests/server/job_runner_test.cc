#include "server/jobs/job_runner.h"

#include <atomic>
#include <cstdint>
#include <fstream>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "core/base/limit_error.h"
#include "core/base/status.h"
#include "tests/server/fakes.h"

namespace ccst::server {
namespace {

// Runs of jobs that wait for `go`, or for being stopped.
class Jobs {
 public:
  std::shared_ptr<Job> Make(const std::string& share = "a", bool ends_with_caller = true) {
    JobSpec spec;
    spec.share = share;
    spec.ends_with_caller = ends_with_caller;
    spec.options.sample_count = 10;
    return std::make_shared<Job>(std::to_string(++last_), spec, clock_, PostNow());
  }

  JobRunner::Run Run(Gate& started, Gate& go) {
    return [&started, &go, this](const std::shared_ptr<Job>& job, std::shared_ptr<void>) {
      {
        const std::lock_guard lock(mutex_);
        order_.push_back(job->spec().share);
      }
      started.Open();
      absl::StatusOr<JobResult> outcome = JobResult();
      if (!go.WaitOrStop(job->stop_token())) outcome = absl::CancelledError("stopped");
      job->Publish(job->Seal(std::move(outcome)));
    };
  }

  std::vector<std::string> order() {
    const std::lock_guard lock(mutex_);
    return order_;
  }

 private:
  const Clock clock_ = FakeDependencies(nullptr).clock;
  int last_ = 0;
  std::mutex mutex_;
  std::vector<std::string> order_;
};

// One worker that a first job keeps busy until `go`.
class BusyRunner : public testing::Test {
 protected:
  void Occupy(int queued, int queued_per_caller = 100, std::int64_t memory = 100) {
    budget_ = std::make_shared<MemoryBudget>(memory);
    runner_ =
        std::make_unique<JobRunner>(RunnerOptions{.max_running_jobs = 1,
                                                  .max_queued_jobs = queued,
                                                  .max_queued_jobs_per_caller = queued_per_caller},
                                    budget_, jobs_.Run(started_, go_));
    first_ = Add("first");
    started_.Wait();
  }

  std::shared_ptr<Job> Add(const std::string& share = "a", bool ends_with_caller = true,
                           std::int64_t memory = 1) {
    auto place = runner_->Reserve(share);
    EXPECT_TRUE(place.ok()) << place.status();
    auto job = jobs_.Make(share, ends_with_caller);
    runner_->Enqueue(*std::move(place), job, memory);
    return job;
  }

  Jobs jobs_;
  Gate started_;
  Gate go_;
  std::shared_ptr<MemoryBudget> budget_;
  std::unique_ptr<JobRunner> runner_;
  std::shared_ptr<Job> first_;
};

TEST_F(BusyRunner, WaitingJobTakesOnePlace) {
  Occupy(2);
  const auto job = jobs_.Make();
  // One expression: what is handed to Enqueue() may live to its end.
  const bool room = (runner_->Enqueue(*runner_->Reserve("a"), job, 1), runner_->Reserve("b").ok());
  EXPECT_TRUE(room);
  go_.Open();
}

TEST_F(BusyRunner, WaitingJobsKnowTheirPosition) {
  Occupy(3);
  const auto a = Add();
  const auto b = Add();
  const auto c = Add();
  EXPECT_EQ(a->View().queue_position, 0);
  EXPECT_EQ(c->View().queue_position, 2);
  EXPECT_EQ(runner_->Load().queued, 3);
  EXPECT_EQ(runner_->Load().running, 1);
  runner_->Cancel(*a, StopCause::kCaller);
  EXPECT_EQ(a->View().state, JobState::kCancelled);
  EXPECT_EQ(b->View().queue_position, 0);
  EXPECT_EQ(c->View().queue_position, 1);
  go_.Open();
}

TEST_F(BusyRunner, FullQueueRefusesUntilAPlaceIsFree) {
  Occupy(1);
  const auto waiting = Add();
  const auto refused = runner_->Reserve("b");
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.status().code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(GetErrorReason(refused.status()), ErrorReason::kQueueFull);
  ASSERT_TRUE(GetPassedLimit(refused.status()).has_value());
  EXPECT_EQ(GetPassedLimit(refused.status())->name, "max_queued_jobs");
  runner_->Cancel(*waiting, StopCause::kCaller);
  EXPECT_TRUE(runner_->Reserve("b").ok());
  go_.Open();
}

TEST_F(BusyRunner, UnusedPlacesAreGivenBack) {
  Occupy(1);
  for (int i = 0; i < 10; ++i) EXPECT_TRUE(runner_->Reserve("a").ok());
  const auto held = runner_->Reserve("a");
  EXPECT_FALSE(runner_->Reserve("b").ok());
  go_.Open();
}

TEST_F(BusyRunner, OneCallerCannotTakeAllPlaces) {
  Occupy(10, 2);
  for (int i = 0; i < 3; ++i) Add("greedy");
  const absl::Status refused = runner_->Reserve("greedy").status();
  EXPECT_EQ(GetErrorReason(refused), ErrorReason::kQuotaExceeded);
  ASSERT_TRUE(GetPassedLimit(refused).has_value());
  EXPECT_EQ(GetPassedLimit(refused)->name, "max_queued_jobs_per_caller");
  EXPECT_EQ(GetPassedLimit(refused)->value, 2);
  EXPECT_TRUE(runner_->Reserve("other").ok());
  go_.Open();
}

TEST_F(BusyRunner, CallersTakeTurns) {
  Occupy(20);
  for (int i = 0; i < 5; ++i) Add("many");
  Add("few");
  const auto last = Add("few");
  EXPECT_EQ(last->View().queue_position, 3);
  go_.Open();
  EXPECT_TRUE(runner_->WaitUntilIdle(absl::InfiniteDuration()));
  EXPECT_EQ(jobs_.order(), (std::vector<std::string>{"first", "many", "few", "many", "few", "many",
                                                     "many", "many"}));
}

TEST_F(BusyRunner, DrainingFinishesCallersJobsAndPutsOthersBack) {
  Occupy(3);
  const auto callers = Add("a", true);
  const auto durable = Add("a", false);
  runner_->StartDraining();
  EXPECT_EQ(GetErrorReason(runner_->Reserve("a").status()), ErrorReason::kDraining);
  EXPECT_EQ(durable->View().stop_cause, StopCause::kDrain);
  go_.Open();
  EXPECT_TRUE(runner_->WaitUntilIdle(absl::InfiniteDuration()));
  EXPECT_EQ(first_->View().state, JobState::kSucceeded);
  EXPECT_EQ(callers->View().state, JobState::kSucceeded);
  EXPECT_EQ(jobs_.order().size(), 2U);
}

TEST_F(BusyRunner, HeldJobsCountAsWaitingAndRunOnceReleased) {
  Occupy(3, 1);
  const auto held = jobs_.Make("greedy");
  runner_->Hold({.job = held, .memory_bytes = 1});
  EXPECT_EQ(runner_->Load().queued, 1);
  Add("greedy");
  EXPECT_EQ(GetErrorReason(runner_->Reserve("greedy").status()), ErrorReason::kQuotaExceeded);
  Add("other");
  EXPECT_EQ(GetErrorReason(runner_->Reserve("third").status()), ErrorReason::kQueueFull);
  go_.Open();
  ASSERT_TRUE(runner_->WaitUntilIdle(absl::InfiniteDuration()));
  EXPECT_EQ(held->View().state, JobState::kQueued);
  runner_->Release(*held);
  ASSERT_TRUE(runner_->WaitUntilIdle(absl::InfiniteDuration()));
  EXPECT_EQ(held->View().state, JobState::kSucceeded);
  runner_->Release(*held);
  EXPECT_EQ(runner_->Load().queued, 0);
}

TEST_F(BusyRunner, HeldJobsAreCancelledAndPutBackAsThoseThatWait) {
  Occupy(5);
  const auto cancelled = jobs_.Make("a", false);
  const auto drained = jobs_.Make("a", false);
  const auto late = jobs_.Make("a", false);
  const auto gone = jobs_.Make("a", false);
  runner_->Hold({.job = cancelled, .memory_bytes = 1});
  runner_->Hold({.job = drained, .memory_bytes = 1});
  EXPECT_TRUE(runner_->Cancel(*cancelled, StopCause::kCaller));
  EXPECT_EQ(cancelled->View().state, JobState::kCancelled);
  ASSERT_TRUE(gone->Cancel(StopCause::kCaller));
  runner_->Hold({.job = gone, .memory_bytes = 1});
  EXPECT_EQ(runner_->Load().queued, 1);
  runner_->StartDraining();
  EXPECT_TRUE(IsPutBack(drained->spec(), drained->View()));
  runner_->Hold({.job = late, .memory_bytes = 1});
  EXPECT_TRUE(IsPutBack(late->spec(), late->View()));
  EXPECT_EQ(runner_->Load().queued, 0);
  go_.Open();
}

TEST(JobRunner, JobThatMustRunAloneDoes) {
  std::atomic<int> now = 0;
  std::atomic<int> beside = 0;
  Jobs jobs;
  JobRunner runner({.max_running_jobs = 3, .max_queued_jobs = 100},
                   std::make_shared<MemoryBudget>(100),
                   [&](const std::shared_ptr<Job>& job, std::shared_ptr<void>) {
                     const bool alone = job->spec().share == "suspect";
                     if (++now > 1 && alone) ++beside;
                     for (int i = 0; i < 100; ++i) {
                       std::this_thread::yield();
                       if (alone && now > 1) ++beside;
                     }
                     --now;
                     job->Publish(job->Seal(JobResult()));
                   });
  std::vector<std::shared_ptr<Job>> all;
  for (int i = 0; i < 30; ++i) {
    all.push_back(jobs.Make());
    runner.Enqueue(*runner.Reserve("a"), all.back(), 1);
    if (i % 5 != 0) continue;
    all.push_back(jobs.Make("suspect"));
    runner.Hold({.job = all.back(), .memory_bytes = 1, .alone = true});
    runner.Release(*all.back());
  }
  ASSERT_TRUE(runner.WaitUntilIdle(absl::InfiniteDuration()));
  EXPECT_EQ(beside, 0);
  for (const auto& job : all) EXPECT_EQ(job->View().state, JobState::kSucceeded);
}

TEST_F(BusyRunner, StopAllEndsRunningAndWaitingJobs) {
  Occupy(2);
  const auto waiting = Add();
  runner_->StopAll();
  EXPECT_TRUE(runner_->WaitUntilIdle(absl::InfiniteDuration()));
  EXPECT_EQ(first_->View().state, JobState::kCancelled);
  EXPECT_EQ(waiting->View().state, JobState::kCancelled);
  EXPECT_EQ(waiting->View().stop_cause, StopCause::kDrain);
}

TEST_F(BusyRunner, DestructionStopsWhatRuns) {
  Occupy(2);
  const auto waiting = Add();
  runner_.reset();
  EXPECT_TRUE(HasEnded(first_->View().state));
  EXPECT_TRUE(HasEnded(waiting->View().state));
}

TEST(JobRunner, StaysWithinItsWorkersAndItsMemory) {
  std::atomic<int> now = 0;
  std::atomic<int> most = 0;
  const auto budget = std::make_shared<MemoryBudget>(20);
  Jobs jobs;
  JobRunner runner({.max_running_jobs = 3, .max_queued_jobs = 100}, budget,
                   [&](const std::shared_ptr<Job>& job, std::shared_ptr<void> grant) {
                     int seen = most.load();
                     const int current = ++now;
                     while (current > seen && !most.compare_exchange_weak(seen, current)) {
                     }
                     EXPECT_LE(budget->used_bytes(), 20);
                     std::this_thread::yield();
                     --now;
                     grant = nullptr;
                     job->Publish(job->Seal(JobResult()));
                   });
  std::vector<std::shared_ptr<Job>> all;
  for (int i = 0; i < 100; ++i) {
    all.push_back(jobs.Make());
    // Two fit at once, three do not.
    runner.Enqueue(*runner.Reserve("a"), all.back(), 10);
  }
  EXPECT_TRUE(runner.WaitUntilIdle(absl::InfiniteDuration()));
  EXPECT_LE(most.load(), 2);
  EXPECT_EQ(budget->used_bytes(), 0);
  for (const auto& job : all) EXPECT_EQ(job->View().state, JobState::kSucceeded);
}

TEST(MemoryBudget, TakeWithinWaitsUntilThereIsEnough) {
  const auto budget = std::make_shared<MemoryBudget>(20);
  std::shared_ptr<void> first = budget->Take(10);
  EXPECT_EQ(budget->TakeWithin(absl::ZeroDuration(), 11), nullptr);
  std::jthread other([&] {
    const std::shared_ptr<void> second = budget->TakeWithin(absl::Hours(1), 11);
    EXPECT_EQ(budget->used_bytes(), 11);
  });
  first = nullptr;
  other.join();
  EXPECT_EQ(budget->used_bytes(), 0);
}

TEST(MemoryBudget, LargeGrantsAreReturnedToTheSystem) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "the sanitizer's allocator keeps what was freed";
#endif
  const auto resident_pages = [] {
    long size = 0;
    long resident = 0;
    std::ifstream("/proc/self/statm") >> size >> resident;
    return resident;
  };
  const auto budget = std::make_shared<MemoryBudget>(std::int64_t{1} << 30);
  std::shared_ptr<void> grant = budget->Take(std::int64_t{64} << 20);
  // Small pieces, which the allocator keeps; the last one is in the way of giving back from the
  // end alone.
  std::vector<std::unique_ptr<char[]>> pieces;
  for (int i = 0; i < 64 * 1024; ++i) pieces.push_back(std::make_unique<char[]>(1000));
  const std::unique_ptr<char[]> last = std::move(pieces.back());
  const long used = resident_pages();
  pieces.clear();
  grant = nullptr;
  EXPECT_LT(resident_pages(), used - (32 << 20) / sysconf(_SC_PAGESIZE));
}

}  // namespace
}  // namespace ccst::server
