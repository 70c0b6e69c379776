#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stop_token>

#include <gtest/gtest.h>

#include "absl/strings/match.h"
#include "core/base/status.h"
#include "core/quality/distances.h"
#include "tests/core/methods/methods_test_util.h"
#include "tests/support/shapes.h"

namespace ccst {
namespace {

using methods_test::DensityOf;
using methods_test::Figures;
using methods_test::Points;
using methods_test::Sample;
using methods_test::SurfaceOf;

// Runs a method and collects the energies it reports.
template <class Options, class Method>
std::vector<double> Energies(Method method, const Surface& surface, const Density& density,
                             std::int64_t count, const Options& options, RelaxedSamples* result) {
  Interrupt never;
  std::vector<double> energies;
  int last = -1;
  const MethodControl control{&never, [&](const MethodStep& step) {
                                EXPECT_EQ(step.step, last + 1);
                                EXPECT_EQ(step.points.size(), static_cast<std::size_t>(count));
                                last = step.step;
                                energies.push_back(step.energy);
                              }};
  absl::StatusOr<RelaxedSamples> samples = method(surface, density, count, 1, options, control);
  EXPECT_TRUE(samples.ok()) << samples.status();
  if (samples.ok()) *result = *std::move(samples);
  return energies;
}

// Squares of the distances of a grid of places of the unit square to their nearest points, and
// how many places are nearest to each point.
struct Nearest {
  double mean_square = 0.0;
  std::vector<int> places;
};

Nearest NearestOnSquare(const Surface& square, const Points& points, int cells) {
  Nearest nearest;
  nearest.places.assign(points.size(), 0);
  std::vector<Eigen::Vector3d> sites;
  for (const SurfacePoint& p : points) sites.push_back(square.ToMesh(p.position));
  for (int x = 0; x < cells; ++x) {
    for (int y = 0; y < cells; ++y) {
      const Eigen::Vector3d place((x + 0.5) / cells, (y + 0.5) / cells, 0.0);
      double least = std::numeric_limits<double>::infinity();
      std::size_t at = 0;
      for (std::size_t s = 0; s < sites.size(); ++s) {
        const double squared = (sites[s] - place).squaredNorm();
        if (squared < least) {
          least = squared;
          at = s;
        }
      }
      nearest.mean_square += least / (cells * cells);
      ++nearest.places[at];
    }
  }
  return nearest;
}

TEST(RelaxLloyd, EnergyIsThatOfTheVoronoiRegions) {
  const Surface square = SurfaceOf(shapes::PlaneGrid(1.0, 1.0, 7, 5));
  RelaxedSamples result;
  const std::vector<double> energies = Energies(RelaxLloyd, square, Density::Uniform(square), 60,
                                                LloydOptions{.max_steps = 3}, &result);
  ASSERT_EQ(energies.size(), 4u);
  EXPECT_EQ(result.energy, energies.back());
  const double expected =
      NearestOnSquare(square, result.points, 500).mean_square / std::pow(square.unit(), 4);
  EXPECT_NEAR(result.energy, expected, 1e-4 * expected);
}

TEST(RelaxLloyd, EnergyNeverRises) {
  const Surface torus = SurfaceOf(shapes::Torus(1.0, 0.4, 60, 30));
  const Density uniform = Density::Uniform(torus);
  const Density steep = DensityOf(torus, [](const auto& p) { return std::exp(2.0 * p.x()); });
  for (const Density* density : {&uniform, &steep}) {
    RelaxedSamples result;
    const std::vector<double> energies =
        Energies(RelaxLloyd, torus, *density, 1000, LloydOptions{.max_steps = 40}, &result);
    for (std::size_t i = 1; i < energies.size(); ++i) {
      EXPECT_LE(energies[i], energies[i - 1] * (1.0 + 1e-9)) << "step " << i;
    }
    EXPECT_LE(energies.back(), 0.75 * energies.front());
  }
}

TEST(RelaxLloyd, SpacesSamplesBetterThanWhiteNoise) {
  const Surface torus = SurfaceOf(shapes::Torus(1.0, 0.4, 60, 30));
  const Density density = Density::Uniform(torus);
  const auto white = Figures(torus, Sample("white noise", torus, density, 1500));
  const auto lloyd = Figures(torus, Sample("lloyd", torus, density, 1500));
  EXPECT_LE(white.mean_nearest_distance, 0.55);
  EXPECT_GE(lloyd.mean_nearest_distance, 0.88);
  EXPECT_LE(white.relative_radius, 0.1);
  EXPECT_GE(lloyd.relative_radius, 0.6);
}

TEST(RelaxLloyd, ComesToRest) {
  const Surface torus = SurfaceOf(shapes::Torus(1.0, 0.4, 30, 15));
  RelaxedSamples result;
  const LloydOptions options{.max_steps = 2000, .tolerance = 1e-4};
  Energies(RelaxLloyd, torus, Density::Uniform(torus), 20, options, &result);
  EXPECT_TRUE(result.converged);
  EXPECT_LT(result.steps, 2000);
}

TEST(BalanceVoronoi, EnergyNeverRises) {
  const Surface torus = SurfaceOf(shapes::Torus(1.0, 0.4, 60, 30));
  const Density steep = DensityOf(torus, [](const auto& p) { return std::exp(2.0 * p.x()); });
  RelaxedSamples result;
  const std::vector<double> energies =
      Energies(BalanceVoronoi, torus, steep, 500, BalanceOptions{.points_per_sample = 64}, &result);
  for (std::size_t i = 1; i < energies.size(); ++i) {
    EXPECT_LE(energies[i], energies[i - 1] * (1.0 + 1e-12)) << "step " << i;
  }
  EXPECT_TRUE(result.converged);
  EXPECT_LE(energies.back(), 0.75 * energies.front());
}

// What capacity constraints are for: Voronoi regions of about equal size, more so than Lloyd's.
TEST(BalanceVoronoi, RegionsAreOfEqualSize) {
  const Surface square = SurfaceOf(shapes::PlaneGrid(1.0, 1.0, 7, 5));
  const Density density = Density::Uniform(square);
  const auto spread = [&](const Points& points) {
    const std::vector<int> places = NearestOnSquare(square, points, 400).places;
    const double mean = 160000.0 / static_cast<double>(points.size());
    double sum = 0.0;
    for (const int n : places) sum += (n / mean - 1.0) * (n / mean - 1.0);
    return std::sqrt(sum / static_cast<double>(points.size()));
  };
  RelaxedSamples balanced;
  Energies(BalanceVoronoi, square, density, 200, BalanceOptions(), &balanced);
  const double of_balanced = spread(balanced.points);
  EXPECT_LE(of_balanced, 0.06);
  EXPECT_LE(of_balanced, 0.9 * spread(Sample("lloyd", square, density, 200)));
}

TEST(BalanceVoronoi, TooManySamplesAreRefused) {
  const Surface square = SurfaceOf(shapes::PlaneGrid(1.0, 1.0, 1, 1));
  Interrupt never;
  const auto samples = BalanceVoronoi(square, Density::Uniform(square), kMaxBalancedCount + 1, 1,
                                      BalanceOptions(), {&never});
  EXPECT_EQ(GetErrorReason(samples.status()), ErrorReason::kLimitExceeded);
  EXPECT_TRUE(absl::StrContains(samples.status().message(), "20001"));
  EXPECT_TRUE(absl::StrContains(samples.status().message(), "20000"));
}

TEST(IterativeMethods, StoppedAfterAStepTheyReturnTheWholeSet) {
  const Surface torus = SurfaceOf(shapes::Torus(1.0, 0.4, 40, 20));
  const Density density = Density::Uniform(torus);
  const auto run = [&](auto method, const auto& options) {
    std::stop_source stop;
    Interrupt interrupt(stop.get_token());
    Points last;
    const MethodControl control{&interrupt, [&](const MethodStep& step) {
                                  last = step.points;
                                  if (step.step == 2) stop.request_stop();
                                }};
    const auto samples = method(torus, density, 500, 1, options, control);
    ASSERT_TRUE(samples.ok()) << samples.status();
    EXPECT_FALSE(samples->converged);
    EXPECT_LE(samples->steps, 3);
    EXPECT_EQ(samples->points.size(), 500u);
  };
  run(RelaxLloyd, LloydOptions());
  run(BalanceVoronoi, BalanceOptions{.points_per_sample = 32});
}

// The start is a set of samples too: whoever is out of time by then gets it.
TEST(IterativeMethods, OutOfTimeBeforeTheFirstStepTheyReturnTheStart) {
  const Surface torus = SurfaceOf(shapes::Torus(1.0, 0.4, 40, 20));
  const Density density = Density::Uniform(torus);
  const auto run = [&](auto method, const auto& options) {
    for (auto limit = std::chrono::microseconds(1);; limit *= 2) {
      Interrupt interrupt({}, Interrupt::Clock::now() + limit);
      const auto samples = method(torus, density, 2000, 1, options, MethodControl{&interrupt});
      if (!samples.ok()) {
        EXPECT_EQ(GetErrorReason(samples.status()), ErrorReason::kTimeLimitExceeded);
        continue;
      }
      EXPECT_EQ(samples->points.size(), 2000u);
      EXPECT_FALSE(samples->converged);
      return;
    }
  };
  run(RelaxLloyd, LloydOptions{.max_steps = 1000, .tolerance = 0.0});
  run(BalanceVoronoi, BalanceOptions());
}

// Regions that reach through a thin plate would leave on each side what is left of one pattern
// over both.
TEST(IterativeMethods, SidesOfAThinPlateAreRelaxedApart) {
  const Surface plate = SurfaceOf(methods_test::ThinPlate(1e-3));
  const Density density = Density::Uniform(plate);
  const auto lloyd = Figures(plate, Sample("lloyd", plate, density, 1000));
  EXPECT_GE(lloyd.relative_radius_same_side, 0.55);
  EXPECT_LE(lloyd.relative_radius, 0.2);
  const auto balanced = Figures(plate, Sample("balanced voronoi", plate, density, 1000));
  EXPECT_GE(balanced.relative_radius_same_side, 0.45);
  EXPECT_LE(balanced.relative_radius, 0.2);
}

}  // namespace
}  // namespace ccst
