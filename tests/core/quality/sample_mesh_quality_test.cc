#include "core/quality/sample_mesh_quality.h"

#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/shapes.h"

namespace ccst::quality {
namespace {

constexpr double kDegrees = 180.0 / M_PI;

TEST(Angles, RegularTrianglesHaveSixtyDegrees) {
  const TriangleMesh mesh = shapes::Tetrahedron();
  const AngleFigures figures = MeasureAngles(mesh.positions, mesh.faces);
  EXPECT_NEAR(figures.smallest, 60.0, 1e-9);
  EXPECT_NEAR(figures.mean_smallest, 60.0, 1e-9);
  EXPECT_EQ(figures.share_below_30, 0.0);
  EXPECT_EQ(figures.share_above_90, 0.0);
}

TEST(Angles, MixedTrianglesGiveMeansAndShares) {
  // 1 : 10 right triangle, and an obtuse one with angles 120, 30 +, 30 -.
  const std::vector<Eigen::Vector3d> positions = {
      {0, 0, 0}, {10, 0, 0}, {0, 1, 0}, {0, 0, 5}, {1, 0, 5}, {-0.5, std::sqrt(0.75) * 1.1, 5}};
  const std::vector<Eigen::Vector3i> triangles = {{0, 1, 2}, {3, 4, 5}};
  const AngleFigures figures = MeasureAngles(positions, triangles);
  EXPECT_NEAR(figures.smallest, std::atan(0.1) * kDegrees, 1e-9);
  const double second = std::atan(1.1 * std::sqrt(0.75) / 1.5) * kDegrees;  // At (1, 0, 5).
  const double third = std::atan2(1.1 * std::sqrt(0.75), 0.5) * kDegrees - second;
  EXPECT_NEAR(figures.mean_smallest, (std::atan(0.1) * kDegrees + std::min(second, third)) / 2.0,
              1e-9);
  const int below = 1 + (second < 30.0) + (third < 30.0);
  EXPECT_NEAR(figures.share_below_30, below / 6.0, 1e-12);
  EXPECT_NEAR(figures.share_above_90, 1.0 / 6.0, 1e-12);
}

TEST(Angles, TriangleWithoutAreaHasTheAngleZero) {
  const std::vector<Eigen::Vector3d> positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  const std::vector<Eigen::Vector3i> triangles = {{0, 1, 2}};
  const AngleFigures figures = MeasureAngles(positions, triangles);
  EXPECT_EQ(figures.smallest, 0.0);
  EXPECT_NEAR(figures.share_above_90, 1.0 / 3.0, 1e-12);
}

TEST(Angles, HistogramCountsEveryAngleInItsBin) {
  // A half of a square, and a triangle on a line.
  const std::vector<Eigen::Vector3d> positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 0, 0}};
  const std::vector<Eigen::Vector3i> triangles = {{0, 1, 2}, {0, 1, 3}};
  const AngleFigures figures = MeasureAngles(positions, triangles);
  std::array<std::int64_t, AngleFigures::kBins> expected{};
  expected[0] = 2;
  expected[22] = 2;  // 45 degrees, twice.
  expected[45] = 1;  // 90.
  expected[AngleFigures::kBins - 1] = 1;
  EXPECT_EQ(figures.histogram, expected);
}

TEST(Valences, IcosphereHasTwelveOfFiveAndElseSix) {
  const TriangleMesh mesh = shapes::Icosphere(3);
  const ValenceFigures figures =
      MeasureValences(static_cast<std::int64_t>(mesh.positions.size()), mesh.faces);
  EXPECT_EQ(figures.inner_vertices, 642);
  EXPECT_EQ(figures.histogram[5], 12);
  EXPECT_EQ(figures.histogram[6], 630);
  EXPECT_EQ(figures.share_5_to_7, 1.0);
}

TEST(Valences, BoundaryVerticesAreLeftOut) {
  const TriangleMesh mesh = shapes::PlaneGrid(1.0, 1.0, 5, 4);
  const ValenceFigures figures =
      MeasureValences(static_cast<std::int64_t>(mesh.positions.size()), mesh.faces);
  EXPECT_EQ(figures.inner_vertices, 4 * 3);
  EXPECT_EQ(figures.histogram[6], 4 * 3);
}

TEST(Valences, ShareCountsOnlyFiveToSeven) {
  const TriangleMesh mesh = shapes::UvSphere(6, 40);  // Poles of valence 40, rows of 6 and 5.
  const ValenceFigures figures =
      MeasureValences(static_cast<std::int64_t>(mesh.positions.size()), mesh.faces);
  EXPECT_EQ(figures.histogram[ValenceFigures::kBins - 1], 2);
  EXPECT_NEAR(figures.share_5_to_7, 1.0 - 2.0 / static_cast<double>(figures.inner_vertices), 1e-12);
}

TEST(TurnedOver, CountsFlippedAndFlatTriangles) {
  TriangleMesh mesh = shapes::Icosphere(2);
  const std::vector<Eigen::Vector3d> normals = mesh.positions;  // Of the unit sphere.
  EXPECT_EQ(CountTurnedOver(mesh.positions, normals, mesh.faces), 0);
  for (const int face : {3, 50, 200}) std::swap(mesh.faces[face][0], mesh.faces[face][1]);
  EXPECT_EQ(CountTurnedOver(mesh.positions, normals, mesh.faces), 3);
  mesh.faces[7] = {4, 4, 5};
  EXPECT_EQ(CountTurnedOver(mesh.positions, normals, mesh.faces), 4);
}

TEST(Shapes, KnownTrianglesHaveTheirQuality) {
  const std::vector<Eigen::Vector3d> positions = {
      {0, 0, 0}, {1, 0, 0}, {0.5, std::sqrt(0.75), 0}, {0, 1, 0}, {2, 0, 0}};
  const std::vector<Eigen::Vector3i> equilateral = {{0, 1, 2}};
  EXPECT_NEAR(MeasureShapes(positions, equilateral).smallest, 1.0, 1e-12);
  // Right and isosceles: r = 1 / (2 + sqrt 2), h = sqrt 2.
  const std::vector<Eigen::Vector3i> both = {{0, 1, 2}, {0, 1, 3}};
  const double right = 2.0 * std::sqrt(3.0) / ((2.0 + std::sqrt(2.0)) * std::sqrt(2.0));
  EXPECT_NEAR(MeasureShapes(positions, both).smallest, right, 1e-12);
  EXPECT_NEAR(MeasureShapes(positions, both).mean, 0.5 * (1.0 + right), 1e-12);
  const std::vector<Eigen::Vector3i> flat = {{0, 1, 4}};
  EXPECT_EQ(MeasureShapes(positions, flat).smallest, 0.0);
}

}  // namespace
}  // namespace ccst::quality
