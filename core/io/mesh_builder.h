#pragma once

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

/// Appends what the corners of a polygon have, in the order in which AddFace() cuts it into a fan:
/// three values a triangle.
template <typename T>
void AppendFan(std::span<const T> polygon, std::vector<T>& corners) {
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    corners.push_back(polygon[0]);
    corners.push_back(polygon[i - 1]);
    corners.push_back(polygon[i]);
  }
}

/// Collects what a reader finds: cuts polygons into fans, keeps the limits, refuses what is not
/// a mesh. `where` arguments are called for messages only.
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

  /// @errors MESH_DEGENERATE not finite; LIMIT_EXCEEDED
  template <typename WhereFunction>
  absl::Status AddVertex(const Eigen::Vector3d& position, const WhereFunction& where) {
    if (!position.allFinite() || vertices() >= limits_.max_vertices) [[unlikely]] {
      return RefuseVertex(position, where());
    }
    file_.mesh.positions.push_back(position);
    return absl::OkStatus();
  }

  /// Adds the file's next face. Corners count from 0.
  /// @errors MESH_UNREADABLE fewer than three corners; MESH_DEGENERATE a corner out of range;
  ///         LIMIT_EXCEEDED
  template <typename WhereFunction>
  absl::Status AddFace(std::span<const std::int64_t> corners, const WhereFunction& where) {
    if (!Accepts(corners)) [[unlikely]]
      return RefuseFace(corners, where());
    AppendTriangles(corners);
    return absl::OkStatus();
  }

  /// Adds values, which must be as many as the vertices or corners need at the end. Names need not
  /// be unique.
  void AddAttribute(Attribute attribute) { file_.mesh.attributes.push_back(std::move(attribute)); }

  /// Adds texture coordinates, one a corner in the order of AppendFan().
  void AddCornerTexture(std::span<const Eigen::Vector2f> uv);

  std::int64_t vertices() const { return static_cast<std::int64_t>(file_.mesh.positions.size()); }
  std::int64_t faces() const { return source_faces_; }
  /// Of the triangles so far.
  std::size_t corners() const { return 3 * file_.mesh.faces.size(); }

  /// @param where_is_face  place of the file's i-th face, for corners that can be checked at the
  ///                       end only; may be null.
  /// @errors MESH_EMPTY no face; MESH_DEGENERATE a corner out of range
  absl::StatusOr<MeshFile> Finish(
      const std::function<std::string(std::int64_t)>& where_is_face = nullptr) &&;

 private:
  bool Accepts(std::span<const std::int64_t> corners) const;
  void AppendTriangles(std::span<const std::int64_t> corners);
  absl::Status RefuseVertex(const Eigen::Vector3d& position, const std::string& where) const;
  absl::Status RefuseFace(std::span<const std::int64_t> corners, const std::string& where) const;
  absl::Status RefuseCorner(std::int64_t corner, const std::string& where,
                            std::int64_t vertices) const;

  MeshLimits limits_;
  MeshFile file_;
  std::int64_t source_faces_ = 0;
  std::int64_t vertex_count_ = -1;  // Unknown.
};

}  // namespace ccst::io
