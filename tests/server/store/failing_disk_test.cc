#include <filesystem>
#include <memory>
#include <string>
#include <utility>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

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

// Takes what the disk has left, to the last byte, as others on the same disk may.
void Fill(const std::string& folder, const char* name) {
  const int file = open((folder + "/" + name).c_str(), O_WRONLY | O_CREAT, S_IRUSR | S_IWUSR);
  const std::string chunk(4096, 'f');
  while (write(file, chunk.data(), chunk.size()) > 0) {
  }
  close(file);
}

TEST_F(SmallDisk, FullToTheLastByteStillDeletesCancelsAndEnds) {
  constexpr int kCount = 60;
  store_.reset();
  ASSERT_EQ(mount("ccst", folder_.path().c_str(), "tmpfs", MS_REMOUNT, "size=16m"), 0);
  store_ = *OpenEmbeddedStore(folder_.path());
  const std::string history(5000, 'h');
  for (int i = 0; i < kCount; ++i) {
    const JobRecord job = SomeJob(std::to_string(i), At(i));
    ASSERT_TRUE(store_->AddJob(job).ok());
    if (i % 3 == 0) {
      ASSERT_TRUE(store_->EndJob(Ended(job), history).ok());
    }
    ASSERT_TRUE(store_->PutMesh(SomeMesh("ann", std::to_string(i))).ok());
  }
  const std::string blob = *PutWhole(store_->blobs(), std::string(300000, 'b'));
  Fill(folder_.path(), "others");
  ExpectError(PutWhole(store_->blobs(), "more").status(), absl::StatusCode::kResourceExhausted,
              "STORAGE_FULL");
  for (int i = 0; i < kCount; ++i) {
    const std::string id = std::to_string(i);
    if (i % 3 == 0) {
      EXPECT_TRUE(store_->DeleteJob(id).ok()) << i;
    } else {
      EXPECT_TRUE(store_->MarkCancelling(id).ok()) << i;
      JobRecord cancelled = Ended(SomeJob(id, At(i)));
      cancelled.state = JobState::kCancelled;
      cancelled.samples_sha256.clear();
      EXPECT_TRUE(store_->EndJob(cancelled, "").ok()) << i;
    }
    EXPECT_TRUE(store_->DeleteMesh("ann", Digest(id)).ok()) << i;
  }
  ASSERT_TRUE(store_->blobs().Remove(blob).ok());
  EXPECT_TRUE(store_->AddJob(SomeJob("new")).ok());
  EXPECT_TRUE(PutWhole(store_->blobs(), "more").ok());
  store_.reset();
  store_ = *OpenEmbeddedStore(folder_.path());
  EXPECT_EQ(store_->ListJobs({}, 1000, "")->records.size(), kCount - kCount / 3 + 1);
  EXPECT_EQ(store_->UnfinishedJobs()->size(), 1);
}

TEST_F(SmallDisk, FullToTheLastByteIsOpenedAndEmptied) {
  ASSERT_TRUE(store_->AddEndedJob(Ended(SomeJob("a")), "history").ok());
  store_.reset();
  Fill(folder_.path(), "others");
  auto store = OpenEmbeddedStore(folder_.path());
  ASSERT_TRUE(store.ok()) << store.status();
  store_ = *std::move(store);
  EXPECT_EQ(*store_->GetHistory("a"), "history");
  EXPECT_TRUE(store_->DeleteJob("a").ok());
  ASSERT_TRUE(std::filesystem::remove(folder_.path() + "/others"));
  EXPECT_TRUE(store_->AddJob(SomeJob("b")).ok());
}

TEST_F(SmallDisk, ReserveIsMadeAgainForTheNextTime) {
  for (int round = 0; round < 3; ++round) {
    const std::string id = std::to_string(round);
    ASSERT_TRUE(store_->AddEndedJob(Ended(SomeJob(id)), std::string(5000, 'h')).ok());
    Fill(folder_.path(), "others");
    EXPECT_TRUE(store_->DeleteJob(id).ok()) << round;
    ASSERT_TRUE(std::filesystem::remove(folder_.path() + "/others"));
  }
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
         {store_->AddJob(SomeJob("b")).status(),
          store_->AddEndedJob(Ended(SomeJob("b")), "history").status(),
          store_->EndJob(Ended(job), "history"), store_->DeleteJob("a"),
          store_->MarkCancelling("a"), store_->PutMesh(SomeMesh("ann", "mesh"))}) {
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

TEST(Descriptors, ThatAreUsedUpAreNoFaultOfTheDisk) {
#if defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "the sanitizer's own checks need descriptors";
#endif
  const TestFolder folder;
  auto store = *OpenEmbeddedStore(folder.path());
  const std::string sha256 = *PutWhole(store->blobs(), "bytes");
  rlimit before = {};
  getrlimit(RLIMIT_NOFILE, &before);
  const rlimit none = {.rlim_cur = 0, .rlim_max = before.rlim_max};
  setrlimit(RLIMIT_NOFILE, &none);
  const absl::Status written = store->blobs().NewBlob().status();
  const absl::Status read = store->blobs().Open(sha256).status();
  const absl::Status deleted = store->DeleteJob("a");
  setrlimit(RLIMIT_NOFILE, &before);
  ExpectError(written, absl::StatusCode::kResourceExhausted, "QUEUE_FULL");
  ExpectError(read, absl::StatusCode::kResourceExhausted, "QUEUE_FULL");
  EXPECT_TRUE(deleted.ok()) << deleted;
  EXPECT_TRUE(store->blobs().NewBlob().ok());
}

}  // namespace
}  // namespace ccst::server
