// Damaged results, rows and histories of jobs: kept from callers, computed again, in nobody's way;
// and how many records jobs may leave.
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/limit_error.h"
#include "core/base/status.h"
#include "server/jobs/job_manager.h"
#include "server/store/sqlite.h"
#include "tests/server/fakes.h"
#include "tests/server/job_manager_fixture.h"

namespace ccst::server {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

class DamagedJobs : public JobManagerTest {
 protected:
  DamagedJobs() { Start(); }

  // As another process would, and counts what is computed.
  void Start() {
    JobManagerTest::Start(
        [this](const TriangleMesh& mesh, const SamplingOptions& options,
               const RunControl& control) {
          ++runs_;
          return QuickSampler(3)(mesh, options, control);
        },
        options_);
  }

  std::string Data() const { return folder_.Path("data"); }
  std::string FileOf(const std::string& sha256) const {
    return Data() + "/blobs/" + sha256.substr(0, 2) + "/" + sha256;
  }
  void Change(const std::string& sql) {
    Stop();
    ASSERT_TRUE((*Database::Open(Data() + "/records.sqlite"))->RunScript(sql).ok());
    Start();
  }

  // The id of a job that has ended.
  std::string Run(JobSpec spec) {
    const auto job = jobs_->Create(spec);
    EXPECT_TRUE(job.ok()) << job.status();
    EXPECT_TRUE(jobs_->WaitUntilIdle(absl::InfiniteDuration()));
    return (*job)->id();
  }
  absl::Status Read(const std::string& id) {
    const auto samples = jobs_->OpenSamples(**jobs_->Find("", id));
    if (!samples.ok()) return samples.status();
    return samples->ReadSamples(0, samples->sample_count()).status();
  }
  std::string BlobOf(const std::string& id) { return (*jobs_->Find("", id))->View().samples_blob; }

  JobManagerOptions options_;
  std::atomic<int> runs_ = 0;
};

TEST_F(DamagedJobs, DamagedResultIsNotReadAnswersNobodyAndIsComputedAgain) {
  const std::string first = Run(Spec());
  const std::string file = FileOf(BlobOf(first));
  const auto size = std::filesystem::file_size(file);
  int runs = 1;
  const std::vector<std::function<void()>> damages = {
      [&] { std::filesystem::resize_file(file, size - 1); },
      [&] { std::filesystem::resize_file(file, 0); }, [&] { std::filesystem::remove(file); },
      [&] {
        std::fstream out(file, std::ios::in | std::ios::out | std::ios::binary);
        out.seekp(static_cast<std::streamoff>(size / 2)) << '\xff';
      }};
  for (const auto& damage : damages) {
    damage();
    EXPECT_TRUE(absl::IsDataLoss(Read(first))) << Read(first);
    EXPECT_EQ(GetErrorReason(Read(first)), ErrorReason::kStorageFailed);
    const std::string again = Run(Spec());
    EXPECT_EQ(runs_, ++runs);
    EXPECT_TRUE(Read(again).ok());
    EXPECT_TRUE(Read(first).ok());
    Run(Spec());
    EXPECT_EQ(runs_, runs);
  }
}

TEST_F(DamagedJobs, SamplesOfADeletedJobAreNotFound) {
  const auto job = *jobs_->Find("", Run(Spec()));
  ASSERT_TRUE(jobs_->Delete("", job->id()).ok());
  EXPECT_EQ(GetErrorReason(jobs_->OpenSamples(*job).status()), ErrorReason::kNotFound);
}

TEST_F(DamagedJobs, DamagedRowIsListedAsSuchBesideTheOthersAndAnswersNobody) {
  const std::vector<std::string> changes = {"outcome = X'ff'", "outcome = X''",
                                            "definition = X'ff'", "display_name = 'x'",
                                            "samples_sha256 = ''"};
  std::vector<std::string> ids;
  for (std::size_t i = 0; i <= changes.size(); ++i) ids.push_back(Run(Spec(i)));
  std::string sql;
  for (std::size_t i = 0; i < changes.size(); ++i) {
    sql += "UPDATE jobs SET " + changes[i] + " WHERE id = '" + ids[i] + "';";
  }
  Change(sql);
  const auto page = jobs_->List({}, 100, "");
  ASSERT_TRUE(page.ok()) << page.status();
  ASSERT_THAT(page->records, SizeIs(ids.size()));
  for (const JobSummary& job : page->records) {
    const bool whole = job.id == ids.back();
    EXPECT_EQ(job.view.state, whole ? JobState::kSucceeded : JobState::kFailed) << job.id;
    EXPECT_EQ(absl::IsDataLoss(job.view.error), !whole) << job.view.error;
  }
  JobFilter succeeded;
  succeeded.states = {JobState::kSucceeded};
  EXPECT_THAT(jobs_->List(succeeded, 100, "")->records, SizeIs(ids.size()));
  runs_ = 0;
  for (std::size_t i = 0; i <= changes.size(); ++i) Run(Spec(i));
  EXPECT_EQ(runs_, static_cast<int>(changes.size()));
  for (std::size_t i = 0; i < changes.size(); ++i) {
    EXPECT_TRUE(absl::IsDataLoss(jobs_->Find("", ids[i]).status())) << changes[i];
    EXPECT_TRUE(jobs_->Delete("", ids[i]).ok());
  }
}

TEST_F(DamagedJobs, DamagedRowIsListedWithTextThatCanBeSent) {
  JobSpec spec = Spec();
  spec.display_name = "name";
  Run(spec);
  Change("UPDATE jobs SET id = CAST(X'61ff' AS TEXT), display_name = CAST(X'fe62' AS TEXT)");
  const auto page = jobs_->List({}, 100, "");
  ASSERT_TRUE(page.ok()) << page.status();
  ASSERT_THAT(page->records, SizeIs(1));
  const JobSummary& job = page->records.front();
  EXPECT_EQ(job.id, "a\\xff");
  EXPECT_EQ(job.spec.display_name, "\\xfeb");
  EXPECT_THAT(std::string(job.view.error.message()), HasSubstr("job a\\xff"));
}

TEST_F(DamagedJobs, DamagedHistoryKeepsNobodyFromTheResultAndIsNotReplayed) {
  const std::string id = Run(Spec());
  Change("UPDATE histories SET history = X'00'");
  const auto job = jobs_->Find("", id);
  ASSERT_TRUE(job.ok()) << job.status();
  EXPECT_EQ((*job)->View().state, JobState::kSucceeded);
  EXPECT_TRUE(Read(id).ok());
  EXPECT_TRUE(absl::IsDataLoss((*job)->history_status()));
  runs_ = 0;
  EXPECT_TRUE((*jobs_->Find("", Run(Spec())))->history_status().ok());
  EXPECT_EQ(runs_, 1);
}

TEST_F(DamagedJobs, SweepDropsAllThatHasExpiredWithItsBlobs) {
  constexpr int kJobs = 350;  // More than one batch.
  for (int i = 0; i < kJobs; ++i) Run(Spec(static_cast<std::uint64_t>(i % 7)));
  const std::string kept = [&] {
    now_ += absl::Hours(12);
    return Run(Spec(3));
  }();
  now_ += absl::Hours(13);
  ASSERT_TRUE(jobs_->Sweep().ok());
  const auto page = jobs_->List({}, 1000, "");
  ASSERT_THAT(page->records, SizeIs(1));
  EXPECT_EQ(page->records.front().id, kept);
  EXPECT_TRUE(Read(kept).ok());
  EXPECT_THAT(*store_->blobs().List(), SizeIs(2));  // Its mesh and samples.
  now_ += absl::Hours(24);
  ASSERT_TRUE(jobs_->Sweep().ok());
  EXPECT_THAT(*store_->blobs().List(), IsEmpty());
  EXPECT_EQ(*store_->AllRecordBytes(), 0);
}

TEST_F(DamagedJobs, RecordsOfACallerAreLimitedAndDeletingMakesRoom) {
  options_.records.max_owner_bytes = 100'000;
  Start();
  std::vector<std::string> ids;
  absl::Status refused;
  while (refused.ok() && ids.size() < 1000) {
    const auto job = jobs_->Create(Spec());
    refused = job.status();
    if (job.ok()) ids.push_back((*job)->id());
    jobs_->WaitUntilIdle(absl::InfiniteDuration());
  }
  EXPECT_EQ(GetErrorReason(refused), ErrorReason::kQuotaExceeded) << refused;
  EXPECT_THAT(std::string(refused.message()), HasSubstr("delete jobs that have ended"));
  const auto passed = GetPassedLimit(refused);
  ASSERT_TRUE(passed.has_value());
  EXPECT_EQ(passed->name, "max_record_bytes_per_caller");
  EXPECT_EQ(passed->value, 100'000);
  EXPECT_GT(passed->requested, 100'000);
  EXPECT_GT(ids.size(), 10U);
  EXPECT_LE(*store_->RecordBytes(""), 100'000);
  JobSpec other = Spec();
  other.owner = "bob";
  EXPECT_TRUE(jobs_->Create(other).ok());
  for (const std::string& id : ids) ASSERT_TRUE(jobs_->Delete("", id).ok());
  EXPECT_TRUE(jobs_->Create(Spec()).ok());
}

TEST_F(DamagedJobs, HistoriesThatMayComeCountFromTheBeginning) {
  options_.records.max_owner_bytes = 300'000;
  Start();
  JobSpec spec = Spec();
  spec.options.max_iterations = kMaxAlternations;
  EXPECT_EQ(GetErrorReason(jobs_->Create(spec).status()), ErrorReason::kLimitExceeded);
  spec.options.max_iterations = 1000;
  EXPECT_TRUE(jobs_->Create(spec).ok());
}

TEST_F(DamagedJobs, RecordsOfAllCallersAreLimited) {
  options_.records.max_bytes = 20'000;
  Start();
  absl::Status refused;
  for (int i = 0; i < 100 && refused.ok(); ++i) {
    JobSpec spec = Spec();
    spec.owner = "caller" + std::to_string(i);
    refused = jobs_->Create(spec).status();
  }
  EXPECT_EQ(GetErrorReason(refused), ErrorReason::kStorageFull) << refused;
}

}  // namespace
}  // namespace ccst::server
