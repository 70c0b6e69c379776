#include "core/methods/strata.h"

#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "tests/core/methods/methods_test_util.h"
#include "tests/support/shapes.h"

namespace ccst {
namespace {

using methods_test::DensityOf;
using methods_test::SurfaceOf;

TEST(ForEachStratum, EveryFaceGetsItsCapacityToOnePoint) {
  const Surface torus = SurfaceOf(shapes::Torus(1.0, 0.4, 16, 8));
  const Density density = DensityOf(torus, [](const auto& p) { return 2.0 + p.x() + p.z(); });
  Interrupt never;
  const CapacityCurve curve(torus, density, &never);
  constexpr std::int64_t kCount = 4000;
  std::vector<double> found(torus.face_count(), 0.0);
  std::int64_t visited = 0;
  ForEachStratum(density, curve, kCount / 4, 4, CounterRandom(1, 1), &never,
                 [&](const SurfacePoint& point) {
                   ++found[point.face];
                   ++visited;
                 });
  EXPECT_EQ(visited, kCount);
  for (std::int32_t f = 0; f < torus.face_count(); ++f) {
    // A face is an interval of the curve: it holds every whole stratum and parts of two.
    EXPECT_NEAR(found[f], kCount * density.face_capacities()[f] / torus.area(), 2.0) << f;
  }
}

TEST(CapacityCurve, ComponentsAreIntervals) {
  const std::vector<TriangleMesh> parts = {shapes::Icosphere(1), shapes::Cube(),
                                           shapes::Icosphere(2, 0.5)};
  const Surface surface = SurfaceOf(shapes::DisjointUnion(parts));
  const Density density = Density::Uniform(surface);
  Interrupt never;
  const CapacityCurve curve(surface, density, &never);
  EXPECT_NEAR(curve.length(), surface.area(), 1e-12);
  for (int c = 0; c < 3; ++c) {
    const double begin = curve.ComponentBegin(c);
    const double end = curve.ComponentBegin(c + 1);
    EXPECT_NEAR(end - begin, surface.component_areas()[c], 1e-12);
    for (int k = 0; k < 100; ++k) {
      const SurfacePoint point = curve.At(begin + (k + 0.5) / 100.0 * (end - begin));
      EXPECT_EQ(surface.face_components()[point.face], c);
    }
  }
}

}  // namespace
}  // namespace ccst
