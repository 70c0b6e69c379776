#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "tests/server/meshes/mesh_store_fixture.h"

namespace ccst::server {
namespace {

/// Room for 100 bytes.
class MeshQuota : public MeshStoreTest {
 protected:
  MeshQuota() {
    AcceptAnyBytes();
    options_.max_stored_bytes = 100;
    options_.max_mesh_bytes = 200;
  }

  bool Holds(const std::string& bytes) { return meshes().Get("ann", Digest(bytes)).ok(); }

  // 40 bytes each.
  const std::string a_ = std::string(40, 'a');
  const std::string b_ = std::string(40, 'b');
  const std::string c_ = std::string(40, 'c');
};

TEST_F(MeshQuota, MeshOverTheLimitIsRefusedBeforeItsBytes) {
  ExpectError(meshes().Begin(Announced("ann", std::string(201, 'x'))).status(),
              absl::StatusCode::kInvalidArgument, "LIMIT_EXCEEDED");
}

TEST_F(MeshQuota, MeshLargerThanTheQuotaIsRefusedBeforeItsBytes) {
  ExpectError(meshes().Begin(Announced("ann", std::string(101, 'x'))).status(),
              absl::StatusCode::kInvalidArgument, "LIMIT_EXCEEDED");
  EXPECT_TRUE(meshes().Begin(Announced("ann", std::string(100, 'x'))).ok());
}

TEST_F(MeshQuota, LeastLatelyUsedMakesRoom) {
  ASSERT_TRUE(Upload("ann", a_).ok());
  now_ = At(1);
  ASSERT_TRUE(Upload("ann", b_).ok());
  now_ = At(2);
  ASSERT_TRUE(meshes().Use("ann", Digest(a_)).ok());
  ASSERT_TRUE(Upload("ann", c_).ok());
  EXPECT_TRUE(Holds(a_));
  EXPECT_FALSE(Holds(b_));
  EXPECT_TRUE(Holds(c_));
  EXPECT_EQ(FileCount(), 2u);
}

TEST_F(MeshQuota, NoMoreIsDroppedThanMustBe) {
  ASSERT_TRUE(Upload("ann", a_).ok());
  now_ = At(1);
  ASSERT_TRUE(Upload("ann", b_).ok());
  ASSERT_TRUE(Upload("ann", std::string(20, 'd')).ok());
  EXPECT_TRUE(Holds(a_));
  EXPECT_TRUE(Holds(b_));
}

TEST_F(MeshQuota, MeshInUseIsNotDropped) {
  ASSERT_TRUE(Upload("ann", a_).ok());
  now_ = At(1);
  ASSERT_TRUE(Upload("ann", b_).ok());
  AddJob("ann", Digest(a_));
  ASSERT_TRUE(Upload("ann", c_).ok());
  EXPECT_TRUE(Holds(a_));
  EXPECT_FALSE(Holds(b_));
}

TEST_F(MeshQuota, UploadThatFitsBesideNothingInUseIsRefused) {
  ASSERT_TRUE(Upload("ann", a_).ok());
  AddJob("ann", Digest(a_));
  ExpectError(meshes().Begin(Announced("ann", std::string(61, 'x'))).status(),
              absl::StatusCode::kResourceExhausted, "QUOTA_EXCEEDED");
  EXPECT_TRUE(Upload("ann", std::string(60, 'x')).ok());
}

TEST_F(MeshQuota, UploadThatIsRefusedDropsNothing) {
  ASSERT_TRUE(Upload("ann", a_).ok());
  ASSERT_TRUE(Upload("ann", b_).ok());
  const MeshUpload upload = Announced("ann", c_);
  auto writer = *meshes().Begin(upload);
  ASSERT_TRUE(writer->Append("other bytes").ok());
  EXPECT_FALSE(meshes().Finish(upload, *writer).ok());
  EXPECT_TRUE(Holds(a_));
  EXPECT_TRUE(Holds(b_));
}

TEST_F(MeshQuota, OwnersDoNotShareIt) {
  ASSERT_TRUE(Upload("ann", a_).ok());
  ASSERT_TRUE(Upload("ann", b_).ok());
  ASSERT_TRUE(Upload("bob", std::string(100, 'x')).ok());
  EXPECT_TRUE(Holds(a_));
  EXPECT_TRUE(Holds(b_));
}

TEST_F(MeshQuota, UploadsAtTheSameTimeStayWithinIt) {
  constexpr int kThreads = 4;
  constexpr int kUploads = 10;
  meshes();
  std::vector<std::jthread> threads;
  for (int t = 0; t < kThreads; ++t) {
    threads.emplace_back([this, t] {
      for (int i = 0; i < kUploads; ++i) {
        EXPECT_TRUE(
            Upload("ann", std::string(30, static_cast<char>('a' + t)) + std::to_string(i)).ok());
      }
    });
  }
  threads.clear();
  EXPECT_LE(*store_->MeshBytes("ann"), 100);
  EXPECT_EQ(*store_->MeshBytes("ann"), 93);
  EXPECT_EQ(FileCount(), 3u);
}

}  // namespace
}  // namespace ccst::server
