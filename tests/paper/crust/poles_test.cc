#include "tests/paper/crust/poles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "core/random/random.h"
#include "tests/paper/crust/crust.h"

namespace ccst {
namespace {

double Degrees(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::acos(std::min(1.0, std::abs(a.dot(b)))) * 180.0 / M_PI;
}

// Points of a sphere have one pole at its centre and the other at infinity, which is the normal.
TEST(FindPoles, PointsOfASphereHaveOneAtItsCentre) {
  const CounterRandom random(5, 1);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 2000; ++i) {
    const double z = 2.0 * random.Uniform(2 * i) - 1.0;
    const double turn = 2.0 * M_PI * random.Uniform(2 * i + 1);
    points.emplace_back(std::sqrt(1.0 - z * z) * std::cos(turn),
                        std::sqrt(1.0 - z * z) * std::sin(turn), z);
  }
  const Poles poles = *FindPoles(points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    // Triangles of the hull bend by the angle that one spacing has, and a few times that in gaps.
    EXPECT_LT(Degrees(poles.first[i], points[i]), 15.0) << i;
    EXPECT_LT(Degrees(poles.second[i], points[i]), 1e-3) << i;
  }
}

TEST(FindPoles, SharedPolesAreThereOnce) {
  // In a cloud many cells end in the same corner.
  const CounterRandom random(7, 1);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 1500; ++i) {
    points.emplace_back(random.Uniform(3 * i), random.Uniform(3 * i + 1),
                        random.Uniform(3 * i + 2));
  }
  const Poles poles = *FindPoles(points);
  std::set<std::array<double, 3>> places;
  for (const Eigen::Vector3d& p : poles.places) places.insert({p.x(), p.y(), p.z()});
  EXPECT_EQ(places.size(), poles.places.size());
  EXPECT_LT(places.size(), 2 * points.size()) << "no pole is shared";
}

// Inside a face of a cube no four points have a sphere, and which of them are on the hull is left
// to rounding; the poles must follow the normal for all that.
TEST(FindPoles, PointsOfFlatFacesHaveBothAlongTheNormal) {
  const CounterRandom random(6, 1);
  std::vector<Eigen::Vector3d> points;
  std::vector<int> axes;
  for (int i = 0; i < 3000; ++i) {
    const int axis = i % 3;
    Eigen::Vector3d p;
    p[axis] = i % 2 == 0 ? 0.0 : 1.0;
    p[(axis + 1) % 3] = random.Uniform(2 * i);
    p[(axis + 2) % 3] = random.Uniform(2 * i + 1);
    // Off the axes, where coordinates are not round numbers.
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()));
    points.push_back(turn * p);
    // Beside an edge the medial axis is as near as the edge.
    const double rim = std::min(
        {p[(axis + 1) % 3], p[(axis + 2) % 3], 1.0 - p[(axis + 1) % 3], 1.0 - p[(axis + 2) % 3]});
    axes.push_back(rim > 0.2 ? axis : -1);
  }
  const Poles poles = *FindPoles(InGeneralPosition(points));
  const Eigen::Matrix3d turned =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  int checked = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (axes[i] < 0) continue;
    EXPECT_LT(Degrees(poles.first[i], turned.col(axes[i])), 10.0) << i;
    EXPECT_LT(Degrees(poles.second[i], turned.col(axes[i])), 25.0) << i;
    ++checked;
  }
  EXPECT_GT(checked, 800);
}

}  // namespace
}  // namespace ccst
