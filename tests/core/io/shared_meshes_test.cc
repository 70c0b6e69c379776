// All public models beside the tree: each is read, or refused for the reason it was chosen for.
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "core/io/mesh_file.h"
#include "tests/core/io/io_test_util.h"

namespace ccst {
namespace {

namespace fs = std::filesystem;

std::string MeshFolder() {
  const char* const set = std::getenv("CCST_MESHES");
  return set != nullptr ? set : std::string(CCST_SOURCE_DIR) + "/../shared/meshes";
}

class SharedMeshes : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!fs::is_directory(MeshFolder())) {
      GTEST_SKIP() << "no test meshes in " << MeshFolder() << "; set CCST_MESHES";
    }
  }
};

const std::map<std::string, ErrorReason> kRefused = {
    {"bad/assimp_invalid.off", ErrorReason::kMeshDegenerate},
    {"bad/draco_inf_nan.obj", ErrorReason::kMeshDegenerate},
    {"bad/empty.obj", ErrorReason::kMeshEmpty},
    {"bad/empty.ply", ErrorReason::kMeshEmpty},
    {"bad/empty.stl", ErrorReason::kMeshEmpty},
    {"stress/empty.off", ErrorReason::kMeshEmpty},
    {"stress/index_out_of_range.off", ErrorReason::kMeshDegenerate},
    {"stress/inf_vertex.off", ErrorReason::kMeshDegenerate},
    {"stress/nan_vertex.off", ErrorReason::kMeshDegenerate},
    {"stress/negative_index.off", ErrorReason::kMeshDegenerate},
    {"stress/no_faces.off", ErrorReason::kMeshEmpty},
    {"draco/DracoPy_point_cloud_bunny.drc", ErrorReason::kDracoDecodeFailed},
    {"draco/DracoPy_point_cloud_bunny_test.drc", ErrorReason::kDracoDecodeFailed},
    {"draco/cube_pc.drc", ErrorReason::kDracoDecodeFailed},
    {"draco/loadersgl_cesium-tile.drc", ErrorReason::kDracoDecodeFailed},
    {"draco/pc_color.drc", ErrorReason::kDracoDecodeFailed},
    {"draco/pc_kd_color.drc", ErrorReason::kDracoDecodeFailed},
    {"draco/point_cloud_no_qp.drc", ErrorReason::kDracoDecodeFailed},
};

TEST_F(SharedMeshes, ValidOnesAreReadAndOthersRefusedForTheirReason) {
  int files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(MeshFolder())) {
    const std::string path = entry.path().string();
    const std::string name = fs::relative(entry.path(), MeshFolder()).string();
    if (!MeshFormatFromPath(path).has_value() || name.starts_with("draco-corrupt/")) continue;
    ++files;
    const auto file = ReadMeshFile(path);
    const auto refused = kRefused.find(name);
    if (refused == kRefused.end()) {
      EXPECT_TRUE(file.ok()) << file.status();
    } else {
      EXPECT_REFUSED(file, refused->second, name);
    }
  }
  EXPECT_GT(files, 100);
}

TEST_F(SharedMeshes, CountsAreThoseMeasured) {
  const std::map<std::string, std::pair<std::size_t, std::size_t>> counts = {
      {"bad/T.ply", {20, 36}},
      {"bad/soup.stl", {300, 100}},
      {"bad/non_manif_hole.ply", {432, 755}},
      {"bad/moebius.obj", {280, 448}},
      {"draco/DracoPy_bunny.drc", {34834, 69451}},
      {"draco/bunny_gltf.drc", {34834, 69451}},
      {"draco/car.drc", {1856, 1744}},
      {"draco/cube_att_sub_o_2.drc", {8, 12}},
      {"draco/octagon_preserved.drc", {8, 6}},
      {"draco/test_nm.obj.edgebreaker.0.9.1.drc", {99, 170}},
      {"draco/test_nm.obj.edgebreaker.cl10.2.2.drc", {99, 170}},
      {"draco/test_nm.obj.sequential.1.0.0.drc", {97, 170}},
      {"draco/test_nm.obj.sequential.cl3.2.2.drc", {97, 170}},
      {"paper/kitten_9756.off", {9756, 19512}},
      {"stress/isolated_vertices.off", {842, 1280}},
      {"stress/quads_only_sphere.off", {1152, 2208}},
      {"textured/knot/texturedknot.ply", {1440, 2880}},
      {"textured/knot/texturedknot.obj", {1440, 2880}},
      {"textured/spot/spot_triangulated.obj", {2930, 5856}},
  };
  for (const auto& [name, count] : counts) {
    const auto file = ReadMeshFile(MeshFolder() + "/" + name);
    ASSERT_TRUE(file.ok()) << file.status();
    EXPECT_EQ(file->mesh.positions.size(), count.first) << name;
    EXPECT_EQ(file->mesh.faces.size(), count.second) << name;
  }
}

// The same model through every generation of encoders, and through the other reader.
TEST_F(SharedMeshes, DracoGenerationsAgree) {
  const auto area = [](const TriangleMesh& mesh) {
    double sum = 0.0;
    for (const Eigen::Vector3i& face : mesh.faces) {
      const auto corner = [&](int k) { return mesh.positions[static_cast<std::size_t>(face[k])]; };
      sum += 0.5 * (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm();
    }
    return sum;
  };
  std::map<std::string, double> areas;
  for (const auto& entry : fs::directory_iterator(MeshFolder() + "/draco")) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with("test_nm")) continue;
    const auto file = ReadMeshFile(entry.path().string());
    ASSERT_TRUE(file.ok()) << file.status();
    areas[name] = area(file->mesh);
  }
  ASSERT_GT(areas.size(), 10u);
  const double expected = areas.begin()->second;
  for (const auto& [name, found] : areas) EXPECT_NEAR(found, expected, 0.02 * expected) << name;
}

TEST_F(SharedMeshes, DamagedDracoGivesAMeshOrARefusalAndTakesLittleMemory) {
  int files = 0;
  for (const auto& entry : fs::directory_iterator(MeshFolder() + "/draco-corrupt")) {
    ++files;
    const std::string path = entry.path().string();
    const auto file = ReadMeshFile(path);
    if (!file.ok()) {
      EXPECT_EQ(file.status().code(), absl::StatusCode::kInvalidArgument) << file.status();
      EXPECT_TRUE(GetErrorReason(file.status()).has_value()) << file.status();
    }
    const std::int64_t growth = testing::PeakGrowth([&] { (void)ReadMeshFile(path); });
    EXPECT_GE(growth, 0) << path << " crashed";
    EXPECT_LT(growth, 16 << 20) << path;
  }
  EXPECT_GT(files, 30);
}

}  // namespace
}  // namespace ccst
