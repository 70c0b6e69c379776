#include "core/analysis/sample_figures.h"

#include <numeric>
#include <stop_token>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/density/density.h"
#include "core/surface/surface.h"
#include "tests/support/shapes.h"

namespace ccst::analysis {
namespace {

// A sphere's own vertices and faces, judged on the sphere.
SampleFigures MeasureSphere(Interrupt* interrupt = nullptr) {
  const TriangleMesh sphere = shapes::Icosphere(3);
  Surface surface = *Surface::Build(sphere);
  Density uniform = Density::Uniform(surface);
  const ReferenceSurface reference(std::move(surface), std::move(uniform));
  const SampleSetView set = {sphere.positions, sphere.faces};
  return MeasureSamples(reference, {&set, 1}, {.surface_distance = false}, Parallel(), interrupt);
}

TEST(SampleFigures, AnglesAreSharesOfAllByDegrees) {
  const SampleFigures figures = MeasureSphere();
  ASSERT_TRUE(figures.mesh.has_value());
  const Curve& angles = figures.mesh->angles;
  ASSERT_EQ(angles.x.size(), 90U);
  EXPECT_DOUBLE_EQ(angles.x.front(), 1.0);
  EXPECT_DOUBLE_EQ(angles.x.back(), 179.0);
  EXPECT_NEAR(std::accumulate(angles.y.begin(), angles.y.end(), 0.0), 1.0, 1e-12);
  // Nearly equilateral, all of them.
  for (std::size_t i = 0; i < angles.x.size(); ++i) {
    if (angles.x[i] > 50.0 && angles.x[i] < 75.0) continue;
    EXPECT_EQ(angles.y[i], 0.0) << angles.x[i];
  }
}

TEST(SampleFigures, CapacitiesAreSharesOfAllTriangles) {
  const Curve capacities = MeasureSphere().mesh->capacities;
  EXPECT_NEAR(std::accumulate(capacities.y.begin(), capacities.y.end(), 0.0), 1.0, 1e-12);
}

TEST(SampleFigures, RequestedStopMeasuresNothingMore) {
  std::stop_source stop;
  stop.request_stop();
  Interrupt interrupt(stop.get_token());
  const SampleFigures figures = MeasureSphere(&interrupt);
  EXPECT_TRUE(figures.radial_mean.x.empty());
  EXPECT_FALSE(figures.mesh.has_value());
}

TEST(SampleFigures, TokenThatIsNotUsedChangesNothing) {
  std::stop_source stop;
  Interrupt interrupt(stop.get_token());
  EXPECT_EQ(MeasureSphere(&interrupt).power_spectrum.y, MeasureSphere().power_spectrum.y);
}

TEST(SampleFigures, ThreadsGiveTheSameBits) {
  Surface surface = *Surface::Build(shapes::Torus(1, 0.35, 60, 30));
  Density density = Density::Uniform(surface);
  const ReferenceSurface reference(std::move(surface), std::move(density));
  const TriangleMesh samples = shapes::Torus(1, 0.35, 50, 22);
  const std::vector<SampleSetView> sets = {{samples.positions, samples.faces}};
  const SampleFigures base = MeasureSamples(reference, sets);
  ASSERT_TRUE(base.mesh.has_value());
  for (const int threads : {2, 3, 8}) {
    const SampleFigures other = MeasureSamples(reference, sets, {}, Parallel(threads));
    EXPECT_EQ(other.relative_radius_same_side, base.relative_radius_same_side);
    EXPECT_EQ(other.mean_nearest_distance, base.mean_nearest_distance);
    EXPECT_EQ(other.density_fidelity, base.density_fidelity);
    EXPECT_EQ(other.radial_mean.y, base.radial_mean.y);
    EXPECT_EQ(other.power_spectrum.y, base.power_spectrum.y);
    EXPECT_EQ(other.nearest_distances.y, base.nearest_distances.y);
    EXPECT_EQ(other.mesh->hausdorff, base.mesh->hausdorff);
    EXPECT_EQ(other.mesh->rms, base.mesh->rms);
  }
}

}  // namespace
}  // namespace ccst::analysis
