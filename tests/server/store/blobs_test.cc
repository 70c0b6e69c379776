#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/limit_error.h"
#include "tests/server/store/store_fixture.h"

namespace ccst::server {
namespace {

using testing::IsEmpty;
using testing::UnorderedElementsAre;

class Blobs : public StoreTest {
 protected:
  std::filesystem::path FileOf(const std::string& sha256) const {
    return std::filesystem::path(directory_) / "blobs" / sha256.substr(0, 2) / sha256;
  }
  std::size_t IncomingCount() const {
    const std::filesystem::directory_iterator entries(directory_ + "/incoming");
    return static_cast<std::size_t>(std::distance(begin(entries), end(entries)));
  }
};

TEST_F(Blobs, ComeBackAsTheyWerePut) {
  for (const std::string& bytes :
       {std::string(), std::string("a\0b", 3), std::string(3000000, 'x')}) {
    const std::string sha256 = *PutWhole(store_->blobs(), bytes);
    EXPECT_EQ(sha256, Digest(bytes));
    EXPECT_TRUE(*ReadWhole(store_->blobs(), sha256) == bytes);
  }
}

TEST_F(Blobs, ArePutInPieces) {
  auto writer = *store_->blobs().NewBlob();
  ASSERT_TRUE(writer->Append("one ").ok());
  ASSERT_TRUE(writer->Append("").ok());
  ASSERT_TRUE(writer->Append("two").ok());
  EXPECT_EQ(writer->size_bytes(), 7);
  EXPECT_EQ(writer->Seal(), Digest("one two"));
  EXPECT_FALSE(store_->blobs().Contains(Digest("one two")));
  ASSERT_TRUE(writer->Commit().ok());
  EXPECT_TRUE(store_->blobs().Contains(Digest("one two")));
}

TEST_F(Blobs, ReadGivesAnyRange) {
  const std::string sha256 = *PutWhole(store_->blobs(), "0123456789");
  const auto blob = *store_->blobs().Open(sha256);
  EXPECT_EQ(blob->size_bytes(), 10);
  std::string part(4, '\0');
  ASSERT_TRUE(blob->Read(3, part).ok());
  EXPECT_EQ(part, "3456");
  ExpectError(blob->Read(7, part), absl::StatusCode::kInternal, "STORAGE_FAILED");
}

TEST_F(Blobs, UncommittedLeaveNothing) {
  {
    auto writer = *store_->blobs().NewBlob();
    ASSERT_TRUE(writer->Append("given up").ok());
    writer->Seal();
    EXPECT_EQ(IncomingCount(), 1);
  }
  EXPECT_EQ(IncomingCount(), 0);
  EXPECT_THAT(*store_->blobs().List(), IsEmpty());
}

TEST_F(Blobs, CommittingTheSameBytesTwiceIsRight) {
  const std::string sha256 = *PutWhole(store_->blobs(), "same");
  EXPECT_EQ(*PutWhole(store_->blobs(), "same"), sha256);
  EXPECT_EQ(*ReadWhole(store_->blobs(), sha256), "same");
  EXPECT_THAT(*store_->blobs().List(), UnorderedElementsAre(sha256));
  EXPECT_EQ(IncomingCount(), 0);
}

TEST_F(Blobs, RemovedOneStaysReadableWhileOpen) {
  const std::string sha256 = *PutWhole(store_->blobs(), "bytes");
  const auto blob = *store_->blobs().Open(sha256);
  ASSERT_TRUE(store_->blobs().Remove(sha256).ok());
  EXPECT_FALSE(store_->blobs().Contains(sha256));
  std::string bytes(5, '\0');
  ASSERT_TRUE(blob->Read(0, bytes).ok());
  EXPECT_EQ(bytes, "bytes");
  ExpectError(store_->blobs().Open(sha256).status(), absl::StatusCode::kNotFound, "NOT_FOUND");
  EXPECT_TRUE(store_->blobs().Remove(sha256).ok());
}

TEST_F(Blobs, WhatIsNoDigestIsNotThere) {
  for (const char* name : {"", "..", "../../lock", "ab", "../records.sqlite"}) {
    EXPECT_FALSE(store_->blobs().Contains(name));
    ExpectError(store_->blobs().Open(name).status(), absl::StatusCode::kNotFound, "NOT_FOUND");
    EXPECT_TRUE(store_->blobs().Remove(name).ok());
  }
  EXPECT_TRUE(std::filesystem::exists(directory_ + "/records.sqlite"));
}

TEST_F(Blobs, DamagedBytesAreNoticed) {
  const std::string sha256 = *PutWhole(store_->blobs(), "bytes");
  std::fstream(FileOf(sha256), std::ios::in | std::ios::out) << 'B';
  ExpectError(ReadWhole(store_->blobs(), sha256).status(), absl::StatusCode::kDataLoss,
              "STORAGE_FAILED");
}

TEST_F(Blobs, PuttingADamagedOneAgainRepairsIt) {
  const std::string sha256 = *PutWhole(store_->blobs(), "bytes");
  std::filesystem::resize_file(FileOf(sha256), 2);
  ASSERT_TRUE(PutWhole(store_->blobs(), "bytes").ok());
  EXPECT_EQ(*ReadWhole(store_->blobs(), sha256), "bytes");
}

TEST_F(Blobs, ReferredOnesAreKeptAtOpenAndOthersRemoved) {
  const std::string mesh = *PutWhole(store_->blobs(), "mesh");
  const std::string texture = *PutWhole(store_->blobs(), "texture");
  const std::string samples = *PutWhole(store_->blobs(), "samples of a");
  const std::string orphan = *PutWhole(store_->blobs(), "orphan");
  const JobRecord job = SomeJob("a");
  ASSERT_TRUE(store_->AddJob(job).ok());
  ASSERT_TRUE(store_->EndJob(Ended(job), "").ok());
  const std::string lone_mesh = *PutWhole(store_->blobs(), "lone mesh");
  ASSERT_TRUE(store_->PutMesh(SomeMesh("ann", "lone mesh")).ok());
  EXPECT_EQ(store_->blobs().List()->size(), 5);
  Reopen();
  EXPECT_THAT(*store_->blobs().List(), UnorderedElementsAre(mesh, texture, samples, lone_mesh));
}

TEST_F(Blobs, AllTogetherHaveNoMoreThanTheLimit) {
  store_ = nullptr;
  store_ = *OpenEmbeddedStore(directory_, 100);
  const std::string first = *PutWhole(store_->blobs(), std::string(60, 'a'));
  ExpectError(PutWhole(store_->blobs(), std::string(41, 'b')).status(),
              absl::StatusCode::kResourceExhausted, "STORAGE_FULL");
  ExpectError(store_->blobs().CheckRoom(41), absl::StatusCode::kResourceExhausted, "STORAGE_FULL");
  EXPECT_TRUE(store_->blobs().CheckRoom(40).ok());
  // Neither the same bytes again nor one that is given up counts.
  EXPECT_TRUE(PutWhole(store_->blobs(), std::string(40, 'c')).ok());
  ASSERT_TRUE(store_->blobs().Remove(Digest(std::string(40, 'c'))).ok());
  {
    const auto given_up = *store_->blobs().NewBlob();
    ASSERT_TRUE(given_up->Append(std::string(40, 'd')).ok());
    EXPECT_FALSE(store_->blobs().CheckRoom(1).ok());
  }
  EXPECT_TRUE(store_->blobs().CheckRoom(40).ok());
  ASSERT_TRUE(store_->blobs().Remove(first).ok());
  EXPECT_TRUE(PutWhole(store_->blobs(), std::string(100, 'e')).ok());
  EXPECT_FALSE(store_->blobs().CheckRoom(1).ok());
}

TEST_F(Blobs, MoreThanTheDiskHasDoesNotFit) {
  const auto free_bytes = static_cast<std::int64_t>(std::filesystem::space(directory_).available);
  EXPECT_TRUE(store_->blobs().CheckRoom(1).ok());
  // The disk is not this test's alone; twice what it has is too much in any case.
  ExpectError(store_->blobs().CheckRoom(2 * free_bytes), absl::StatusCode::kResourceExhausted,
              "STORAGE_FULL");
}

TEST_F(Blobs, WhatAloneIsOverTheLimitIsNeverKept) {
  store_ = nullptr;
  store_ = *OpenEmbeddedStore(directory_, 100);
  const absl::Status refused = store_->blobs().CheckRoom(101);
  ExpectError(refused, absl::StatusCode::kInvalidArgument, "LIMIT_EXCEEDED");
  ASSERT_TRUE(GetPassedLimit(refused).has_value());
  EXPECT_EQ(GetPassedLimit(refused)->name, "max_data_bytes");
  EXPECT_EQ(GetPassedLimit(refused)->value, 100);
  EXPECT_EQ(GetPassedLimit(refused)->requested, 101);
}

TEST_F(Blobs, SameBytesTwiceTakeTheirSpaceOnce) {
  store_ = nullptr;
  store_ = *OpenEmbeddedStore(directory_, 100);
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(PutWhole(store_->blobs(), std::string(50, 'a')).ok());
  EXPECT_TRUE(store_->blobs().CheckRoom(50).ok());
}

TEST_F(Blobs, ThoseOfBeforeCountTowardsTheLimit) {
  const std::string kept = *PutWhole(store_->blobs(), std::string(60, 'a'));
  MeshRecord mesh = SomeMesh("ann", "x");
  mesh.sha256 = kept;
  ASSERT_TRUE(store_->PutMesh(mesh).ok());
  store_ = nullptr;
  store_ = *OpenEmbeddedStore(directory_, 50);  // Has become smaller, which loses nothing.
  EXPECT_EQ(*ReadWhole(store_->blobs(), kept), std::string(60, 'a'));
  EXPECT_FALSE(store_->blobs().CheckRoom(1).ok());
}

TEST_F(Blobs, UnfinishedFilesOfACrashAreRemovedAtOpen) {
  std::ofstream(directory_ + "/incoming/17") << "half";
  Reopen();
  EXPECT_EQ(IncomingCount(), 0);
  EXPECT_TRUE(PutWhole(store_->blobs(), "whole").ok());
}

}  // namespace
}  // namespace ccst::server
