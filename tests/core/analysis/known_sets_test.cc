// The measures against figures known for known sets: 1024 samples in the repeated unit square, mean
// of eight sets. Most were measured by other programs (Schloemer's psa among them).

#include <cmath>
#include <cstdio>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

#include "core/analysis/differentials.h"
#include "core/analysis/periodogram.h"
#include "core/analysis/spectral_figures.h"
#include "core/quality/capacity.h"
#include "core/quality/distances.h"
#include "core/quality/sample_mesh_quality.h"
#include "tests/core/analysis/torus_sets.h"

namespace ccst::analysis {
namespace {

constexpr int kCount = 1024;
constexpr int kSets = 8;

struct Figures {
  double radius = 0.0, mean = 0.0, nu = 0.0, omega = 0.0, cv = 0.0, voronoi_cv = 0.0, angle = 0.0,
         valence = 0.0;
};

double Variation(const std::vector<double>& values) {
  double sum = 0.0;
  double squares = 0.0;
  for (const double v : values) {
    sum += v;
    squares += v * v;
  }
  const double mean = sum / static_cast<double>(values.size());
  return std::sqrt(squares / static_cast<double>(values.size()) - mean * mean) / mean;
}

Figures Measure(const char* name, const std::function<torus::Points(std::uint64_t)>& make) {
  Figures f;
  Differentials differentials(kCount);
  for (std::uint64_t seed = 1; seed <= kSets; ++seed) {
    const torus::Points points = make(seed);
    std::vector<Eigen::Vector3d> flat;
    for (const Eigen::Vector2d& p : points) flat.emplace_back(p.x(), p.y(), 0.0);
    const quality::DistanceFigures distances =
        quality::MeasureDistances(flat, {}, 1.0, Eigen::Vector3d(1.0, 1.0, 0.0));
    f.radius += distances.relative_radius / kSets;
    f.mean += distances.mean_nearest_distance / kSets;
    const torus::Cells cells = torus::MakeCells(points);
    const torus::Unrolled mesh = torus::Unroll(points, cells.triangles);
    f.cv += quality::MeasureCapacities(mesh.positions, mesh.triangles).cv / kSets;
    f.voronoi_cv += Variation(cells.areas) / kSets;
    f.angle += quality::MeasureAngles(mesh.positions, mesh.triangles).smallest / kSets;
    f.valence += quality::MeasureValences(kCount, cells.triangles).share_5_to_7 / kSets;
    differentials.AddTorus(points, Eigen::Vector2d::Ones());
  }
  const SpectralFigures spectral = MeasureSpectrum(differentials.PowerSpectrum());
  f.nu = spectral.effective_nyquist;
  f.omega = spectral.oscillation;
  double low = 0.0;
  double peak = 0.0;
  const Curve power = differentials.PowerSpectrum();
  for (std::size_t i = 0; i < power.x.size() && power.x[i] < 0.4; ++i)
    low = std::max(low, power.y[i]);
  for (const double y : differentials.RadialMean().y) peak = std::max(peak, y);
  std::printf(
      "%-6s nu %.3f, Omega %.3f, radius %.3f, mean %.3f, cv %.4f, Voronoi cv %.4f, smallest angle "
      "%.1f, valence %.4f; power below 0.4 %.4f, peak %.2f\n",
      name, f.nu, f.omega, f.radius, f.mean, f.cv, f.voronoi_cv, f.angle, f.valence, low, peak);
  return f;
}

void ExpectWithin5Percent(double value, double known) { EXPECT_NEAR(value, known, 0.05 * known); }

TEST(KnownSets, WhiteNoise) {
  const Figures f = Measure("white", [](std::uint64_t s) { return torus::WhiteNoise(kCount, s); });
  EXPECT_EQ(f.nu, 0.0);
  // Omega of white noise is nothing but the noise of its spectrum, and falls with the number of
  // samples measured: 0.235 sqrt(1024 / samples) is the root of the mean over the band of the
  // power's variance, (2 / samples) times the integral of 2 pi r w(r)^2 J_0(2 pi f r)^2, times
  // psa's 1.01. One of eight sets of 1024 varies by 0.010 (48 sets). The 0.1 in print is that of
  // about six.
  EXPECT_NEAR(f.omega, 0.235 / std::sqrt(1.0 * kSets), 4.0 * 0.010);
  EXPECT_LT(f.radius, 0.04);
  ExpectWithin5Percent(f.mean, 0.465);
}

TEST(KnownSets, DartThrowing) {
  const Figures f =
      Measure("darts", [](std::uint64_t s) { return torus::DartThrowing(kCount, s); });
  ExpectWithin5Percent(f.nu, 0.67);
  ExpectWithin5Percent(f.omega, 1.31);
  ExpectWithin5Percent(f.mean, 0.81);
}

TEST(KnownSets, Lloyd) {
  const Figures f = Measure("Lloyd", [](std::uint64_t s) { return torus::Lloyd(kCount, 100, s); });
  ExpectWithin5Percent(f.nu, 0.92);
  ExpectWithin5Percent(f.omega, 3.45);
  ExpectWithin5Percent(f.mean, 0.92);
}

TEST(KnownSets, CapacityConstrainedDelaunay) {
  const Figures f = Measure("CCDT", [](std::uint64_t s) { return torus::Ccdt(kCount, 30, s); });
  ExpectWithin5Percent(f.nu, 0.88);
  ExpectWithin5Percent(f.omega, 2.30);
  ExpectWithin5Percent(f.radius, 0.72);
  ExpectWithin5Percent(f.mean, 0.88);
  ExpectWithin5Percent(f.cv, 0.018);
  ExpectWithin5Percent(f.angle, 33.0);
  ExpectWithin5Percent(f.valence, 0.999);
}

}  // namespace
}  // namespace ccst::analysis
