#include "core/io/mesh_builder.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "absl/strings/str_cat.h"
#include "core/io/io_errors.h"
#include "core/io/numbers.h"
#include "core/mesh/attributes.h"

namespace ccst::io {
namespace {

// Corners are stored as 32-bit numbers whatever the limits say.
constexpr std::int64_t kMaxIndex = std::numeric_limits<std::int32_t>::max();

}  // namespace

absl::Status MeshBuilder::Announce(std::int64_t vertices, std::int64_t faces,
                                   std::int64_t bytes_left, std::int64_t vertex_bytes,
                                   std::int64_t face_bytes) {
  if (vertices > limits_.max_vertices) {
    return OverLimit(absl::StrCat("the file announces ", vertices, " vertices; at most ",
                                  limits_.max_vertices, " are accepted"));
  }
  if (faces > limits_.max_faces) {
    return OverLimit(absl::StrCat("the file announces ", faces, " faces; at most ",
                                  limits_.max_faces, " triangles are accepted"));
  }
  file_.mesh.positions.reserve(std::min(vertices, bytes_left / vertex_bytes + 1));
  file_.mesh.faces.reserve(std::min(faces, bytes_left / face_bytes + 1));
  return absl::OkStatus();
}

bool MeshBuilder::Accepts(std::span<const std::int64_t> corners) const {
  if (corners.size() < 3) return false;
  const std::int64_t triangles =
      static_cast<std::int64_t>(file_.mesh.faces.size() + corners.size() - 2);
  if (triangles > std::min(limits_.max_faces, kMaxIndex)) return false;
  const std::int64_t bound = vertex_count_ < 0 ? kMaxIndex : vertex_count_;
  return std::all_of(corners.begin(), corners.end(),
                     [bound](std::int64_t corner) { return corner >= 0 && corner < bound; });
}

void MeshBuilder::AppendTriangles(std::span<const std::int64_t> corners) {
  auto& faces = file_.mesh.faces;
  auto& source = file_.face_source;
  // The map back stays empty while it would say i -> i.
  if (corners.size() > 3 && source.empty()) {
    source.resize(faces.size());
    std::iota(source.begin(), source.end(), 0);
  }
  const bool mapped = corners.size() > 3 || !source.empty();
  for (std::size_t i = 2; i < corners.size(); ++i) {
    faces.emplace_back(static_cast<int>(corners[0]), static_cast<int>(corners[i - 1]),
                       static_cast<int>(corners[i]));
    if (mapped) source.push_back(static_cast<std::int32_t>(source_faces_));
  }
  ++source_faces_;
}

absl::Status MeshBuilder::RefuseVertex(const Eigen::Vector3d& position,
                                       const std::string& where) const {
  for (int axis = 0; axis < 3; ++axis) {
    if (std::isfinite(position[axis])) continue;
    std::string value;
    AppendDouble(value, position[axis]);
    return Degenerate(absl::StrCat(where, ": vertex ", vertices(), " (counted from 0) has ",
                                   std::string(1, "xyz"[axis]), " = ", value,
                                   "; coordinates must be finite"));
  }
  return OverLimit(
      absl::StrCat(where, ": more than ", limits_.max_vertices, " vertices, the most accepted"));
}

absl::Status MeshBuilder::RefuseCorner(std::int64_t corner, const std::string& where,
                                       std::int64_t vertices) const {
  return Degenerate(absl::StrCat(where, ": face ", source_faces_, " has a corner at vertex ",
                                 corner, ", but there are ", vertices,
                                 " vertices (faces and vertices counted from 0)"));
}

absl::Status MeshBuilder::RefuseFace(std::span<const std::int64_t> corners,
                                     const std::string& where) const {
  if (corners.size() < 3) {
    return Unreadable(absl::StrCat(where, ": face ", source_faces_, " (counted from 0) has ",
                                   corners.size(), " corners; a face needs at least 3"));
  }
  const std::int64_t bound = vertex_count_ < 0 ? kMaxIndex : vertex_count_;
  for (const std::int64_t corner : corners) {
    if (corner < 0 || corner >= bound) {
      return RefuseCorner(corner, where, vertex_count_ < 0 ? vertices() : vertex_count_);
    }
  }
  return OverLimit(
      absl::StrCat(where, ": more than ", limits_.max_faces, " triangles, the most accepted"));
}

void MeshBuilder::AddCornerTexture(std::span<const Eigen::Vector2f> uv) {
  Attribute attribute{.name = "uv",
                      .kind = AttributeKind::kTextureCoordinates,
                      .components = 2,
                      .per_corner = true};
  attribute.values.reserve(2 * uv.size());
  for (const Eigen::Vector2f& coordinates : uv) {
    attribute.values.push_back(coordinates.x());
    attribute.values.push_back(coordinates.y());
  }
  AddAttribute(std::move(attribute));
}

absl::StatusOr<MeshFile> MeshBuilder::Finish(
    const std::function<std::string(std::int64_t)>& where_is_face) && {
  if (file_.mesh.faces.empty() && (limits_.min_faces > 0 || vertices() == 0)) {
    return Empty(absl::StrCat("the mesh has no faces (and ", vertices(), " vertices)"));
  }
  const std::int64_t count = vertices();
  for (std::size_t i = 0; i < file_.mesh.faces.size(); ++i) {
    const int worst = file_.mesh.faces[i].maxCoeff();
    if (worst < count) continue;
    source_faces_ = file_.face_source.empty() ? static_cast<std::int64_t>(i) : file_.face_source[i];
    return RefuseCorner(worst, where_is_face ? where_is_face(source_faces_) : "at the end", count);
  }
  NameAttributes(file_.mesh.attributes);
  return std::move(file_);
}

}  // namespace ccst::io
