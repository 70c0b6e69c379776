#pragma once

#include <vector>

#include <Eigen/Core>

#include "core/random/random.h"

/// What the tests of trees and orders share.
namespace ccst::spatial_test {

/// n x 3 points, even and independent in the cube [low, low + 1)^3; the same at every call.
inline std::vector<Eigen::Vector3d> RandomPoints(int count, double low = 0.0) {
  const CounterRandom random(1, 1);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < count; ++i) {
    points.emplace_back(low + random.Uniform(3 * i), low + random.Uniform(3 * i + 1),
                        low + random.Uniform(3 * i + 2));
  }
  return points;
}

}  // namespace ccst::spatial_test
