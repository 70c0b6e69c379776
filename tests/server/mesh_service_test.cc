#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "proto/convert/field_limits.h"
#include "tests/server/mesh_service_fixture.h"

namespace ccst::server {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

using MeshServiceCalls = MeshServiceTest;

v1::CreateMeshRequest Whole(const std::string& bytes) {
  v1::CreateMeshRequest request;
  *request.mutable_header() = HeaderOf(bytes);
  request.set_data(bytes);
  return request;
}

class DownloadMesh : public MeshServiceTest {
 protected:
  struct Download {
    grpc::Status status;
    std::vector<std::int64_t> offsets;
    std::vector<std::size_t> sizes;
    std::string bytes;
  };

  std::string BlobFile(const std::string& sha256) const {
    return directory_ + "/blobs/" + sha256.substr(0, 2) + "/" + sha256;
  }

  Download Get(const std::string& name, std::int64_t start, const std::string& caller = "ann") {
    v1::DownloadMeshRequest request;
    request.set_name(name);
    request.set_start_offset_bytes(start);
    const auto context = As(caller);
    const auto reader = stub().DownloadMesh(context.get(), request);
    Download download;
    v1::DownloadMeshResponse message;
    while (reader->Read(&message)) {
      download.offsets.push_back(message.chunk().offset_bytes());
      download.sizes.push_back(message.chunk().data().size());
      download.bytes += message.chunk().data();
    }
    download.status = reader->Finish();
    return download;
  }
};

TEST_F(MeshServiceCalls, CreatedMeshIsStored) {
  const std::string bytes = SphereBytes();
  const auto reply = Create(Whole(bytes));
  ASSERT_TRUE(reply.status.ok()) << reply.status.error_message();
  EXPECT_FALSE(reply.response.already_present());
  EXPECT_EQ(reply.response.mesh().face_count(), 1280);
  EXPECT_TRUE(Create(Whole(bytes)).response.already_present());
}

TEST_F(MeshServiceCalls, CreatedMeshHasTheLimitOfInlineMeshes) {
  options_.max_inline_mesh_bytes = 99;
  const auto reply = Create(Whole(std::string(100, 'x')));
  ExpectStatus(reply.status, grpc::StatusCode::INVALID_ARGUMENT, "LIMIT_EXCEEDED");
  const auto violation = DetailOf<v1::LimitViolation>(reply.status);
  ASSERT_TRUE(violation.has_value());
  EXPECT_EQ(violation->limit(), "max_inline_mesh_bytes");
  EXPECT_EQ(violation->requested_value(), 100);
}

TEST_F(MeshServiceCalls, CreatedMeshHasTheQuota) {
  store_options_.max_stored_bytes = 99;
  const auto reply = Create(Whole(std::string(100, 'x')));
  ExpectStatus(reply.status, grpc::StatusCode::INVALID_ARGUMENT, "LIMIT_EXCEEDED");
  EXPECT_TRUE(DetailOf<v1::LimitViolation>(reply.status).has_value());
  EXPECT_FALSE(DetailOf<v1::RetryAdvice>(reply.status).has_value());
}

TEST_F(MeshServiceCalls, CreatedMeshOfOtherBytesIsRefusedAndNothingStays) {
  v1::CreateMeshRequest request = Whole(SphereBytes());
  request.mutable_header()->mutable_digest()->set_sha256(Digest("other"));
  ExpectStatus(Create(request).status, grpc::StatusCode::INVALID_ARGUMENT, "DIGEST_MISMATCH");
  EXPECT_EQ(FileCount(), 0u);
}

TEST_F(MeshServiceCalls, CreateWithoutHeaderSaysWhatIsMissing) {
  const auto reply = Create({});
  ExpectStatus(reply.status, grpc::StatusCode::INVALID_ARGUMENT, "REQUEST_INVALID");
  EXPECT_THAT(WrongFields(reply.status),
              ElementsAre("header.digest.sha256", "header.digest.size_bytes", "header.format"));
}

TEST_F(MeshServiceCalls, GetFindsOnlyTheCallersOwn) {
  const std::string bytes = SphereBytes();
  const std::string name = Upload(bytes).response.mesh().name();
  const auto own = Get(name, "ann");
  ASSERT_TRUE(own.status.ok()) << own.status.error_message();
  EXPECT_EQ(own.response.mesh().face_count(), 1280);
  ExpectStatus(Get(name, "bob").status, grpc::StatusCode::NOT_FOUND, "NOT_FOUND");
  ExpectStatus(Get("meshes/" + Digest("other")).status, grpc::StatusCode::NOT_FOUND, "NOT_FOUND");
}

TEST_F(MeshServiceCalls, NameThatIsNoneIsRefused) {
  for (const std::string& name : {std::string(), Digest("a"), std::string("meshes/"),
                                  "meshes/" + Digest("a") + "0", "jobs/" + Digest("a")}) {
    const auto reply = Get(name);
    ExpectStatus(reply.status, grpc::StatusCode::INVALID_ARGUMENT, "REQUEST_INVALID");
    EXPECT_THAT(WrongFields(reply.status), ElementsAre("name"));
  }
}

TEST_F(MeshServiceCalls, ExpiredMeshIsNotFound) {
  const std::string name = Upload(SphereBytes()).response.mesh().name();
  now_ = At(1) + store_options_.retention;
  ExpectStatus(Get(name).status, grpc::StatusCode::NOT_FOUND, "NOT_FOUND");
}

TEST_F(MeshServiceCalls, ListGivesPagesNewestFirst) {
  AcceptAnyBytes();
  for (int i = 0; i < 3; ++i) {
    now_ = At(i);
    ASSERT_TRUE(Upload("mesh" + std::to_string(i)).status.ok());
  }
  std::vector<std::string> names;
  v1::ListMeshesRequest request;
  request.set_page_size(2);
  int pages = 0;
  do {
    v1::ListMeshesResponse response;
    const grpc::Status status = stub().ListMeshes(As("ann").get(), request, &response);
    ASSERT_TRUE(status.ok()) << status.error_message();
    for (const v1::Mesh& mesh : response.meshes()) names.push_back(mesh.name());
    request.set_page_token(response.next_page_token());
    ++pages;
  } while (!request.page_token().empty());
  EXPECT_EQ(pages, 2);
  EXPECT_THAT(names, ElementsAre("meshes/" + Digest("mesh2"), "meshes/" + Digest("mesh1"),
                                 "meshes/" + Digest("mesh0")));
}

TEST_F(MeshServiceCalls, ListRefusesWrongSizesAndTokens) {
  v1::ListMeshesResponse response;
  v1::ListMeshesRequest request;
  request.set_page_size(-1);
  const grpc::Status size = stub().ListMeshes(As("ann").get(), request, &response);
  ExpectStatus(size, grpc::StatusCode::INVALID_ARGUMENT, "REQUEST_INVALID");
  EXPECT_THAT(WrongFields(size), ElementsAre("page_size"));
  request.set_page_size(0);
  request.set_page_token("no token");
  ExpectStatus(stub().ListMeshes(As("ann").get(), request, &response),
               grpc::StatusCode::INVALID_ARGUMENT, "REQUEST_INVALID");
}

TEST_F(MeshServiceCalls, MissingMeshesAreNamed) {
  const std::string bytes = SphereBytes();
  ASSERT_TRUE(Upload(bytes).status.ok());
  v1::FindMissingMeshesRequest request;
  *request.add_digests() = HeaderOf(bytes).digest();
  *request.add_digests() = HeaderOf("other").digest();
  v1::FindMissingMeshesResponse response;
  ASSERT_TRUE(stub().FindMissingMeshes(As("ann").get(), request, &response).ok());
  ASSERT_THAT(response.missing_digests(), SizeIs(1));
  EXPECT_EQ(response.missing_digests(0).sha256(), Digest("other"));
  EXPECT_EQ(response.missing_digests(0).size_bytes(), 5);
}

TEST_F(MeshServiceCalls, AskingForMeshesKeepsThemUnlessTheTokenMayOnlyRead) {
  const std::string bytes = SphereBytes();
  ASSERT_TRUE(Upload(bytes).status.ok());
  const auto expiry = [&] { return store_->GetMesh("ann", Digest(bytes))->value().expire_time; };
  v1::FindMissingMeshesRequest request;
  *request.add_digests() = HeaderOf(bytes).digest();
  v1::FindMissingMeshesResponse response;
  now_ = At(60);
  ASSERT_TRUE(stub().FindMissingMeshes(As("ann-reads").get(), request, &response).ok());
  EXPECT_THAT(response.missing_digests(), IsEmpty());
  EXPECT_EQ(expiry(), At(0) + store_options_.retention);
  ASSERT_TRUE(stub().FindMissingMeshes(As("ann").get(), request, &response).ok());
  EXPECT_EQ(expiry(), At(60) + store_options_.retention);
}

TEST_F(MeshServiceCalls, WrongAndTooManyDigestsAreRefused) {
  v1::FindMissingMeshesRequest request;
  *request.add_digests() = HeaderOf("mesh").digest();
  request.add_digests()->set_sha256("abc");
  v1::FindMissingMeshesResponse response;
  const grpc::Status wrong = stub().FindMissingMeshes(As("ann").get(), request, &response);
  ExpectStatus(wrong, grpc::StatusCode::INVALID_ARGUMENT, "REQUEST_INVALID");
  EXPECT_THAT(WrongFields(wrong), ElementsAre("digests[1].sha256", "digests[1].size_bytes"));
  request.clear_digests();
  for (int i = 0; i <= kMaxDigests; ++i) *request.add_digests() = HeaderOf("mesh").digest();
  ExpectStatus(stub().FindMissingMeshes(As("ann").get(), request, &response),
               grpc::StatusCode::INVALID_ARGUMENT, "REQUEST_INVALID");
}

TEST_F(MeshServiceCalls, DeletedMeshIsGone) {
  v1::DeleteMeshRequest request;
  request.set_name(Upload(SphereBytes()).response.mesh().name());
  v1::DeleteMeshResponse response;
  ExpectStatus(stub().DeleteMesh(As("bob").get(), request, &response), grpc::StatusCode::NOT_FOUND,
               "NOT_FOUND");
  ExpectStatus(stub().DeleteMesh(As("eve").get(), request, &response),
               grpc::StatusCode::PERMISSION_DENIED, "PERMISSION_DENIED");
  EXPECT_TRUE(stub().DeleteMesh(As("ann").get(), request, &response).ok());
  EXPECT_EQ(FileCount(), 0u);
  ExpectStatus(stub().DeleteMesh(As("ann").get(), request, &response), grpc::StatusCode::NOT_FOUND,
               "NOT_FOUND");
}

TEST_F(MeshServiceCalls, MeshInUseIsNotDeleted) {
  v1::DeleteMeshRequest request;
  const v1::Mesh mesh = Upload(SphereBytes()).response.mesh();
  request.set_name(mesh.name());
  JobRecord job = SomeJob("a");
  job.mesh_sha256 = mesh.digest().sha256();
  ASSERT_TRUE(store_->AddJob(job).ok());
  v1::DeleteMeshResponse response;
  ExpectStatus(stub().DeleteMesh(As("ann").get(), request, &response),
               grpc::StatusCode::FAILED_PRECONDITION, "MESH_IN_USE");
}

TEST_F(MeshServiceCalls, FullExecutorRefusesWithAdvice) {
  max_waiting_ = 0;
  const auto reply = Get("meshes/" + Digest("mesh"));
  ExpectStatus(reply.status, grpc::StatusCode::RESOURCE_EXHAUSTED, "QUEUE_FULL");
  EXPECT_TRUE(DetailOf<v1::RetryAdvice>(reply.status).has_value());
}

TEST_F(MeshServiceCalls, LineIsWrittenBeforeTheAnswer) {
  Get("meshes/" + Digest("mesh"));
  EXPECT_THAT(LogLines(), SizeIs(1));
}

TEST_F(MeshServiceCalls, UnknownCallerIsRefused) {
  ExpectStatus(Get("meshes/" + Digest("mesh"), "nobody").status, grpc::StatusCode::UNAUTHENTICATED,
               "UNAUTHENTICATED");
}

TEST_F(DownloadMesh, BytesComeInChunksAsUploaded) {
  options_.max_chunk_bytes = 4000;
  const std::string bytes = SphereBytes();
  const Download download = Get(Upload(bytes).response.mesh().name(), 0);
  ASSERT_TRUE(download.status.ok()) << download.status.error_message();
  EXPECT_TRUE(download.bytes == bytes);
  ASSERT_GT(download.sizes.size(), 2u);
  EXPECT_THAT(download.sizes, Each(testing::Le(4000u)));
  std::int64_t next = 0;
  for (std::size_t i = 0; i < download.sizes.size(); ++i) {
    EXPECT_EQ(download.offsets[i], next);
    next += static_cast<std::int64_t>(download.sizes[i]);
  }
}

TEST_F(DownloadMesh, DownloadResumesFromAnyByte) {
  const std::string bytes = SphereBytes();
  const std::string name = Upload(bytes).response.mesh().name();
  const auto size = static_cast<std::int64_t>(bytes.size());
  for (const std::int64_t start : {std::int64_t{1}, size - 1, size}) {
    const Download download = Get(name, start);
    ASSERT_TRUE(download.status.ok()) << download.status.error_message();
    EXPECT_TRUE(download.bytes == bytes.substr(static_cast<std::size_t>(start)));
  }
}

TEST_F(DownloadMesh, StartOutsideTheMeshIsRefused) {
  const std::string bytes = SphereBytes();
  const std::string name = Upload(bytes).response.mesh().name();
  for (const std::int64_t start : {std::int64_t{-1}, static_cast<std::int64_t>(bytes.size()) + 1}) {
    const Download download = Get(name, start);
    ExpectStatus(download.status, grpc::StatusCode::INVALID_ARGUMENT, "REQUEST_INVALID");
    EXPECT_THAT(WrongFields(download.status), ElementsAre("start_offset_bytes"));
  }
}

TEST_F(DownloadMesh, DamagedBytesEndWithDataLossFromWhicheverByte) {
  options_.max_chunk_bytes = 4000;
  const std::string bytes = SphereBytes();
  const std::string name = Upload(bytes).response.mesh().name();
  const std::string path = BlobFile(Digest(bytes));
  for (const std::size_t at : {std::size_t{0}, bytes.size() / 2, bytes.size() - 1}) {
    std::string damaged = bytes;
    damaged[at] ^= 8;
    std::ofstream(path, std::ios::binary) << damaged;
    const auto size = static_cast<std::int64_t>(bytes.size());
    for (const std::int64_t start : {std::int64_t{0}, std::int64_t{1}, size - 10, size}) {
      const Download download = Get(name, start);
      ExpectStatus(download.status, grpc::StatusCode::DATA_LOSS, "STORAGE_FAILED");
      EXPECT_LT(download.bytes.size(), static_cast<std::size_t>(size - start) + 1);
    }
  }
  for (const std::size_t size : {bytes.size() - 1, std::size_t{0}}) {
    std::ofstream(path, std::ios::binary) << bytes.substr(0, size);
    const Download download = Get(name, 0);
    ExpectStatus(download.status, grpc::StatusCode::DATA_LOSS, "STORAGE_FAILED");
    EXPECT_THAT(download.bytes, IsEmpty());
  }
  std::filesystem::remove(path);
  ExpectStatus(Get(name, 0).status, grpc::StatusCode::DATA_LOSS, "STORAGE_FAILED");
}

TEST_F(DownloadMesh, UploadOfTheRightBytesHealsThem) {
  const std::string bytes = SphereBytes();
  const std::string name = Upload(bytes).response.mesh().name();
  for (const std::string& damaged : {bytes.substr(0, 5000), std::string(), 'x' + bytes.substr(1)}) {
    std::ofstream(BlobFile(Digest(bytes)), std::ios::binary) << damaged;
    const auto reply = Upload(bytes);
    ASSERT_TRUE(reply.status.ok()) << reply.status.error_message();
    EXPECT_FALSE(reply.response.already_present());
    EXPECT_EQ(Get(name, 0).bytes, bytes);
  }
  std::ofstream(BlobFile(Digest(bytes)), std::ios::binary) << "x";
  EXPECT_FALSE(Create(Whole(bytes)).response.already_present());
  EXPECT_EQ(Get(name, 0).bytes, bytes);
}

TEST_F(DownloadMesh, OnlyTheCallersOwnIsFound) {
  const std::string name = Upload(SphereBytes()).response.mesh().name();
  const Download download = Get(name, 0, "bob");
  ExpectStatus(download.status, grpc::StatusCode::NOT_FOUND, "NOT_FOUND");
  EXPECT_THAT(download.bytes, IsEmpty());
}

TEST_F(DownloadMesh, DownloadChangesNothing) {
  const std::string bytes = SphereBytes();
  const std::string name = Upload(bytes).response.mesh().name();
  now_ = At(60);
  ASSERT_TRUE(Get(name, 0, "ann").status.ok());
  ASSERT_TRUE(Get(name, 0, "ann-reads").status.ok());
  EXPECT_EQ(store_->GetMesh("ann", Digest(bytes))->value().expire_time,
            At(0) + store_options_.retention);
}

// Descriptors of this process that are files below the store's folder.
std::size_t OpenBlobs(const std::string& folder) {
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
    std::error_code gone;
    const std::string target = std::filesystem::read_symlink(entry.path(), gone).string();
    if (target.starts_with(folder) && target.find("/blobs/") != std::string::npos) ++count;
  }
  return count;
}

class SlowDownloads : public DownloadMesh {
 protected:
  struct Stream {
    std::unique_ptr<grpc::ClientContext> context;
    std::unique_ptr<grpc::ClientReader<v1::DownloadMeshResponse>> reader;
  };

  SlowDownloads() { AcceptAnyBytes(); }

  // A mesh of more bytes than the connection takes from a reader who has stopped.
  std::string UploadLarge() {
    return Upload(std::string(std::size_t{8} << 20, 'x'), "ann", std::size_t{1} << 20)
        .response.mesh()
        .name();
  }

  // One that has read its first message and then reads no more; empty when it was refused.
  std::optional<Stream> Begin(const std::string& name) {
    Stream stream;
    stream.context = As("ann");
    v1::DownloadMeshRequest request;
    request.set_name(name);
    stream.reader = stub().DownloadMesh(stream.context.get(), request);
    v1::DownloadMeshResponse message;
    if (stream.reader->Read(&message)) return stream;
    last_status_ = stream.reader->Finish();
    return std::nullopt;
  }

  grpc::Status last_status_;
};

TEST_F(SlowDownloads, ReaderWhoWaitsHoldsNoDescriptor) {
  const std::string name = UploadLarge();
  std::vector<std::optional<Stream>> streams;
  for (int i = 0; i < 20; ++i) streams.push_back(Begin(name));
  // The blob is open only while a chunk of one of them is read, by the one thread of the disk.
  EXPECT_LE(OpenBlobs(folder_.path()), 1u);
  for (auto& stream : streams) {
    ASSERT_TRUE(stream.has_value());
    stream->context->TryCancel();
    stream->reader->Finish();
  }
}

TEST_F(SlowDownloads, MeshStaysReadableForWhoReadsItThoughItIsDeleted) {
  const std::string name = UploadLarge();
  auto stream = Begin(name);
  ASSERT_TRUE(stream.has_value());
  v1::DeleteMeshRequest request;
  request.set_name(name);
  v1::DeleteMeshResponse deleted;
  ASSERT_TRUE(stub().DeleteMesh(As("ann").get(), request, &deleted).ok());
  v1::DownloadMeshResponse message;
  while (stream->reader->Read(&message)) {
  }
  EXPECT_TRUE(stream->reader->Finish().ok());
  WaitForCalls(3);
  EXPECT_EQ(FileCount(), 0u);
}

TEST_F(SlowDownloads, StreamsOverTheMemoryOfACallerAreRefusedUntilOthersEnd) {
  // One caller has three quarters: room for two streams of 544 KiB.
  stream_limits_.most_bytes = std::int64_t{2} << 20;
  const std::string name = UploadLarge();
  auto first = Begin(name);
  auto second = Begin(name);
  ASSERT_TRUE(first.has_value() && second.has_value());
  EXPECT_FALSE(Begin(name).has_value());
  ExpectStatus(last_status_, grpc::StatusCode::RESOURCE_EXHAUSTED, "QUOTA_EXCEEDED");
  const auto violation = DetailOf<v1::LimitViolation>(last_status_);
  ASSERT_TRUE(violation.has_value());
  EXPECT_EQ(violation->limit(), "max_stream_bytes_per_caller");
  EXPECT_EQ(violation->limit_value(), (std::int64_t{2} << 20) / 4 * 3);
  EXPECT_GT(violation->requested_value(), violation->limit_value());
  EXPECT_TRUE(DetailOf<v1::RetryAdvice>(last_status_).has_value());
  first->context->TryCancel();
  first->reader->Finish();
  WaitForCalls(3);  // The upload, the refused one and the first.
  EXPECT_TRUE(Begin(name).has_value());
}

TEST_F(SlowDownloads, ReaderWhoTakesNoMessageForTooLongIsEnded) {
  stream_limits_.longest_write_seconds = 0.2;
  const std::string name = UploadLarge();
  const auto stream = Begin(name);
  ASSERT_TRUE(stream.has_value());
  WaitForCalls(2);  // Nobody reads or cancels.
  EXPECT_THAT(LogLines().back(),
              testing::AllOf(testing::HasSubstr("DownloadMesh"), testing::HasSubstr("CANCELLED")));
  v1::DownloadMeshResponse message;
  while (stream->reader->Read(&message)) {
  }
  EXPECT_EQ(stream->reader->Finish().error_code(), grpc::StatusCode::CANCELLED);
}

TEST_F(DownloadMesh, FullExecutorRefuses) {
  max_waiting_ = 0;
  ExpectStatus(Get("meshes/" + Digest("mesh"), 0).status, grpc::StatusCode::RESOURCE_EXHAUSTED,
               "QUEUE_FULL");
}

TEST_F(DownloadMesh, ReaderWhoGoesAwayEndsTheCall) {
  AcceptAnyBytes();
  const std::string bytes(std::size_t{8} << 20, 'x');
  v1::DownloadMeshRequest request;
  request.set_name(Upload(bytes, "ann", std::size_t{1} << 20).response.mesh().name());
  WaitForCalls(1);
  {
    const auto context = As("ann");
    const auto reader = stub().DownloadMesh(context.get(), request);
    v1::DownloadMeshResponse message;
    ASSERT_TRUE(reader->Read(&message));
    context->TryCancel();
    reader->Finish();
  }
  WaitForCalls(2);
}

}  // namespace
}  // namespace ccst::server
