#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/io/mesh_file.h"

namespace ccst::io {

/// Appends what the corners of a polygon have, in the order of a fan around its first corner: three
/// values a triangle. MeshBuilder::Finish() gives them the order of the triangles that it cuts.
template <typename T>
void AppendFan(std::span<const T> polygon, std::vector<T>& corners) {
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    corners.push_back(polygon[0]);
    corners.push_back(polygon[i - 1]);
    corners.push_back(polygon[i]);
  }
}

/// Collects what a reader finds: cuts polygons into triangles once all vertices are known, keeps
/// the limits, refuses what is not a mesh. `where` arguments are called for messages only.
class MeshBuilder {
 public:
  using Where = std::function<std::string()>;

  explicit MeshBuilder(const MeshLimits& limits) : limits_(limits) {}

  /// For formats that announce their counts. Refuses those over the limits. `bytes_left` must
  /// be what the announced records are still to be read from: no more is reserved than
  /// `bytes_left` can hold at `vertex_bytes` and `face_bytes` a record or more.
  absl::Status Announce(std::int64_t vertices, std::int64_t faces, std::int64_t bytes_left,
                        std::int64_t vertex_bytes, std::int64_t face_bytes);

  /// From now on corners must be in [0, `vertices`) when they are added, not only at the end.
  void SetVertexCount(std::int64_t vertices) { vertex_count_ = vertices; }

  /// Coordinates may be anything: Finish() refuses a vertex that is not finite only where a face
  /// uses it.
  /// @errors LIMIT_EXCEEDED
  template <typename WhereFunction>
  absl::Status AddVertex(const Eigen::Vector3d& position, const WhereFunction& where) {
    if (vertices() >= limits_.max_vertices) [[unlikely]]
      return RefuseVertex(where());
    if (!position.allFinite()) [[unlikely]]
      NoteNotFinite(where());
    file_.mesh.positions.push_back(position);
    return absl::OkStatus();
  }

  /// Adds the file's next face. Corners count from 0. A face of fewer than three is counted and
  /// skipped, but keeps its number.
  /// @errors MESH_DEGENERATE a corner out of range; LIMIT_EXCEEDED
  template <typename WhereFunction>
  absl::Status AddFace(std::span<const std::int64_t> corners, const WhereFunction& where) {
    if (!Accepts(corners)) [[unlikely]]
      return RefuseFace(corners, where());
    AppendTriangles(corners);
    return absl::OkStatus();
  }

  /// Says that something of the file was passed over.
  void Ignore(std::string what) { file_.report.ignored.push_back(std::move(what)); }

  /// Adds values, which must be as many as the vertices or corners need at the end. Names need not
  /// be unique.
  void AddAttribute(Attribute attribute) { file_.mesh.attributes.push_back(std::move(attribute)); }

  /// Adds texture coordinates, one a corner in the order of AppendFan(), as all values by corner
  /// that AddAttribute() is given.
  void AddCornerTexture(std::span<const Eigen::Vector2f> uv);

  std::int64_t vertices() const { return static_cast<std::int64_t>(file_.mesh.positions.size()); }
  std::int64_t faces() const { return source_faces_; }
  /// Of the triangles so far.
  std::size_t corners() const { return 3 * file_.mesh.faces.size(); }

  /// @param where_is_face  place of the file's i-th face, for corners that can be checked at the
  ///                       end only; may be null.
  /// Cost O(V + F), and that of cutting polygons of more than three corners.
  /// @errors MESH_EMPTY no face; MESH_DEGENERATE a corner out of range, or a vertex of a face that
  ///         is not finite; LIMIT_EXCEEDED a polygon that takes too long to cut
  absl::StatusOr<MeshFile> Finish(
      const std::function<std::string(std::int64_t)>& where_is_face = nullptr) &&;

 private:
  bool Accepts(std::span<const std::int64_t> corners) const;
  void AppendTriangles(std::span<const std::int64_t> corners);
  void NoteNotFinite(std::string where);
  absl::Status CheckFinite();
  void NoteCorners(std::size_t triangle, std::int32_t i,
                   const std::array<std::int32_t, 3>& corners);
  absl::Status CutPolygons();
  absl::Status RefuseVertex(const std::string& where) const;
  absl::Status RefuseFace(std::span<const std::int64_t> corners, const std::string& where) const;
  absl::Status RefuseCorner(std::int64_t corner, const std::string& where,
                            std::int64_t vertices) const;

  MeshLimits limits_;
  MeshFile file_;
  std::int64_t source_faces_ = 0;
  std::int64_t vertex_count_ = -1;  // Unknown.
  bool has_polygons_ = false;
  bool is_mapped_ = false;  // `face_source` is in use.
  // Vertices that are not finite, and where the first few of them stand.
  std::vector<std::int32_t> not_finite_;
  std::vector<std::string> not_finite_where_;
};

}  // namespace ccst::io
