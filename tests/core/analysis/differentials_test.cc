#include "core/analysis/differentials.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

#include "core/analysis/periodogram.h"
#include "core/random/random.h"
#include "tests/core/analysis/torus_sets.h"
#include "tests/support/shapes.h"

namespace ccst::analysis {
namespace {

SurfacePoint PointOn(const Surface& surface, std::int32_t face, double u, double v) {
  if (u + v > 1.0) {
    u = 1.0 - u;
    v = 1.0 - v;
  }
  const Eigen::Vector3d weights(u, v, 1.0 - u - v);
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  for (int k = 0; k < 3; ++k) {
    position += weights[k] * surface.positions()[surface.faces()[face][k]];
  }
  return {face, weights, position};
}

// Independent points, by the capacities of the faces; the density is uniform within a face.
std::vector<SurfacePoint> WhiteNoise(const Surface& surface, const Density& density, int count,
                                     std::uint64_t seed) {
  std::vector<double> passed;
  double total = 0.0;
  for (const double capacity : density.face_capacities()) passed.push_back(total += capacity);
  const CounterRandom random(seed, 0);
  std::vector<SurfacePoint> points;
  for (int i = 0; i < count; ++i) {
    const auto face =
        std::upper_bound(passed.begin(), passed.end(), total * random.Uniform(3 * i)) -
        passed.begin();
    points.push_back(PointOn(surface, static_cast<std::int32_t>(face), random.Uniform(3 * i + 1),
                             random.Uniform(3 * i + 2)));
  }
  return points;
}

// Largest |y - expected| of the values at x in [from, to].
double Deviation(const Curve& curve, double from, double to, double expected) {
  double worst = 0.0;
  for (std::size_t i = 0; i < curve.x.size(); ++i) {
    if (curve.x[i] < from || curve.x[i] > to) continue;
    worst = std::max(worst, std::abs(curve.y[i] - expected));
  }
  return worst;
}

// What is measured of n independent samples varies as counts of their pairs do. These deviations
// are of curves from `centers` samples in all sets; a test compares some hundred values, so that
// one beyond kMostDeviations comes up in about one of a thousand tests.
constexpr double kMostDeviations = 4.5;

// Of the radial mean: pairs in a ring, each seen from both ends, are Poisson distributed.
double RadialDeviation(double x, double width, double centers) {
  return 1.0 / std::sqrt(0.5 * centers * 2.0 * M_PI * x * width);
}

// Of the power at a frequency: 1 + (2 / centers) sum over the pairs of w(r) J_0(2 pi f r).
// `variance` is that of a pair at a distance, 1 where all vary; the quarter is the noise of the
// points at which the area is counted, four a sample.
double PowerDeviation(double frequency, double centers,
                      const std::function<double(double)>& variance) {
  const double reach = Differentials::kReach;
  double sum = 0.0;
  for (double r = 0.01; r < reach; r += 0.02) {
    const double window =
        0.42 + 0.5 * std::cos(M_PI * r / reach) + 0.08 * std::cos(2.0 * M_PI * r / reach);
    const double wave = ::j0(2.0 * M_PI * frequency * r);
    sum += 2.0 * M_PI * r * window * window * wave * wave * (variance(r) + 0.25) * 0.02;
  }
  return std::sqrt(2.0 / centers * sum);
}

double AllVary(double /*distance*/) { return 1.0; }

TEST(Differentials, WhiteNoiseIsFlatOnAnySurface) {
  constexpr int kSets = 4;
  constexpr int kCount = 1000;
  for (const TriangleMesh& mesh :
       {shapes::Icosphere(4), shapes::Cube(), shapes::Torus(1.0, 0.2, 80, 20), shapes::Saddle(20),
        shapes::PlateWithHoles(2, 2)}) {
    const Surface surface = *Surface::Build(mesh);
    const Density density = Density::Uniform(surface);
    Differentials differentials(kCount);
    for (int seed = 0; seed < kSets; ++seed) {
      differentials.AddSurface(surface, density, WhiteNoise(surface, density, kCount, seed));
    }
    const Curve radial = differentials.RadialMean(0.1);
    for (std::size_t i = 0; i < radial.x.size(); ++i) {
      if (radial.x[i] < 0.5) continue;  // Fewer than a thousand pairs are not normally distributed.
      EXPECT_NEAR(radial.y[i], 1.0,
                  kMostDeviations * RadialDeviation(radial.x[i], 0.1, kSets * kCount));
    }
    const Curve power = differentials.PowerSpectrum(7.0, 0.05);
    for (std::size_t i = 0; i < power.x.size(); ++i) {
      if (power.x[i] < 0.3) continue;  // The window's own transform.
      EXPECT_NEAR(power.y[i], 1.0,
                  kMostDeviations * PowerDeviation(power.x[i], kSets * kCount, AllVary))
          << power.x[i];
    }
    const Curve anisotropy = differentials.Anisotropy();
    const std::vector<double> noise = differentials.AnisotropyNoise(anisotropy);
    for (std::size_t i = 0; i < anisotropy.x.size(); ++i) {
      if (anisotropy.x[i] < 0.5) continue;
      EXPECT_NEAR(anisotropy.y[i], -10.0 * std::log10(kSets), kMostDeviations * noise[i]);
    }
  }
}

TEST(Differentials, DensityIsScaledAway) {
  const Surface surface = *Surface::Build(shapes::PlaneGrid(1, 1, 40, 40));
  std::vector<double> corners;
  for (const Eigen::Vector3i& f : surface.faces()) {
    const double x = surface.positions()[f[0]].x() + 0.5;
    for (int k = 0; k < 3; ++k) corners.push_back(x < 0.5 ? 1.0 : 4.0);
  }
  const Density density = *Density::Linear(surface, corners, 100.0);
  Differentials scaled(1000);
  Differentials unscaled(1000);
  for (int seed = 0; seed < 4; ++seed) {
    const std::vector<SurfacePoint> points = WhiteNoise(surface, density, 1000, seed);
    scaled.AddSurface(surface, density, points);
    unscaled.AddSurface(surface, Density::Uniform(surface), points);
  }
  const auto worst = [](const Differentials& differentials) {
    const Curve radial = differentials.RadialMean(0.1);
    double deviations = 0.0;
    for (std::size_t i = 0; i < radial.x.size(); ++i) {
      if (radial.x[i] < 0.5) continue;
      deviations = std::max(
          deviations, std::abs(radial.y[i] - 1.0) / RadialDeviation(radial.x[i], 0.1, 4000.0));
    }
    return deviations;
  };
  EXPECT_LT(worst(scaled), kMostDeviations);
  EXPECT_GT(worst(unscaled), 2.0 * kMostDeviations);
}

// Samples in the plane lifted to a mesh, and in the same plane as a torus: away from the boundary
// nothing differs.
TEST(Differentials, PlaneOfFacesAgreesWithTheTorus) {
  const Surface surface = *Surface::Build(shapes::PlaneGrid(1, 1, 30, 30));
  const Density density = Density::Uniform(surface);
  Differentials on_mesh(1024);
  Differentials on_torus(1024);
  for (int seed = 1; seed <= 2; ++seed) {
    const torus::Points points = torus::Ccdt(1024, 5, seed);
    std::vector<SurfacePoint> samples;
    for (const Eigen::Vector2d& p : points) {
      const int column = static_cast<int>(p.x() * 30);
      const int row = static_cast<int>(p.y() * 30);
      const Eigen::Vector3d place((p.x() - 0.5) / surface.unit(), (p.y() - 0.5) / surface.unit(),
                                  0);
      const std::int32_t quad = 2 * (row * 30 + column);
      const SurfacePoint a = surface.ClosestOnFace(quad, place);
      const SurfacePoint b = surface.ClosestOnFace(quad + 1, place);
      samples.push_back((a.position - place).norm() < (b.position - place).norm() ? a : b);
      ASSERT_LT((samples.back().position - place).norm(), 1e-9);
    }
    on_mesh.AddSurface(surface, density, samples);
    on_torus.AddTorus(points, Eigen::Vector2d::Ones());
  }
  const Curve mesh = on_mesh.RadialMean(0.1);
  const Curve torus = on_torus.RadialMean(0.1);
  ASSERT_EQ(mesh.x, torus.x);
  // Of the pairs of the torus the mesh lacks those over its border, the share that a square with a
  // side of 32 spacings loses to a shift by x. The mean of the rest varies about that of all.
  const auto lost = [](double x) {
    const double share = std::min(0.9, 4.0 * x / (M_PI * 32.0) - x * x / (M_PI * 32.0 * 32.0));
    return share / (1.0 - share);
  };
  constexpr double kCenters = 2 * 1024.0;
  for (std::size_t i = 0; i < mesh.x.size(); ++i) {
    const double one = RadialDeviation(mesh.x[i], 0.1, kCenters);
    EXPECT_NEAR(mesh.y[i], torus.y[i],
                kMostDeviations * one * std::sqrt((lost(mesh.x[i]) + 0.25) * torus.y[i]))
        << mesh.x[i];
  }
  const Curve mesh_power = on_mesh.PowerSpectrum(7.0, 0.05);
  const Curve torus_power = on_torus.PowerSpectrum(7.0, 0.05);
  for (std::size_t i = 0; i < mesh_power.x.size(); ++i) {
    // A spectrum varies by its own height, where that is more than white noise's.
    EXPECT_NEAR(mesh_power.y[i], torus_power.y[i],
                kMostDeviations * std::max(1.0, torus_power.y[i]) *
                    PowerDeviation(mesh_power.x[i], kCenters, lost))
        << mesh_power.x[i];
  }
}

TEST(Differentials, LatticeHasPeaksAtItsDistances) {
  torus::Points lattice;
  for (int i = 0; i < 32; ++i) {
    for (int j = 0; j < 32; ++j) lattice.emplace_back((i + 0.5) / 32.0, (j + 0.5) / 32.0);
  }
  Differentials differentials(1024);
  differentials.AddTorus(lattice, Eigen::Vector2d::Ones());
  const Curve mean = differentials.RadialMean();
  // Four neighbours at one spacing: over 2 pi * 0.025.
  double first = 0.0;
  for (std::size_t i = 0; i < mean.x.size() && mean.x[i] < 1.1; ++i) first += mean.y[i] * mean.x[i];
  EXPECT_NEAR(first * 2.0 * M_PI * 0.025, 4.0, 0.1);
  EXPECT_EQ(Deviation(mean, 0.05, 0.95, 0.0), 0.0);
  // All neighbours of a ring in two of its cells.
  EXPECT_GT(differentials.Anisotropy().y.front(), 20.0);
}

// As where a sample mesh is the surface: no point of a face's inside is near its corners.
TEST(Differentials, SamplesAtTheCornersOfFacesHaveAWholeCurve) {
  const Surface surface = *Surface::Build(shapes::Icosphere(4));
  std::vector<SurfacePoint> samples;
  for (std::int32_t v = 0; v < surface.vertex_count(); ++v) {
    const std::int32_t h = surface.outgoing()[v];
    SurfacePoint sample;
    sample.face = h / 3;
    sample.weights[h % 3] = 1.0;
    sample.position = surface.positions()[v];
    samples.push_back(sample);
  }
  Differentials differentials(surface.vertex_count());
  differentials.AddSurface(surface, Density::Uniform(surface), samples);
  const Curve mean = differentials.RadialMean();
  ASSERT_GT(mean.x.size(), 20u);
  EXPECT_LT(mean.x.front(), 0.05);
  EXPECT_EQ(mean.y.front(), 0.0);
  EXPECT_GT(*std::max_element(mean.y.begin(), mean.y.end()), 1.5);
}

TEST(Differentials, ThinPlateHasTheStatisticsOfItsSides) {
  // Two sheets 0.002 apart, joined at their rims: near in space are points of the other side only.
  TriangleMesh plate = shapes::Subdivided(shapes::Subdivided(shapes::Cube()));
  for (Eigen::Vector3d& p : plate.positions)
    p = Eigen::Vector3d(p.x() / 2, p.y() / 2, p.z() / 1000);
  const Surface surface = *Surface::Build(plate);
  const Density density = Density::Uniform(surface);
  // On each side a lattice, shifted against each other: 0.7 spacings in space.
  std::vector<SurfacePoint> samples;
  for (std::int32_t face = 0; face < surface.face_count(); ++face) {
    const double height = surface.ToMesh(surface.positions()[surface.faces()[face][0]]).z() +
                          surface.ToMesh(surface.positions()[surface.faces()[face][1]]).z() +
                          surface.ToMesh(surface.positions()[surface.faces()[face][2]]).z();
    if (std::abs(height) < 0.0029) continue;
    const double shift = height > 0.0 ? 0.25 : 0.75;
    for (int i = 0; i < 20; ++i) {
      for (int j = 0; j < 20; ++j) {
        const Eigen::Vector3d target((i + shift) / 20.0 - 0.5, (j + shift) / 20.0 - 0.5,
                                     height / 3.0);
        const SurfacePoint point = surface.ClosestOnFace(face, target / surface.unit());
        if ((point.position - target / surface.unit()).norm() < 1e-9 &&
            point.weights.minCoeff() > 1e-9) {
          samples.push_back(point);
        }
      }
    }
  }
  ASSERT_GT(samples.size(), 600u);
  Differentials differentials(static_cast<std::int64_t>(samples.size()));
  differentials.AddSurface(surface, density, samples);
  // Around the rim samples are at 0.25 + 0.25 and more spacings of their side.
  double near = 0.0;
  const Curve mean = differentials.RadialMean();
  for (std::size_t i = 0; i < mean.x.size() && mean.x[i] < 0.45; ++i) near += mean.y[i];
  EXPECT_EQ(near, 0.0);
}

TEST(Differentials, ThreadsGiveTheSameBits) {
  const Surface surface = *Surface::Build(shapes::Torus(1, 0.35, 60, 30));
  std::vector<double> corners;
  for (const Eigen::Vector3i& face : surface.faces()) {
    for (const std::int32_t v : face) {
      corners.push_back(1.0 + 4.0 * std::abs(surface.positions()[v].x()));
    }
  }
  const Density density = *Density::Linear(surface, corners, 100.0);
  const std::vector<SurfacePoint> points = WhiteNoise(surface, density, 1500, 2);
  const auto measure = [&](int threads) {
    Differentials differentials(1500);
    differentials.AddSurface(surface, density, points, Parallel(threads));
    return differentials;
  };
  const Differentials base = measure(1);
  for (const int threads : {2, 3, 8}) {
    const Differentials other = measure(threads);
    EXPECT_EQ(other.RadialMean().y, base.RadialMean().y);
    EXPECT_EQ(other.Anisotropy().y, base.Anisotropy().y);
    EXPECT_EQ(other.PowerSpectrum().y, base.PowerSpectrum().y);
  }
}

TEST(Periodogram, LatticeHasPowerAtItsFrequenciesOnly) {
  torus::Points lattice;
  for (int i = 0; i < 16; ++i) {
    for (int j = 0; j < 16; ++j) lattice.emplace_back(i / 16.0, j / 16.0);
  }
  Periodogram periodogram(1.5);
  periodogram.Add(lattice, Eigen::Vector2d::Ones());
  const Curve mean = periodogram.RadialMean();
  EXPECT_LT(Deviation(mean, 0.0, 0.95, 0.0), 1e-9);
  EXPECT_GT(Deviation(mean, 0.95, 1.05, 0.0), 1.0);
}

TEST(Periodogram, WhiteNoiseHasOneEverywhere) {
  Periodogram periodogram;
  constexpr int kSets = 10;
  for (int seed = 0; seed < kSets; ++seed) {
    periodogram.Add(torus::WhiteNoise(1024, seed), Eigen::Vector2d::Ones());
  }
  EXPECT_LT(Deviation(periodogram.RadialMean(), 0.3, 4.0, 1.0), 0.2);
  EXPECT_LT(Deviation(periodogram.Anisotropy(), 1.0, 4.0, -10.0), 2.0);
}

TEST(Periodogram, AgreesWithTheSpectrumFromThePairCorrelation) {
  Periodogram direct;
  Differentials differentials(1024);
  for (int seed = 1; seed <= 4; ++seed) {
    const torus::Points points = torus::DartThrowing(1024, seed);
    direct.Add(points, Eigen::Vector2d::Ones());
    differentials.AddTorus(points, Eigen::Vector2d::Ones());
  }
  const Curve power = differentials.PowerSpectrum();
  const Curve mean = direct.RadialMean();
  for (std::size_t i = 0; i < mean.x.size(); ++i) {
    if (mean.x[i] < 0.2 || mean.x[i] > 3.5) continue;
    const auto at = static_cast<std::size_t>(std::lround(mean.x[i] / 0.01)) - 1;
    EXPECT_NEAR(power.y[at], mean.y[i], 0.05 + 0.15 * mean.y[i]) << mean.x[i];
  }
}

}  // namespace
}  // namespace ccst::analysis
