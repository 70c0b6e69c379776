#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/server/mesh_service_fixture.h"

namespace ccst::server {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

using MeshServiceCalls = MeshServiceTest;

void ExpectStatus(const grpc::Status& status, grpc::StatusCode code, const std::string& reason) {
  EXPECT_EQ(status.error_code(), code) << status.error_message();
  EXPECT_EQ(ReasonOf(status), reason) << status.error_message();
}

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
  ExpectStatus(reply.status, grpc::StatusCode::RESOURCE_EXHAUSTED, "QUOTA_EXCEEDED");
  EXPECT_TRUE(DetailOf<v1::LimitViolation>(reply.status).has_value());
  EXPECT_TRUE(DetailOf<v1::RetryAdvice>(reply.status).has_value());
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

TEST_F(DownloadMesh, OnlyTheCallersOwnIsFound) {
  const std::string name = Upload(SphereBytes()).response.mesh().name();
  const Download download = Get(name, 0, "bob");
  ExpectStatus(download.status, grpc::StatusCode::NOT_FOUND, "NOT_FOUND");
  EXPECT_THAT(download.bytes, IsEmpty());
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
