// All public models beside the tree: repaired, or refused for the reason they were chosen for.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "core/base/status.h"
#include "core/io/mesh_file.h"
#include "core/repair/repair.h"
#include "tests/core/repair/repair_test_util.h"

namespace ccst {
namespace {

namespace fs = std::filesystem;
using ::ccst::testing::RepairAndCheck;

std::string MeshFolder() {
  const char* const set = std::getenv("CCST_MESHES");
  return set != nullptr ? set : std::string(CCST_SOURCE_DIR) + "/../shared/meshes";
}

const std::map<std::string, ErrorReason> kRefused = {
    {"stress/all_collapsed_to_point.off", ErrorReason::kMeshEmpty},
    {"stress/all_collinear.off", ErrorReason::kMeshEmpty},
};

std::string Describe(const RepairReport& r) {
  std::string text;
  const auto add = [&](const char* name, std::int64_t count) {
    if (count != 0)
      text += std::string(text.empty() ? "" : ", ") + name + " " + std::to_string(count);
  };
  add("welded", r.welded_vertices);
  add("repeated index", r.repeated_index_faces);
  add("duplicate", r.duplicate_faces);
  add("degenerate", r.degenerate_faces);
  add("split", r.split_faces);
  add("cut edges", r.cut_edges);
  add("non-orientable cuts", r.non_orientable_cuts);
  add("cut vertices", r.cut_vertices);
  add("flipped", r.flipped_faces);
  add("isolated", r.isolated_vertices);
  return text.empty() ? "clean" : text;
}

TEST(RepairSharedMeshes, EveryFileIsRepairedOrRefusedForItsReason) {
  if (!fs::is_directory(MeshFolder())) {
    GTEST_SKIP() << "no test meshes in " << MeshFolder() << "; set CCST_MESHES";
  }
  std::set<std::string> paths;
  for (const auto& entry : fs::recursive_directory_iterator(MeshFolder())) {
    if (MeshFormatFromPath(entry.path().string()).has_value()) paths.insert(entry.path().string());
  }
  EXPECT_GT(paths.size(), 80u);
  for (const std::string& path : paths) {
    const std::string name = fs::relative(path, MeshFolder()).string();
    SCOPED_TRACE(name);
    const auto file = ReadMeshFile(path);
    if (!file.ok()) continue;  // The tests of core/io say which and why.
    const auto start = std::chrono::steady_clock::now();
    const auto result = Repair(file->mesh);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    const auto refused = kRefused.find(name);
    const bool corrupt = name.starts_with("draco-corrupt/");
    std::printf("%-48s %8zu faces %6.0f ns/face  %s\n", name.c_str(), file->mesh.faces.size(),
                1e9 * seconds.count() / static_cast<double>(file->mesh.faces.size()),
                result.ok() ? Describe(result->report).c_str()
                            : std::string(result.status().message()).c_str());
    if (!result.ok()) {
      if (corrupt) {
        EXPECT_TRUE(GetErrorReason(result.status()).has_value());
        continue;
      }
      ASSERT_NE(refused, kRefused.end()) << result.status().ToString();
      EXPECT_EQ(GetErrorReason(result.status()), refused->second);
      continue;
    }
    EXPECT_EQ(refused, kRefused.end());
    RepairedMesh repaired;
    RepairAndCheck(file->mesh, {}, &repaired);
  }
}

}  // namespace
}  // namespace ccst
