// The readers of text and binary mesh files, the first byte names the format; what was read is
// written again.
#include <array>
#include <cstdlib>
#include <string_view>

#include "core/base/status.h"
#include "core/io/mesh_file.h"
#include "core/mesh/attributes.h"
#include "tests/fuzz/target.h"

namespace {

using ccst::MeshFile;
using ccst::MeshFormat;
using ccst::MeshOutputFormat;

// What the header promises of a mesh that was read.
void Check(const MeshFile& file) {
  const auto count = static_cast<std::int64_t>(file.mesh.positions.size());
  if (file.mesh.faces.empty()) std::abort();
  for (const Eigen::Vector3i& face : file.mesh.faces) {
    if (face.minCoeff() < 0 || face.maxCoeff() >= count) std::abort();
  }
  for (const Eigen::Vector3d& position : file.mesh.positions) {
    if (!position.allFinite()) std::abort();
  }
  if (!file.face_source.empty() && file.face_source.size() != file.mesh.faces.size()) {
    std::abort();
  }
  if (!ccst::CheckAttributes(file.mesh).ok()) std::abort();
}

void CheckWritten(const MeshFile& file, MeshOutputFormat output, MeshFormat input) {
  const auto bytes = ccst::EncodeMesh(file.mesh, output);
  if (!bytes.ok()) return;  // No floats, for example.
  const auto again = ccst::ReadMesh(*bytes, input);
  if (!again.ok()) {
    // Columns of several components are as many attributes in a PLY.
    if (ccst::GetErrorReason(again.status()) == ccst::ErrorReason::kLimitExceeded) return;
    std::abort();
  }
  Check(*again);
  if (again->mesh.faces.size() != file.mesh.faces.size()) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::array<MeshFormat, 5> kFormats = {
      MeshFormat::kObj, MeshFormat::kPly, MeshFormat::kStl, MeshFormat::kOff, MeshFormat::kGltf};
  // Small enough that shared accessors and nodes, which multiply, are read in no time.
  const ccst::MeshLimits limits = {
      .max_vertices = 100'000, .max_faces = 100'000, .max_decoded_bytes = std::int64_t{16} << 20};
  if (size == 0) return 0;
  const std::string_view bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  const auto file = ccst::ReadMesh(bytes, kFormats[data[0] % kFormats.size()], limits);
  if (!file.ok()) return 0;
  Check(*file);
  CheckWritten(*file, MeshOutputFormat::kObj, MeshFormat::kObj);
  CheckWritten(*file, MeshOutputFormat::kPly, MeshFormat::kPly);
  CheckWritten(*file, MeshOutputFormat::kGlb, MeshFormat::kGltf);
  return 0;
}
