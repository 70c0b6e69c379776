#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "core/quality/distances.h"
#include "tests/core/methods/methods_test_util.h"
#include "tests/support/shapes.h"

namespace ccst {
namespace {

using methods_test::DensityOf;
using methods_test::Figures;
using methods_test::HostNormals;
using methods_test::Points;
using methods_test::Sample;
using methods_test::SurfaceOf;

DartSamples Darts(const Surface& surface, const Density& density, std::int64_t count) {
  Interrupt never;
  absl::StatusOr<DartSamples> samples = ThrowDarts(surface, density, count, 1, {&never});
  EXPECT_TRUE(samples.ok()) << samples.status();
  return samples.ok() ? *samples : DartSamples();
}

// Smallest distance of two points on one side in units of the smaller of their local spacings
// 1 / sqrt(rho), over all pairs.
double SmallestScaledDistance(const Surface& surface, const Density& density,
                              const Points& points) {
  const std::vector<Eigen::Vector3d> normals = HostNormals(surface, points);
  std::vector<double> spacings;
  for (const SurfacePoint& p : points) {
    spacings.push_back(1.0 / std::sqrt(density.At(p.face, p.weights)));
  }
  double smallest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (!(normals[i].dot(normals[j]) > 0.0)) continue;
      const double distance = (points[i].position - points[j].position).norm();
      smallest = std::min(smallest, distance / std::min(spacings[i], spacings[j]));
    }
  }
  return smallest;
}

TEST(ThrowDarts, NoPairIsNearerThanTheRadius) {
  const Surface torus = SurfaceOf(shapes::Torus(1.0, 0.4, 80, 40));
  const Density uniform = Density::Uniform(torus);
  const Density steep = DensityOf(torus, [](const auto& p) { return std::exp(2.0 * p.x()); });
  for (const Density* density : {&uniform, &steep}) {
    const DartSamples samples = Darts(torus, *density, 1000);
    const double smallest = SmallestScaledDistance(torus, *density, samples.points);
    // Radii are kept in single precision.
    EXPECT_GE(smallest, samples.radius * (1.0 - 1e-6));
    EXPECT_LE(smallest, samples.radius * 1.05);
  }
}

TEST(ThrowDarts, RadiusIsThatOfMaximalSets) {
  const Surface torus = SurfaceOf(shapes::Torus(1.0, 0.4, 80, 40));
  const Density density = Density::Uniform(torus);
  for (const std::int64_t count : {1000, 5000}) {
    const DartSamples samples = Darts(torus, density, count);
    const double r_max = quality::HexagonalSpacing(torus.area(), count);
    // Random sequential packing saturates at 0.547 of the area: at 0.777 r_max.
    EXPECT_GE(samples.radius / r_max, 0.68) << count;
    EXPECT_LE(samples.radius / r_max, 0.777) << count;
  }
}

TEST(ThrowDarts, AlmostNoPlaceIsLeftForAnotherDart) {
  const Surface torus = SurfaceOf(shapes::Torus(1.0, 0.4, 80, 40));
  const Density density = Density::Uniform(torus);
  const DartSamples samples = Darts(torus, density, 1000);
  int free = 0;
  const Points tries = Sample("white noise", torus, density, 5000, 99);
  for (const SurfacePoint& dart : tries) {
    const bool covered =
        std::any_of(samples.points.begin(), samples.points.end(), [&](const SurfacePoint& sample) {
          return (sample.position - dart.position).norm() < samples.radius;
        });
    if (!covered) ++free;
  }
  EXPECT_LE(free, 0.03 * static_cast<double>(tries.size()));
}

TEST(EliminateSamples, RelativeRadiusIsThatOfThePaper) {
  for (const TriangleMesh& mesh :
       {shapes::Torus(1.0, 0.4, 80, 40), shapes::PlaneGrid(1.0, 1.0, 8, 8)}) {
    const Surface surface = SurfaceOf(mesh);
    const Density density = Density::Uniform(surface);
    const quality::DistanceFigures figures =
        Figures(surface, Sample("elimination", surface, density, 2000));
    // On a plane with boundary the outermost points have neighbours on one side only.
    EXPECT_GE(figures.relative_radius_same_side, 0.6);
    EXPECT_GE(figures.mean_nearest_distance, 0.75);
  }
}

TEST(EliminateSamples, SpacingFollowsTheDensity) {
  const Surface torus = SurfaceOf(shapes::Torus(1.0, 0.4, 80, 40));
  const Density steep = DensityOf(torus, [](const auto& p) { return std::exp(2.0 * p.x()); });
  constexpr int kCount = 2000;
  const Points points = Sample("elimination", torus, steep, kCount);
  const double r_max = quality::HexagonalSpacing(torus.area(), kCount);
  EXPECT_GE(SmallestScaledDistance(torus, steep, points), 0.55 * r_max);
}

// The two sides of a plate that is much thinner than the spacing: if they saw each other, each
// would keep only about half of the relative radius squared.
TEST(PoissonDisks, SidesOfAThinPlateDoNotSeeEachOther) {
  const Surface plate = SurfaceOf(methods_test::ThinPlate(1e-3));
  const Density density = Density::Uniform(plate);
  for (const char* method : {"dart throwing", "elimination"}) {
    const Points points = Sample(method, plate, density, 2000);
    const quality::DistanceFigures figures = Figures(plate, points);
    EXPECT_GE(figures.relative_radius_same_side, 0.6) << method;
    EXPECT_LE(figures.relative_radius, 0.2) << method;
  }
}

TEST(PoissonDisks, NestedComponentsDoNotSeeEachOther) {
  const std::vector<TriangleMesh> both = {shapes::Icosphere(4), shapes::Icosphere(4, 0.995)};
  const Surface spheres = SurfaceOf(shapes::DisjointUnion(both));
  const Density density = Density::Uniform(spheres);
  for (const char* method : {"dart throwing", "elimination"}) {
    const Points points = Sample(method, spheres, density, 2000);
    Points outer;
    for (const SurfacePoint& point : points) {
      if (spheres.face_components()[point.face] == 0) outer.push_back(point);
    }
    const double r_max = quality::HexagonalSpacing(spheres.area(), 2000);
    const quality::DistanceFigures figures = Figures(spheres, outer);
    EXPECT_GE(figures.relative_radius * figures.r_max, 0.6 * r_max) << method;
    EXPECT_NEAR(static_cast<double>(outer.size()), 1000.0, 40.0) << method;
  }
}

}  // namespace
}  // namespace ccst
