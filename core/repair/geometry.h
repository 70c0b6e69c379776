#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace ccst::repair {

/// Differences of positions in a unit in which the mesh has a size of about 1, so that products
/// neither overflow nor vanish, and what rounding of the coordinates can do to them.
class Geometry {
 public:
  /// @param positions must outlive this. @param unit > 0, a power of two.
  Geometry(const std::vector<Eigen::Vector3d>& positions, double unit)
      : positions_(positions), unit_(unit) {}

  /// From vertex a to vertex b.
  Eigen::Vector3d Edge(std::int32_t a, std::int32_t b) const {
    return (positions_[b] - positions_[a]) / unit_;
  }

  /// How far rounding may have moved the corners of a triangle.
  double Rounding(const Eigen::Vector3i& t) const {
    return 8.0 * std::numeric_limits<double>::epsilon() * Reach(t);
  }

  /// The same where the coordinates were 32-bit floats once, as in most files.
  double FloatRounding(const Eigen::Vector3i& t) const {
    return 4.0 * std::numeric_limits<float>::epsilon() * Reach(t);
  }

  /// Index k of the longest side, from corner k to corner k + 1.
  int LongestSide(const Eigen::Vector3i& t) const {
    int longest = 0;
    double best = -1.0;
    for (int k = 0; k < 3; ++k) {
      const double length = Edge(t[k], t[(k + 1) % 3]).squaredNorm();
      if (length > best) {
        best = length;
        longest = k;
      }
    }
    return longest;
  }

  /// Height over the longest side is at most `height`, or `share` of that side.
  bool IsFlat(const Eigen::Vector3i& t, double height, double share) const {
    const int k = LongestSide(t);
    const Eigen::Vector3d side = Edge(t[k], t[(k + 1) % 3]);
    const double twice_area = side.cross(Edge(t[k], t[(k + 2) % 3])).norm();
    const double length = side.norm();
    return twice_area <= length * std::max(height, share * length);
  }

  /// No area: as good as a line segment.
  bool HasNoArea(const Eigen::Vector3i& t) const { return IsFlat(t, Rounding(t), 0.0); }

 private:
  double Reach(const Eigen::Vector3i& t) const {
    return std::max({positions_[t[0]].cwiseAbs().maxCoeff(), positions_[t[1]].cwiseAbs().maxCoeff(),
                     positions_[t[2]].cwiseAbs().maxCoeff()}) /
           unit_;
  }

  const std::vector<Eigen::Vector3d>& positions_;
  double unit_;
};

}  // namespace ccst::repair
