#include "core/quality/capacity.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/shapes.h"

namespace ccst::quality {
namespace {

// Right triangles of the given areas, apart from each other.
TriangleMesh TrianglesOfAreas(const std::vector<double>& areas) {
  TriangleMesh mesh;
  for (const double area : areas) {
    const int first = static_cast<int>(mesh.positions.size());
    mesh.positions.emplace_back(0, 0, first);
    mesh.positions.emplace_back(2 * area, 0, first);
    mesh.positions.emplace_back(0, 1, first);
    mesh.faces.emplace_back(first, first + 1, first + 2);
  }
  return mesh;
}

TEST(Capacity, EqualTrianglesHaveNoVariation) {
  const TriangleMesh grid = shapes::PlaneGrid(3.0, 2.0, 6, 4);
  const CapacityFigures figures = MeasureCapacities(grid.positions, grid.faces);
  EXPECT_NEAR(figures.total, 6.0, 1e-12);
  EXPECT_NEAR(figures.mean, 6.0 / 48.0, 1e-12);
  EXPECT_NEAR(figures.cv, 0.0, 1e-12);
  EXPECT_NEAR(figures.smallest, 1.0, 1e-12);
  EXPECT_NEAR(figures.largest, 1.0, 1e-12);
}

TEST(Capacity, KnownAreasGiveTheirVariation) {
  const TriangleMesh mesh = TrianglesOfAreas({1.0, 2.0, 3.0});
  const CapacityFigures figures = MeasureCapacities(mesh.positions, mesh.faces);
  EXPECT_NEAR(figures.mean, 2.0, 1e-12);
  EXPECT_NEAR(figures.cv, std::sqrt(2.0 / 3.0) / 2.0, 1e-12);
  EXPECT_NEAR(figures.smallest, 0.5, 1e-12);
  EXPECT_NEAR(figures.largest, 1.5, 1e-12);
}

TEST(Capacity, DensityInverseToAreaGivesNoVariation) {
  const TriangleMesh mesh = TrianglesOfAreas({1.0, 2.0, 4.0});
  const std::vector<double> densities = {4.0, 2.0, 1.0};
  const CapacityFigures figures = MeasureCapacities(mesh.positions, mesh.faces, densities);
  EXPECT_NEAR(figures.total, 12.0, 1e-12);
  EXPECT_NEAR(figures.cv, 0.0, 1e-12);
}

TEST(Capacity, TinyVariationSurvivesRounding) {
  const double step = 1e-9;
  const TriangleMesh mesh = TrianglesOfAreas({1.0 - step, 1.0 + step});
  EXPECT_NEAR(MeasureCapacities(mesh.positions, mesh.faces).cv, step, 1e-14);
}

TEST(Capacity, NothingGivesZeros) {
  EXPECT_EQ(MeasureCapacities({}, {}).cv, 0.0);
  const TriangleMesh flat = TrianglesOfAreas({0.0, 0.0});
  EXPECT_EQ(MeasureCapacities(flat.positions, flat.faces).cv, 0.0);
  EXPECT_EQ(TotalArea(flat.positions, flat.faces), 0.0);
}

}  // namespace
}  // namespace ccst::quality
