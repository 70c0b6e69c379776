#include "tests/paper/crust/delaunay.h"

#include <cmath>
#include <limits>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include "core/random/random.h"

namespace ccst {
namespace {

std::vector<Eigen::Vector3d> PointsInCube(int count) {
  const CounterRandom random(3, 1);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < count; ++i) {
    points.emplace_back(random.Uniform(3 * i), random.Uniform(3 * i + 1),
                        random.Uniform(3 * i + 2));
  }
  return points;
}

double Volume(const std::vector<Eigen::Vector3d>& p, const std::array<std::int32_t, 4>& t) {
  return (p[t[1]] - p[t[0]]).cross(p[t[2]] - p[t[0]]).dot(p[t[3]] - p[t[0]]) / 6.0;
}

TEST(DelaunayTetrahedra, CircumscribedBallsAreEmpty) {
  const std::vector<Eigen::Vector3d> points = PointsInCube(60);
  const auto tetrahedra = *DelaunayTetrahedra(points);
  for (const auto& t : tetrahedra) {
    Eigen::Matrix3d edges;
    Eigen::Vector3d squares;
    for (int k = 0; k < 3; ++k) {
      edges.row(k) = (points[t[k + 1]] - points[t[0]]).transpose();
      squares[k] = 0.5 * edges.row(k).squaredNorm();
    }
    const Eigen::Vector3d center = points[t[0]] + edges.inverse() * squares;
    const double radius = (points[t[0]] - center).norm();
    for (const Eigen::Vector3d& point : points) {
      EXPECT_GT((point - center).norm(), radius * (1.0 - 1e-9));
    }
  }
  EXPECT_GT(tetrahedra.size(), 60u);
}

TEST(DelaunayTetrahedra, FillTheConvexHull) {
  std::vector<Eigen::Vector3d> points = PointsInCube(200);
  for (int corner = 0; corner < 8; ++corner) {
    points.emplace_back(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
  }
  const auto tetrahedra = *DelaunayTetrahedra(points);
  double volume = 0.0;
  for (const auto& t : tetrahedra) volume += std::abs(Volume(points, t));
  EXPECT_NEAR(volume, 1.0, 1e-6);
}

TEST(DelaunayTetrahedra, NonFinitePointIsRefused) {
  std::vector<Eigen::Vector3d> points = PointsInCube(10);
  points[4].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(DelaunayTetrahedra(points).ok());
}

TEST(DelaunayTetrahedra, TooFewPointsAreRefused) {
  EXPECT_FALSE(DelaunayTetrahedra(PointsInCube(3)).ok());
}

}  // namespace
}  // namespace ccst
