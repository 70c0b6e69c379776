#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/base/interrupt.h"
#include "core/surface/surface.h"

namespace ccst::analysis {

/// A face of the surface laid into the tangent plane of a centre.
struct FlatFace {
  std::int32_t face = -1;
  std::array<Eigen::Vector2d, 3> corners;  ///< Relative to the centre [unit].

  /// The place in the plane of the point of the face with these weights.
  Eigen::Vector2d At(const Eigen::Vector3d& weights) const {
    return weights[0] * corners[0] + weights[1] * corners[1] + weights[2] * corners[2];
  }
};

/// Lays the surface around a point flat: a discrete logarithmic map, whose lengths are distances
/// along the surface and whose directions are those in which straight lines leave the point.
///
/// Faces are unfolded across the edges they share, nearest first, each from the neighbour over
/// whose side the way to its centroid is shortest; never nearer than its centroid is in space.
/// Exact on planes and other developable pieces, at creases too; elsewhere the error grows with the
/// curvature between the path of faces and the straight line (under 1 % of the distance within a
/// radian on a sphere). Sheets that are near in space only are not reached, the other side of a rim
/// as far away as it is along the surface. Source: the unfolding of Mitchell, Mount, Papadimitriou,
/// "The discrete geodesic problem", SIAM J. Comput. 16(4), 1987, with one path a face, as the
/// discrete exponential maps of Schmidt, Grimm, Wyvill, SIGGRAPH 2006.
class GeodesicDisc {
 public:
  /// @param surface  not owned.
  explicit GeodesicDisc(const Surface& surface);

  /// The faces with a point at most `radius` from `center`, the host first; each once. The x axis
  /// is the first vector of TangentFrame() at the host's normal. Valid until the next call.
  /// Unfinished when `interrupt`, which may be null, was requested. Cost O(k log k) for k faces.
  const std::vector<FlatFace>& Unfold(const SurfacePoint& center, double radius,
                                      Interrupt* interrupt = nullptr);

 private:
  // A face that can be unfolded across the side from `corners[0]` to `corners[1]`, its half-edge.
  struct Candidate {
    double distance;  // To the centroid.
    std::int32_t half_edge;
    std::array<Eigen::Vector2d, 3> corners;  // From the half-edge's origin on.
    // The queue has the largest first; equal ones by index, so that order is fixed.
    bool operator<(const Candidate& other) const {
      if (distance != other.distance) return distance > other.distance;
      return half_edge > other.half_edge;
    }
  };

  void Offer(std::int32_t half_edge, const Eigen::Vector2d& from, const Eigen::Vector2d& to,
             double radius);

  const Surface& surface_;
  std::vector<std::int32_t> visited_;  // Per face: the disc that has it.
  std::int32_t disc_ = 0;
  Eigen::Vector3d center_ = Eigen::Vector3d::Zero();
  std::vector<Candidate> queue_;  // A heap.
  std::vector<FlatFace> faces_;
};

}  // namespace ccst::analysis
