#include "server/jobs/job.h"

#include <memory>
#include <new>
#include <stdexcept>
#include <thread>
#include <utility>

#include <gtest/gtest.h>

#include "core/base/status.h"
#include "server/jobs/run_job.h"
#include "tests/server/fakes.h"

namespace ccst::server {
namespace {

JobSpec Spec(std::int64_t count = 10) {
  JobSpec spec;
  spec.mesh_sha256 = "mesh";
  spec.options.sample_count = count;
  return spec;
}

std::shared_ptr<Job> NewJob(const RunDependencies& dependencies) {
  return std::make_shared<Job>("1", Spec(), dependencies.clock, PostNow());
}

// Runs a job that was taken on this thread, and ends it.
void RunToTheEnd(Job& job, const RunDependencies& dependencies) {
  Executor decoders(1, 10);
  SilentJobObserver observer;
  job.Publish(job.Seal(RunJob(job, dependencies, FakeInputs(decoders, observer))));
}

// Runs a job with `sample` on this thread.
JobView RunWith(SampleFunction sample) {
  const RunDependencies dependencies = FakeDependencies(std::move(sample));
  const auto job = NewJob(dependencies);
  EXPECT_TRUE(job->Take());
  RunToTheEnd(*job, dependencies);
  return job->View();
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
  const auto job = NewJob(dependencies);
  job->Cancel(StopCause::kCaller);
  EXPECT_EQ(job->View().state, JobState::kCancelled);
  EXPECT_FALSE(job->Take());
}

TEST(Job, CancelDuringTheRunIsNoticedOnceAndSticks) {
  const RunDependencies dependencies = FakeDependencies(nullptr);
  const auto job = NewJob(dependencies);
  RunDependencies cancelling = dependencies;
  cancelling.sample = [&](const TriangleMesh&, const SamplingOptions&,
                          const RunControl& run) -> absl::StatusOr<SamplingResult> {
    job->Cancel(StopCause::kCaller);
    job->Cancel(StopCause::kDrain);
    EXPECT_TRUE(run.stop.stop_requested());
    EXPECT_EQ(job->View().state, JobState::kCancelling);
    SamplingResult result;
    result.termination = Termination::kStopped;
    return result;
  };
  ASSERT_TRUE(job->Take());
  RunToTheEnd(*job, cancelling);
  EXPECT_EQ(job->View().state, JobState::kCancelled);
  EXPECT_EQ(job->View().stop_cause, StopCause::kCaller);
  job->Cancel(StopCause::kDrain);
  EXPECT_EQ(job->View().state, JobState::kCancelled);
}

TEST(Job, RunThatWinsTheRaceAgainstCancelSucceeds) {
  RunDependencies dependencies = FakeDependencies(nullptr);
  const auto job = NewJob(dependencies);
  dependencies.sample = [&](auto&&...) -> absl::StatusOr<SamplingResult> {
    job->Cancel(StopCause::kCaller);
    return MakeResult(10);
  };
  ASSERT_TRUE(job->Take());
  RunToTheEnd(*job, dependencies);
  EXPECT_EQ(job->View().state, JobState::kSucceeded);
}

TEST(Job, WatcherHearsOfEveryChangeAndThenOfNone) {
  const RunDependencies dependencies = FakeDependencies(QuickSampler(2));
  const auto job = NewJob(dependencies);
  int calls = 0;
  const auto watcher = *job->AddWatcher([&] { ++calls; }, 0, 1);
  job->SetQueuePosition(2);
  job->SetQueuePosition(2);
  EXPECT_EQ(calls, 1);
  ASSERT_TRUE(job->Take());
  job->RemoveWatcher(watcher);
  const int before = calls;
  RunToTheEnd(*job, dependencies);
  EXPECT_EQ(calls, before);
}

TEST(Job, HasAtMostSoManyWatchers) {
  const RunDependencies dependencies = FakeDependencies(QuickSampler());
  const auto job = NewJob(dependencies);
  const auto first = job->AddWatcher([] {}, 0, 1);
  ASSERT_TRUE(first.has_value());
  EXPECT_FALSE(job->AddWatcher([] {}, 0, 1).has_value());
  EXPECT_EQ(job->UnwatchedSeconds(), 0.0);
  job->RemoveWatcher(*first);
  EXPECT_GT(job->UnwatchedSeconds(), 0.0);
  EXPECT_TRUE(job->AddWatcher([] {}, 0, 1).has_value());
}

TEST(Job, CancelAfterTheEndWasDecidedChangesNothing) {
  const RunDependencies dependencies = FakeDependencies(QuickSampler());
  const auto job = NewJob(dependencies);
  ASSERT_TRUE(job->Take());
  JobResult result;
  JobView end = job->Seal(std::move(result));
  EXPECT_FALSE(job->Cancel(StopCause::kCaller));
  EXPECT_EQ(job->View().state, JobState::kRunning);
  job->Publish(std::move(end));
  EXPECT_EQ(job->View().state, JobState::kSucceeded);
}

TEST(Job, StopDuringDecodingLeavesTheDecoderBehind) {
  Gate decoding;
  Gate go;
  RunDependencies dependencies = FakeDependencies(QuickSampler());
  dependencies.decode = [&](std::span<const char>,
                            const MeshLimits&) -> absl::StatusOr<TriangleMesh> {
    decoding.Open();
    go.Wait();
    return TriangleMesh();
  };
  const auto job = NewJob(dependencies);
  ASSERT_TRUE(job->Take());
  Executor decoders(1, 10);
  SilentJobObserver observer;
  auto grant = std::make_shared<int>(0);
  RunInputs inputs = FakeInputs(decoders, observer);
  inputs.source.grant = grant;
  std::jthread canceller([&] {
    decoding.Wait();
    job->Cancel(StopCause::kCaller);
  });
  EXPECT_TRUE(absl::IsCancelled(RunJob(*job, dependencies, inputs).status()));
  inputs.source.grant = nullptr;
  EXPECT_GT(grant.use_count(), 1) << "what is left behind must count as memory in use";
  go.Open();
}

TEST(Job, PreviewIsThinnedOutAndTheLatest) {
  const RunDependencies dependencies = FakeDependencies(nullptr);
  const auto job = NewJob(dependencies);
  job->AddWatcher([] {}, 3, 2);
  job->AddWatcher([] {}, 4, 2);
  ASSERT_TRUE(job->Take());
  const SamplingResult result = MakeResult(10);
  for (int i = 1; i <= 3; ++i) {
    AlternationReport report;
    report.alternation = i;
    report.positions = result.samples.positions;
    job->AddReport(report);
  }
  ASSERT_NE(job->Preview(), nullptr);
  EXPECT_EQ(job->Preview()->alternation, 3);
  ASSERT_EQ(job->Preview()->positions.size(), 12U);
  EXPECT_EQ(job->Preview()->positions[3], 2.0F);
  EXPECT_EQ(job->Report(2)->alternation, 3);
  EXPECT_FALSE(job->Report(3).has_value());
}

absl::Status FullDisk() {
  return MakeError(absl::StatusCode::kResourceExhausted, ErrorReason::kStorageFull, "full");
}

TEST(Job, PutOffWaitsAndStartsAnewAndSaysWhy) {
  const RunDependencies dependencies = FakeDependencies(nullptr);
  const auto job = NewJob(dependencies);
  for (int count = 1; count <= 2; ++count) {
    ASSERT_TRUE(job->Take());
    EXPECT_TRUE(job->View().error.ok());
    job->AddPhase(Phase::kRelaxing);
    AlternationReport report;
    report.alternation = 1;
    job->AddReport(report);
    if (count == 2) job->Seal(JobResult());
    const std::int64_t before = job->Version();
    EXPECT_EQ(job->PutOff(FullDisk()), count);
    EXPECT_GT(job->Version(), before);
    const JobView view = job->View();
    EXPECT_EQ(view.state, JobState::kQueued);
    EXPECT_EQ(view.error, FullDisk());
    EXPECT_FALSE(view.start_time.has_value());
    EXPECT_FALSE(view.last_report.has_value());
    EXPECT_TRUE(job->Reports().empty());
  }
  ASSERT_TRUE(job->Take());
  job->Publish(job->Seal(JobResult()));
  EXPECT_EQ(job->View().state, JobState::kSucceeded);
}

TEST(Job, PutOffJobCanBeCancelled) {
  const RunDependencies dependencies = FakeDependencies(nullptr);
  const auto job = NewJob(dependencies);
  ASSERT_TRUE(job->Take());
  job->PutOff(FullDisk());
  EXPECT_TRUE(job->Cancel(StopCause::kCaller));
  EXPECT_EQ(job->View().state, JobState::kCancelled);
  EXPECT_FALSE(job->Take());
}

TEST(Job, CancelAfterTheEndIsDecidedCountsWhereTheEndIsGivenUp) {
  const RunDependencies dependencies = FakeDependencies(nullptr);
  for (const StopCause cause : {StopCause::kCaller, StopCause::kAbandoned, StopCause::kDrain}) {
    const auto job = NewJob(dependencies);
    ASSERT_TRUE(job->Take());
    EXPECT_EQ(job->Seal(JobResult()).state, JobState::kSucceeded);
    EXPECT_FALSE(job->Cancel(cause));
    EXPECT_EQ(job->PutOff(FullDisk()), 0);
    job->Publish(job->Seal(absl::CancelledError("stopped")));
    EXPECT_EQ(job->View().state, JobState::kCancelled);
    EXPECT_EQ(job->View().stop_cause, cause);
    EXPECT_EQ(IsPutBack(job->spec(), job->View()), cause == StopCause::kDrain);
  }
}

}  // namespace
}  // namespace ccst::server
