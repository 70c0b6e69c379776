#include "core/analysis/sample_figures.h"

#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/density/density.h"
#include "core/surface/surface.h"
#include "tests/support/shapes.h"

namespace ccst::analysis {
namespace {

TEST(MeasureSamples, ThreadsGiveTheSameBits) {
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
