#include "client/cli/stage_files.h"

#include <filesystem>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/cli/outputs.h"
#include "core/base/status.h"
#include "core/io/mesh_file.h"

namespace ccst::cli {
namespace {

constexpr Stage kStages[] = {Stage::kRepaired, Stage::kRefined,   Stage::kInitial, Stage::kEarly,
                             Stage::kMended,   Stage::kConverged, Stage::kRelaxed, Stage::kResult};

const char* StageName(Stage stage) {
  switch (stage) {
    case Stage::kRepaired:
      return "1-repaired";
    case Stage::kRefined:
      return "2-refined";
    case Stage::kInitial:
      return "3-initial";
    case Stage::kEarly:
      return "4-early";
    case Stage::kMended:
      return "5-mended";
    case Stage::kConverged:
      return "6-converged";
    case Stage::kRelaxed:
      return "7-relaxed";
    case Stage::kResult:
      return "8-result";
  }
  return "unknown";
}

std::string PathOf(const std::string& folder, Stage stage) {
  return (std::filesystem::path(folder) / absl::StrCat(StageName(stage), ".ply")).string();
}

}  // namespace

absl::Status CheckStageFiles(const std::string& folder, const std::vector<NamedFile>& others) {
  std::vector<NamedFile> files;
  for (const Stage stage : kStages) {
    const std::string path = PathOf(folder, stage);
    CCST_RETURN_IF_ERROR(CheckWritable(path));
    files.push_back({"--dump-stages", path});
  }
  return CheckDistinct(files, others);
}

StageFiles::StageFiles(std::string folder, const Eigen::Vector3d& origin)
    : folder_(std::move(folder)), origin_(origin) {}

void StageFiles::OnStage(Stage stage, std::span<const Eigen::Vector3d> positions,
                         std::span<const Eigen::Vector3i> triangles) {
  if (!status_.ok()) return;
  TriangleMesh mesh;
  mesh.positions.assign(positions.begin(), positions.end());
  for (Eigen::Vector3d& position : mesh.positions) position += origin_;
  mesh.faces.assign(triangles.begin(), triangles.end());
  status_ = WriteMeshFile(mesh, PathOf(folder_, stage));
}

}  // namespace ccst::cli
