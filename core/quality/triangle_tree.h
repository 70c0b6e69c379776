#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/base/interrupt.h"

namespace ccst::quality {

/// The point of triangle (a, b, c) closest to `p`. Exact up to rounding; triangles without
/// area are treated as their edges.
Eigen::Vector3d ClosestPointOnTriangle(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                                       const Eigen::Vector3d& b, const Eigen::Vector3d& c);

/// A tree of bounding boxes over triangles that answers closest-point queries exactly.
/// Keeps a copy of the corners. Thread-safe once built.
class TriangleTree {
 public:
  struct Hit {
    std::int64_t triangle = -1;  ///< -1: none within the bound.
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    double distance = std::numeric_limits<double>::infinity();  ///< [mesh unit]
  };

  /// @param positions  n x 3, finite.  @param triangles  m x 3 indices in [0, n).
  /// @param interrupt  may be null; once requested, searches are right but slow.
  /// Cost O(m log m).
  TriangleTree(std::span<const Eigen::Vector3d> positions,
               std::span<const Eigen::Vector3i> triangles, Interrupt* interrupt = nullptr);

  /// The closest point on the triangles that is nearer than `bound`. Cost O(log m) typically.
  Hit FindClosest(const Eigen::Vector3d& p,
                  double bound = std::numeric_limits<double>::infinity()) const;

 private:
  struct Node {
    Eigen::AlignedBox3d box;
    std::int32_t begin = 0;  // Leaf: first triangle.
    std::int32_t end = 0;    // Leaf: past the last; inner node: 0.
    std::int32_t right = 0;  // Inner node: its right child; the left one is next to it.
  };
  struct Triangle {
    Eigen::Vector3d a, b, c;
    std::int64_t index;
  };

  std::int32_t BuildNode(std::int32_t begin, std::int32_t end, Interrupt* interrupt);

  std::vector<Node> nodes_;
  std::vector<Triangle> triangles_;
};

}  // namespace ccst::quality
