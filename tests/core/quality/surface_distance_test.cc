#include "core/quality/surface_distance.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/shapes.h"

namespace ccst::quality {
namespace {

SurfaceDistanceFigures Distance(const TriangleMesh& surface, const TriangleMesh& samples,
                                double spacing = 0.0) {
  const TriangleTree tree(surface.positions, surface.faces);
  return MeasureSurfaceDistance(surface, tree, samples.positions, samples.faces, spacing);
}

TEST(SurfaceDistance, OfAMeshFromItselfIsZero) {
  const TriangleMesh torus = shapes::Torus(1.0, 0.3, 30, 16);
  const SurfaceDistanceFigures figures = Distance(torus, torus, 0.05);
  EXPECT_LT(figures.hausdorff, 1e-15);
  EXPECT_LT(figures.rms, 1e-15);
}

TEST(SurfaceDistance, OfParallelPlanesIsTheirDistance) {
  const TriangleMesh plane = shapes::PlaneGrid(1.0, 1.0, 3, 3);
  const SurfaceDistanceFigures figures =
      Distance(plane, shapes::Moved(plane, {0.0, 0.0, 0.25}), 0.02);
  EXPECT_NEAR(figures.hausdorff, 0.25, 1e-12);
  EXPECT_NEAR(figures.rms, 0.25, 1e-12);
  EXPECT_NEAR(figures.samples_to_surface.rms, 0.25, 1e-12);
}

TEST(SurfaceDistance, MissingPartShowsFromTheSurfaceAlone) {
  const TriangleMesh whole = shapes::PlaneGrid(2.0, 1.0, 2, 1);
  const TriangleMesh half = shapes::PlaneGrid(1.0, 1.0, 1, 1);
  const SurfaceDistanceFigures figures = Distance(whole, half, 0.01);
  EXPECT_NEAR(figures.surface_to_samples.largest, 1.0, 1e-12);
  EXPECT_NEAR(figures.samples_to_surface.largest, 0.0, 1e-12);
  EXPECT_NEAR(figures.hausdorff, 1.0, 1e-12);
  // Half of the area at distance 0, half uniform in [0, 1].
  EXPECT_NEAR(figures.surface_to_samples.rms, std::sqrt(1.0 / 6.0), 1e-3);
  const SurfaceDistanceFigures reverse = Distance(half, whole, 0.01);
  EXPECT_NEAR(reverse.surface_to_samples.largest, 0.0, 1e-12);
  EXPECT_NEAR(reverse.samples_to_surface.largest, 1.0, 1e-12);
}

TEST(SurfaceDistance, InteriorOfALargeFaceIsLookedAt) {
  // The samples' plane has a square hole in the middle, the surface only two faces.
  const TriangleMesh surface = shapes::PlaneGrid(3.0, 3.0, 1, 1);
  TriangleMesh samples = shapes::PlaneGrid(3.0, 3.0, 3, 3);
  samples.faces.erase(samples.faces.begin() + 8, samples.faces.begin() + 10);
  const SurfaceDistanceFigures figures = Distance(surface, samples, 0.03);
  EXPECT_NEAR(figures.hausdorff, 0.5, 0.03);
  EXPECT_LE(figures.hausdorff, 0.5 + 1e-12);
}

TEST(SurfaceDistance, CentresOfSampleTrianglesAreLookedAt) {
  // An octahedron in the unit sphere is farthest at the middles of its faces.
  const TriangleMesh sphere = shapes::Icosphere(5);
  const SurfaceDistanceFigures figures = Distance(sphere, shapes::UvSphere(2, 4), 0.05);
  EXPECT_NEAR(figures.samples_to_surface.largest, 1.0 - 1.0 / std::sqrt(3.0), 1e-3);
  EXPECT_NEAR(figures.surface_to_samples.largest, 1.0 - 1.0 / std::sqrt(3.0), 1e-3);
}

TEST(SurfaceDistance, ScalesWithTheMesh) {
  const TriangleMesh fine = shapes::Icosphere(3), coarse = shapes::Icosphere(2);
  const double unit = Distance(fine, coarse, 0.05).hausdorff;
  const Eigen::Vector3d far(1e4, -2e4, 3e4);
  const double large =
      Distance(shapes::Moved(fine, far, 100.0), shapes::Moved(coarse, far, 100.0), 5.0).hausdorff;
  EXPECT_NEAR(large, 100.0 * unit, 1e-6);
}

TEST(SurfaceDistance, DefaultSpacingResolvesALargeFace) {
  // A tip of height 0.1 over a flat square, 0.02 wide: it has to be met inside one of two faces.
  TriangleMesh tip = shapes::PlaneGrid(1.0, 1.0, 50, 50);
  tip.positions[51 * 17 + 23].z() = 0.1;
  const SurfaceDistanceFigures figures = Distance(shapes::PlaneGrid(1.0, 1.0, 1, 1), tip);
  EXPECT_NEAR(figures.hausdorff, 0.1, 1e-12);
  EXPECT_GT(figures.surface_to_samples.largest, 0.01);
}

TEST(SurfaceDistance, NeedleFacesStayCheap) {
  TriangleMesh needle;
  needle.positions = {{0, 0, 0}, {1e9, 0, 0}, {0, 1e-9, 0}};
  needle.faces = {{0, 1, 2}};
  EXPECT_LT(Distance(needle, needle, 1e-6).hausdorff, 1e-6);
}

TEST(SurfaceDistance, ThreadsGiveTheSameBits) {
  const TriangleMesh surface = shapes::Torus(1.0, 0.3, 60, 30);
  const TriangleMesh samples = shapes::Torus(1.0, 0.3, 50, 23);
  const TriangleTree tree(surface.positions, surface.faces);
  const SurfaceDistanceFigures base = Distance(surface, samples, 0.02);
  for (const int threads : {2, 3, 8}) {
    const SurfaceDistanceFigures other = MeasureSurfaceDistance(
        surface, tree, samples.positions, samples.faces, 0.02, Parallel(threads));
    EXPECT_EQ(other.hausdorff, base.hausdorff);
    EXPECT_EQ(other.surface_to_samples.rms, base.surface_to_samples.rms);
    EXPECT_EQ(other.samples_to_surface.rms, base.samples_to_surface.rms);
  }
}

TEST(LargestDistance, IsExact) {
  const TriangleMesh plane = shapes::PlaneGrid(1.0, 1.0, 4, 4);
  const TriangleTree tree(plane.positions, plane.faces);
  const std::vector<Eigen::Vector3d> points = {{0.3, 0.4, 1e-9}, {0.1, 0.9, -2e-9}, {0.5, 0.5, 0}};
  EXPECT_NEAR(LargestDistance(points, tree), 2e-9, 1e-24);
  EXPECT_EQ(LargestDistance({}, tree), 0.0);
}

}  // namespace
}  // namespace ccst::quality
