#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "client/render/camera.h"

namespace ccst {

/// Which triangle every pixel sees, and how far away it is.
struct VisibilityBuffer {
  int width = 0;
  int height = 0;
  std::vector<std::int32_t> triangle;  ///< height x width; -1 where nothing is seen.
  std::vector<float> depth;            ///< height x width; Camera::Depth, infinity for nothing.

  std::size_t Index(int x, int y) const { return static_cast<std::size_t>(y) * width + x; }
};

/// Draws a triangle mesh from both sides into a fresh buffer. A pixel is covered when its middle
/// is.
/// @param view   V x 3 in the camera's view space, all in front of it.
/// @param faces  F x 3 indices in [0, V).
/// Cost O(F + covered pixels, hidden ones included).
VisibilityBuffer Rasterize(std::span<const Eigen::Vector3d> view,
                           std::span<const Eigen::Vector3i> faces, const Camera& camera, int width,
                           int height);

}  // namespace ccst
