#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "absl/status/statusor.h"
#include "core/base/interrupt.h"
#include "core/mesh/faces.h"
#include "core/mesh/triangle_mesh.h"
#include "core/parallel/parallel.h"

namespace ccst {

class CornerSums;

/// A point on the surface: its face and the weights of the face's three corners.
struct SurfacePoint {
  std::int32_t face = -1;
  Eigen::Vector3d weights = Eigen::Vector3d::Zero();   ///< >= 0, sum 1.
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< Unit frame, see Surface.
};

/// A closed chain of boundary edges, as half-edges in walking order (the surface on the left).
struct BoundaryLoop {
  std::vector<std::int32_t> half_edges;
  double length = 0.0;  ///< Unit frame.
  std::int32_t component = 0;
};

/// The input as an oriented 2-manifold with everything sampling asks of it. Immutable.
///
/// Coordinates are kept in a unit frame: moved by the centre of the bounding box and scaled by a
/// power of two so that its longest side lies in [1/2, 1). All lengths here are in that frame.
/// Half-edge 3 f + k goes from corner k of face f to corner k + 1. Faces and vertices are those of
/// the mesh; equal positions stay different vertices, which is how a cut is told from an edge.
class Surface {
 public:
  /// Checks `mesh` and derives normals and curvature.
  /// @param mesh  an oriented 2-manifold without vertices of no face; Repair() makes one of any.
  /// @errors INVALID_ARGUMENT MESH_DEGENERATE (non-finite coordinate, index out of range, a face
  ///         with a repeated vertex) | MESH_EMPTY (no face of positive area);
  ///         FAILED_PRECONDITION MESH_NOT_MANIFOLD naming the edge or vertex; CANCELLED when
  ///         `interrupt` (may be null) was requested.
  /// Cost O(V + F); the same bits on any number of threads.
  static absl::StatusOr<Surface> Build(const TriangleMesh& mesh, Interrupt* interrupt = nullptr,
                                       const Parallel& parallel = Parallel());

  std::int32_t vertex_count() const { return static_cast<std::int32_t>(positions_.size()); }
  std::int32_t face_count() const { return static_cast<std::int32_t>(faces_.size()); }

  /// V x 3.
  const std::vector<Eigen::Vector3d>& positions() const { return positions_; }
  /// F x 3 indices into positions().
  const std::vector<Eigen::Vector3i>& faces() const { return faces_; }
  /// 3 F: the opposite half-edge, -1 on the boundary.
  const std::vector<std::int32_t>& twins() const { return twins_; }
  /// V: a half-edge that starts at the vertex; the boundary one where there is one.
  const std::vector<std::int32_t>& outgoing() const { return outgoing_; }
  /// V x 3 unit normals, area-weighted over the incident faces.
  const std::vector<Eigen::Vector3d>& normals() const { return normals_; }
  /// F.
  const std::vector<double>& face_areas() const { return face_areas_; }
  /// F: connected component of the face, in [0, component_count()).
  const std::vector<std::int32_t>& face_components() const { return face_components_; }
  /// Area of each component.
  const std::vector<double>& component_areas() const { return component_areas_; }
  /// Euler characteristic of each component.
  const std::vector<std::int64_t>& component_eulers() const { return component_eulers_; }
  const std::vector<BoundaryLoop>& boundary_loops() const { return boundary_loops_; }
  double area() const { return area_; }
  /// Diagonal of the bounding box.
  double diagonal() const { return diagonal_; }

  /// Length of one unit of this frame [mesh unit].
  double unit() const { return unit_; }
  /// A position in mesh units.
  Eigen::Vector3d ToMesh(const Eigen::Vector3d& position) const {
    return center_ + unit_ * position;
  }

  std::int32_t Origin(std::int32_t half_edge) const { return faces_[half_edge / 3][half_edge % 3]; }
  std::int32_t Target(std::int32_t half_edge) const { return Origin(NextHalfEdge(half_edge)); }

  /// The normal of a face, twice its area long.
  Eigen::Vector3d FaceCross(std::int32_t face) const {
    return ccst::FaceCross(positions_, faces_[face]);
  }

  /// Unit normal at a point, interpolated over its face.
  Eigen::Vector3d NormalAt(std::int32_t face, const Eigen::Vector3d& weights) const;

  /// Shape operator at a point as a symmetric 3 x 3 tensor (xx, xy, xz, yy, yz, zz) [1 / unit],
  /// interpolated over its face as a tensor; T . Q . T is the normal curvature along T, positive
  /// where the surface bends towards its normal.
  Eigen::Matrix<double, 6, 1> ShapeAt(std::int32_t face, const Eigen::Vector3d& weights) const;

  /// Closest point to `target` that is reached from `face` by crossing edges and vertices while
  /// the distance falls: never jumps between sheets, never leaves through a boundary.
  SurfacePoint Follow(std::int32_t face, const Eigen::Vector3d& target) const;

  /// Closest point of one face.
  SurfacePoint ClosestOnFace(std::int32_t face, const Eigen::Vector3d& target) const;

 private:
  Surface() = default;
  absl::Status AddNormals(const CornerSums& corners, const Parallel& parallel,
                          Interrupt* interrupt);
  absl::Status Connect(const Parallel& parallel, Interrupt* interrupt);
  absl::Status CheckVertices(const Parallel& parallel);
  /// Unfinished when `interrupt` was requested.
  void FindComponentsAndLoops(Interrupt* interrupt);

  std::vector<Eigen::Vector3d> positions_;
  std::vector<Eigen::Vector3i> faces_;
  std::vector<std::int32_t> twins_;
  std::vector<std::int32_t> outgoing_;
  std::vector<Eigen::Vector3d> normals_;
  std::vector<std::array<float, 6>> shapes_;
  std::vector<double> face_areas_;
  std::vector<std::int32_t> face_components_;
  std::vector<double> component_areas_;
  std::vector<std::int64_t> component_eulers_;
  std::vector<BoundaryLoop> boundary_loops_;
  Eigen::Vector3d center_ = Eigen::Vector3d::Zero();
  double unit_ = 1.0;
  double area_ = 0.0;
  double diagonal_ = 0.0;
};

}  // namespace ccst
