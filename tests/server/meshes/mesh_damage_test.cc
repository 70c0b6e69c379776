// Damaged meshes: told apart from whole ones, and healed by an upload.
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/status.h"
#include "server/store/sqlite.h"
#include "tests/server/meshes/mesh_store_fixture.h"

namespace ccst::server {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

class DamagedMeshes : public MeshStoreTest {
 protected:
  DamagedMeshes() : bytes_(CubeBytes()), sha256_(Digest(bytes_)) {
    EXPECT_TRUE(Upload("ann", bytes_).ok());
  }
  std::string FileOf(const std::string& sha256) const {
    return directory_ + "/blobs/" + sha256.substr(0, 2) + "/" + sha256;
  }
  void Write(const std::string& bytes) {
    std::ofstream(FileOf(sha256_), std::ios::binary) << bytes;
  }
  std::size_t MissingCount() {
    const std::int64_t size = static_cast<std::int64_t>(bytes_.size());
    return meshes().FindMissing("ann", {{.sha256 = sha256_, .size_bytes = size}})->size();
  }

  const std::string bytes_;
  const std::string sha256_;
};

TEST_F(DamagedMeshes, AreMissingUntilTheyAreUploadedAgain) {
  for (const std::string& damaged :
       {bytes_.substr(0, 20), std::string(), std::string(bytes_.size(), 'x')}) {
    EXPECT_EQ(MissingCount(), 0U);
    Write(damaged);
    EXPECT_EQ(MissingCount(), 1U);
    ExpectError(meshes().Use("ann", sha256_).status(), absl::StatusCode::kDataLoss,
                "STORAGE_FAILED");
    EXPECT_TRUE(meshes().Get("ann", sha256_).ok());
    ASSERT_TRUE(Upload("ann", bytes_).ok());
    EXPECT_TRUE(meshes().Use("ann", sha256_).ok());
  }
  std::filesystem::remove(FileOf(sha256_));
  EXPECT_EQ(MissingCount(), 1U);
  ASSERT_TRUE(Upload("ann", bytes_).ok());
  EXPECT_EQ(MissingCount(), 0U);
}

TEST_F(DamagedMeshes, AreHealedWhoeverUploadsThem) {
  ASSERT_TRUE(Upload("bob", bytes_).ok());
  Write("x");
  ASSERT_TRUE(Upload("bob", bytes_).ok());
  EXPECT_TRUE(meshes().Use("ann", sha256_).ok());
}

TEST_F(DamagedMeshes, AreHealedThoughTheirOwnerHasNoRoomForMore) {
  options_.max_stored_bytes = static_cast<std::int64_t>(bytes_.size());
  AddJob("ann", sha256_);  // It may not be dropped.
  Write("x");
  BlobPins pins(*store_);
  MeshStore tight(*store_, pins, options_, dependencies_);
  const MeshUpload upload = Announced("ann", bytes_);
  const auto writer = tight.Begin(upload);
  ASSERT_TRUE(writer.ok()) << writer.status();
  ASSERT_TRUE((*writer)->Append(bytes_).ok());
  ASSERT_TRUE(tight.Finish(upload, **writer).ok());
  EXPECT_TRUE(tight.Use("ann", sha256_).ok());
}

TEST_F(DamagedMeshes, OneDamagedRowDoesNotHideTheOthers) {
  ASSERT_TRUE(Upload("ann", CubeBytes(2.0)).ok());
  ASSERT_TRUE((*Database::Open(directory_ + "/records.sqlite"))
                  ->RunScript("UPDATE meshes SET facts = CAST('x' AS BLOB) WHERE sha256 = '" +
                              sha256_ + "'")
                  .ok());
  const auto page = meshes().List("ann", 10, "");
  ASSERT_TRUE(page.ok()) << page.status();
  ASSERT_THAT(page->records, SizeIs(2));
  for (const StoredMesh& mesh : page->records) {
    if (mesh.record.sha256 == sha256_) {
      EXPECT_THAT(mesh.facts.warnings, ElementsAre(HasSubstr("damaged")));
    } else {
      EXPECT_THAT(mesh.facts.warnings, IsEmpty());
      EXPECT_EQ(mesh.facts.file_faces, 12);
    }
  }
  EXPECT_EQ(MissingCount(), 1U);
  ASSERT_TRUE(Upload("ann", bytes_).ok());
  EXPECT_EQ(meshes().Get("ann", sha256_)->facts.file_faces, 12);
  EXPECT_EQ(MissingCount(), 0U);
}

TEST_F(DamagedMeshes, AreListedWithTextThatCanBeSent) {
  ASSERT_TRUE((*Database::Open(directory_ + "/records.sqlite"))
                  ->RunScript("UPDATE meshes SET display_name = CAST(X'61ff' AS TEXT)")
                  .ok());
  const auto page = meshes().List("ann", 10, "");
  ASSERT_TRUE(page.ok()) << page.status();
  ASSERT_THAT(page->records, SizeIs(1));
  EXPECT_EQ(page->records.front().record.display_name, "a\\xff");
}

TEST_F(DamagedMeshes, OfWhichRecordAndFileSayNothingAreNotOpened) {
  ASSERT_TRUE((*Database::Open(directory_ + "/records.sqlite"))
                  ->RunScript("UPDATE meshes SET size_bytes = 0")
                  .ok());
  Write("");
  ExpectError(meshes().Open("ann", sha256_).status(), absl::StatusCode::kDataLoss,
              "STORAGE_FAILED");
}

TEST_F(DamagedMeshes, OfWhichBytesAreMissingAreNotOpened) {
  Write(bytes_.substr(1));
  ExpectError(meshes().Open("ann", sha256_).status(), absl::StatusCode::kDataLoss,
              "STORAGE_FAILED");
  std::filesystem::remove(FileOf(sha256_));
  ExpectError(meshes().Open("ann", sha256_).status(), absl::StatusCode::kDataLoss,
              "STORAGE_FAILED");
}

}  // namespace
}  // namespace ccst::server
