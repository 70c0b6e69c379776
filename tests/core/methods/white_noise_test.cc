#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/core/methods/methods_test_util.h"
#include "tests/support/shapes.h"

namespace ccst {
namespace {

using methods_test::DensityOf;
using methods_test::Points;
using methods_test::Sample;
using methods_test::SurfaceOf;

// The chi-square statistic of the counts in patches of faces against capacities worked out here.
TEST(DrawWhiteNoise, CountsInPatchesAreMultinomial) {
  const Surface torus = SurfaceOf(shapes::Torus(1.0, 0.4, 32, 16));
  const auto rho = [](const Eigen::Vector3d& p) { return std::exp(1.5 * p.x()); };
  const Density density = DensityOf(torus, rho);
  constexpr int kPatches = 64;
  constexpr int kCount = 20000;
  const int faces_per_patch = torus.face_count() / kPatches;
  ASSERT_EQ(faces_per_patch * kPatches, torus.face_count());
  std::vector<double> capacity(kPatches, 0.0);
  double total = 0.0;
  for (std::int32_t f = 0; f < torus.face_count(); ++f) {
    double mean = 0.0;
    for (const std::int32_t v : torus.faces()[f]) mean += rho(torus.ToMesh(torus.positions()[v]));
    capacity[f / faces_per_patch] += torus.face_areas()[f] * mean;
    total += torus.face_areas()[f] * mean;
  }
  for (const std::uint64_t seed : {1, 2, 3}) {
    std::vector<int> found(kPatches, 0);
    for (const SurfacePoint& point : Sample("white noise", torus, density, kCount, seed)) {
      ++found[point.face / faces_per_patch];
    }
    double chi_square = 0.0;
    for (int k = 0; k < kPatches; ++k) {
      const double expected = kCount * capacity[k] / total;
      chi_square += (found[k] - expected) * (found[k] - expected) / expected;
    }
    // Mean 63, standard deviation sqrt(126): too even would be as wrong as too uneven.
    EXPECT_NEAR(chi_square, 63.0, 4.0 * std::sqrt(126.0)) << "seed " << seed;
  }
}

// Within one face whose density grows linearly from one side: P(x < t) = t^2 when rho is x.
TEST(DrawWhiteNoise, FollowsTheDensityWithinAFace) {
  const Surface square = SurfaceOf(shapes::PlaneGrid(1.0, 1.0, 1, 1));
  const Density density = DensityOf(square, [](const auto& p) { return p.x(); });
  constexpr int kCount = 20000;
  std::vector<double> x;
  for (const SurfacePoint& point : Sample("white noise", square, density, kCount)) {
    x.push_back(square.ToMesh(point.position).x());
  }
  std::sort(x.begin(), x.end());
  double worst = 0.0;
  for (int i = 0; i < kCount; ++i) {
    worst = std::max(worst, std::abs(x[i] * x[i] - (i + 0.5) / kCount));
  }
  // Kolmogorov: beyond 1.95 / sqrt(n) with probability 1e-3.
  EXPECT_LE(worst, 1.95 / std::sqrt(kCount));
}

}  // namespace
}  // namespace ccst
