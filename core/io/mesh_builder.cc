#include "core/io/mesh_builder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "absl/strings/str_cat.h"
#include "core/base/status.h"
#include "core/io/io_errors.h"
#include "core/io/numbers.h"
#include "core/io/polygon.h"
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
  const std::size_t cut = corners.size() < 3 ? 0 : corners.size() - 2;
  const auto triangles = static_cast<std::int64_t>(file_.mesh.faces.size() + cut);
  if (source_faces_ >= kMaxIndex) return false;
  if (triangles > std::min(limits_.max_faces, kMaxIndex)) return false;
  const std::int64_t bound = vertex_count_ < 0 ? kMaxIndex : vertex_count_;
  return std::all_of(corners.begin(), corners.end(),
                     [bound](std::int64_t corner) { return corner >= 0 && corner < bound; });
}

void MeshBuilder::AppendTriangles(std::span<const std::int64_t> corners) {
  auto& faces = file_.mesh.faces;
  auto& source = file_.face_source;
  // The map back stays empty while it would say i -> i.
  const bool is_triangle = corners.size() == 3;
  if (!is_triangle && !is_mapped_) {
    is_mapped_ = true;
    source.resize(faces.size());
    std::iota(source.begin(), source.end(), 0);
  }
  has_polygons_ = has_polygons_ || corners.size() > 3;
  if (corners.size() < 3) ++file_.report.faces_skipped;
  for (std::size_t i = 2; i < corners.size(); ++i) {
    faces.emplace_back(static_cast<int>(corners[0]), static_cast<int>(corners[i - 1]),
                       static_cast<int>(corners[i]));
    if (is_mapped_) source.push_back(static_cast<std::int32_t>(source_faces_));
  }
  ++source_faces_;
}

void MeshBuilder::NoteNotFinite(std::string where) {
  constexpr std::size_t kPlaces = 1000;
  not_finite_.push_back(static_cast<std::int32_t>(vertices()));
  if (not_finite_where_.size() < kPlaces) not_finite_where_.push_back(std::move(where));
}

absl::Status MeshBuilder::RefuseVertex(const std::string& where) const {
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

// Vertices of no face that are not finite go to a place that a face uses, so that nobody after
// this has to look out for them.
absl::Status MeshBuilder::CheckFinite() {
  if (not_finite_.empty()) return absl::OkStatus();
  TriangleMesh& mesh = file_.mesh;
  std::vector<bool> is_used(mesh.faces.empty() ? 0 : mesh.positions.size(), false);
  for (const Eigen::Vector3i& face : mesh.faces) {
    for (const int corner : face) is_used[static_cast<std::size_t>(corner)] = true;
  }
  for (std::size_t i = 0; i < not_finite_.size(); ++i) {
    const auto vertex = static_cast<std::size_t>(not_finite_[i]);
    // Points without faces are all used.
    if (!mesh.faces.empty() && !is_used[vertex]) continue;
    const Eigen::Vector3d& position = mesh.positions[vertex];
    int axis = 0;
    while (std::isfinite(position[axis])) ++axis;
    std::string value;
    AppendDouble(value, position[axis]);
    return Degenerate(absl::StrCat(i < not_finite_where_.size() ? not_finite_where_[i] + ": " : "",
                                   "vertex ", vertex, " (counted from 0) has ",
                                   std::string(1, "xyz"[axis]), " = ", value,
                                   "; coordinates must be finite"));
  }
  for (const std::int32_t vertex : not_finite_) {
    mesh.positions[static_cast<std::size_t>(vertex)] =
        mesh.positions[static_cast<std::size_t>(mesh.faces[0][0])];
  }
  file_.report.vertices_not_finite = static_cast<std::int64_t>(not_finite_.size());
  return absl::OkStatus();
}

// `triangle` is the `i`-th of its face.
void MeshBuilder::NoteCorners(std::size_t triangle, std::int32_t i,
                              const std::array<std::int32_t, 3>& corners) {
  const Eigen::Vector3i fan(0, i + 1, i + 2);
  const Eigen::Vector3i cut(corners[0], corners[1], corners[2]);
  std::vector<Eigen::Vector3i>& face_corners = file_.face_corners;
  if (face_corners.empty()) {
    if (cut == fan) return;
    const std::vector<std::int32_t>& source = file_.face_source;
    face_corners.resize(source.size());
    for (std::size_t t = 0, first = 0; t < source.size(); ++t) {
      if (source[t] != source[first]) first = t;
      const auto in_face = static_cast<std::int32_t>(t - first);
      face_corners[t] = {0, in_face + 1, in_face + 2};
    }
  }
  face_corners[triangle] = cut;
}

// The triangles of a polygon stand together, as a fan; what they carry by corner as well.
absl::Status MeshBuilder::CutPolygons() {
  if (!has_polygons_) return absl::OkStatus();
  TriangleMesh& mesh = file_.mesh;
  const std::vector<std::int32_t>& source = file_.face_source;
  PolygonCutter cutter;
  std::vector<int> vertices;
  std::vector<Eigen::Vector3d> corners;
  std::vector<std::array<std::int32_t, 3>> triangles;
  std::vector<float> values;
  for (std::size_t first = 0, end = 0; first < mesh.faces.size(); first = end) {
    end = first + 1;
    while (end < mesh.faces.size() && source[end] == source[first]) ++end;
    if (end - first == 1) continue;
    vertices.assign({mesh.faces[first][0], mesh.faces[first][1]});
    for (std::size_t t = first; t < end; ++t) vertices.push_back(mesh.faces[t][2]);
    corners.clear();
    for (const int vertex : vertices) {
      corners.push_back(mesh.positions[static_cast<std::size_t>(vertex)]);
    }
    const PolygonCut cut = cutter.Cut(corners, triangles);
    if (cut == PolygonCut::kTooComplex) {
      return OverLimit(absl::StrCat("face ", source[first], " (counted from 0) has ",
                                    corners.size(),
                                    " corners and takes too long to cut into triangles; save the "
                                    "mesh with triangles"));
    }
    if (cut == PolygonCut::kSelfCrossing) ++file_.report.polygons_self_crossing;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      for (int k = 0; k < 3; ++k) {
        mesh.faces[first + t][k] = vertices[static_cast<std::size_t>(triangles[t][k])];
      }
      NoteCorners(first + t, static_cast<std::int32_t>(t), triangles[t]);
    }
    // Where the fan has the values of corner `i`: in the first triangle, or as the last of one.
    const auto row = [first](std::int32_t i) {
      return 3 * first + static_cast<std::size_t>(i < 2 ? i : 3 * (i - 2) + 2);
    };
    for (Attribute& attribute : mesh.attributes) {
      if (!attribute.per_corner) continue;
      const auto width = static_cast<std::size_t>(attribute.components);
      values.clear();
      for (const auto& triangle : triangles) {
        for (const std::int32_t corner : triangle) {
          const auto at =
              attribute.values.begin() + static_cast<std::ptrdiff_t>(row(corner) * width);
          values.insert(values.end(), at, at + attribute.components);
        }
      }
      std::copy(values.begin(), values.end(),
                attribute.values.begin() + static_cast<std::ptrdiff_t>(3 * first * width));
    }
  }
  return absl::OkStatus();
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
  CCST_RETURN_IF_ERROR(CheckFinite());
  CCST_RETURN_IF_ERROR(CutPolygons());
  NameAttributes(file_.mesh.attributes);
  return std::move(file_);
}

}  // namespace ccst::io
