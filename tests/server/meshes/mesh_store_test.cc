#include <stdexcept>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/status.h"
#include "tests/server/meshes/mesh_store_fixture.h"

namespace ccst::server {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

using MeshStores = MeshStoreTest;

std::vector<std::string> Digests(const Page<StoredMesh>& page) {
  std::vector<std::string> digests;
  for (const StoredMesh& mesh : page.records) digests.push_back(mesh.record.sha256);
  return digests;
}

TEST_F(MeshStores, UploadIsStoredWithItsFacts) {
  const std::string bytes = CubeBytes();
  const StoredMesh mesh = *Upload("ann", bytes);
  EXPECT_EQ(mesh.record.owner, "ann");
  EXPECT_EQ(mesh.record.sha256, Digest(bytes));
  EXPECT_EQ(mesh.record.size_bytes, static_cast<std::int64_t>(bytes.size()));
  EXPECT_EQ(mesh.record.display_name, "a mesh");
  EXPECT_EQ(mesh.record.create_time, now_);
  EXPECT_EQ(mesh.record.expire_time, now_ + options_.retention);
  EXPECT_EQ(mesh.facts.file_faces, 12);
  const StoredMesh found = *meshes().Get("ann", Digest(bytes));
  ExpectSame(found.record, mesh.record);
  EXPECT_DOUBLE_EQ(found.facts.area, 24.0);
  EXPECT_EQ(*ReadWhole(store_->blobs(), Digest(bytes)), bytes);
}

TEST_F(MeshStores, AnswerIsWhatIsFoundLaterThoughTheClockIsFinerThanRecords) {
  now_ = At(0) + absl::Nanoseconds(1234);
  const StoredMesh mesh = *Upload("ann", CubeBytes());
  ExpectSame(meshes().Get("ann", mesh.record.sha256)->record, mesh.record);
}

TEST_F(MeshStores, WrongDigestIsRefusedAndNothingStays) {
  MeshUpload upload = Announced("ann", CubeBytes());
  upload.sha256 = Digest("something else");
  auto writer = *meshes().Begin(upload);
  ASSERT_TRUE(writer->Append(CubeBytes()).ok());
  ExpectError(meshes().Finish(upload, *writer).status(), absl::StatusCode::kInvalidArgument,
              "DIGEST_MISMATCH");
  writer.reset();
  EXPECT_EQ(FileCount(), 0u);
}

TEST_F(MeshStores, WrongSizeIsRefusedAndNothingStays) {
  MeshUpload upload = Announced("ann", CubeBytes());
  ++upload.size_bytes;
  auto writer = *meshes().Begin(upload);
  ASSERT_TRUE(writer->Append(CubeBytes()).ok());
  ExpectError(meshes().Finish(upload, *writer).status(), absl::StatusCode::kInvalidArgument,
              "DIGEST_MISMATCH");
  writer.reset();
  EXPECT_EQ(FileCount(), 0u);
}

TEST_F(MeshStores, BytesThatAreNoMeshAreRefusedAndNothingStays) {
  ExpectError(Upload("ann", "no mesh").status(), absl::StatusCode::kInvalidArgument,
              "DRACO_DECODE_FAILED");
  EXPECT_EQ(FileCount(), 0u);
  EXPECT_THAT(meshes().List("ann", 10, "")->records, IsEmpty());
}

TEST_F(MeshStores, BytesOfAnotherOwnerStayWhenTheyAreRefusedHere) {
  const std::string bytes = CubeBytes();
  ASSERT_TRUE(Upload("ann", bytes).ok());
  BlobPins pins(*store_);
  MeshStore tight(
      *store_, pins, options_,
      {.decode = [](std::span<const char>, const MeshLimits&) -> absl::StatusOr<TriangleMesh> {
         throw std::runtime_error("broken");
       },
       .take_memory = {},
       .measure = {},
       .clock = {.now = [this] { return now_; }, .seconds = {}}});
  auto writer = *store_->blobs().NewBlob();
  ASSERT_TRUE(writer->Append(bytes).ok());
  EXPECT_THROW(tight.Finish(Announced("bob", bytes), *writer).IgnoreError(), std::runtime_error);
  EXPECT_EQ(FileCount(), 1u);
}

TEST_F(MeshStores, OwnerSeesOnlyItsOwn) {
  const std::string sha256 = Upload("ann", CubeBytes())->record.sha256;
  ExpectError(meshes().Get("bob", sha256).status(), absl::StatusCode::kNotFound, "NOT_FOUND");
  ExpectError(meshes().Use("bob", sha256).status(), absl::StatusCode::kNotFound, "NOT_FOUND");
  ExpectError(meshes().Open("bob", sha256).status(), absl::StatusCode::kNotFound, "NOT_FOUND");
  ExpectError(meshes().Delete("bob", sha256), absl::StatusCode::kNotFound, "NOT_FOUND");
  EXPECT_THAT(meshes().List("bob", 10, "")->records, IsEmpty());
  const auto size = static_cast<std::int64_t>(CubeBytes().size());
  EXPECT_THAT(*meshes().FindMissing("bob", {{sha256, size}}), SizeIs(1));
}

TEST_F(MeshStores, EqualBytesOfTwoOwnersAreOneBlobUntilBothAreGone) {
  const std::string sha256 = Upload("ann", CubeBytes())->record.sha256;
  ASSERT_TRUE(Upload("bob", CubeBytes()).ok());
  EXPECT_EQ(FileCount(), 1u);
  ASSERT_TRUE(meshes().Delete("ann", sha256).ok());
  EXPECT_EQ(FileCount(), 1u);
  EXPECT_TRUE(meshes().Open("bob", sha256).ok());
  ASSERT_TRUE(meshes().Delete("bob", sha256).ok());
  EXPECT_EQ(FileCount(), 0u);
}

TEST_F(MeshStores, SecondUploadLeavesTheRecordAndMovesItsExpiry) {
  const StoredMesh first = *Upload("ann", CubeBytes());
  now_ = At(60);
  const StoredMesh second = *Upload("ann", CubeBytes());
  EXPECT_EQ(second.record.create_time, first.record.create_time);
  EXPECT_EQ(second.record.expire_time, At(60) + options_.retention);
}

TEST_F(MeshStores, MissingIsWhatIsNotHeldInThisSize) {
  const std::string bytes = CubeBytes();
  ASSERT_TRUE(Upload("ann", bytes).ok());
  const auto size = static_cast<std::int64_t>(bytes.size());
  const std::vector<MeshDigest> missing = *meshes().FindMissing(
      "ann", {{Digest(bytes), size}, {Digest("other"), 5}, {Digest(bytes), size + 1}});
  ASSERT_THAT(missing, SizeIs(2));
  EXPECT_EQ(missing[0].sha256, Digest("other"));
  EXPECT_EQ(missing[1].size_bytes, size + 1);
}

TEST_F(MeshStores, MeshExpiresWhenUnusedForTheRetention) {
  const std::string sha256 = Upload("ann", CubeBytes())->record.sha256;
  now_ = At(0) + options_.retention;
  EXPECT_TRUE(meshes().Get("ann", sha256).ok());
  now_ += absl::Seconds(1);
  ExpectError(meshes().Get("ann", sha256).status(), absl::StatusCode::kNotFound, "NOT_FOUND");
  EXPECT_THAT(meshes().List("ann", 10, "")->records, IsEmpty());
  ASSERT_TRUE(meshes().DropExpired().ok());
  EXPECT_EQ(FileCount(), 0u);
  EXPECT_FALSE(store_->GetMesh("ann", sha256)->has_value());
}

TEST_F(MeshStores, UseMovesTheExpiryAndLookingDoesNot) {
  const std::string bytes = CubeBytes();
  const std::string sha256 = Upload("ann", bytes)->record.sha256;
  const auto expiry = [&] { return meshes().Get("ann", sha256)->record.expire_time; };
  now_ = At(1);
  EXPECT_EQ(meshes().Use("ann", sha256)->record.expire_time, At(1) + options_.retention);
  EXPECT_EQ(expiry(), At(1) + options_.retention);
  now_ = At(2);
  ASSERT_TRUE(meshes().Open("ann", sha256).ok());
  const MeshDigest digest = {sha256, static_cast<std::int64_t>(bytes.size())};
  ASSERT_TRUE(meshes().FindMissing("ann", {digest}, /*is_use=*/false).ok());
  EXPECT_EQ(expiry(), At(1) + options_.retention);
  now_ = At(3);
  ASSERT_TRUE(meshes().FindMissing("ann", {digest}).ok());
  EXPECT_EQ(expiry(), At(3) + options_.retention);
}

TEST_F(MeshStores, ExpiredMeshOfARunningJobIsKeptUntilItEnds) {
  const std::string sha256 = Upload("ann", CubeBytes())->record.sha256;
  AddJob("ann", sha256);
  now_ = At(1) + options_.retention;
  ASSERT_TRUE(meshes().DropExpired().ok());
  EXPECT_EQ(FileCount(), 1u);
  EndJobs();
  ASSERT_TRUE(meshes().DropExpired().ok());
  EXPECT_FALSE(store_->GetMesh("ann", sha256)->has_value());
}

TEST_F(MeshStores, ExpiredMeshCanBeUploadedAgain) {
  const std::string sha256 = Upload("ann", CubeBytes())->record.sha256;
  now_ = At(1) + options_.retention;
  EXPECT_EQ(Upload("ann", CubeBytes())->record.create_time, now_);
  ASSERT_TRUE(meshes().DropExpired().ok());
  EXPECT_TRUE(meshes().Get("ann", sha256).ok());
}

TEST_F(MeshStores, MoreThanABatchOfExpiredMeshesIsDropped) {
  AcceptAnyBytes();
  for (int i = 0; i < 40; ++i) ASSERT_TRUE(Upload("ann", "mesh" + std::to_string(i)).ok());
  now_ = At(1) + options_.retention;
  ASSERT_TRUE(meshes().DropExpired().ok());
  EXPECT_EQ(FileCount(), 0u);
}

TEST_F(MeshStores, MeshOfAJobThatHasNotEndedIsNotDeleted) {
  const std::string sha256 = Upload("ann", CubeBytes())->record.sha256;
  AddJob("ann", sha256);
  ExpectError(meshes().Delete("ann", sha256), absl::StatusCode::kFailedPrecondition, "MESH_IN_USE");
  EndJobs();
  EXPECT_TRUE(meshes().Delete("ann", sha256).ok());
  ExpectError(meshes().Delete("ann", sha256), absl::StatusCode::kNotFound, "NOT_FOUND");
}

TEST_F(MeshStores, OpenMeshIsReadToItsEndThoughDeleted) {
  const std::string bytes = CubeBytes();
  ASSERT_TRUE(Upload("ann", bytes).ok());
  const auto blob = *meshes().Open("ann", Digest(bytes));
  ASSERT_TRUE(meshes().Delete("ann", Digest(bytes)).ok());
  std::string read(bytes.size(), '\0');
  ASSERT_TRUE(blob->Read(0, read).ok());
  EXPECT_EQ(read, bytes);
}

TEST_F(MeshStores, ListIsNewestFirstAndPaged) {
  AcceptAnyBytes();
  for (int i = 0; i < 3; ++i) {
    now_ = At(i);
    ASSERT_TRUE(Upload("ann", "mesh" + std::to_string(i)).ok());
  }
  const Page<StoredMesh> first = *meshes().List("ann", 2, "");
  EXPECT_THAT(Digests(first), ElementsAre(Digest("mesh2"), Digest("mesh1")));
  const Page<StoredMesh> second = *meshes().List("ann", 2, first.next_token);
  EXPECT_THAT(Digests(second), ElementsAre(Digest("mesh0")));
  EXPECT_EQ(second.next_token, "");
  ExpectError(meshes().List("ann", 2, "no token").status(), absl::StatusCode::kInvalidArgument,
              "REQUEST_INVALID");
}

TEST_F(MeshStores, MeshesOutliveARestart) {
  const std::string sha256 = Upload("ann", CubeBytes())->record.sha256;
  Reopen();
  EXPECT_EQ(FileCount(), 1u);
  EXPECT_TRUE(store_->GetMesh("ann", sha256)->has_value());
}

TEST_F(MeshStores, MemoryIsHeldWhileAMeshIsDecodedAndMeasured) {
  const auto memory = std::make_shared<int>();
  std::vector<long> users;  // Of the memory, ours included.
  dependencies_.take_memory =
      [&](const ByteSource& source) -> absl::StatusOr<std::shared_ptr<void>> {
    std::string bytes(static_cast<std::size_t>(source.size), '\0');
    EXPECT_TRUE(source.read(0, bytes).ok());
    EXPECT_EQ(bytes, CubeBytes());
    return memory;
  };
  dependencies_.measure = [&](const TriangleMesh& mesh) {
    users.push_back(memory.use_count());
    return MeasureMesh(mesh);
  };
  ASSERT_TRUE(Upload("ann", CubeBytes()).ok());
  EXPECT_THAT(users, ElementsAre(2));
  EXPECT_EQ(memory.use_count(), 1);
}

TEST_F(MeshStores, MeshForWhichThereIsNoMemoryIsRefusedAndNothingStays) {
  dependencies_.take_memory = [](const ByteSource&) -> absl::StatusOr<std::shared_ptr<void>> {
    return MakeError(absl::StatusCode::kResourceExhausted, ErrorReason::kQueueFull, "later");
  };
  ExpectError(Upload("ann", CubeBytes()).status(), absl::StatusCode::kResourceExhausted,
              "QUEUE_FULL");
  EXPECT_EQ(FileCount(), 0U);
}

}  // namespace
}  // namespace ccst::server
