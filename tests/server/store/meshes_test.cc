#include <algorithm>
#include <string>
#include <tuple>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/server/store/store_fixture.h"

namespace ccst::server {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

class MeshRecords : public StoreTest {};

TEST_F(MeshRecords, AreReadAsTheyWereWritten) {
  const MeshRecord mesh = SomeMesh("ann", "bunny", At(1.000001));
  ASSERT_TRUE(store_->PutMesh(mesh).ok());
  Reopen();
  ExpectSame(store_->GetMesh("ann", mesh.sha256)->value(), mesh);
}

TEST_F(MeshRecords, BelongToOneOwner) {
  const MeshRecord mesh = SomeMesh("ann", "bunny");
  ASSERT_TRUE(store_->PutMesh(mesh).ok());
  EXPECT_FALSE(store_->GetMesh("bob", mesh.sha256)->has_value());
  EXPECT_FALSE(store_->GetMesh("ann", Digest("cow"))->has_value());
  ASSERT_TRUE(store_->DeleteMesh("bob", mesh.sha256).ok());
  EXPECT_TRUE(store_->GetMesh("ann", mesh.sha256)->has_value());
}

TEST_F(MeshRecords, ASecondOneReplacesTheFirst) {
  MeshRecord mesh = SomeMesh("ann", "bunny");
  ASSERT_TRUE(store_->PutMesh(mesh).ok());
  mesh.display_name = "another name";
  mesh.expire_time = At(7);
  ASSERT_TRUE(store_->PutMesh(mesh).ok());
  ExpectSame(store_->GetMesh("ann", mesh.sha256)->value(), mesh);
  EXPECT_EQ(store_->ListMeshes("ann", 10, "")->records.size(), 1);
}

TEST_F(MeshRecords, TouchMovesTheExpiryOnlyLater) {
  const MeshRecord mesh = SomeMesh("ann", "bunny");
  ASSERT_TRUE(store_->PutMesh(mesh).ok());
  ASSERT_TRUE(store_->TouchMesh("ann", mesh.sha256, mesh.expire_time - absl::Seconds(1)).ok());
  EXPECT_EQ(store_->GetMesh("ann", mesh.sha256)->value().expire_time, mesh.expire_time);
  ASSERT_TRUE(store_->TouchMesh("ann", mesh.sha256, mesh.expire_time + absl::Seconds(1)).ok());
  EXPECT_EQ(store_->GetMesh("ann", mesh.sha256)->value().expire_time,
            mesh.expire_time + absl::Seconds(1));
}

TEST_F(MeshRecords, ManyAreTouchedInOneStep) {
  std::vector<std::string> touched;
  for (int i = 0; i < 100; ++i) {
    const MeshRecord mesh = SomeMesh("ann", std::to_string(i));
    ASSERT_TRUE(store_->PutMesh(mesh).ok());
    touched.push_back(mesh.sha256);
  }
  const MeshRecord other = SomeMesh("bob", "0");
  ASSERT_TRUE(store_->PutMesh(other).ok());
  touched.push_back(Digest("of nobody"));
  ASSERT_TRUE(store_->TouchMeshes("ann", touched, At(1e6)).ok());
  touched.pop_back();
  for (const std::string& sha256 : touched) {
    EXPECT_EQ(store_->GetMesh("ann", sha256)->value().expire_time, At(1e6));
  }
  EXPECT_EQ(store_->GetMesh("bob", other.sha256)->value().expire_time, other.expire_time);
}

TEST_F(MeshRecords, BytesAreSummedPerOwner) {
  ASSERT_TRUE(store_->PutMesh(SomeMesh("ann", "123")).ok());
  ASSERT_TRUE(store_->PutMesh(SomeMesh("ann", "12345")).ok());
  ASSERT_TRUE(store_->PutMesh(SomeMesh("bob", "1234567")).ok());
  EXPECT_EQ(*store_->MeshBytes("ann"), 8);
  EXPECT_EQ(*store_->MeshBytes("eve"), 0);
}

TEST_F(MeshRecords, ListIsNewestFirstInPages) {
  for (int i = 0; i < 7; ++i) {
    const MeshRecord mesh = SomeMesh("ann", "mesh " + std::to_string(i), At(i / 2));
    ASSERT_TRUE(store_->PutMesh(mesh).ok());
    ASSERT_TRUE(store_->PutMesh(SomeMesh("bob", "other " + std::to_string(i), At(i))).ok());
  }
  const auto whole = *store_->ListMeshes("ann", 100, "");
  EXPECT_EQ(whole.records.size(), 7);
  EXPECT_TRUE(whole.next_token.empty());
  EXPECT_TRUE(std::is_sorted(
      whole.records.begin(), whole.records.end(), [](const MeshRecord& a, const MeshRecord& b) {
        return std::tie(a.create_time, a.sha256) > std::tie(b.create_time, b.sha256);
      }));
  std::vector<std::string> paged;
  std::string token;
  do {
    const auto page = *store_->ListMeshes("ann", 2, token);
    for (const std::string& digest : Digests(page.records)) paged.push_back(digest);
    token = page.next_token;
  } while (!token.empty());
  EXPECT_EQ(paged, Digests(whole.records));
}

TEST_F(MeshRecords, ForeignTokensAreRefused) {
  for (const char* token : {"x", "AAAA", "????", "MTIzNDU2Nzg5MDEyMzQ1Njc4OTA"}) {
    ExpectError(store_->ListMeshes("ann", 10, token).status(), absl::StatusCode::kInvalidArgument,
                "REQUEST_INVALID");
  }
}

TEST_F(MeshRecords, TokensOfAJobListAreRefused) {
  ASSERT_TRUE(store_->AddJob(SomeJob("a")).ok());
  ASSERT_TRUE(store_->AddJob(SomeJob("b")).ok());
  const std::string token = store_->ListJobs({}, 1, "")->next_token;
  ASSERT_FALSE(token.empty());
  ExpectError(store_->ListMeshes("ann", 10, token).status(), absl::StatusCode::kInvalidArgument,
              "REQUEST_INVALID");
}

TEST_F(MeshRecords, ExpireOnceTheirTimeHasPassed) {
  for (const int i : {3, 1, 2}) {
    MeshRecord mesh = SomeMesh("ann", std::to_string(i));
    mesh.expire_time = At(i);
    ASSERT_TRUE(store_->PutMesh(mesh).ok());
  }
  EXPECT_THAT(*store_->DropExpiredMeshes(At(1), 10), IsEmpty());
  EXPECT_THAT(Digests(*store_->DropExpiredMeshes(At(9), 1)), ElementsAre(Digest("1")));
  EXPECT_THAT(Digests(*store_->DropExpiredMeshes(At(3), 10)), ElementsAre(Digest("2")));
  EXPECT_THAT(Digests(store_->ListMeshes("ann", 10, "")->records), ElementsAre(Digest("3")));
}

TEST_F(MeshRecords, DoNotExpireWhileAJobOfTheOwnerNeedsThem) {
  MeshRecord mesh = SomeMesh("ann", "mesh");
  mesh.expire_time = At(1);
  ASSERT_TRUE(store_->PutMesh(mesh).ok());
  const JobRecord job = SomeJob("a");
  ASSERT_TRUE(store_->AddJob(job).ok());
  EXPECT_THAT(*store_->DropExpiredMeshes(At(2), 10), IsEmpty());
  EXPECT_THAT(*store_->IdleMeshes("ann"), IsEmpty());
  ASSERT_TRUE(store_->MarkCancelling("a").ok());
  EXPECT_THAT(*store_->DropExpiredMeshes(At(2), 10), IsEmpty());
  ASSERT_TRUE(store_->EndJob(Ended(job), "").ok());
  EXPECT_THAT(Digests(*store_->IdleMeshes("ann")), ElementsAre(mesh.sha256));
  EXPECT_THAT(Digests(*store_->DropExpiredMeshes(At(2), 10)), ElementsAre(mesh.sha256));
}

TEST_F(MeshRecords, IdleOnesComeLeastLatelyUsedFirst) {
  for (const char* content : {"a", "b", "c"}) {
    ASSERT_TRUE(store_->PutMesh(SomeMesh("ann", content)).ok());
  }
  ASSERT_TRUE(store_->PutMesh(SomeMesh("bob", "d")).ok());
  ASSERT_TRUE(store_->TouchMesh("ann", Digest("b"), At(1e6)).ok());
  ASSERT_TRUE(store_->TouchMesh("ann", Digest("a"), At(2e6)).ok());
  EXPECT_THAT(Digests(*store_->IdleMeshes("ann")),
              ElementsAre(Digest("c"), Digest("b"), Digest("a")));
}

TEST_F(MeshRecords, AreInUseOnlyForTheOwnerOfTheJob) {
  const JobRecord job = SomeJob("a");
  ASSERT_TRUE(store_->AddJob(job).ok());
  EXPECT_TRUE(*store_->IsMeshInUse("ann", job.mesh_sha256));
  EXPECT_FALSE(*store_->IsMeshInUse("bob", job.mesh_sha256));
  EXPECT_FALSE(*store_->IsMeshInUse("ann", Digest("another")));
  ASSERT_TRUE(store_->EndJob(Ended(job), "").ok());
  EXPECT_FALSE(*store_->IsMeshInUse("ann", job.mesh_sha256));
}

TEST_F(MeshRecords, ReferToTheirBlobUntilTheLastIsDeleted) {
  const MeshRecord mesh = SomeMesh("ann", "bunny");
  EXPECT_FALSE(*store_->IsReferenced(mesh.sha256));
  ASSERT_TRUE(store_->PutMesh(mesh).ok());
  ASSERT_TRUE(store_->PutMesh(SomeMesh("bob", "bunny")).ok());
  ASSERT_TRUE(store_->DeleteMesh("ann", mesh.sha256).ok());
  EXPECT_TRUE(*store_->IsReferenced(mesh.sha256));
  ASSERT_TRUE(store_->DeleteMesh("bob", mesh.sha256).ok());
  EXPECT_FALSE(*store_->IsReferenced(mesh.sha256));
}

}  // namespace
}  // namespace ccst::server
