#include "core/quality/voronoi_cells.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/quality/capacity.h"
#include "tests/core/analysis/torus_sets.h"
#include "tests/support/shapes.h"

namespace ccst::quality {
namespace {

TEST(VoronoiCells, ShareOutTheAreaOfAClosedMesh) {
  const TriangleMesh sphere = shapes::Icosphere(3);
  double total = 0.0;
  for (const double cell : VoronoiCellCapacities(sphere.positions, sphere.faces)) total += cell;
  EXPECT_NEAR(total, TotalArea(sphere.positions, sphere.faces), 1e-12);
}

TEST(VoronoiCells, RegularMeshHasNoVariation) {
  const TriangleMesh icosahedron = shapes::Icosphere(0);
  EXPECT_NEAR(MeasureVoronoiVariation(icosahedron.positions, icosahedron.faces), 0.0, 1e-12);
}

TEST(VoronoiCells, AgreeWithCellsCutAtBisectors) {
  const torus::Points points = torus::DartThrowing(300, 1);
  const torus::Cells cells = torus::MakeCells(points);
  // Without the triangles across the border the rest is a mesh of the plane.
  std::vector<Eigen::Vector3d> positions;
  for (const Eigen::Vector2d& p : points) positions.emplace_back(p.x(), p.y(), 0.0);
  std::vector<Eigen::Vector3i> triangles;
  std::vector<bool> whole(points.size(), true);
  for (const Eigen::Vector3i& t : cells.triangles) {
    bool across = false;
    for (int k = 0; k < 3; ++k) {
      across = across || (points[t[k]] - points[t[(k + 1) % 3]]).norm() > 0.5;
    }
    if (!across) triangles.push_back(t);
    for (int k = 0; k < 3 && across; ++k) whole[t[k]] = false;
  }
  std::vector<double> expected;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (whole[i]) expected.push_back(cells.areas[i]);
  }
  const std::vector<double> measured = VoronoiCellCapacities(positions, triangles);
  ASSERT_EQ(measured.size(), expected.size());
  ASSERT_GT(measured.size(), 150u);
  for (std::size_t i = 0; i < measured.size(); ++i) EXPECT_NEAR(measured[i], expected[i], 1e-12);
}

TEST(VoronoiCells, DensityWeighsTriangles) {
  const TriangleMesh sphere = shapes::Icosphere(1);
  const std::vector<double> densities(sphere.faces.size(), 3.0);
  const std::vector<double> one = VoronoiCellCapacities(sphere.positions, sphere.faces);
  const std::vector<double> three =
      VoronoiCellCapacities(sphere.positions, sphere.faces, densities);
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_NEAR(three[i], 3.0 * one[i], 1e-12);
}

}  // namespace
}  // namespace ccst::quality
