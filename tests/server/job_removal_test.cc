// Jobs that are dropped in the middle of other calls.
#include <memory>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "tests/server/job_manager_fixture.h"

namespace ccst::server {
namespace {

TEST_F(JobManagerTest, SamplesStayWhenAJobWithEqualOnesIsDeletedWhileTheyAreStored) {
  for (const std::string_view moment : {"Append", "Commit", "EndJob"}) {
    Start(QuickSampler());
    const std::string first = Create(Spec())->id();
    Finish(first);
    JobSpec again = Spec();
    again.skip_cache_lookup = true;
    store_->after = [&](std::string_view call) {
      if (call != moment) return;
      store_->after = [](std::string_view) {};
      EXPECT_TRUE(jobs_->Delete("", first).ok());
    };
    const std::string second = Create(again)->id();
    ASSERT_EQ(Finish(second).state, JobState::kSucceeded);
    EXPECT_TRUE(absl::IsNotFound(jobs_->Find("", first).status()));
    {
      // As long as somebody reads them, samples stay also when their job is deleted.
      const auto samples = jobs_->OpenSamples(**jobs_->Find("", second));
      EXPECT_TRUE(samples.ok()) << moment << ": " << samples.status();
    }
    ASSERT_TRUE(jobs_->Delete("", second).ok());
    EXPECT_TRUE(store_->blobs().List()->empty()) << moment;
  }
}

TEST_F(JobManagerTest, JobThatIsDroppedWhileItIsReadBackIsNotFound) {
  for (const bool expires : {false, true}) {
    for (const std::string_view moment : {"GetJob", "GetHistory"}) {
      Start(QuickSampler(3));
      const std::string id = Create(Spec())->id();
      Finish(id);
      Start(QuickSampler(3));  // Now it is in the store alone.
      store_->after = [&](std::string_view call) {
        if (call != moment) return;
        store_->after = [](std::string_view) {};
        if (expires) now_ += absl::Hours(1000);
        EXPECT_TRUE(expires ? jobs_->Sweep().ok() : jobs_->Delete("", id).ok());
      };
      // Never the job without its reports.
      EXPECT_TRUE(absl::IsNotFound(jobs_->Find("", id).status())) << moment;
      EXPECT_TRUE(absl::IsNotFound(jobs_->Find("", id).status())) << moment;
    }
  }
}

TEST_F(JobManagerTest, JobThatIsDroppedJustAfterItWasReadBackIsFoundNoMore) {
  Start(QuickSampler(3));
  const std::string id = Create(Spec())->id();
  Finish(id);
  Start(QuickSampler(3));
  int looks = 0;
  store_->after = [&](std::string_view call) {
    if (call != "GetJob" || ++looks != 2) return;
    store_->after = [](std::string_view) {};
    EXPECT_TRUE(jobs_->Delete("", id).ok());
  };
  // Whoever was faster than the removal has all of it.
  const auto found = jobs_->Find("", id);
  ASSERT_TRUE(found.ok()) << found.status();
  EXPECT_EQ((*found)->Reports().size(), 3U);
  EXPECT_TRUE(absl::IsNotFound(jobs_->Find("", id).status()));
}

TEST_F(JobManagerTest, RequestWhoseCachedAnswerIsDroppedAtOnceIsAnsweredAnew) {
  for (const std::string_view request_id : {"", "once"}) {
    Start(QuickSampler(3));
    const std::string first = Create(Spec())->id();
    Finish(first);
    JobSpec spec = Spec();
    spec.request_id = request_id;
    std::string dropped;
    store_->after = [&](std::string_view call) {
      if (call != "AddEndedJob") return;
      store_->after = [](std::string_view) {};
      const auto listed = jobs_->List({}, 10, "");
      ASSERT_TRUE(listed.ok()) << listed.status();
      for (const JobSummary& job : listed->records) {
        if (job.id != first) dropped = job.id;
      }
      EXPECT_TRUE(jobs_->Delete("", dropped).ok());
    };
    const auto answer = Create(spec);
    EXPECT_FALSE(dropped.empty());
    EXPECT_NE(answer->id(), dropped);
    EXPECT_EQ(answer->Reports().size(), 3U);
    EXPECT_TRUE(jobs_->Find("", answer->id()).ok());
    EXPECT_TRUE(jobs_->Delete("", answer->id()).ok());
    EXPECT_TRUE(jobs_->Delete("", first).ok());
  }
}

}  // namespace
}  // namespace ccst::server
