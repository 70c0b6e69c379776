// The readers of text and binary mesh files; the first byte names the format.
#include <array>
#include <cstdlib>
#include <string_view>

#include "core/io/mesh_file.h"
#include "tests/fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using ccst::MeshFormat;
  constexpr std::array<MeshFormat, 4> kFormats = {MeshFormat::kObj, MeshFormat::kPly,
                                                  MeshFormat::kStl, MeshFormat::kOff};
  if (size == 0) return 0;
  const std::string_view bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  const auto file = ccst::ReadMesh(bytes, kFormats[data[0] % kFormats.size()]);
  if (!file.ok()) return 0;
  // What the header promises of a mesh that was read.
  const auto count = static_cast<std::int64_t>(file->mesh.positions.size());
  if (file->mesh.faces.empty()) std::abort();
  for (const Eigen::Vector3i& face : file->mesh.faces) {
    if (face.minCoeff() < 0 || face.maxCoeff() >= count) std::abort();
  }
  for (const Eigen::Vector3d& position : file->mesh.positions) {
    if (!position.allFinite()) std::abort();
  }
  if (!file->face_source.empty() && file->face_source.size() != file->mesh.faces.size()) {
    std::abort();
  }
  return 0;
}
