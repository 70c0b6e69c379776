#pragma once

#include <cmath>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/base/portable_math.h"

namespace ccst {

/// Two unit vectors that complete the unit vector `n` to a right-handed frame.
/// Source: Duff et al., "Building an orthonormal basis, revisited", JCGT 6(1), 2017.
inline void TangentFrame(const Eigen::Vector3d& n, Eigen::Vector3d* t1, Eigen::Vector3d* t2) {
  const double sign = std::copysign(1.0, n.z());
  const double a = -1.0 / (sign + n.z());
  const double b = n.x() * n.y() * a;
  *t1 = {1.0 + sign * n.x() * n.x() * a, sign * b, -sign * n.x()};
  *t2 = {b, sign + n.y() * n.y() * a, -n.y()};
}

/// The angle between two vectors [rad], in [0, pi]; the same bits on every machine.
inline double AngleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return PortableAtan2(a.cross(b).norm(), a.dot(b));
}

/// x . Q . y for a symmetric tensor stored as (xx, xy, xz, yy, yz, zz).
inline double TensorProduct(const Eigen::Matrix<double, 6, 1>& q, const Eigen::Vector3d& x,
                            const Eigen::Vector3d& y) {
  return x[0] * (q[0] * y[0] + q[1] * y[1] + q[2] * y[2]) +
         x[1] * (q[1] * y[0] + q[3] * y[1] + q[4] * y[2]) +
         x[2] * (q[2] * y[0] + q[4] * y[1] + q[5] * y[2]);
}

}  // namespace ccst
