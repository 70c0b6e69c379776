#include "client/cli/outputs.h"

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <unistd.h>

#include "absl/strings/str_cat.h"
#include "client/cli/distinct_files.h"
#include "client/render/picture.h"
#include "core/base/status.h"
#include "core/io/atomic_file.h"
#include "core/io/mesh_file.h"
#include "core/io/sample_file.h"

namespace ccst::cli {
namespace {

constexpr char kStandardOutput[] = "-";

SampleFormat SamplesFormat(const std::string& path) {
  return SampleFormatFromPath(path).value_or(SampleFormat::kCsv);
}

MeshOutputFormat MeshFormatOf(const std::string& path) {
  return MeshOutputFormatFromPath(path).value_or(MeshOutputFormat::kObj);
}

bool IsPng(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension == ".png";
}

absl::Status CheckExtension(bool known, const char* flag, const std::string& path,
                            const char* extensions) {
  if (path.empty() || path == kStandardOutput || known) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat(flag, " ", path, ": the name must end in one of ", extensions));
}

absl::StatusOr<std::string> EncodePicture(const TriangleMesh& surface, const SampleSet& samples) {
  CCST_ASSIGN_OR_RETURN(const RgbImage image, RenderPicture(surface, samples));
  return EncodePng(image);
}

}  // namespace

absl::Status CheckWritable(const std::string& path) {
  if (path.empty() || path == kStandardOutput) return absl::OkStatus();
  namespace fs = std::filesystem;
  std::error_code error;
  if (fs::is_directory(path, error)) {
    return absl::InvalidArgumentError(absl::StrCat(path, " is a folder; name a file"));
  }
  // Devices and pipes are written in place, all else is renamed into its folder.
  if (fs::exists(path, error) && !fs::is_regular_file(path, error)) {
    if (access(path.c_str(), W_OK) == 0) return absl::OkStatus();
    return absl::InvalidArgumentError(absl::StrCat(path, " cannot be written"));
  }
  fs::path folder = fs::path(path).parent_path();
  if (folder.empty()) folder = ".";
  if (!fs::is_directory(folder, error)) {
    return absl::InvalidArgumentError(
        absl::StrCat(path, ": there is no folder ", folder.string(), "; make it first"));
  }
  if (access(folder.c_str(), W_OK | X_OK) != 0) {
    return absl::InvalidArgumentError(
        absl::StrCat(path, ": the folder ", folder.string(), " cannot be written to"));
  }
  return absl::OkStatus();
}

absl::Status CheckOutputs(const OutputPaths& paths, const std::vector<NamedFile>& inputs) {
  const std::string& samples = paths.samples_path;
  const std::string& mesh = paths.mesh_path;
  CCST_RETURN_IF_ERROR(
      CheckExtension(SampleFormatFromPath(samples).has_value(), "-o", samples, kSampleExtensions));
  CCST_RETURN_IF_ERROR(CheckExtension(MeshOutputFormatFromPath(mesh).has_value(), "--mesh-output",
                                      mesh, ".obj .ply .stl .off .glb .drc"));
  CCST_RETURN_IF_ERROR(
      CheckExtension(IsPng(paths.picture_path), "--picture", paths.picture_path, ".png"));
  for (const std::string& path : {samples, mesh, paths.picture_path, paths.summary_path}) {
    CCST_RETURN_IF_ERROR(CheckWritable(path));
  }
  return CheckDistinct({{"-o", samples},
                        {"--mesh-output", mesh},
                        {"--picture", paths.picture_path},
                        {"--summary", paths.summary_path}},
                       inputs);
}

absl::Status WriteOutputs(const OutputPaths& paths, const TriangleMesh& surface,
                          const FinishedRun& run) {
  const SampleSet& samples = run.outcome.result.samples;
  std::vector<std::pair<std::string, std::string>> files;  // Path and contents.
  std::string contents;
  if (!paths.samples_path.empty()) {
    CCST_ASSIGN_OR_RETURN(contents, EncodeSamples(samples, SamplesFormat(paths.samples_path)));
    files.emplace_back(paths.samples_path, std::move(contents));
  }
  if (!paths.mesh_path.empty()) {
    CCST_ASSIGN_OR_RETURN(contents,
                          EncodeMesh({samples.positions, samples.triangles, samples.attributes},
                                     MeshFormatOf(paths.mesh_path)));
    files.emplace_back(paths.mesh_path, std::move(contents));
  }
  if (!paths.picture_path.empty()) {
    CCST_ASSIGN_OR_RETURN(contents, EncodePicture(surface, samples));
    files.emplace_back(paths.picture_path, std::move(contents));
  }
  if (!paths.summary_path.empty()) {
    files.emplace_back(paths.summary_path, SummaryJson(run));
  }
  for (const auto& [path, bytes] : files) CCST_RETURN_IF_ERROR(WriteFileAtomically(path, bytes));
  return absl::OkStatus();
}

}  // namespace ccst::cli
