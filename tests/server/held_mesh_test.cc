// Jobs that end with their callers and whose mesh only they have.
#include <memory>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/sha256.h"
#include "server/jobs/job_manager.h"
#include "tests/server/fakes.h"
#include "tests/server/job_manager_fixture.h"

namespace ccst::server {
namespace {

using testing::Contains;
using testing::IsEmpty;
using testing::SizeIs;

class HeldMeshes : public JobManagerTest {
 protected:
  // Of a `Sample` call with an inline mesh.
  std::shared_ptr<Job> Sample(std::uint64_t seed = 0) {
    JobSpec spec;
    spec.share = "caller";
    spec.mesh_sha256 = sha256_;
    spec.options.sample_count = 10;
    spec.options.seed = seed;
    spec.ends_with_caller = true;
    std::string bytes = "held mesh";
    const BlobPins::Pin pin(*pins_, sha256_);
    auto job = jobs_->Create(spec, jobs_->Hold(sha256_, bytes));
    EXPECT_TRUE(job.ok()) << job.status();
    EXPECT_TRUE(bytes.empty());
    return *std::move(job);
  }
  std::vector<std::string> Blobs() { return *store_->blobs().List(); }

  const std::string sha256_ = Sha256Of("held mesh");
};

TEST_F(HeldMeshes, AreComputedOnBeforeTheyAreStored) {
  Gate go;
  Start(GatedSampler(started_, go));
  const auto job = Sample();
  started_.Wait();
  EXPECT_THAT(Blobs(), IsEmpty());
  EXPECT_EQ(job->View().state, JobState::kRunning);
  EXPECT_THAT(jobs_->List({}, 10, "")->records, SizeIs(1));
  go.Open();
  EXPECT_EQ(Finish(job->id()).state, JobState::kSucceeded);
  EXPECT_EQ(*ReadWhole(store_->blobs(), sha256_), "held mesh");
  EXPECT_EQ(job->held_input(), nullptr);
}

TEST_F(HeldMeshes, StayWithTheResultUntilThatGoes) {
  Start(QuickSampler());
  const std::string id = Sample()->id();
  EXPECT_EQ(Finish(id).state, JobState::kSucceeded);
  Start(QuickSampler());
  EXPECT_EQ((*jobs_->Find("", id))->View().state, JobState::kSucceeded);
  EXPECT_THAT(Blobs(), SizeIs(2));
  ASSERT_TRUE(jobs_->Delete("", id).ok());
  EXPECT_THAT(Blobs(), IsEmpty());
}

TEST_F(HeldMeshes, AreNotStoredForAJobThatIsCancelled) {
  Start(GatedSampler(started_, never_));
  const auto running = Sample(1);
  started_.Wait();
  const auto waiting = Sample(2);
  ASSERT_TRUE(jobs_->Cancel(waiting, StopCause::kCaller).ok());
  EXPECT_EQ(waiting->held_input(), nullptr);
  ASSERT_TRUE(jobs_->Cancel(running, StopCause::kCaller).ok());
  EXPECT_EQ(Finish(running->id()).state, JobState::kCancelled);
  EXPECT_EQ(running->held_input(), nullptr);
  EXPECT_THAT(Blobs(), IsEmpty());
}

TEST_F(HeldMeshes, AreStoredWithAResultThatWasThereAlready) {
  Start(QuickSampler());
  const std::string first = Sample()->id();
  ASSERT_EQ(Finish(first).state, JobState::kSucceeded);
  ASSERT_TRUE(store_->blobs().Remove(sha256_).ok());
  const auto second = Sample();
  EXPECT_TRUE(second->View().cached);
  EXPECT_THAT(Blobs(), Contains(sha256_));
}

TEST_F(HeldMeshes, FailTheirJobWhereTheDiskDoesNotTakeThem) {
  Start(QuickSampler());
  store_->before = Failing("Append", FullDisk());
  const std::string id = Sample()->id();
  const JobView end = Finish(id);
  EXPECT_EQ(end.state, JobState::kFailed);
  EXPECT_EQ(GetErrorReason(end.error), ErrorReason::kStorageFull);
  EXPECT_THAT(Blobs(), IsEmpty());
}

TEST_F(HeldMeshes, JobOfADeadProcessIsCancelled) {
  Start(GatedSampler(started_, never_));
  const std::string id = Sample()->id();
  started_.Wait();
  Die();
  Start(QuickSampler());
  EXPECT_EQ(Finish(id).state, JobState::kCancelled);
}

TEST_F(HeldMeshes, AreNoMoreThanTheBoundAllows) {
  budget_ = std::make_shared<MemoryBudget>(std::int64_t{64} << 20);  // 1 MiB of meshes.
  Start(QuickSampler());
  std::string large((std::size_t{64} << 10) + 1, 'x');
  EXPECT_EQ(jobs_->Hold("digest", large), nullptr);
  EXPECT_FALSE(large.empty());
}

}  // namespace
}  // namespace ccst::server
