// What the sampler converges to does not depend on where it starts.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <span>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/analysis/differentials.h"
#include "core/base/interrupt.h"
#include "core/sampling/mesh/edge_flips.h"
#include "core/sampling/relax/relaxation.h"
#include "core/sampling/start/initial_mesh.h"
#include "tests/paper/start.h"
#include "tests/support/shapes.h"

namespace ccst::paper {
namespace {

constexpr std::int64_t kCount = 1200;
constexpr int kSets = 6;

enum class Connection { kByConstruction, kCrust };

TriangleMesh Torus() { return shapes::Torus(1.0, 0.45, 60, 30); }

// In bins wide enough that pairs in them are many.
std::vector<double> RadialMean(const Start& start) {
  std::vector<SurfacePoint> placed;
  for (std::int32_t i = 0; i < start.samples.count(); ++i) {
    placed.push_back(start.surface.ClosestOnFace(start.samples.face[i], start.samples.position[i]));
  }
  analysis::Differentials differentials(kCount);
  differentials.AddSurface(start.surface, start.density, placed);
  return differentials.RadialMean(0.1).y;
}

// The radial mean of one run; empty where Crust gives no start.
std::vector<double> Converge(Points points, Connection connection, std::uint64_t seed) {
  Start start = *DrawStart(Torus(), kCount, seed, points);
  Interrupt never;
  SampleMesh mesh;
  if (connection == Connection::kByConstruction) {
    mesh = *BuildInitialMesh(start.surface, start.plan, start.samples, &never);
  } else {
    const CrustOutcome crust = *RunCrust(start, {});
    EXPECT_TRUE(crust.usable) << "seed " << seed;
    if (!crust.usable) return {};
    mesh.SetTriangles(static_cast<std::int32_t>(kCount), crust.triangles);
    internal::EdgeFlips(&mesh, &start.samples.position, &start.samples.normal).FlipAll();
  }
  SamplingOptions options;
  options.sample_count = kCount;
  internal::Relaxation relaxation(&start.surface, &start.density, &start.plan, options, {}, &never,
                                  Interrupt::Clock::duration::zero(), &mesh, &start.samples);
  const auto report = relaxation.Run();
  EXPECT_TRUE(report.ok()) << report.status();
  return RadialMean(start);
}

using Curves = std::vector<std::vector<double>>;

std::vector<double> Mean(const Curves& curves) {
  std::vector<double> mean(curves.front().size(), 0.0);
  for (const std::vector<double>& curve : curves) {
    for (std::size_t i = 0; i < mean.size(); ++i) {
      mean[i] += curve[i] / static_cast<double>(curves.size());
    }
  }
  return mean;
}

// Variance of the groups' means over that which the spread within the groups makes them have, over
// all bins: what an analysis of variance calls F.
double VarianceRatio(std::span<const Curves> groups) {
  Curves means;
  double within = 0.0;
  for (const Curves& group : groups) {
    means.push_back(Mean(group));
    for (const std::vector<double>& curve : group) {
      for (std::size_t i = 0; i < curve.size(); ++i) {
        within += (curve[i] - means.back()[i]) * (curve[i] - means.back()[i]);
      }
    }
  }
  const std::vector<double> all = Mean(means);
  double between = 0.0;
  for (const std::vector<double>& mean : means) {
    for (std::size_t i = 0; i < all.size(); ++i) {
      between += kSets * (mean[i] - all[i]) * (mean[i] - all[i]);
    }
  }
  const auto count = static_cast<double>(groups.size());
  return (between / (count - 1.0)) / (within / (count * (kSets - 1.0)));
}

// Seeds of their own for every group, so that all runs are independent.
Curves ConvergeAll(Points points, Connection connection, std::uint64_t first_seed) {
  Curves curves;
  for (std::uint64_t set = 0; set < kSets; ++set) {
    curves.push_back(Converge(points, connection, first_seed + set));
    if (curves.back().empty()) return {};
  }
  return curves;
}

TEST(Starts, CurvesDifferAsThoseOfSeedsDo) {
  const std::vector<Curves> groups = {
      ConvergeAll(Points::kWhite, Connection::kByConstruction, 1),
      ConvergeAll(Points::kWhite, Connection::kByConstruction, 101),
      ConvergeAll(Points::kWhite, Connection::kCrust, 201),
      ConvergeAll(Points::kStrata, Connection::kByConstruction, 301)};
  for (const Curves& group : groups) ASSERT_FALSE(group.empty());
  const double seeds = VarianceRatio(std::span(groups).first(2));
  const double starts = VarianceRatio(std::span(groups).last(3));
  std::printf("variance ratio: %.2f of two groups of seeds, %.2f of three starts\n", seeds, starts);
  // F is 1 where nothing but the seed matters. Most of the variance is in about ten bins around the
  // first two peaks, so F of three groups has about 2 x 10 degrees of freedom over 15 x 10: a
  // deviation of sqrt(2 / 20 + 2 / 150) = 0.34, and of two groups 0.46. Four of them.
  EXPECT_LT(seeds, 1.0 + 4.0 * 0.46);
  EXPECT_LT(starts, 1.0 + 4.0 * 0.34);
}

// Four times as dense on one side: samples move by local differences, so what is uneven on the
// largest scale goes last, and the relaxation ends before all of it is gone. The sampler never
// starts so; tests/paper/README.md says what it does to the paper's claim.
TEST(Starts, UnevenStartLeavesALowerFirstPeak) {
  const std::vector<Curves> groups = {
      ConvergeAll(Points::kWhite, Connection::kByConstruction, 1),
      ConvergeAll(Points::kUneven, Connection::kByConstruction, 401)};
  const std::vector<double> white = Mean(groups[0]);
  const std::vector<double> uneven = Mean(groups[1]);
  const double share = *std::max_element(uneven.begin(), uneven.end()) /
                       *std::max_element(white.begin(), white.end());
  std::printf("variance ratio: %.2f, first peak %.3f of that of white noise\n",
              VarianceRatio(groups), share);
  EXPECT_GT(share, 0.85);
  EXPECT_LT(share, 1.05);
}

// The same measure tells two kinds of blue noise apart.
TEST(Starts, CurvesOfSampleEliminationDifferFromThoseOfCcst) {
  std::vector<Curves> groups(2);
  for (std::uint64_t set = 1; set <= kSets; ++set) {
    groups[0].push_back(Converge(Points::kWhite, Connection::kByConstruction, set));
    groups[1].push_back(RadialMean(*DrawStart(Torus(), kCount, set, Points::kEven)));
  }
  EXPECT_GT(VarianceRatio(groups), 10.0);
}

}  // namespace
}  // namespace ccst::paper
