#include "core/io/mesh_file.h"

#include <array>
#include <filesystem>
#include <string>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "core/base/status.h"
#include "core/io/atomic_file.h"
#include "core/io/draco_mesh.h"
#include "core/io/gzip.h"
#include "core/io/io_errors.h"
#include "core/io/mesh_readers.h"
#include "core/io/numbers.h"
#include "core/io/path_extension.h"
#include "core/io/whole_file.h"

namespace ccst {
namespace {

constexpr std::array<std::pair<std::string_view, MeshFormat>, 7> kFormats = {{
    {".obj", MeshFormat::kObj},
    {".ply", MeshFormat::kPly},
    {".stl", MeshFormat::kStl},
    {".off", MeshFormat::kOff},
    {".glb", MeshFormat::kGltf},
    {".gltf", MeshFormat::kGltf},
    {".drc", MeshFormat::kDraco},
}};

constexpr std::array<std::pair<std::string_view, MeshOutputFormat>, 6> kOutputFormats = {{
    {".obj", MeshOutputFormat::kObj},
    {".ply", MeshOutputFormat::kPly},
    {".stl", MeshOutputFormat::kStl},
    {".off", MeshOutputFormat::kOff},
    {".drc", MeshOutputFormat::kDraco},
    {".glb", MeshOutputFormat::kGlb},
}};

/// @param folder  of the file, where it was one.
absl::StatusOr<MeshFile> Read(std::string_view bytes, MeshFormat format, const MeshLimits& limits,
                              const std::optional<std::string>& folder) {
  if (static_cast<std::int64_t>(bytes.size()) > limits.max_bytes) {
    return io::OverLimit(
        absl::StrCat(bytes.size(), " bytes; at most ", limits.max_bytes, " are accepted"));
  }
  if (bytes.empty()) return io::Empty("the file is empty");
  std::string inflated;
  if (io::IsGzip(bytes)) {
    CCST_ASSIGN_OR_RETURN(inflated, io::DecompressGzip(bytes, limits.max_bytes));
    bytes = inflated;
  }
  // Some editors put a byte order mark before text.
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (bytes.starts_with(kByteOrderMark)) bytes.remove_prefix(kByteOrderMark.size());
  switch (format) {
    case MeshFormat::kObj:
      return io::ReadObj(bytes, limits);
    case MeshFormat::kPly:
      return io::ReadPly(bytes, limits);
    case MeshFormat::kStl:
      return io::ReadStl(bytes, limits);
    case MeshFormat::kOff:
      return io::ReadOff(bytes, limits);
    case MeshFormat::kGltf:
      return io::ReadGltf(bytes, limits, folder);
    case MeshFormat::kDraco: {
      CCST_ASSIGN_OR_RETURN(TriangleMesh mesh, DecodeDraco(bytes, limits));
      return MeshFile{.mesh = std::move(mesh), .face_source = {}, .report = {}};
    }
  }
  return io::Unreadable("unknown mesh format");
}

}  // namespace

std::optional<MeshFormat> MeshFormatFromPath(std::string_view path) {
  constexpr absl::string_view kCompressed = ".gz";
  if (absl::EndsWithIgnoreCase(absl::string_view(path.data(), path.size()), kCompressed))
    path.remove_suffix(kCompressed.size());
  return io::FindByExtension(path, kFormats);
}

std::optional<MeshOutputFormat> MeshOutputFormatFromPath(std::string_view path) {
  return io::FindByExtension(path, kOutputFormats);
}

absl::StatusOr<MeshFile> ReadMesh(std::string_view bytes, MeshFormat format,
                                  const MeshLimits& limits) {
  return Read(bytes, format, limits, std::nullopt);
}

absl::StatusOr<MeshFile> ReadMeshFile(const std::string& path, const MeshLimits& limits) {
  const auto format = MeshFormatFromPath(path);
  if (!format.has_value()) {
    return io::Unreadable(
        absl::StrCat(path,
                     ": cannot tell the format; known are .obj .ply .stl .off .glb .gltf .drc, "
                     "also with .gz behind"));
  }
  CCST_ASSIGN_OR_RETURN(const std::string bytes, io::ReadWholeFile(path, limits.max_bytes));
  const std::string folder = std::filesystem::path(path).parent_path().string();
  auto file = Read(bytes, *format, limits, folder);
  if (!file.ok()) return io::WithPrefix(file.status(), path + ": ");
  return file;
}

absl::Status WriteMeshFile(const TriangleMesh& mesh, const std::string& path) {
  const auto format = MeshOutputFormatFromPath(path);
  if (!format.has_value()) {
    return MakeError(
        absl::StatusCode::kInvalidArgument, ErrorReason::kOptionInvalid,
        absl::StrCat(path, ": cannot tell the format; known are .obj .ply .stl .off .drc .glb"));
  }
  const auto bytes = EncodeMesh(mesh, *format);
  if (!bytes.ok()) return io::WithPrefix(bytes.status(), path + ": ");
  return WriteFileAtomically(path, *bytes);
}

}  // namespace ccst
