#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <Eigen/Geometry>

#include "absl/strings/str_cat.h"
#include "core/base/status.h"
#include "core/io/draco_cloud.h"
#include "core/io/draco_mesh.h"
#include "core/io/float_positions.h"
#include "core/io/glb_writer.h"
#include "core/io/io_errors.h"
#include "core/io/mesh_file.h"
#include "core/io/numbers.h"
#include "core/io/obj_writer.h"
#include "core/io/sample_columns.h"
#include "core/mesh/attributes.h"

namespace ccst {
namespace {

void AppendPosition(std::string& out, const Eigen::Vector3d& position) {
  io::AppendDouble(out, position.x());
  out += ' ';
  io::AppendDouble(out, position.y());
  out += ' ';
  io::AppendDouble(out, position.z());
}

std::string EncodeOff(const TriangleMesh& mesh) {
  std::string out = absl::StrCat("OFF\n", mesh.positions.size(), " ", mesh.faces.size(), " 0\n");
  for (const Eigen::Vector3d& position : mesh.positions) {
    AppendPosition(out, position);
    out += '\n';
  }
  for (const Eigen::Vector3i& face : mesh.faces) {
    out += '3';
    for (const int corner : face) {
      out += ' ';
      io::AppendInteger(out, corner);
    }
    out += '\n';
  }
  return out;
}

std::string EncodePly(const TriangleMesh& mesh) {
  // Readers take nx ny nz for normals.
  const std::vector<io::SampleColumn> columns =
      io::LayOutColumns(mesh.attributes, {"x", "y", "z", "nx", "ny", "nz"});
  std::string out =
      absl::StrCat("ply\nformat binary_little_endian 1.0\nelement vertex ", mesh.positions.size(),
                   "\nproperty double x\nproperty double y\nproperty double z\n");
  io::AppendPlyProperties(out, columns);
  absl::StrAppend(&out, "element face ", mesh.faces.size(),
                  "\nproperty list uchar int vertex_indices\nend_header\n");
  out.reserve(out.size() + (24 + io::BytesOf(columns)) * mesh.positions.size() +
              13 * mesh.faces.size());
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    for (const double coordinate : mesh.positions[i]) io::AppendLittleEndian(out, coordinate);
    io::AppendValues(out, columns, i);
  }
  for (const Eigen::Vector3i& face : mesh.faces) {
    out += '\x03';
    for (const int corner : face) io::AppendLittleEndian(out, std::int32_t{corner});
  }
  return out;
}

absl::StatusOr<std::string> EncodeStl(const TriangleMesh& mesh) {
  if (mesh.faces.size() > std::numeric_limits<std::uint32_t>::max()) {
    return io::OverLimit(absl::StrCat(mesh.faces.size(), " faces; STL counts to 4294967295"));
  }
  std::string out = "binary STL";
  out.resize(80, ' ');
  out.reserve(84 + 50 * mesh.faces.size());
  io::AppendLittleEndian(out, static_cast<std::uint32_t>(mesh.faces.size()));
  for (const Eigen::Vector3i& face : mesh.faces) {
    const Eigen::Vector3d& a = mesh.positions[static_cast<std::size_t>(face[0])];
    const Eigen::Vector3d& b = mesh.positions[static_cast<std::size_t>(face[1])];
    const Eigen::Vector3d& c = mesh.positions[static_cast<std::size_t>(face[2])];
    // Faces without area have no normal; readers take the zero vector for "compute it".
    const Eigen::Vector3d normal = (b - a).cross(c - a).stableNormalized();
    for (const Eigen::Vector3d& vector : {normal, a, b, c}) {
      for (const double value : vector) io::AppendLittleEndian(out, static_cast<float>(value));
    }
    io::AppendLittleEndian(out, std::uint16_t{0});
  }
  return out;
}

// A point cloud where there are no faces, which a Draco mesh cannot do without.
absl::StatusOr<std::string> EncodeDracoFile(const TriangleMesh& mesh) {
  if (!mesh.faces.empty()) return EncodeDraco(mesh);
  if (mesh.positions.empty()) return io::Empty("the mesh has no vertices; Draco needs one");
  CCST_RETURN_IF_ERROR(io::ToFloatPositions(mesh.positions, Eigen::Vector3d::Zero()).status());
  return io::EncodeDracoCloud(mesh.positions, {}, mesh.attributes);
}

absl::Status Validate(const TriangleMesh& mesh, MeshOutputFormat format) {
  CCST_RETURN_IF_ERROR(CheckAttributes(mesh));
  // The other formats hold doubles. GLB and Draco look after their own, which may be relative.
  const bool holds_floats = format == MeshOutputFormat::kStl;
  const double largest =
      holds_floats ? double{std::numeric_limits<float>::max()} : std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    if ((mesh.positions[i].array().abs() <= largest).all()) continue;
    return io::Degenerate(absl::StrCat("vertex ", i, " (counted from 0) has a coordinate that is ",
                                       "not finite", holds_floats ? " as a 32-bit float" : ""));
  }
  const auto vertices = static_cast<std::int64_t>(mesh.positions.size());
  if (vertices > std::numeric_limits<std::int32_t>::max()) {
    return io::OverLimit(absl::StrCat(vertices, " vertices; indices have 31 bits"));
  }
  for (std::size_t i = 0; i < mesh.faces.size(); ++i) {
    if (mesh.faces[i].minCoeff() >= 0 && mesh.faces[i].maxCoeff() < vertices) continue;
    return io::Degenerate(absl::StrCat("face ", i, " (counted from 0) has a corner outside the ",
                                       vertices, " vertices"));
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::string> EncodeMesh(const TriangleMesh& mesh, MeshOutputFormat format) {
  CCST_RETURN_IF_ERROR(Validate(mesh, format));
  switch (format) {
    case MeshOutputFormat::kObj:
      return io::EncodeObj(mesh.positions, mesh.faces, mesh.attributes);
    case MeshOutputFormat::kPly:
      return EncodePly(mesh);
    case MeshOutputFormat::kStl:
      return EncodeStl(mesh);
    case MeshOutputFormat::kOff:
      return EncodeOff(mesh);
    case MeshOutputFormat::kDraco:
      return EncodeDracoFile(mesh);
    case MeshOutputFormat::kGlb:
      return io::EncodeGlb(mesh);
  }
  return io::Unreadable("unknown mesh format");
}

}  // namespace ccst
