#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/store/sqlite.h"
#include "tests/server/store/store_fixture.h"

namespace ccst::server {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

class JobRecords : public StoreTest {};

TEST_F(JobRecords, AreReadAsTheyWereWritten) {
  const JobRecord job = SomeJob("a", At(1.000001));
  ExpectSame(*store_->AddJob(job), job);
  Reopen();
  ExpectSame(store_->GetJob("a")->value(), job);
}

TEST_F(JobRecords, EmptyFieldsStayEmpty) {
  JobRecord job;
  job.id = "a";
  job.create_time = At(0);
  ASSERT_TRUE(store_->AddJob(job).ok());
  ExpectSame(store_->GetJob("a")->value(), job);
}

TEST_F(JobRecords, TimesAreRoundedDownToMicroseconds) {
  const JobRecord added = *store_->AddJob(SomeJob("a", At(0) + absl::Nanoseconds(1999)));
  EXPECT_EQ(added.create_time, At(0) + absl::Microseconds(1));
}

TEST_F(JobRecords, UnknownIdGivesNone) {
  EXPECT_FALSE(store_->GetJob("a")->has_value());
  EXPECT_EQ(*store_->GetHistory("a"), "");
}

TEST_F(JobRecords, OneThatMayBeLostSurvivesTheProcess) {
  JobRecord job = SomeJob("a");
  job.may_be_lost = true;
  ASSERT_TRUE(store_->AddJob(job).ok());
  ASSERT_TRUE(store_->AddJob(SomeJob("b")).ok());
  Reopen();
  ExpectSame(**store_->GetJob("a"), job);
  EXPECT_TRUE((*store_->GetJob("b")).has_value());
}

TEST_F(JobRecords, SameRequestOfAnOwnerGivesTheFirstJob) {
  const JobRecord first = SomeJob("a");
  ASSERT_TRUE(store_->AddJob(first).ok());
  JobRecord again = SomeJob("b", At(5));
  again.request_id = first.request_id;
  ExpectSame(*store_->AddJob(again), first);
  EXPECT_FALSE(store_->GetJob("b")->has_value());
  again.owner = "bob";
  EXPECT_EQ(store_->AddJob(again)->id, "b");
}

TEST_F(JobRecords, WithoutRequestIdAreNeverTheSame) {
  for (const char* id : {"a", "b"}) {
    JobRecord job = SomeJob(id);
    job.request_id.clear();
    EXPECT_EQ(store_->AddJob(job)->id, id);
  }
}

TEST_F(JobRecords, ATakenIdIsRefusedAndChangesNothing) {
  const JobRecord job = SomeJob("a");
  ASSERT_TRUE(store_->AddJob(job).ok());
  JobRecord other = SomeJob("a", At(3));
  other.request_id = "another";
  other.labels = {{"more", "labels"}};
  ExpectError(store_->AddJob(other).status(), absl::StatusCode::kInternal, "STORAGE_FAILED");
  ExpectSame(store_->GetJob("a")->value(), job);
}

TEST_F(JobRecords, RunningIsStoredAsQueued) {
  JobRecord job = SomeJob("a");
  job.state = JobState::kRunning;
  EXPECT_EQ(store_->AddJob(job)->state, JobState::kQueued);
}

TEST_F(JobRecords, EndWritesOutcomeAndHistory) {
  const JobRecord job = SomeJob("a");
  ASSERT_TRUE(store_->AddJob(job).ok());
  const std::string history("history\0\xff", 9);
  ASSERT_TRUE(store_->EndJob(Ended(job), history).ok());
  Reopen();
  ExpectSame(store_->GetJob("a")->value(), Ended(job));
  EXPECT_EQ(*store_->GetHistory("a"), history);
}

TEST_F(JobRecords, EndedOneIsAddedWithItsHistory) {
  const JobRecord job = Ended(SomeJob("a"));
  const std::string history("history\0\xff", 9);
  ExpectSame(*store_->AddEndedJob(job, history), job);
  Reopen();
  ExpectSame(store_->GetJob("a")->value(), job);
  EXPECT_EQ(*store_->GetHistory("a"), history);
  EXPECT_THAT(*store_->UnfinishedJobs(), IsEmpty());
}

TEST_F(JobRecords, EndedOneOfARequestThatIsThereGivesTheFirstJob) {
  const JobRecord first = SomeJob("a");
  ASSERT_TRUE(store_->AddJob(first).ok());
  JobRecord again = Ended(SomeJob("b", At(5)));
  again.request_id = first.request_id;
  ExpectSame(*store_->AddEndedJob(again, "history"), first);
  EXPECT_FALSE(store_->GetJob("b")->has_value());
  EXPECT_EQ(*store_->GetHistory("b"), "");
}

TEST_F(JobRecords, EndLeavesTheDefinitionAlone) {
  const JobRecord job = SomeJob("a");
  ASSERT_TRUE(store_->AddJob(job).ok());
  JobRecord ended = Ended(job);
  ended.owner = "bob";
  ended.labels.clear();
  ended.definition = "other";
  ASSERT_TRUE(store_->EndJob(ended, "").ok());
  ExpectSame(store_->GetJob("a")->value(), Ended(job));
}

TEST_F(JobRecords, EndOfAnUnknownJobIsAnError) {
  ExpectError(store_->EndJob(Ended(SomeJob("a")), "history"), absl::StatusCode::kNotFound,
              "NOT_FOUND");
  EXPECT_EQ(*store_->GetHistory("a"), "");
}

TEST_F(JobRecords, EndedStatesNeverChange) {
  const JobRecord job = SomeJob("a");
  ASSERT_TRUE(store_->AddJob(job).ok());
  ASSERT_TRUE(store_->EndJob(Ended(job), "first").ok());
  JobRecord failed = Ended(job);
  failed.state = JobState::kFailed;
  ASSERT_TRUE(store_->EndJob(failed, "second").ok());
  ExpectSame(store_->GetJob("a")->value(), Ended(job));
  EXPECT_EQ(*store_->GetHistory("a"), "first");
}

TEST_F(JobRecords, OnlyQueuedOnesBecomeCancelling) {
  const JobRecord job = SomeJob("a");
  ASSERT_TRUE(store_->AddJob(job).ok());
  ASSERT_TRUE(store_->MarkCancelling("a").ok());
  EXPECT_EQ(store_->GetJob("a")->value().state, JobState::kCancelling);
  ASSERT_TRUE(store_->EndJob(Ended(job), "").ok());
  ASSERT_TRUE(store_->MarkCancelling("a").ok());
  EXPECT_EQ(store_->GetJob("a")->value().state, JobState::kSucceeded);
  EXPECT_TRUE(store_->MarkCancelling("unknown").ok());
}

TEST_F(JobRecords, StartsAreCountedAndGivenBack) {
  ASSERT_TRUE(store_->AddJob(SomeJob("a")).ok());
  const auto starts = [this] { return store_->GetJob("a")->value().starts; };
  EXPECT_EQ(starts(), 0);
  ASSERT_TRUE(store_->GiveBackStart("a").ok());
  EXPECT_EQ(starts(), 0);
  ASSERT_TRUE(store_->CountStart("a").ok());
  ASSERT_TRUE(store_->CountStart("a").ok());
  Reopen();
  EXPECT_EQ(starts(), 2);
  EXPECT_EQ(store_->UnfinishedJobs()->front().starts, 2);
  ASSERT_TRUE(store_->GiveBackStart("a").ok());
  EXPECT_EQ(starts(), 1);
  EXPECT_TRUE(store_->CountStart("unknown").ok());
  EXPECT_TRUE(store_->GiveBackStart("unknown").ok());
}

TEST_F(JobRecords, UnfinishedComeOldestFirst) {
  for (const char* id : {"b", "a", "d", "c"}) {
    ASSERT_TRUE(store_->AddJob(SomeJob(id, At(id[0]))).ok());
  }
  ASSERT_TRUE(store_->MarkCancelling("c").ok());
  ASSERT_TRUE(store_->EndJob(Ended(SomeJob("b")), "").ok());
  EXPECT_THAT(Ids(*store_->UnfinishedJobs()), ElementsAre("a", "c", "d"));
}

TEST_F(JobRecords, LatestReusableOneOfAnEqualSpecIsFound) {
  for (const char* id : {"a", "b", "c", "d"}) {
    JobRecord job = SomeJob(id, At(id[0]));
    if (id[0] == 'd') job.spec_digest = Digest("another spec");
    ASSERT_TRUE(store_->AddJob(job).ok());
    job = Ended(job, At(1000));
    job.reusable = id[0] != 'c';
    ASSERT_TRUE(store_->EndJob(job, "").ok());
  }
  ASSERT_TRUE(store_->AddJob(SomeJob("waiting", At(500))).ok());
  EXPECT_EQ(store_->FindReusable(Digest("spec"), At(999))->value().id, "b");
  EXPECT_EQ(store_->FindReusable(Digest("another spec"), At(999))->value().id, "d");
  EXPECT_FALSE(store_->FindReusable(Digest("unknown spec"), At(999))->has_value());
  EXPECT_FALSE(store_->FindReusable(Digest("spec"), At(1001))->has_value());
}

TEST_F(JobRecords, ExpireOnceEndedAndTheirTimeHasPassed) {
  for (const int i : {3, 1, 2}) {
    const JobRecord job = SomeJob(std::to_string(i));
    ASSERT_TRUE(store_->AddJob(job).ok());
    ASSERT_TRUE(store_->EndJob(Ended(job, At(i)), "").ok());
  }
  ASSERT_TRUE(store_->AddJob(SomeJob("waiting")).ok());
  const auto drop = [this](absl::Time now, int limit) {
    std::vector<std::string> ids;
    const auto dropped = *store_->DropExpiredJobs(now, limit);
    for (const DroppedJob& job : dropped) ids.push_back(job.id);
    return ids;
  };
  EXPECT_THAT(drop(At(1), 10), IsEmpty());
  EXPECT_THAT(drop(At(9), 1), ElementsAre("1"));
  EXPECT_THAT(drop(At(3), 10), ElementsAre("2"));
  EXPECT_THAT(Ids(store_->ListJobs({}, 10, "")->records), UnorderedElementsAre("3", "waiting"));
}

TEST_F(JobRecords, DeleteTakesLabelsHistoryAndRequestAlong) {
  const JobRecord job = SomeJob("a");
  ASSERT_TRUE(store_->AddJob(job).ok());
  ASSERT_TRUE(store_->EndJob(Ended(job), "history").ok());
  ASSERT_TRUE(store_->DeleteJob("a").ok());
  EXPECT_FALSE(store_->GetJob("a")->has_value());
  EXPECT_EQ(*store_->GetHistory("a"), "");
  JobFilter filter;
  filter.labels = job.labels;
  EXPECT_THAT(store_->ListJobs(filter, 10, "")->records, IsEmpty());
  JobRecord again = SomeJob("a");
  again.labels.clear();
  ASSERT_TRUE(store_->AddJob(again).ok());
  ExpectSame(store_->GetJob("a")->value(), again);
  EXPECT_TRUE(store_->DeleteJob("unknown").ok());
}

TEST_F(JobRecords, ReferToMeshTextureAndSamples) {
  const JobRecord job = SomeJob("a");
  ASSERT_TRUE(store_->AddJob(job).ok());
  ASSERT_TRUE(store_->EndJob(Ended(job), "").ok());
  for (const std::string& digest :
       {job.mesh_sha256, job.texture_sha256, Ended(job).samples_sha256}) {
    EXPECT_TRUE(*store_->IsReferenced(digest));
  }
  EXPECT_FALSE(*store_->IsReferenced(Digest("another")));
  EXPECT_FALSE(*store_->IsReferenced(""));
  ASSERT_TRUE(store_->DeleteJob("a").ok());
  for (const std::string& digest :
       {job.mesh_sha256, job.texture_sha256, Ended(job).samples_sha256}) {
    EXPECT_FALSE(*store_->IsReferenced(digest));
  }
}

TEST_F(JobRecords, DamagedDefinitionIsNoticed) {
  JobRecord job = SomeJob("a");
  job.definition = "what was asked for";
  ASSERT_TRUE(store_->AddJob(job).ok());
  EXPECT_FALSE((*store_->GetJob("a"))->damaged);
  store_ = nullptr;
  {
    const auto database = *Database::Open(directory_ + "/records.sqlite");
    ASSERT_TRUE(
        database->RunScript("UPDATE jobs SET definition = CAST('what was asked foR' AS BLOB)")
            .ok());
  }
  Reopen();
  EXPECT_TRUE((*store_->GetJob("a"))->damaged);
  EXPECT_TRUE(store_->UnfinishedJobs()->front().damaged);
}

}  // namespace
}  // namespace ccst::server
