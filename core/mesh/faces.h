#pragma once

#include <cstddef>
#include <span>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace ccst {

// Half-edge 3 f + k of a list of triangles goes from corner k of face f to corner k + 1.

/// The half-edge of the same face that starts where `h` ends.
template <typename Index>
constexpr Index NextHalfEdge(Index h) {
  return h % 3 == 2 ? h - 2 : h + 1;
}

/// The half-edge of the same face that ends where `h` starts.
template <typename Index>
constexpr Index PreviousHalfEdge(Index h) {
  return h % 3 == 0 ? h + 2 : h - 1;
}

/// The normal of a face, twice its area long.
/// @param face  three indices of `positions`.
inline Eigen::Vector3d FaceCross(std::span<const Eigen::Vector3d> positions,
                                 const Eigen::Vector3i& face) {
  const Eigen::Vector3d& a = positions[static_cast<std::size_t>(face[0])];
  return (positions[static_cast<std::size_t>(face[1])] - a)
      .cross(positions[static_cast<std::size_t>(face[2])] - a);
}

}  // namespace ccst
