#include "server/jobs/job.h"

#include <new>
#include <stdexcept>

#include <gtest/gtest.h>

#include "core/base/status.h"
#include "server/jobs/run_job.h"
#include "tests/server/fakes.h"

namespace ccst::server {
namespace {

JobSpec Spec(std::int64_t count = 10, int preview = 0) {
  JobSpec spec;
  spec.mesh = "mesh";
  spec.options.sample_count = count;
  spec.preview_sample_count = preview;
  return spec;
}

// Runs a job with `sample` on this thread.
JobView RunWith(SampleFunction sample) {
  const RunDependencies dependencies = FakeDependencies(std::move(sample));
  Job job("jobs/1", Spec(), dependencies.clock);
  EXPECT_TRUE(job.Take());
  RunJob(job, dependencies);
  return job.View();
}

TEST(Job, WholeRunSucceedsWithItsFigures) {
  const JobView view = RunWith(QuickSampler(3));
  EXPECT_EQ(view.state, JobState::kSucceeded);
  ASSERT_NE(view.result, nullptr);
  EXPECT_EQ(view.result->samples_sha256, "digest");
  EXPECT_EQ(view.result->samples_bytes, 15 + 16 + 10 * 20 + 10 * 12);
  EXPECT_GT(view.result->queue_seconds, 0.0);
  EXPECT_GT(view.result->decode_seconds, 0.0);
  EXPECT_GT(view.result->total_seconds, view.result->decode_seconds);
  EXPECT_EQ(view.last_report->alternation, 3);
  EXPECT_TRUE(view.last_report->positions.empty());
  EXPECT_TRUE(view.end_time.has_value());
}

TEST(Job, RefusalKeepsItsReason) {
  const JobView view = RunWith([](auto&&...) {
    return MakeError(absl::StatusCode::kFailedPrecondition, ErrorReason::kMeshNotManifold, "no");
  });
  EXPECT_EQ(view.state, JobState::kFailed);
  EXPECT_EQ(GetErrorReason(view.error), ErrorReason::kMeshNotManifold);
}

TEST(Job, ExceptionsEndTheJobNotTheWorker) {
  EXPECT_EQ(GetErrorReason(RunWith([](auto&&...) -> absl::StatusOr<SamplingResult> {
                             throw std::bad_alloc();
                           }).error),
            ErrorReason::kOutOfMemory);
  const absl::Status broken = RunWith([](auto&&...) -> absl::StatusOr<SamplingResult> {
                                throw std::runtime_error("division");
                              }).error;
  EXPECT_EQ(GetErrorReason(broken), ErrorReason::kInternal);
  EXPECT_NE(broken.message().find("division"), absl::string_view::npos);
  EXPECT_EQ(
      GetErrorReason(RunWith([](auto&&...) -> absl::StatusOr<SamplingResult> { throw 1; }).error),
      ErrorReason::kInternal);
}

TEST(Job, StoppingUnaskedIsAFault) {
  const JobView view = RunWith([](auto&&...) -> absl::StatusOr<SamplingResult> {
    SamplingResult result;
    result.termination = Termination::kStopped;
    return result;
  });
  EXPECT_EQ(view.state, JobState::kFailed);
  EXPECT_EQ(GetErrorReason(view.error), ErrorReason::kInternal);
}

TEST(Job, CancelBeforeTheRunSkipsIt) {
  const RunDependencies dependencies = FakeDependencies(QuickSampler());
  Job job("jobs/1", Spec(), dependencies.clock);
  job.Cancel(StopCause::kCaller);
  EXPECT_EQ(job.View().state, JobState::kCancelled);
  EXPECT_FALSE(job.Take());
  EXPECT_TRUE(job.TakeMesh().empty());
}

TEST(Job, CancelDuringTheRunIsNoticedOnceAndSticks) {
  const RunDependencies dependencies = FakeDependencies(nullptr);
  Job job("jobs/1", Spec(), dependencies.clock);
  RunDependencies cancelling = dependencies;
  cancelling.sample = [&](const TriangleMesh&, const SamplingOptions&,
                          const RunControl& run) -> absl::StatusOr<SamplingResult> {
    job.Cancel(StopCause::kCaller);
    job.Cancel(StopCause::kDrain);
    EXPECT_TRUE(run.stop.stop_requested());
    EXPECT_EQ(job.View().state, JobState::kCancelling);
    SamplingResult result;
    result.termination = Termination::kStopped;
    return result;
  };
  ASSERT_TRUE(job.Take());
  RunJob(job, cancelling);
  EXPECT_EQ(job.View().state, JobState::kCancelled);
  EXPECT_EQ(job.View().stop_cause, StopCause::kCaller);
  job.Cancel(StopCause::kDrain);
  EXPECT_EQ(job.View().state, JobState::kCancelled);
}

TEST(Job, RunThatWinsTheRaceAgainstCancelSucceeds) {
  RunDependencies dependencies = FakeDependencies(nullptr);
  Job job("jobs/1", Spec(), dependencies.clock);
  dependencies.sample = [&](auto&&...) -> absl::StatusOr<SamplingResult> {
    job.Cancel(StopCause::kCaller);
    return MakeResult(10);
  };
  ASSERT_TRUE(job.Take());
  RunJob(job, dependencies);
  EXPECT_EQ(job.View().state, JobState::kSucceeded);
}

TEST(Job, WatcherHearsOfEveryChangeAndThenOfNone) {
  const RunDependencies dependencies = FakeDependencies(QuickSampler(2));
  Job job("jobs/1", Spec(), dependencies.clock);
  int calls = 0;
  job.SetWatcher([&] { ++calls; });
  job.SetQueuePosition(2);
  job.SetQueuePosition(2);
  EXPECT_EQ(calls, 1);
  ASSERT_TRUE(job.Take());
  job.SetWatcher(nullptr);
  const int before = calls;
  RunJob(job, dependencies);
  EXPECT_EQ(calls, before);
}

TEST(Job, PreviewIsThinnedOutAndTheLatest) {
  const RunDependencies dependencies = FakeDependencies(nullptr);
  Job job("jobs/1", Spec(10, 4), dependencies.clock);
  ASSERT_TRUE(job.Take());
  const SamplingResult result = MakeResult(10);
  for (int i = 1; i <= 3; ++i) {
    AlternationReport report;
    report.alternation = i;
    report.positions = result.samples.positions;
    job.AddReport(report);
  }
  ASSERT_NE(job.Preview(), nullptr);
  EXPECT_EQ(job.Preview()->alternation, 3);
  ASSERT_EQ(job.Preview()->positions.size(), 12U);
  EXPECT_EQ(job.Preview()->positions[3], 2.0F);
  EXPECT_EQ(job.Report(2)->alternation, 3);
  EXPECT_FALSE(job.Report(3).has_value());
}

}  // namespace
}  // namespace ccst::server
