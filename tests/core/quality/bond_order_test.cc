#include "core/quality/bond_order.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/shapes.h"

namespace ccst::quality {
namespace {

TEST(BondOrder, HexagonalLatticeIsOne) {
  TriangleMesh grid = shapes::PlaneGrid(10, 10, 10, 10);
  // The grid's diagonals run one way: sheared, its triangles are equilateral.
  const Eigen::Vector3i& f = grid.faces.front();
  const Eigen::Vector3d diagonal(1.0, 1.0, 0.0);
  bool rising = false;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d d = grid.positions[f[(k + 1) % 3]] - grid.positions[f[k]];
    rising = rising || std::abs(d.dot(diagonal)) > 1.5;
  }
  const double shear = rising ? -0.5 : 0.5;
  for (Eigen::Vector3d& p : grid.positions) {
    p = Eigen::Vector3d(p.x() + shear * p.y(), std::sqrt(0.75) * p.y(), 0.0);
  }
  EXPECT_NEAR(MeasureBondOrder(grid.positions, grid.faces), 1.0, 1e-12);
}

TEST(BondOrder, RegularFansOfFourAndFiveAreZero) {
  const std::vector<Eigen::Vector3d> octahedron = {{1, 0, 0},  {0, 1, 0}, {-1, 0, 0},
                                                   {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  const std::vector<Eigen::Vector3i> faces = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4},
                                              {1, 0, 5}, {2, 1, 5}, {3, 2, 5}, {0, 3, 5}};
  EXPECT_NEAR(MeasureBondOrder(octahedron, faces), 0.0, 1e-12);
  const TriangleMesh icosahedron = shapes::Icosphere(0);
  EXPECT_NEAR(MeasureBondOrder(icosahedron.positions, icosahedron.faces), 0.0, 1e-12);
}

TEST(BondOrder, BoundaryVerticesAreLeftOut) {
  const TriangleMesh triangle = shapes::SingleTriangle();
  EXPECT_EQ(MeasureBondOrder(triangle.positions, triangle.faces), 0.0);
}

}  // namespace
}  // namespace ccst::quality
