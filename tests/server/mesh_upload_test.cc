#include <cstdio>
#include <optional>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "core/base/sha256.h"
#include "core/base/status.h"
#include "server/rpc/upload_slots.h"
#include "tests/server/mesh_service_fixture.h"

namespace ccst::server {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

using UploadMesh = MeshServiceTest;

// Of this process.
std::int64_t ResidentBytes() {
  long pages = 0;
  std::FILE* file = std::fopen("/proc/self/statm", "r");
  if (file == nullptr || std::fscanf(file, "%*s %ld", &pages) != 1) ADD_FAILURE();
  if (file != nullptr) std::fclose(file);
  return pages * sysconf(_SC_PAGESIZE);
}

TEST_F(UploadMesh, WholeMeshIsStoredWithItsFacts) {
  const std::string bytes = SphereBytes();
  const auto reply = Upload(bytes);
  ASSERT_TRUE(reply.status.ok()) << reply.status.error_message();
  EXPECT_FALSE(reply.response.already_present());
  const v1::Mesh& mesh = reply.response.mesh();
  EXPECT_EQ(mesh.name(), "meshes/" + Digest(bytes));
  EXPECT_EQ(mesh.digest().sha256(), Digest(bytes));
  EXPECT_EQ(mesh.digest().size_bytes(), static_cast<std::int64_t>(bytes.size()));
  EXPECT_EQ(mesh.format(), v1::MESH_FORMAT_DRACO);
  EXPECT_EQ(mesh.display_name(), "a sphere");
  EXPECT_EQ(mesh.create_time().seconds(), absl::ToUnixSeconds(now_));
  EXPECT_EQ(mesh.expire_time().seconds(), absl::ToUnixSeconds(now_ + store_options_.retention));
  EXPECT_EQ(mesh.face_count(), 1280);
  EXPECT_EQ(mesh.vertex_count(), 642);
  EXPECT_EQ(mesh.component_count(), 1);
  EXPECT_NEAR(mesh.surface_area(), 12.5, 0.1);
  EXPECT_NEAR(mesh.bounds_max().z(), 1.0, 1e-6);
  EXPECT_EQ(*ReadWhole(store_->blobs(), Digest(bytes)), bytes);
}

TEST_F(UploadMesh, ChunkBeforeTheHeaderIsRefused) {
  const auto reply = Send({ChunkMessage(0, "bytes")});
  ExpectStatus(reply.status, grpc::StatusCode::INVALID_ARGUMENT, "REQUEST_INVALID");
  EXPECT_THAT(WrongFields(reply.status), ElementsAre("header"));
}

TEST_F(UploadMesh, NothingAtAllIsRefused) {
  ExpectStatus(Send({}).status, grpc::StatusCode::INVALID_ARGUMENT, "REQUEST_INVALID");
}

TEST_F(UploadMesh, SecondHeaderIsRefused) {
  const auto reply = Send({HeaderMessage("bytes"), HeaderMessage("bytes")});
  ExpectStatus(reply.status, grpc::StatusCode::INVALID_ARGUMENT, "REQUEST_INVALID");
  EXPECT_THAT(WrongFields(reply.status), ElementsAre("chunk"));
}

TEST_F(UploadMesh, EverythingWrongWithTheHeaderIsSaidAtOnce) {
  v1::UploadMeshRequest message;
  message.mutable_header()->mutable_digest()->set_sha256("ABC");
  std::string name;
  for (int i = 0; i < 129; ++i) name += "ä";
  message.mutable_header()->set_display_name(name);
  const auto reply = Send({message}, false);
  ExpectStatus(reply.status, grpc::StatusCode::INVALID_ARGUMENT, "REQUEST_INVALID");
  EXPECT_THAT(WrongFields(reply.status),
              ElementsAre("header.digest.sha256", "header.digest.size_bytes", "header.format",
                          "header.display_name"));
}

TEST_F(UploadMesh, DisplayNameIsCountedInCharacters) {
  const std::string bytes = SphereBytes();
  v1::UploadMeshRequest header = HeaderMessage(bytes);
  std::string name;
  for (int i = 0; i < 128; ++i) name += "ä";
  header.mutable_header()->set_display_name(name);
  const auto reply = Send({header, ChunkMessage(0, bytes)});
  EXPECT_TRUE(reply.status.ok()) << reply.status.error_message();
  EXPECT_EQ(reply.response.mesh().display_name(), name);
}

TEST_F(UploadMesh, MeshOverTheLimitIsRefusedOnTheHeader) {
  store_options_.max_mesh_bytes = 99;
  const auto reply = Send({HeaderMessage(std::string(100, 'x'))}, false);
  ExpectStatus(reply.status, grpc::StatusCode::INVALID_ARGUMENT, "LIMIT_EXCEEDED");
  const auto violation = DetailOf<v1::LimitViolation>(reply.status);
  ASSERT_TRUE(violation.has_value());
  EXPECT_EQ(violation->limit(), "max_mesh_bytes");
  EXPECT_EQ(violation->limit_value(), 99);
  EXPECT_EQ(violation->requested_value(), 100);
}

TEST_F(UploadMesh, MeshThatFitsBesideNothingInUseIsRefusedOnTheHeader) {
  AcceptAnyBytes();
  store_options_.max_stored_bytes = 99;
  const std::string held(50, 'h');
  ASSERT_TRUE(Upload(held).status.ok());
  JobRecord job = SomeJob("a");
  job.mesh_sha256 = Digest(held);
  ASSERT_TRUE(store_->AddJob(job).ok());
  const auto reply = Send({HeaderMessage(std::string(60, 'x'))}, false);
  ExpectStatus(reply.status, grpc::StatusCode::RESOURCE_EXHAUSTED, "QUOTA_EXCEEDED");
  const auto violation = DetailOf<v1::LimitViolation>(reply.status);
  ASSERT_TRUE(violation.has_value());
  EXPECT_EQ(violation->limit(), "max_stored_mesh_bytes");
  EXPECT_EQ(violation->limit_value(), 99);
  EXPECT_EQ(violation->requested_value(), 60);
  EXPECT_TRUE(DetailOf<v1::RetryAdvice>(reply.status).has_value());
}

TEST_F(UploadMesh, MeshThatNeverFitsTheQuotaIsNotToldToComeAgain) {
  store_options_.max_stored_bytes = 99;
  const auto reply = Send({HeaderMessage(std::string(100, 'x'))}, false);
  ExpectStatus(reply.status, grpc::StatusCode::INVALID_ARGUMENT, "LIMIT_EXCEEDED");
  const auto violation = DetailOf<v1::LimitViolation>(reply.status);
  ASSERT_TRUE(violation.has_value());
  EXPECT_EQ(violation->limit(), "max_stored_mesh_bytes");
  EXPECT_EQ(violation->limit_value(), 99);
  EXPECT_EQ(violation->requested_value(), 100);
  EXPECT_FALSE(DetailOf<v1::RetryAdvice>(reply.status).has_value());
}

TEST_F(UploadMesh, HeldMeshIsAnsweredOnTheHeader) {
  const std::string bytes = SphereBytes();
  ASSERT_TRUE(Upload(bytes).status.ok());
  now_ = At(10);
  const auto reply = Send({HeaderMessage(bytes)}, false);
  ASSERT_TRUE(reply.status.ok()) << reply.status.error_message();
  EXPECT_TRUE(reply.response.already_present());
  EXPECT_EQ(reply.response.mesh().face_count(), 1280);
  EXPECT_EQ(reply.response.mesh().expire_time().seconds(),
            absl::ToUnixSeconds(At(10) + store_options_.retention));
}

TEST_F(UploadMesh, MeshOfAnotherOwnerIsNotHeld) {
  const std::string bytes = SphereBytes();
  ASSERT_TRUE(Upload(bytes, "ann").status.ok());
  const auto reply = Upload(bytes, "bob");
  ASSERT_TRUE(reply.status.ok()) << reply.status.error_message();
  EXPECT_FALSE(reply.response.already_present());
  EXPECT_EQ(FileCount(), 1u);
}

TEST_F(UploadMesh, DigestThatIsHeldWithAnotherSizeIsRefused) {
  const std::string bytes = SphereBytes();
  ASSERT_TRUE(Upload(bytes).status.ok());
  v1::UploadMeshRequest header = HeaderMessage(bytes);
  header.mutable_header()->mutable_digest()->set_size_bytes(5);
  ExpectStatus(Send({header}, false).status, grpc::StatusCode::INVALID_ARGUMENT, "DIGEST_MISMATCH");
}

TEST_F(UploadMesh, ChunkThatDoesNotFollowIsRefused) {
  for (const std::int64_t offset : {0, 4, 6}) {
    const auto reply =
        Send({HeaderMessage("0123456789"), ChunkMessage(0, "01234"), ChunkMessage(offset, "5")});
    ExpectStatus(reply.status, grpc::StatusCode::INVALID_ARGUMENT, "CHUNK_OFFSET_MISMATCH");
    EXPECT_THAT(reply.status.error_message(), HasSubstr("byte 5"));
  }
  WaitForCalls(3);
  EXPECT_EQ(FileCount(), 0u);
}

TEST_F(UploadMesh, ChunkOverTheLimitIsRefused) {
  options_.max_chunk_bytes = 4;
  const auto reply = Send({HeaderMessage("0123456789"), ChunkMessage(0, "01234")}, false);
  ExpectStatus(reply.status, grpc::StatusCode::INVALID_ARGUMENT, "LIMIT_EXCEEDED");
  const auto violation = DetailOf<v1::LimitViolation>(reply.status);
  ASSERT_TRUE(violation.has_value());
  EXPECT_EQ(violation->limit(), "max_chunk_bytes");
  EXPECT_EQ(violation->requested_value(), 5);
}

TEST_F(UploadMesh, EmptyChunkIsRefused) {
  ExpectStatus(Send({HeaderMessage("0123456789"), ChunkMessage(0, "")}, false).status,
               grpc::StatusCode::INVALID_ARGUMENT, "REQUEST_INVALID");
}

TEST_F(UploadMesh, MoreBytesThanAnnouncedAreRefusedAtOnce) {
  ExpectStatus(
      Send({HeaderMessage("0123"), ChunkMessage(0, "012"), ChunkMessage(3, "34")}, false).status,
      grpc::StatusCode::INVALID_ARGUMENT, "DIGEST_MISMATCH");
}

TEST_F(UploadMesh, FewerBytesThanAnnouncedAreRefused) {
  ExpectStatus(Send({HeaderMessage("0123"), ChunkMessage(0, "012")}).status,
               grpc::StatusCode::INVALID_ARGUMENT, "DIGEST_MISMATCH");
  WaitForCalls(1);
  EXPECT_EQ(FileCount(), 0u);
}

TEST_F(UploadMesh, OtherBytesThanAnnouncedAreRefused) {
  ExpectStatus(Send({HeaderMessage("0123"), ChunkMessage(0, "4567")}).status,
               grpc::StatusCode::INVALID_ARGUMENT, "DIGEST_MISMATCH");
  WaitForCalls(1);
  EXPECT_EQ(FileCount(), 0u);
}

TEST_F(UploadMesh, BytesThatAreNoMeshAreRefused) {
  ExpectStatus(Upload("0123456789").status, grpc::StatusCode::INVALID_ARGUMENT,
               "DRACO_DECODE_FAILED");
  WaitForCalls(1);
  EXPECT_EQ(FileCount(), 0u);
}

TEST_F(UploadMesh, VanishedSenderLeavesNothingBehind) {
  v1::UploadMeshResponse response;
  const auto context = As("ann");
  {
    const auto writer = stub().UploadMesh(context.get(), &response);
    ASSERT_TRUE(writer->Write(HeaderMessage("0123456789")));
    ASSERT_TRUE(writer->Write(ChunkMessage(0, "01234")));
    context->TryCancel();
    EXPECT_EQ(writer->Finish().error_code(), grpc::StatusCode::CANCELLED);
  }
  WaitForCalls(1);
  EXPECT_EQ(FileCount(), 0u);
}

TEST_F(UploadMesh, StalledSenderIsEndedAndLeavesNothingBehind) {
  options_.max_idle = absl::Milliseconds(50);
  ExpectStatus(Send({HeaderMessage("0123456789"), ChunkMessage(0, "01234")}, false).status,
               grpc::StatusCode::CANCELLED, "CANCELLED");
  WaitForCalls(1);
  EXPECT_EQ(FileCount(), 0u);
}

TEST_F(UploadMesh, SenderOfNothingIsEnded) {
  options_.max_idle = absl::Milliseconds(50);
  ExpectStatus(Send({}, false).status, grpc::StatusCode::CANCELLED, "CANCELLED");
}

TEST_F(UploadMesh, UploadsOverTheirNumberAreRefused) {
  options_.max_uploads = 0;
  const auto reply = Upload(SphereBytes());
  ExpectStatus(reply.status, grpc::StatusCode::RESOURCE_EXHAUSTED, "QUEUE_FULL");
  EXPECT_TRUE(DetailOf<v1::RetryAdvice>(reply.status).has_value());
}

TEST_F(UploadMesh, UploadsOverTheirNumberOfACallerAreRefused) {
  options_.max_uploads_per_caller = 0;
  const auto reply = Upload(SphereBytes());
  ExpectStatus(reply.status, grpc::StatusCode::RESOURCE_EXHAUSTED, "QUOTA_EXCEEDED");
  EXPECT_TRUE(DetailOf<v1::RetryAdvice>(reply.status).has_value());
  const auto violation = DetailOf<v1::LimitViolation>(reply.status);
  ASSERT_TRUE(violation.has_value());
  EXPECT_EQ(violation->limit(), "max_uploads_per_caller");
}

TEST(UploadSlots, OneCallerDoesNotGetAll) {
  UploadSlots slots(3, 2);
  std::optional<UploadSlots::Slot> first = *slots.Take("ann");
  const UploadSlots::Slot second = *slots.Take("ann");
  EXPECT_EQ(GetErrorReason(slots.Take("ann").status()), ErrorReason::kQuotaExceeded);
  const UploadSlots::Slot third = *slots.Take("bob");
  EXPECT_EQ(GetErrorReason(slots.Take("eve").status()), ErrorReason::kQueueFull);
  first.reset();
  EXPECT_TRUE(slots.Take("eve").ok());
  EXPECT_TRUE(slots.Take("ann").ok());
}

TEST_F(UploadMesh, SenderThatTricklesIsEnded) {
  options_.max_idle = absl::Seconds(1);
  options_.min_bytes_per_second = 1e9;
  v1::UploadMeshResponse response;
  const auto context = As("ann");
  const auto writer = stub().UploadMesh(context.get(), &response);
  const std::string bytes(10'000'000, 'x');
  ASSERT_TRUE(writer->Write(HeaderMessage(bytes)));
  // Never idle, never fast.
  for (std::int64_t sent = 0; writer->Write(ChunkMessage(sent, "x")); ++sent) {
  }
  const grpc::Status status = writer->Finish();
  ExpectStatus(status, grpc::StatusCode::CANCELLED, "CANCELLED");
  EXPECT_THAT(status.error_message(), HasSubstr("too few"));
  WaitForCalls(1);
  EXPECT_EQ(FileCount(), 0u);
}

TEST_F(UploadMesh, EndedUploadMakesRoomForAnother) {
  options_.max_uploads = 1;
  for (std::size_t i = 1; i <= 3; ++i) {
    ExpectStatus(Upload("no mesh").status, grpc::StatusCode::INVALID_ARGUMENT,
                 "DRACO_DECODE_FAILED");
    WaitForCalls(i);
  }
}

TEST_F(UploadMesh, FullExecutorEndsTheCall) {
  max_waiting_ = 0;
  const auto reply = Upload(SphereBytes());
  ExpectStatus(reply.status, grpc::StatusCode::RESOURCE_EXHAUSTED, "QUEUE_FULL");
  EXPECT_TRUE(DetailOf<v1::RetryAdvice>(reply.status).has_value());
}

TEST_F(UploadMesh, CallerWhoMayOnlyReadIsRefused) {
  ExpectStatus(Upload(SphereBytes(), "eve").status, grpc::StatusCode::PERMISSION_DENIED,
               "PERMISSION_DENIED");
}

TEST_F(UploadMesh, UnknownCallerIsRefused) {
  ExpectStatus(Upload(SphereBytes(), "nobody").status, grpc::StatusCode::UNAUTHENTICATED,
               "UNAUTHENTICATED");
}

TEST_F(UploadMesh, CallLeavesALineWithItsOwner) {
  ASSERT_TRUE(Upload(SphereBytes()).status.ok());
  WaitForCalls(1);
  EXPECT_THAT(LogLines(), ElementsAre(testing::AllOf(HasSubstr("UploadMesh"), HasSubstr("ann"),
                                                     HasSubstr("OK"))));
}

TEST_F(UploadMesh, LargeMeshTakesAFewChunksOfMemoryOnTheWay) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers keep what was freed";
#endif
  AcceptAnyBytes();
  constexpr std::int64_t kMebibyte = 1 << 20;
  constexpr int kChunks = 100;
  // A chunk on either side, and what gRPC and the allocator keep at hand.
  constexpr std::int64_t kMaxGrowth = 48 * kMebibyte;
  const auto chunk = [](int i) { return std::string(kMebibyte, static_cast<char>(i)); };
  Sha256 hash;
  for (int i = 0; i < kChunks; ++i) hash.Add(chunk(i));
  v1::UploadMeshRequest header = HeaderMessage("mesh");
  header.mutable_header()->mutable_digest()->set_sha256(hash.Finish());
  header.mutable_header()->mutable_digest()->set_size_bytes(kChunks * kMebibyte);
  v1::UploadMeshResponse response;
  const auto context = As("ann");
  const auto writer = stub().UploadMesh(context.get(), &response);
  ASSERT_TRUE(writer->Write(header));
  const std::int64_t before = ResidentBytes();
  std::int64_t most = before;
  for (int i = 0; i < kChunks; ++i) {
    ASSERT_TRUE(writer->Write(ChunkMessage(i * kMebibyte, chunk(i))));
    most = std::max(most, ResidentBytes());
  }
  writer->WritesDone();
  ASSERT_TRUE(writer->Finish().ok());
  EXPECT_EQ(response.mesh().digest().size_bytes(), kChunks * kMebibyte);
  RecordProperty("growth_bytes", std::to_string(most - before));
  EXPECT_LT(most - before, kMaxGrowth);
}

}  // namespace
}  // namespace ccst::server
