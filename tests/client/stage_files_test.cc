#include "client/cli/stage_files.h"

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/io/mesh_file.h"
#include "tests/support/shapes.h"

namespace ccst::cli {
namespace {

namespace fs = std::filesystem;

class StageFilesTest : public testing::Test {
 protected:
  StageFilesTest() {
    folder_ = testing::TempDir() + "stages_of_" +
              testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(folder_);
    fs::create_directory(folder_);
  }
  ~StageFilesTest() override { fs::remove_all(folder_); }

  std::string folder_;
};

TEST_F(StageFilesTest, MeshIsWrittenUnderTheNameOfItsStage) {
  const TriangleMesh torus = shapes::Torus(1.0, 0.35, 12, 6);
  StageFiles files(folder_, Eigen::Vector3d::Zero());
  files.OnStage(Stage::kInitial, torus.positions, torus.faces);
  EXPECT_TRUE(files.status().ok());
  const TriangleMesh read = ReadMeshFile(folder_ + "/3-initial.ply")->mesh;
  EXPECT_EQ(read.positions, torus.positions);
  EXPECT_EQ(read.faces, torus.faces);
}

TEST_F(StageFilesTest, EveryStageHasAFileOfItsOwn) {
  const TriangleMesh cube = shapes::Cube();
  StageFiles files(folder_, Eigen::Vector3d::Zero());
  for (int stage = 0; stage <= static_cast<int>(Stage::kResult); ++stage) {
    files.OnStage(static_cast<Stage>(stage), cube.positions, cube.faces);
  }
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder_)) {
    names.push_back(entry.path().filename().string());
  }
  EXPECT_THAT(names, testing::UnorderedElementsAre(
                         "1-repaired.ply", "2-refined.ply", "3-initial.ply", "4-early.ply",
                         "5-mended.ply", "6-converged.ply", "7-relaxed.ply", "8-result.ply"));
}

TEST_F(StageFilesTest, OriginIsAdded) {
  const TriangleMesh cube = shapes::Cube();
  StageFiles files(folder_, {100.0, 200.0, 300.0});
  files.OnStage(Stage::kResult, cube.positions, cube.faces);
  const TriangleMesh read = ReadMeshFile(folder_ + "/8-result.ply")->mesh;
  EXPECT_EQ(read.positions.front(), cube.positions.front() + Eigen::Vector3d(100.0, 200.0, 300.0));
}

TEST_F(StageFilesTest, FirstErrorIsKept) {
  const TriangleMesh cube = shapes::Cube();
  StageFiles files(folder_ + "/none", Eigen::Vector3d::Zero());
  files.OnStage(Stage::kRepaired, cube.positions, cube.faces);
  files.OnStage(Stage::kResult, cube.positions, cube.faces);
  EXPECT_THAT(std::string(files.status().message()), testing::HasSubstr("1-repaired.ply"));
}

TEST_F(StageFilesTest, FolderHasToExist) {
  EXPECT_TRUE(CheckStageFiles(folder_, {}).ok());
  const absl::Status status = CheckStageFiles(folder_ + "/none", {});
  EXPECT_THAT(std::string(status.message()), testing::HasSubstr("there is no folder"));
}

TEST_F(StageFilesTest, MeshThatIsSampledIsNotOverwritten) {
  const std::string mesh = folder_ + "/1-repaired.ply";
  std::ofstream(mesh) << "kept";
  const absl::Status status = CheckStageFiles(folder_, {{"the mesh", mesh}});
  EXPECT_THAT(std::string(status.message()), testing::HasSubstr("--dump-stages"));
}

}  // namespace
}  // namespace ccst::cli
