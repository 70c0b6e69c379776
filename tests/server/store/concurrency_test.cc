#include <atomic>
#include <barrier>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "tests/server/store/store_fixture.h"

namespace ccst::server {
namespace {

constexpr int kThreadCount = 8;
constexpr int kJobsPerThread = 10;

class Concurrency : public StoreTest {
 protected:
  template <typename Work>
  void OnThreads(const Work& work) {
    std::vector<std::jthread> threads;
    for (int i = 0; i < kThreadCount; ++i) threads.emplace_back([&work, i] { work(i); });
  }
};

TEST_F(Concurrency, ThreadsDoNotDisturbEachOther) {
  OnThreads([this](int thread) {
    for (int i = 0; i < kJobsPerThread; ++i) {
      const JobRecord job = SomeJob(std::to_string(thread) + "-" + std::to_string(i), At(i));
      const std::string samples = *PutWhole(store_->blobs(), "samples of " + job.id);
      EXPECT_TRUE(store_->AddJob(job).ok());
      EXPECT_TRUE(store_->ListJobs({}, 5, "").ok());
      EXPECT_TRUE(store_->EndJob(Ended(job), "history of " + job.id).ok());
      ExpectSame(store_->GetJob(job.id)->value(), Ended(job));
      EXPECT_EQ(*store_->GetHistory(job.id), "history of " + job.id);
      EXPECT_EQ(*ReadWhole(store_->blobs(), samples), "samples of " + job.id);
    }
  });
  EXPECT_EQ(store_->ListJobs({}, 1000, "")->records.size(), kThreadCount * kJobsPerThread);
}

TEST_F(Concurrency, OneRequestSentManyTimesAtOnceIsOneJob) {
  std::vector<std::string> ids(kThreadCount);
  OnThreads([this, &ids](int thread) {
    JobRecord job = SomeJob(std::to_string(thread));
    job.request_id = "the same";
    ids[static_cast<std::size_t>(thread)] = store_->AddJob(job)->id;
  });
  for (const std::string& id : ids) EXPECT_EQ(id, ids[0]);
  EXPECT_EQ(store_->ListJobs({}, 100, "")->records.size(), 1);
}

TEST_F(Concurrency, OneBlobPutReadAndRemovedAtOnceIsWholeOrNotThere) {
  const std::string bytes(100000, 'x');
  std::atomic<int> read_count = 0;
  OnThreads([this, &bytes, &read_count](int thread) {
    for (int i = 0; i < kJobsPerThread; ++i) {
      EXPECT_TRUE(PutWhole(store_->blobs(), bytes).ok());
      const auto whole = ReadWhole(store_->blobs(), Digest(bytes));
      if (whole.ok()) {
        EXPECT_TRUE(*whole == bytes);
        ++read_count;
      } else {
        ExpectError(whole.status(), absl::StatusCode::kNotFound, "NOT_FOUND");
      }
      if (thread == 0) {
        EXPECT_TRUE(store_->blobs().Remove(Digest(bytes)).ok());
      }
    }
  });
  EXPECT_GT(read_count, 0);
}

TEST_F(Concurrency, SpaceIsThatOfTheFilesWhoeverPutsAndRemovesOneBlobAtOnce) {
  constexpr std::int64_t kLimit = std::int64_t{1} << 20;
  constexpr int kRounds = 300;
  store_ = nullptr;
  store_ = *OpenEmbeddedStore(directory_, kLimit);
  const std::string bytes(1000, 'x');
  std::barrier round(kThreadCount);
  OnThreads([&](int thread) {
    for (int i = 0; i < kRounds; ++i) {
      // All commit at once, then all remove at once, then both.
      auto writer = *store_->blobs().NewBlob();
      EXPECT_TRUE(writer->Append(bytes).ok());
      const std::string sha256 = writer->Seal();
      round.arrive_and_wait();
      EXPECT_TRUE(writer->Commit().ok());
      if (thread % 2 == 0 || i % 2 == 0) round.arrive_and_wait();
      EXPECT_TRUE(store_->blobs().Remove(sha256).ok());
      if (thread % 2 == 1 && i % 2 == 1) round.arrive_and_wait();
    }
  });
  ASSERT_TRUE(store_->blobs().Remove(Digest(bytes)).ok());
  EXPECT_TRUE(store_->blobs().CheckRoom(kLimit).ok());
  EXPECT_FALSE(store_->blobs().CheckRoom(kLimit + 1).ok());
}

}  // namespace
}  // namespace ccst::server
