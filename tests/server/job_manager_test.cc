// Jobs over a real store: what survives, what is reused, what is dropped.
#include "server/jobs/job_manager.h"

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/limit_error.h"
#include "core/base/status.h"
#include "server/store/sqlite.h"
#include "tests/server/job_manager_fixture.h"

namespace ccst::server {
namespace {

TEST_F(JobManagerTest, EndedJobsAreReadBackAfterARestart) {
  Start(QuickSampler(3));
  JobSpec spec = Spec();
  spec.display_name = "bunny";
  spec.labels = {{"team", "a"}};
  const std::string id = Create(spec)->id();
  const JobView before = Finish(id);
  EXPECT_EQ(before.state, JobState::kSucceeded);
  Start(QuickSampler());
  const auto job = *jobs_->Find("", id);
  const JobView after = job->View();
  EXPECT_EQ(after.state, JobState::kSucceeded);
  EXPECT_EQ(after.result->samples_sha256, before.result->samples_sha256);
  EXPECT_EQ(job->Reports().size(), 3U);
  EXPECT_EQ(job->spec().display_name, "bunny");
  const auto samples = jobs_->OpenSamples(*job);
  ASSERT_TRUE(samples.ok()) << samples.status();
  EXPECT_EQ(samples->ReadSamples(0, 10)->faces[9], 9);
}

TEST_F(JobManagerTest, UnfinishedJobsAreRunByTheNextStart) {
  Start(GatedSampler(started_, never_));
  const std::string running = Create(Spec(1))->id();
  const std::string waiting = Create(Spec(2))->id();
  started_.Wait();
  Start(QuickSampler());
  EXPECT_EQ(Finish(running).state, JobState::kSucceeded);
  EXPECT_EQ(Finish(waiting).state, JobState::kSucceeded);
}

TEST_F(JobManagerTest, JobsOfCallersEndWithTheServer) {
  Start(GatedSampler(started_, never_));
  JobSpec spec = Spec();
  spec.ends_with_caller = true;
  const std::string id = Create(spec)->id();
  started_.Wait();
  Start(QuickSampler());
  EXPECT_EQ(Finish(id).state, JobState::kCancelled);
}

TEST_F(JobManagerTest, CancelledJobsStayCancelled) {
  Start(GatedSampler(started_, never_));
  const auto running = Create(Spec(1));
  started_.Wait();
  const auto waiting = Create(Spec(2));
  ASSERT_TRUE(jobs_->Cancel(running, StopCause::kCaller).ok());
  ASSERT_TRUE(jobs_->Cancel(waiting, StopCause::kCaller).ok());
  EXPECT_EQ(Finish(running->id()).state, JobState::kCancelled);
  Start(QuickSampler());
  EXPECT_EQ(Finish(running->id()).state, JobState::kCancelled);
  EXPECT_EQ(Finish(waiting->id()).state, JobState::kCancelled);
}

TEST_F(JobManagerTest, CancelIsStoredBeforeTheRunLearnsOfIt) {
  JobState stored = JobState::kQueued;
  std::string id;
  Start([&](const TriangleMesh&, const SamplingOptions&,
            const RunControl& run) -> absl::StatusOr<SamplingResult> {
    started_.Open();
    EXPECT_FALSE(never_.WaitOrStop(run.stop));
    stored = (*store_->GetJob(id))->state;
    return absl::CancelledError("stopped");
  });
  const auto job = Create(Spec());
  id = job->id();
  started_.Wait();
  ASSERT_TRUE(jobs_->Cancel(job, StopCause::kCaller).ok());
  EXPECT_EQ(Finish(id).state, JobState::kCancelled);
  EXPECT_EQ(stored, JobState::kCancelling);
}

TEST_F(JobManagerTest, CancelledBeforeACrashIsNotRunAgain) {
  Start(GatedSampler(started_, never_));
  const std::string id = Create(Spec())->id();
  started_.Wait();
  Stop();
  // What a crash leaves of a job whose cancel was answered with CANCELLING.
  ASSERT_TRUE((*OpenEmbeddedStore(folder_.Path("data")))->MarkCancelling(id).ok());
  Start(QuickSampler());
  EXPECT_EQ(Finish(id).state, JobState::kCancelled);
}

TEST_F(JobManagerTest, RunThatIsWholeBeforeItSeesTheCancelSucceedsForGood) {
  Gate cancelled;
  Start([&](const TriangleMesh&, const SamplingOptions& options,
            const RunControl&) -> absl::StatusOr<SamplingResult> {
    started_.Open();
    cancelled.Wait();
    return MakeResult(options.sample_count);
  });
  const auto job = Create(Spec());
  started_.Wait();
  ASSERT_TRUE(jobs_->Cancel(job, StopCause::kCaller).ok());
  EXPECT_EQ(job->View().state, JobState::kCancelling);
  cancelled.Open();
  EXPECT_EQ(Finish(job->id()).state, JobState::kSucceeded);
  Start(QuickSampler());
  EXPECT_EQ(Finish(job->id()).state, JobState::kSucceeded);
}

TEST_F(JobManagerTest, CancelOfAJobThatADrainStopsIsForGood) {
  Start(GatedSampler(started_, never_));
  const auto running = Create(Spec(1));
  started_.Wait();
  const auto waiting = Create(Spec(2));
  jobs_->StartDraining();
  EXPECT_TRUE(IsPutBack(waiting->spec(), waiting->View()));
  EXPECT_FALSE(IsPutBack(running->spec(), running->View()));
  ASSERT_TRUE(jobs_->Cancel(waiting, StopCause::kCaller).ok());
  EXPECT_FALSE(IsPutBack(waiting->spec(), waiting->View()));
  jobs_->StopAll();
  ASSERT_TRUE(jobs_->WaitUntilIdle(absl::InfiniteDuration()));
  EXPECT_TRUE(IsPutBack(running->spec(), running->View()));
  // Whoever still holds it may cancel it, too.
  ASSERT_TRUE(jobs_->Cancel(running, StopCause::kCaller).ok());
  Start(QuickSampler());
  EXPECT_EQ(Finish(waiting->id()).state, JobState::kCancelled);
  EXPECT_EQ(Finish(running->id()).state, JobState::kCancelled);
}

TEST_F(JobManagerTest, DamagedJobFailsAndOthersRun) {
  Start(GatedSampler(started_, never_));
  const std::string damaged = Create(Spec(1))->id();
  const std::string whole = Create(Spec(2))->id();
  started_.Wait();
  Stop();
  {
    const auto database = *Database::Open(folder_.Path("data") + "/records.sqlite");
    ASSERT_TRUE(database
                    ->RunScript("UPDATE jobs SET definition = CAST('x' AS BLOB) WHERE id = '" +
                                damaged + "'")
                    .ok());
  }
  Start(QuickSampler());
  EXPECT_EQ(Finish(whole).state, JobState::kSucceeded);
  EXPECT_EQ(GetErrorReason(jobs_->Find("", damaged).status()), ErrorReason::kStorageFailed);
  JobFilter filter;
  filter.states = {JobState::kFailed};
  const auto failed = *jobs_->List(filter, 10, "");
  ASSERT_EQ(failed.records.size(), 1U);
  EXPECT_EQ(failed.records.front().id, damaged);
  EXPECT_EQ(GetErrorReason(failed.records.front().view.error), ErrorReason::kStorageFailed);
}

TEST_F(JobManagerTest, JobWhoseSamplesCouldNeverFitTheDiskLimitIsRefusedForGood) {
  max_blob_bytes_ = 1000;
  Start(QuickSampler());
  JobSpec spec = Spec();
  spec.options.sample_count = 20;
  const auto refused = jobs_->Create(spec);
  EXPECT_TRUE(absl::IsInvalidArgument(refused.status()));
  EXPECT_EQ(GetErrorReason(refused.status()), ErrorReason::kLimitExceeded);
}

TEST_F(JobManagerTest, ObserverIsToldWhoStoppedJobsAndWhatWasReused) {
  Start(GatedSampler(started_, never_));
  const auto cancelled = Create(Spec(1));
  started_.Wait();
  ASSERT_TRUE(jobs_->Cancel(cancelled, StopCause::kCaller).ok());
  ASSERT_TRUE(jobs_->Cancel(cancelled, StopCause::kCaller).ok());  // Counts once.
  Finish(cancelled->id());
  JobSpec hasty = Spec(2);
  hasty.abandon_seconds = 0.5;  // The clock of this test moves a second a look.
  Create(hasty);
  ASSERT_TRUE(jobs_->Sweep().ok());
  Create(Spec(3));
  jobs_->StopAll();
  EXPECT_EQ(observer_.cancels,
            (std::map<std::string, int>{{"abandoned", 1}, {"caller", 1}, {"drain", 1}}));
  Start(QuickSampler());
  Finish(Create(Spec(4))->id());
  observer_.hits = observer_.misses = 0;
  Create(Spec(4));
  Create(Spec(5));
  EXPECT_EQ(observer_.hits, 1);
  EXPECT_EQ(observer_.misses, 1);
}

TEST_F(JobManagerTest, MemoryAndWatchersAreCountedWhileTheyLast) {
  const auto budget = std::make_shared<MemoryBudget>(std::int64_t{4} << 30);
  budget_ = budget;
  Start(GatedSampler(started_, never_));
  const auto job = Create(Spec());
  started_.Wait();
  EXPECT_GT(jobs_->memory().used_bytes(), 0);
  const std::int64_t watcher = *jobs_->Watch(
      *job, [] {}, 0);
  EXPECT_EQ(jobs_->watcher_count(), 1);
  jobs_->Unwatch(*job, watcher);
  EXPECT_EQ(jobs_->watcher_count(), 0);
  ASSERT_TRUE(jobs_->Cancel(job, StopCause::kCaller).ok());
  ASSERT_TRUE(jobs_->WaitUntilIdle(absl::InfiniteDuration()));
  jobs_ = nullptr;  // Whatever still stores the end has let go of it then.
  EXPECT_EQ(budget->used_bytes(), 0);
}

TEST_F(JobManagerTest, EqualSpecsShareTheResultButNotTheJob) {
  Start(QuickSampler(3));
  const std::string first = Create(Spec())->id();
  Finish(first);
  const auto second = Create(Spec());
  EXPECT_NE(second->id(), first);
  EXPECT_TRUE(second->View().cached);
  EXPECT_EQ(second->View().state, JobState::kSucceeded);
  EXPECT_EQ(second->Reports().size(), 3U);
  // The samples stay as long as one of the two does.
  ASSERT_TRUE(jobs_->Delete("", first).ok());
  EXPECT_TRUE(jobs_->OpenSamples(*second).ok());
  JobSpec fresh = Spec();
  fresh.skip_cache_lookup = true;
  EXPECT_FALSE(Create(fresh)->View().cached);
}

TEST_F(JobManagerTest, TimeLimitedResultsAreNotReused) {
  Start([](const TriangleMesh&, const SamplingOptions& options,
           const RunControl&) -> absl::StatusOr<SamplingResult> {
    SamplingResult result = MakeResult(options.sample_count);
    result.termination = Termination::kTimeLimit;
    return result;
  });
  Finish(Create(Spec())->id());
  EXPECT_FALSE(Create(Spec())->View().cached);
}

TEST_F(JobManagerTest, SameRequestIdIsTheSameJob) {
  Start(QuickSampler());
  JobSpec spec = Spec();
  spec.request_id = "once";
  const std::string id = Create(spec)->id();
  EXPECT_EQ(Create(spec)->id(), id);
  spec.owner = "somebody else";
  EXPECT_NE(Create(spec)->id(), id);
}

TEST_F(JobManagerTest, SameRequestIdIsTheSameJobWhenTheResultIsStored) {
  Start(QuickSampler(3));
  Finish(Create(Spec())->id());
  JobSpec spec = Spec();
  spec.request_id = "once";
  // A second call with the request in the middle of the first.
  std::string second;
  const auto repeat = [&](std::string_view call) {
    if (call != "AddJob" && call != "AddEndedJob" && call != "EndJob") return;
    store_->after = [](std::string_view) {};
    const auto repeated = jobs_->Create(spec);
    ASSERT_TRUE(repeated.ok()) << call << ": " << repeated.status();
    second = (*repeated)->id();
    EXPECT_EQ((*repeated)->View().state, JobState::kSucceeded);
  };
  store_->after = repeat;
  const auto first = Create(spec);
  EXPECT_EQ(first->id(), second);
  EXPECT_TRUE(first->View().cached);
  EXPECT_EQ(first->Reports().size(), 3U);
}

TEST_F(JobManagerTest, CallThatComesFirstWithARequestIdDecides) {
  Start(QuickSampler());
  Finish(Create(Spec())->id());
  for (const bool has_answer : {true, false}) {
    JobSpec spec = Spec(has_answer ? 0 : 1);
    spec.request_id = has_answer ? "answered" : "computed";
    std::string overtaker;
    store_->before = [&](std::string_view call) {
      if (call != "AddJob" && call != "AddEndedJob") return absl::OkStatus();
      store_->before = [](std::string_view) { return absl::OkStatus(); };
      overtaker = Create(spec)->id();
      return absl::OkStatus();
    };
    EXPECT_EQ(Create(spec)->id(), overtaker);
  }
  EXPECT_EQ(jobs_->List({}, 10, "")->records.size(), 3U);
}

TEST_F(JobManagerTest, FullDiskInTheMiddleOfACachedAnswerLeavesNothing) {
  Start(QuickSampler());
  Finish(Create(Spec())->id());
  JobSpec spec = Spec();
  spec.request_id = "once";
  for (const std::string_view full : {"AddEndedJob", "AddJob", "EndJob"}) {
    store_->before = [full](std::string_view call) {
      return call == full ? MakeError(absl::StatusCode::kResourceExhausted,
                                      ErrorReason::kStorageFull, "the disk is full")
                          : absl::OkStatus();
    };
    const auto answered = jobs_->Create(spec);
    store_->before = [](std::string_view) { return absl::OkStatus(); };
    if (!answered.ok()) {
      EXPECT_EQ(GetErrorReason(answered.status()), ErrorReason::kStorageFull);
      EXPECT_EQ(jobs_->List({}, 10, "")->records.size(), 1U) << full;
    }
    EXPECT_EQ(Create(spec)->View().state, JobState::kSucceeded);
  }
  EXPECT_TRUE(store_->UnfinishedJobs()->empty());
}

TEST_F(JobManagerTest, RequestIdOfAnotherSpecIsRefused) {
  Start(QuickSampler());
  JobSpec first = Spec();
  first.request_id = "once";
  first.options.density.source = DensitySource::kTexture;
  first.texture_sha256 = *PutWhole(store_->blobs(), "image");
  const std::string id = Create(first)->id();
  const auto change = [&](const std::function<void(JobSpec&)>& edit) {
    JobSpec other = first;
    edit(other);
    return other;
  };
  const std::string other_mesh = *PutWhole(store_->blobs(), "other mesh");
  for (const JobSpec& other : {
           change([&](JobSpec& spec) { spec.mesh_sha256 = other_mesh; }),
           change([&](JobSpec& spec) { spec.texture_sha256 = other_mesh; }),
           change([](JobSpec& spec) { spec.origin = Eigen::Vector3d(1, 2, 3); }),
           change([](JobSpec& spec) { ++spec.options.sample_count; }),
           change([](JobSpec& spec) { ++spec.options.seed; }),
           change([](JobSpec& spec) { spec.options.time_limit_seconds = 1.5; }),
           change([](JobSpec& spec) { spec.options.density.exponent = 0.25; }),
           change([](JobSpec& spec) { spec.options.crease_angle = 0.5; }),
       }) {
    const auto refused = jobs_->Create(other);
    ASSERT_FALSE(refused.ok());
    EXPECT_EQ(GetErrorReason(refused.status()), ErrorReason::kRequestInvalid);
    EXPECT_TRUE(absl::IsInvalidArgument(refused.status()));
    EXPECT_NE(refused.status().message().find(id), std::string::npos);
  }
  // What is no part of what is asked for may differ.
  JobSpec renamed = first;
  renamed.display_name = "another name";
  renamed.labels = {{"team", "b"}};
  renamed.abandon_seconds = 1e6;
  EXPECT_EQ(Create(renamed)->id(), id);
  Start(QuickSampler());
  EXPECT_EQ(Create(first)->id(), id);
}

TEST_F(JobManagerTest, OwnersSeeTheirOwnJobs) {
  Start(QuickSampler());
  JobSpec spec = Spec();
  spec.owner = "a";
  const std::string id = Create(spec)->id();
  EXPECT_TRUE(jobs_->Find("a", id).ok());
  EXPECT_EQ(GetErrorReason(jobs_->Find("b", id).status()), ErrorReason::kNotFound);
  EXPECT_EQ(GetErrorReason(jobs_->Delete("b", id)), ErrorReason::kNotFound);
  JobFilter filter;
  filter.owner = "b";
  EXPECT_TRUE(jobs_->List(filter, 10, "")->records.empty());
}

TEST_F(JobManagerTest, JobOverTheMemoryBudgetIsRefused) {
  JobManagerOptions options;
  options.memory_budget_bytes = 1000;
  Start(QuickSampler(), options);
  const auto refused = jobs_->Create(Spec());
  EXPECT_TRUE(absl::IsInvalidArgument(refused.status()));
  EXPECT_EQ(GetErrorReason(refused.status()), ErrorReason::kLimitExceeded);
  ASSERT_TRUE(GetPassedLimit(refused.status()).has_value());
  EXPECT_EQ(GetPassedLimit(refused.status())->name, "max_job_memory_bytes");
  EXPECT_EQ(GetPassedLimit(refused.status())->value, 1000);
}

TEST_F(JobManagerTest, WatcherOverTheirNumberIsRefusedWithTheLimit) {
  JobManagerOptions options;
  options.max_watchers_per_job = 1;
  Start(QuickSampler(), options);
  const auto job = Create(Spec());
  const auto watch = [&] {
    return jobs_->Watch(
        *job, [] {}, 0);
  };
  const auto first = watch();
  ASSERT_TRUE(first.ok());
  const absl::Status refused = watch().status();
  EXPECT_EQ(GetErrorReason(refused), ErrorReason::kQuotaExceeded);
  ASSERT_TRUE(GetPassedLimit(refused).has_value());
  EXPECT_EQ(GetPassedLimit(refused)->name, "max_watchers_per_job");
  EXPECT_EQ(GetPassedLimit(refused)->value, 1);
  EXPECT_EQ(GetPassedLimit(refused)->requested, 2);
  jobs_->Unwatch(*job, *first);
}

TEST_F(JobManagerTest, MissingMeshIsRefused) {
  Start(QuickSampler());
  JobSpec spec = Spec();
  spec.mesh_sha256 = std::string(64, '0');
  EXPECT_EQ(GetErrorReason(jobs_->Create(spec).status()), ErrorReason::kMeshMissing);
}

TEST_F(JobManagerTest, ExpiredJobsGoWithTheirSamplesAndMeshes) {
  Start(QuickSampler());
  const std::string id = Create(Spec())->id();
  const std::string blob = Finish(id).samples_blob;
  ASSERT_TRUE(store_->blobs().Contains(blob));
  now_ += absl::Hours(25);
  ASSERT_TRUE(jobs_->Sweep().ok());
  EXPECT_EQ(GetErrorReason(jobs_->Find("", id).status()), ErrorReason::kNotFound);
  EXPECT_TRUE(store_->blobs().List()->empty());
}

TEST_F(JobManagerTest, UnwatchedJobIsAbandonedWhenItAskedForThat) {
  Start(GatedSampler(started_, never_));
  JobSpec spec = Spec();
  spec.abandon_seconds = 1e6;
  const auto patient = Create(spec);
  spec.abandon_seconds = 0.5;  // The clock of this test moves a second a look.
  spec.options.seed = 1;
  const auto hasty = Create(spec);
  ASSERT_TRUE(jobs_->Sweep().ok());
  EXPECT_EQ(hasty->View().stop_cause, StopCause::kAbandoned);
  EXPECT_EQ(patient->View().stop_cause, StopCause::kNone);
}

TEST_F(JobManagerTest, DrainPutsRunningJobsBack) {
  Start(GatedSampler(started_, never_));
  const auto job = Create(Spec());
  started_.Wait();
  jobs_->StartDraining();
  EXPECT_EQ(GetErrorReason(jobs_->Create(Spec(1)).status()), ErrorReason::kDraining);
  jobs_->StopAll();
  ASSERT_TRUE(jobs_->WaitUntilIdle(absl::InfiniteDuration()));
  EXPECT_EQ(job->View().stop_cause, StopCause::kDrain);
  Start(QuickSampler());
  EXPECT_EQ(Finish(job->id()).state, JobState::kSucceeded);
}

TEST_F(JobManagerTest, ListsByStateWhatRunsApartFromWhatWaits) {
  Start(GatedSampler(started_, never_));
  const std::string running = Create(Spec(1))->id();
  started_.Wait();
  const std::string waiting = Create(Spec(2))->id();
  const auto ids = [&](JobState state) {
    JobFilter filter;
    filter.states = {state};
    std::vector<std::string> found;
    const auto page = jobs_->List(filter, 10, "");
    for (const JobSummary& job : page->records) found.push_back(job.id);
    return found;
  };
  EXPECT_EQ(ids(JobState::kRunning), std::vector<std::string>{running});
  EXPECT_EQ(ids(JobState::kQueued), std::vector<std::string>{waiting});
  EXPECT_TRUE(ids(JobState::kSucceeded).empty());
}

}  // namespace
}  // namespace ccst::server
