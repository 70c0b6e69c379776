#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace ccst::quality {

/// What a triangle list is as a surface. The defect counts say why it is not an oriented
/// 2-manifold; where one of them is not 0 the figures above them are only indicative.
struct MeshTopology {
  std::int64_t vertices = 0;  ///< Used by at least one face.
  std::int64_t edges = 0;     ///< Undirected.
  std::int64_t faces = 0;
  std::int64_t euler = 0;       ///< vertices - edges + faces.
  std::int64_t components = 0;  ///< Connected through edges.
  /// Closed walks along edges of one face, as vertex indices in the direction of the faces.
  std::vector<std::vector<std::int32_t>> boundary_loops;

  std::int64_t bad_faces = 0;           ///< Index out of range or repeated; left out above.
  std::int64_t duplicate_faces = 0;     ///< Same three vertices as an earlier face.
  std::int64_t crowded_edges = 0;       ///< Edges of three or more faces.
  std::int64_t inconsistent_edges = 0;  ///< Edges of two faces running the same way.
  std::int64_t split_vertices = 0;      ///< Vertices whose faces form more than one fan.
  std::int64_t unused_vertices = 0;     ///< Vertices of no face.
  std::string first_defect;             ///< One sentence that says where; empty if manifold.

  /// No defect, unused vertices included.
  bool IsManifold() const { return first_defect.empty(); }
};

/// Examines `triangles` (m x 3 indices in [0, vertex_count)).
/// Cost O(m log m). Never fails: whatever is wrong is counted.
MeshTopology MeasureTopology(std::int64_t vertex_count, std::span<const Eigen::Vector3i> triangles);

/// Length of a closed loop of vertices [mesh unit].
double LoopLength(std::span<const Eigen::Vector3d> positions, std::span<const std::int32_t> loop);

}  // namespace ccst::quality
