#include "core/quality/triangle_tree.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "core/mesh/triangle_mesh.h"
#include "tests/support/shapes.h"

namespace ccst::quality {
namespace {

Eigen::Vector3d RandomPoint(std::mt19937& random, double extent) {
  std::uniform_real_distribution<double> uniform(-extent, extent);
  const double x = uniform(random), y = uniform(random), z = uniform(random);
  return {x, y, z};
}

// Smallest distance to a fine grid over the triangle; an upper bound, `step` coarse.
double DistanceToGrid(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                      const Eigen::Vector3d& c, int steps) {
  double best = (p - a).norm();
  for (int i = 0; i <= steps; ++i) {
    for (int j = 0; i + j <= steps; ++j) {
      const double u = static_cast<double>(i) / steps, v = static_cast<double>(j) / steps;
      best = std::min(best, (a + u * (b - a) + v * (c - a) - p).norm());
    }
  }
  return best;
}

TEST(ClosestPoint, RegionsOfATriangleAreRight) {
  const Eigen::Vector3d a(0, 0, 0), b(4, 0, 0), c(0, 4, 0);
  const auto closest = [&](double x, double y, double z) {
    return ClosestPointOnTriangle({x, y, z}, a, b, c);
  };
  EXPECT_TRUE(closest(1, 1, 7).isApprox(Eigen::Vector3d(1, 1, 0)));
  EXPECT_TRUE(closest(2, -3, 1).isApprox(Eigen::Vector3d(2, 0, 0)));
  EXPECT_TRUE(closest(-3, 2, 1).isApprox(Eigen::Vector3d(0, 2, 0)));
  EXPECT_TRUE(closest(5, 5, -1).isApprox(Eigen::Vector3d(2, 2, 0)));
  EXPECT_TRUE(closest(-1, -1, 0).isZero());
  EXPECT_TRUE(closest(9, -1, 0).isApprox(b));
  EXPECT_TRUE(closest(-1, 9, 0).isApprox(c));
}

TEST(ClosestPoint, NeverFartherThanAGridOverTheTriangle) {
  std::mt19937 random(1);
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector3d a = RandomPoint(random, 1), b = RandomPoint(random, 1),
                          c = RandomPoint(random, 1), p = RandomPoint(random, 2);
    const double exact = (ClosestPointOnTriangle(p, a, b, c) - p).norm();
    const double grid = DistanceToGrid(p, a, b, c, 60);
    EXPECT_LE(exact, grid + 1e-12);
    EXPECT_GE(exact, grid - 0.1);  // The grid's spacing.
  }
}

TEST(ClosestPoint, TrianglesWithoutAreaAreSegments) {
  const Eigen::Vector3d a(0, 0, 0), b(1, 0, 0), c(3, 0, 0);
  EXPECT_TRUE(ClosestPointOnTriangle({2, 1, 0}, a, b, c).isApprox(Eigen::Vector3d(2, 0, 0)));
  EXPECT_TRUE(ClosestPointOnTriangle({5, 1, 0}, a, b, c).isApprox(c));
  EXPECT_TRUE(ClosestPointOnTriangle({5, 1, 0}, b, b, b).isApprox(b));
}

TEST(TriangleTree, AgreesWithEveryTriangle) {
  std::mt19937 random(2);
  for (const TriangleMesh& mesh :
       {shapes::Torus(1.0, 0.4, 24, 12), shapes::Saddle(6), shapes::Tetrahedron(),
        shapes::SingleTriangle(), shapes::UvSphere(40, 6)}) {
    const TriangleTree tree(mesh.positions, mesh.faces);
    for (int i = 0; i < 200; ++i) {
      const Eigen::Vector3d p = RandomPoint(random, 1.5);
      double expected = INFINITY;
      for (const Eigen::Vector3i& t : mesh.faces) {
        expected =
            std::min(expected, (ClosestPointOnTriangle(p, mesh.positions[t[0]],
                                                       mesh.positions[t[1]], mesh.positions[t[2]]) -
                                p)
                                   .norm());
      }
      const TriangleTree::Hit hit = tree.FindClosest(p);
      EXPECT_EQ(hit.distance, expected);
      EXPECT_NEAR((hit.point - p).norm(), expected, 1e-15);
      const Eigen::Vector3i& t = mesh.faces[hit.triangle];
      EXPECT_TRUE(ClosestPointOnTriangle(p, mesh.positions[t[0]], mesh.positions[t[1]],
                                         mesh.positions[t[2]])
                      .isApprox(hit.point));
      EXPECT_EQ(tree.FindClosest(p, 0.999 * expected).triangle, -1);
    }
  }
}

TEST(TriangleTree, EmptyTreeFindsNothing) {
  const TriangleTree tree({}, {});
  EXPECT_EQ(tree.FindClosest({0, 0, 0}).triangle, -1);
}

TEST(TriangleTree, EqualTrianglesStayShallow) {
  const TriangleMesh one = shapes::SingleTriangle();
  const std::vector<Eigen::Vector3i> many(10000, one.faces[0]);
  const TriangleTree tree(one.positions, many);
  EXPECT_NEAR(tree.FindClosest({0.2, 0.2, 3.0}).distance, 3.0, 1e-12);
}

}  // namespace
}  // namespace ccst::quality
