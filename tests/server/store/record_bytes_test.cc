// What records take: counted by owner, exactly, whatever happens to them; dropped many at a time.
#include "server/store/record_bytes.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/server/store/store_fixture.h"

namespace ccst::server {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

class RecordBytesOfAStore : public StoreTest {
 protected:
  std::int64_t Bytes(const std::string& owner) { return *store_->RecordBytes(owner); }
  std::int64_t AllBytes() { return *store_->AllRecordBytes(); }
  void End(const JobRecord& job, const std::string& history) {
    ASSERT_TRUE(store_->EndJob(Ended(job), history).ok());
  }
};

TEST_F(RecordBytesOfAStore, AreThoseOfItsJobsAndMeshes) {
  EXPECT_EQ(Bytes("ann"), 0);
  const JobRecord job = SomeJob("a");
  ASSERT_TRUE(store_->AddJob(job).ok());
  EXPECT_EQ(Bytes("ann"), BytesOf(job));
  const MeshRecord mesh = SomeMesh("ann", "mesh");
  ASSERT_TRUE(store_->PutMesh(mesh).ok());
  ASSERT_TRUE(store_->PutMesh(mesh).ok());  // Replaces it.
  EXPECT_EQ(Bytes("ann"), BytesOf(job) + BytesOf(mesh));
  const MeshRecord other = SomeMesh("bob", "mesh");
  ASSERT_TRUE(store_->PutMesh(other).ok());
  EXPECT_EQ(Bytes("bob"), BytesOf(other));
  EXPECT_EQ(AllBytes(), BytesOf(job) + BytesOf(mesh) + BytesOf(other));
}

TEST_F(RecordBytesOfAStore, HoldTheRoomOfAHistoryUntilItIsThere) {
  JobRecord job = SomeJob("a");
  job.expected_end_bytes = 5000;
  ASSERT_TRUE(store_->AddJob(job).ok());
  EXPECT_EQ(Bytes("ann"), BytesOf(job) + 5000);
  End(job, std::string(300, 'h'));
  EXPECT_EQ(Bytes("ann"), BytesOf(Ended(job)) + 300);
}

TEST_F(RecordBytesOfAStore, CountAHistoryForEachJobThoughItIsStoredOnce) {
  const std::string history(1'000'000, 'h');
  std::vector<JobRecord> jobs;
  for (int i = 0; i < 20; ++i) {
    jobs.push_back(SomeJob(std::to_string(i)));
    ASSERT_TRUE(store_->AddEndedJob(Ended(jobs.back()), history).ok());
  }
  EXPECT_GT(Bytes("ann"), 20'000'000);
  store_.reset();
  std::int64_t stored = 0;
  for (const auto& file : std::filesystem::directory_iterator(directory_)) {
    // The reserve for a full disk lies beside the records.
    if (!file.path().filename().string().starts_with("records.")) continue;
    stored += static_cast<std::int64_t>(file.file_size());
  }
  EXPECT_LT(stored, 2'000'000);
  Reopen();
  for (const JobRecord& job : jobs) {
    EXPECT_EQ(*store_->GetHistory(job.id), history);
    ASSERT_TRUE(store_->DeleteJob(job.id).ok());
  }
  EXPECT_EQ(AllBytes(), 0);
}

TEST_F(RecordBytesOfAStore, GoWithWhatIsDeleted) {
  const JobRecord job = SomeJob("a");
  ASSERT_TRUE(store_->AddJob(job).ok());
  End(job, "history");
  const MeshRecord mesh = SomeMesh("ann", "mesh");
  ASSERT_TRUE(store_->PutMesh(mesh).ok());
  Reopen();
  ASSERT_TRUE(store_->DeleteJob("a").ok());
  EXPECT_EQ(Bytes("ann"), BytesOf(mesh));
  ASSERT_TRUE(store_->DeleteMesh("ann", mesh.sha256).ok());
  EXPECT_EQ(Bytes("ann"), 0);
  EXPECT_EQ(AllBytes(), 0);
}

TEST_F(RecordBytesOfAStore, AreLimitedByOwnerAndInAll) {
  const RecordLimits limits = {.max_bytes = 20'000, .max_owner_bytes = 10'000};
  JobRecord job = SomeJob("a");
  job.expected_end_bytes = 6000;
  ASSERT_TRUE(store_->AddJob(job).ok());
  const std::int64_t used = Bytes("ann");
  EXPECT_TRUE(CheckRecordRoom(*store_, "ann", 10'000 - used, limits).ok());
  const absl::Status quota = CheckRecordRoom(*store_, "ann", 10'001 - used, limits);
  ExpectError(quota, absl::StatusCode::kResourceExhausted, "QUOTA_EXCEEDED");
  EXPECT_THAT(std::string(quota.message()), testing::HasSubstr("delete"));
  EXPECT_TRUE(CheckRecordRoom(*store_, "bob", 10'000, limits).ok());
  job.id = "b";
  job.owner = "bob";
  ASSERT_TRUE(store_->AddJob(job).ok());
  ExpectError(CheckRecordRoom(*store_, "eve", 10'000, limits), absl::StatusCode::kResourceExhausted,
              "STORAGE_FULL");
}

TEST_F(RecordBytesOfAStore, ExpiredJobsAreDroppedManyAtATime) {
  for (int i = 0; i < 10; ++i) {
    JobRecord job = SomeJob(std::to_string(i), At(i));
    ASSERT_TRUE(store_->AddJob(job).ok());
    if (i >= 8) continue;
    ASSERT_TRUE(store_->EndJob(Ended(job, At(100 + i)), "history").ok());
  }
  const auto first = *store_->DropExpiredJobs(At(105), 3);
  ASSERT_THAT(first, SizeIs(3));
  EXPECT_EQ(first[0].id, "0");
  EXPECT_THAT(first[0].blobs,
              ElementsAre(Digest("samples of 0"), Digest("texture"), Digest("mesh")));
  EXPECT_THAT(*store_->DropExpiredJobs(At(105), 100), SizeIs(2));
  EXPECT_THAT(*store_->DropExpiredJobs(At(105), 100), IsEmpty());
  EXPECT_THAT(Ids(store_->ListJobs({}, 100, "")->records), ElementsAre("9", "8", "7", "6", "5"));
}

TEST_F(RecordBytesOfAStore, ExpiredMeshesAreDroppedManyAtATimeUnlessAJobNeedsThem) {
  for (const char* content : {"a", "b", "c"}) {
    ASSERT_TRUE(store_->PutMesh(SomeMesh("ann", content)).ok());
  }
  JobRecord job = SomeJob("job");
  job.mesh_sha256 = Digest("b");
  ASSERT_TRUE(store_->AddJob(job).ok());
  EXPECT_THAT(*store_->DropExpiredMeshes(At(0), 10), IsEmpty());
  EXPECT_THAT(*store_->DropExpiredMeshes(At(1e6), 1), SizeIs(1));
  EXPECT_THAT(*store_->DropExpiredMeshes(At(1e6), 10), SizeIs(1));
  EXPECT_THAT(Digests(store_->ListMeshes("ann", 10, "")->records), ElementsAre(Digest("b")));
}

}  // namespace
}  // namespace ccst::server
