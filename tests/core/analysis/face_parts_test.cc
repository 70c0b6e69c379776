#include "core/analysis/face_parts.h"

#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "core/analysis/density_fidelity.h"
#include "core/random/random.h"
#include "tests/support/shapes.h"

namespace ccst::analysis {
namespace {

TEST(FaceParts, CentroidsLieInTheirParts) {
  const Surface surface = *Surface::Build(shapes::Tetrahedron());
  const Density density = Density::Uniform(surface);
  const FaceParts parts(surface, density, 400.0);
  EXPECT_EQ(parts.size(), 400);
  for (std::int32_t face = 0; face < 4; ++face) {
    for (std::int64_t k = parts.first(face); k < parts.first(face + 1); ++k) {
      const Eigen::Vector3d weights = parts.Centroid(face, k);
      EXPECT_GT(weights.minCoeff(), 0.0);
      EXPECT_EQ(parts.Find({face, weights, {}}), k);
      EXPECT_NEAR(parts.Capacity(k), surface.area() / 400.0, 1e-15);
    }
  }
}

TEST(FaceParts, LinearDensityIsSharedOut) {
  const Surface surface = *Surface::Build(shapes::SingleTriangle());
  const Density density = *Density::Linear(surface, {3.0, 1.0, 1.0}, 100.0);
  const FaceParts parts(surface, density, 10000.0);
  double total = 0.0;
  double near_corner = 0.0;  // Where corner 0 weighs more than half.
  for (std::int64_t k = 0; k < parts.size(); ++k) {
    total += parts.Capacity(k);
    if (parts.Centroid(0, k)[0] > 0.5) near_corner += parts.Capacity(k);
  }
  EXPECT_NEAR(total, density.face_capacities()[0], 1e-12);
  // A quarter of the area with the mean density 1 + 2 * 2/3 of a mean of 5/3.
  EXPECT_NEAR(near_corner / total, 0.25 * (7.0 / 3.0) / (5.0 / 3.0), 1e-3);
}

std::vector<SurfacePoint> Centroids(const FaceParts& parts, const Surface& surface) {
  std::vector<SurfacePoint> points;
  for (std::int32_t face = 0; face < surface.face_count(); ++face) {
    for (std::int64_t k = parts.first(face); k < parts.first(face + 1); ++k) {
      points.push_back({face, parts.Centroid(face, k), {}});
    }
  }
  return points;
}

TEST(DensityFidelity, EvenSamplesFollowAUniformDensity) {
  const Surface surface = *Surface::Build(shapes::Cube());
  const Density density = Density::Uniform(surface);
  const FaceParts parts(surface, density, 60000.0);
  EXPECT_LT(MeasureDensityFidelity(surface, density, Centroids(parts, surface)), 0.02);
}

TEST(DensityFidelity, WhiteNoiseIsOffByItsShotNoise) {
  const Surface surface = *Surface::Build(shapes::Icosphere(3));
  const Density density = Density::Uniform(surface);
  const FaceParts parts(surface, density, 100000.0);
  const std::vector<SurfacePoint> places = Centroids(parts, surface);
  constexpr int kSets = 20;
  double sum = 0.0;
  for (int set = 0; set < kSets; ++set) {
    const CounterRandom random(set, 0);
    std::vector<SurfacePoint> samples;
    for (int i = 0; i < 6400; ++i) {
      samples.push_back(places[static_cast<std::size_t>(random.Uniform(i) * places.size())]);
    }
    sum += MeasureDensityFidelity(surface, density, samples) / kSets;
  }
  // The root of a mean of 64 squares varies by 1 / sqrt(2 * 64) of itself, the mean of the sets by
  // that over sqrt(20); four and a half times as much.
  const double expected = std::sqrt(64.0 / 6400.0);
  EXPECT_NEAR(sum, expected, 4.5 * expected / std::sqrt(2.0 * 64.0 * kSets));
}

TEST(DensityFidelity, UniformSamplesMissADensity) {
  const Surface surface = *Surface::Build(shapes::PlaneGrid(1, 1, 20, 20));
  std::vector<double> corners;
  for (const Eigen::Vector3i& f : surface.faces()) {
    const double x = surface.positions()[f[0]].x() + surface.positions()[f[1]].x() +
                     surface.positions()[f[2]].x();
    corners.insert(corners.end(), 3, x < 0.0 ? 1.0 : 3.0);
  }
  const Density density = *Density::Linear(surface, corners, 100.0);
  const Density uniform = Density::Uniform(surface);
  const FaceParts parts(surface, uniform, 60000.0);
  // Found 1/2 where 1/4 belongs and 1/2 where 3/4 belongs, in patches of 16 and 48.
  const double expected = std::sqrt(0.25 * 1.0 + 0.75 / 9.0);
  // The halves are whole numbers of patches, so none lies across; what is left is what even samples
  // are off by, as above.
  EXPECT_NEAR(MeasureDensityFidelity(surface, density, Centroids(parts, surface)), expected, 0.02);
}

}  // namespace
}  // namespace ccst::analysis
