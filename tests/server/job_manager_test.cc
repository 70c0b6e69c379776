// Jobs over a real store: what survives, what is reused, what is dropped.
#include "server/jobs/job_manager.h"

#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "core/base/status.h"
#include "server/rpc/job_codec.h"
#include "server/store/sqlite.h"
#include "tests/server/fakes.h"
#include "tests/server/temp_folder.h"

namespace ccst::server {
namespace {

class CountingJobObserver final : public JobObserver {
 public:
  void OnPhase(std::string_view /*phase*/, double /*seconds*/) override {}
  void OnAlternation() override {}
  void OnEnd(std::string_view /*state*/, double /*seconds*/) override {}
  void OnCancel(std::string_view reason) override { ++cancels[std::string(reason)]; }
  void OnCacheLookup(std::string_view /*cache*/, bool hit) override { ++(hit ? hits : misses); }

  // Told on the thread that asks.
  std::map<std::string, int> cancels;
  int hits = 0;
  int misses = 0;
};

class JobManagerTest : public testing::Test {
 protected:
  // Opens the store anew, as another process would, with `sample` as the sampler.
  void Start(SampleFunction sample, JobManagerOptions options = {}) {
    Stop();
    store_ = *OpenEmbeddedStore(folder_.Path("data"), max_blob_bytes_);
    pins_ = std::make_unique<BlobPins>(*store_);
    RunDependencies run = FakeDependencies(std::move(sample));
    run.clock.now = [this] { return now_; };
    run.count = [](std::span<const char>, std::int64_t,
                   const MeshLimits&) -> absl::StatusOr<MeshCounts> {
      return MeshCounts{.vertices = 10, .faces = 20};
    };
    jobs_ = *JobManager::Start(*store_, *pins_, options,
                               {.run = std::move(run),
                                .codec = ProtoJobCodec(),
                                .new_id = ids_,
                                .observer = &observer_,
                                .budget = budget_});
  }
  void Stop() {
    jobs_ = nullptr;
    pins_ = nullptr;
    store_ = nullptr;
  }
  void TearDown() override { Stop(); }

  JobSpec Spec(std::uint64_t seed = 0) {
    JobSpec spec;
    spec.share = "caller";
    spec.mesh_sha256 = *PutWhole(store_->blobs(), "mesh");
    spec.options.sample_count = 10;
    spec.options.seed = seed;
    return spec;
  }
  std::shared_ptr<Job> Create(JobSpec spec) {
    auto job = jobs_->Create(std::move(spec));
    EXPECT_TRUE(job.ok()) << job.status();
    return *std::move(job);
  }
  JobView Finish(const std::string& id) {
    jobs_->WaitUntilIdle(absl::InfiniteDuration());
    return (*jobs_->Find("", id))->View();
  }

  std::int64_t max_blob_bytes_ = std::numeric_limits<std::int64_t>::max();
  Gate started_;
  Gate never_;
  TempFolder folder_;
  absl::Time now_ = absl::FromUnixSeconds(1'700'000'000);
  std::function<std::string()> ids_ = CountingIds();
  CountingJobObserver observer_;
  std::shared_ptr<MemoryBudget> budget_;  // Null: the manager's own.
  std::unique_ptr<Store> store_;
  std::unique_ptr<BlobPins> pins_;
  std::unique_ptr<JobManager> jobs_;
};

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

TEST_F(JobManagerTest, JobWhoseSamplesWouldNotFitTheDiskLimitIsRefused) {
  max_blob_bytes_ = 1000;
  Start(QuickSampler());
  JobSpec spec = Spec();
  spec.options.sample_count = 20;
  const auto refused = jobs_->Create(spec);
  EXPECT_TRUE(absl::IsResourceExhausted(refused.status()));
  EXPECT_EQ(GetErrorReason(refused.status()), ErrorReason::kStorageFull);
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
