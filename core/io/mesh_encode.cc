#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

#include "absl/strings/str_cat.h"
#include "core/base/status.h"
#include "core/io/draco_mesh.h"
#include "core/io/glb_writer.h"
#include "core/io/io_errors.h"
#include "core/io/mesh_file.h"
#include "core/io/numbers.h"

namespace ccst {
namespace {

void AppendPosition(std::string& out, const Eigen::Vector3d& position) {
  io::AppendDouble(out, position.x());
  out += ' ';
  io::AppendDouble(out, position.y());
  out += ' ';
  io::AppendDouble(out, position.z());
}

std::string EncodeObj(const TriangleMesh& mesh) {
  std::string out;
  for (const Eigen::Vector3d& position : mesh.positions) {
    out += "v ";
    AppendPosition(out, position);
    out += '\n';
  }
  for (const Eigen::Vector3i& face : mesh.faces) {
    out += 'f';
    for (const int corner : face) {
      out += ' ';
      io::AppendInteger(out, std::int64_t{corner} + 1);
    }
    out += '\n';
  }
  return out;
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
  std::string out =
      absl::StrCat("ply\nformat binary_little_endian 1.0\nelement vertex ", mesh.positions.size(),
                   "\nproperty double x\nproperty double y\nproperty double z\nelement face ",
                   mesh.faces.size(), "\nproperty list uchar int vertex_indices\nend_header\n");
  out.reserve(out.size() + 24 * mesh.positions.size() + 13 * mesh.faces.size());
  for (const Eigen::Vector3d& position : mesh.positions) {
    for (const double coordinate : position) io::AppendLittleEndian(out, coordinate);
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

absl::Status Validate(const TriangleMesh& mesh, MeshOutputFormat format) {
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
      return EncodeObj(mesh);
    case MeshOutputFormat::kPly:
      return EncodePly(mesh);
    case MeshOutputFormat::kStl:
      return EncodeStl(mesh);
    case MeshOutputFormat::kOff:
      return EncodeOff(mesh);
    case MeshOutputFormat::kDraco:
      return EncodeDraco(mesh);
    case MeshOutputFormat::kGlb:
      return io::EncodeGlb(mesh);
  }
  return io::Unreadable("unknown mesh format");
}

}  // namespace ccst
