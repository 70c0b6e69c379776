#include <filesystem>
#include <memory>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include "tests/server/store/store_fixture.h"

namespace ccst::server {
namespace {

using testing::HasSubstr;
using testing::Not;

// A small disk of its own, where the system lets us have one.
class SmallDisk : public testing::Test {
 protected:
  void SetUp() override {
    mounted_ = mount("ccst", folder_.path().c_str(), "tmpfs", 0, "size=2m,mode=0700") == 0;
    if (!mounted_) GTEST_SKIP() << "mounting a file system is not permitted here";
    store_ = *OpenEmbeddedStore(folder_.path());
  }
  void TearDown() override {
    store_.reset();
    if (mounted_) umount(folder_.path().c_str());
  }

  const TestFolder folder_;
  std::unique_ptr<Store> store_;
  bool mounted_ = false;
};

TEST_F(SmallDisk, ABlobThatDoesNotFitIsRefusedAndLeavesNothing) {
  auto writer = *store_->blobs().NewBlob();
  const std::string chunk(100000, 'x');
  absl::Status status;
  for (int i = 0; i < 100 && status.ok(); ++i) status = writer->Append(chunk);
  ExpectError(status, absl::StatusCode::kResourceExhausted, "STORAGE_FULL");
  EXPECT_EQ(writer->Append("more"), status);
  EXPECT_EQ(writer->Commit(), status);
  // The space is free at once, also while the writer is there.
  EXPECT_TRUE(PutWhole(store_->blobs(), chunk).ok());
  EXPECT_EQ(store_->blobs().List()->size(), 1);
}

TEST_F(SmallDisk, FullRefusesJobsKeepsTheOldAndWorksAgainWithSpace) {
  int count = 0;
  absl::Status status;
  const std::string history(50000, 'h');
  for (; count < 1000 && status.ok(); ++count) {
    const JobRecord job = SomeJob(std::to_string(count), At(count));
    status = store_->AddJob(job).status();
    if (status.ok()) status = store_->EndJob(Ended(job), history);
  }
  ExpectError(status, absl::StatusCode::kResourceExhausted, "STORAGE_FULL");
  const int kept = count - 1;
  ASSERT_GT(kept, 1);
  for (int i = 0; i < kept; ++i) {
    const std::string id = std::to_string(i);
    ExpectSame(store_->GetJob(id)->value(), Ended(SomeJob(id, At(i))));
    EXPECT_EQ(*store_->GetHistory(id), history);
  }
  EXPECT_EQ(*store_->GetHistory(std::to_string(kept)), "");

  ASSERT_EQ(mount("ccst", folder_.path().c_str(), "tmpfs", MS_REMOUNT, "size=8m"), 0);
  const JobRecord job = SomeJob("with space", At(5000));
  EXPECT_TRUE(store_->AddJob(job).ok());
  EXPECT_TRUE(store_->EndJob(Ended(job), history).ok());
  store_.reset();
  store_ = *OpenEmbeddedStore(folder_.path());
  EXPECT_EQ(*store_->GetHistory("0"), history);
  EXPECT_EQ(*store_->GetHistory("with space"), history);
}

TEST_F(SmallDisk, ReadOnlyIsReportedAndChangesNothing) {
  ASSERT_TRUE(store_->AddJob(SomeJob("a")).ok());
  store_.reset();
  ASSERT_EQ(mount("ccst", folder_.path().c_str(), "tmpfs", MS_REMOUNT | MS_RDONLY, nullptr), 0);
  const auto store = OpenEmbeddedStore(folder_.path());
  ExpectError(store.status(), absl::StatusCode::kInternal, "STORAGE_FAILED");
  EXPECT_THAT(std::string(store.status().message()), HasSubstr("Read-only"));
  EXPECT_THAT(std::string(store.status().message()), HasSubstr(folder_.path()));
  ASSERT_EQ(mount("ccst", folder_.path().c_str(), "tmpfs", MS_REMOUNT, nullptr), 0);
  EXPECT_TRUE((*OpenEmbeddedStore(folder_.path()))->GetJob("a")->has_value());
}

// No file may grow beyond a size: writes fail without a special disk.
class SizeLimit {
 public:
  explicit SizeLimit(rlim_t size) {
    signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit = {.rlim_cur = size, .rlim_max = before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~SizeLimit() {
    setrlimit(RLIMIT_FSIZE, &before_);
    signal(SIGXFSZ, SIG_DFL);
  }
  SizeLimit(const SizeLimit&) = delete;
  SizeLimit& operator=(const SizeLimit&) = delete;

 private:
  rlimit before_ = {};
};

class FailingWrites : public StoreTest {};

TEST_F(FailingWrites, OfRecordsChangeNothingAndNameNoPath) {
  const JobRecord job = SomeJob("a");
  ASSERT_TRUE(store_->AddJob(job).ok());
  {
    const SizeLimit limit(4096);
    for (const absl::Status& status :
         {store_->AddJob(SomeJob("b")).status(), store_->EndJob(Ended(job), "history"),
          store_->DeleteJob("a"), store_->MarkCancelling("a"),
          store_->PutMesh(SomeMesh("ann", "mesh"))}) {
      ExpectError(status, absl::StatusCode::kInternal, "STORAGE_FAILED");
      EXPECT_THAT(std::string(status.message()), HasSubstr("records"));
      EXPECT_THAT(std::string(status.message()), Not(HasSubstr(folder_.path())));
    }
    ExpectSame(store_->GetJob("a")->value(), job);
  }
  EXPECT_FALSE(store_->GetJob("b")->has_value());
  EXPECT_FALSE(store_->GetMesh("ann", Digest("mesh"))->has_value());
  ASSERT_TRUE(store_->EndJob(Ended(job), "history").ok());
  Reopen();
  ExpectSame(store_->GetJob("a")->value(), Ended(job));
}

TEST_F(FailingWrites, OfBlobsLeaveNothingAndNameNoPath) {
  {
    const SizeLimit limit(4096);
    const auto put = PutWhole(store_->blobs(), std::string(5000, 'x'));
    ExpectError(put.status(), absl::StatusCode::kInternal, "STORAGE_FAILED");
    EXPECT_THAT(std::string(put.status().message()), HasSubstr("blob"));
    EXPECT_THAT(std::string(put.status().message()), Not(HasSubstr(folder_.path())));
  }
  EXPECT_TRUE(std::filesystem::is_empty(directory_ + "/incoming"));
  EXPECT_TRUE(store_->blobs().List()->empty());
  EXPECT_TRUE(PutWhole(store_->blobs(), std::string(5000, 'x')).ok());
}

}  // namespace
}  // namespace ccst::server
