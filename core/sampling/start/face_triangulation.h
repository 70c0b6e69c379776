#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/sampling/mesh/sample_mesh.h"

namespace ccst::internal {

/// The triangles of one flat face of the surface while points are inserted into it, as a mesh of
/// its own whose boundary stays as it is.
class FaceTriangulation {
 public:
  /// A triangle over the corners in `place`, counter-clockwise: vertices 0 to 2.
  void Start(const std::vector<Eigen::Vector3d>& place);
  /// Several triangles, over all of `place`, that cover the face.
  void Start(const std::vector<Eigen::Vector3d>& place,
             const std::vector<Eigen::Vector3i>& triangles);

  /// Inserts a point as the next vertex and flips towards Delaunay, so that finding the triangle
  /// of the next point is a short walk. Never joins two of the vertices it started with.
  /// Cost O(1) expected where points that follow each other are near each other.
  void Insert(const Eigen::Vector3d& point);

  /// Triangles passed and edges flipped by the last Insert().
  std::int64_t work() const { return work_; }

  /// Triangles it started with, then two for each point.
  const SampleMesh& mesh() const { return mesh_; }

 private:
  void SetPlane(const std::vector<Eigen::Vector3d>& place, const Eigen::Vector3i& corner);
  Eigen::Vector2d Flat(const Eigen::Vector3d& point) const;
  TriangleIndex Locate(const Eigen::Vector2d& p);
  bool IsWanted(std::int32_t h) const;

  SampleMesh mesh_;
  std::vector<Eigen::Vector2d> place_;  // Per vertex, in the face's plane.
  std::int32_t outer_ = 0;              // Vertices it started with.
  TriangleIndex last_{0};               // Triangle into which the last point was inserted.
  std::int64_t work_ = 0;
  std::vector<std::int32_t> stack_;
  Eigen::Vector3d corner_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d along_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d aside_ = Eigen::Vector3d::Zero();
};

}  // namespace ccst::internal
