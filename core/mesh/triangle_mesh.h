#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace ccst {

/// A plain indexed triangle list, as read from a file or a stream. No invariant holds beyond
/// the types: indices may be out of range and coordinates non-finite until
/// `Surface::Build` (core/surface) has checked them.
struct TriangleMesh {
  /// V x 3 [mesh unit].
  std::vector<Eigen::Vector3d> positions;
  /// F x 3 indices into `positions`; counter-clockwise seen from outside.
  std::vector<Eigen::Vector3i> faces;
};

}  // namespace ccst
