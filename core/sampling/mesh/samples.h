#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/sampling/mesh/sample_mesh.h"
#include "core/surface/surface.h"

namespace ccst::internal {

/// Where the samples are, as parallel arrays in the surface's unit frame. Every sample has a host
/// at all times.
struct Samples {
  std::vector<Eigen::Vector3d> position;  ///< N x 3 on the surface.
  std::vector<Eigen::Vector3d> normal;    ///< N x 3 unit, of the surface there.
  std::vector<std::int32_t> face;         ///< N: host face.
  std::vector<Eigen::Vector3d> weights;   ///< N x 3: barycentric coordinates on the host.
  std::vector<SampleMesh::Kind> kind;     ///< N.
  std::vector<std::int32_t> component;    ///< N: connected component of the surface.
  std::vector<std::int32_t> loop;         ///< N: boundary loop of a boundary sample, else -1.
  std::vector<double> arc;                ///< N: its arc length along that loop.

  std::int32_t count() const { return static_cast<std::int32_t>(position.size()); }

  void Resize(std::int32_t n) {
    position.resize(n);
    normal.resize(n);
    face.resize(n);
    weights.resize(n);
    kind.resize(n, SampleMesh::Kind::kInterior);
    component.resize(n, 0);
    loop.resize(n, -1);
    arc.resize(n, 0.0);
  }

  void Place(std::int32_t i, const Surface& surface, const SurfacePoint& point) {
    position[i] = point.position;
    face[i] = point.face;
    weights[i] = point.weights;
    normal[i] = surface.NormalAt(point.face, point.weights);
  }
};

}  // namespace ccst::internal
