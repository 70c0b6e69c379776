// On the plane the method is capacity-constrained Delaunay triangulation (Xu et al. 2011). Inside
// a window of a square, away from the boundary, results must agree with it.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include <gtest/gtest.h>

#include "core/quality/capacity.h"
#include "core/quality/distances.h"
#include "core/sampling/sampling.h"
#include "tests/support/shapes.h"

namespace ccst {
namespace {

// What planar CCDT reaches with 1024 samples after 30 alternations, mean of 6 seeds.
constexpr double kRelativeRadius = 0.72;
constexpr double kMeanNearest = 0.88;
constexpr double kCapacityCv = 0.02;
constexpr double kTolerance = 0.03;

// The window holds half the area and, because samples on the boundary have half a cell only, a
// little less than half of the samples.
constexpr std::int64_t kSamples = 2148;
constexpr int kSeeds = 16;

TEST(Planar, AgreesWithCapacityConstrainedDelaunayTriangulation) {
  const TriangleMesh square = shapes::PlaneGrid(1, 1, 100, 100);
  const double margin = 0.5 * (1.0 - std::sqrt(0.5));
  const auto inside = [&](const Eigen::Vector3d& p) {
    return std::min({p.x(), p.y(), 1.0 - p.x(), 1.0 - p.y()}) >= margin;
  };
  const double r_max = quality::HexagonalSpacing(1.0, kSamples);
  double radius = 0.0;
  double nearest_distance = 0.0;
  double cv = 0.0;
  double held = 0.0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    SamplingOptions options;
    options.sample_count = kSamples;
    options.max_iterations = 30;
    options.relative_tolerance = 1e-9;  // Do not end before.
    options.seed = seed;
    const SamplingResult result = *SampleSurface(square, options);
    const std::vector<Eigen::Vector3d>& p = result.samples.positions;
    double least = 1e9;
    double sum = 0.0;
    int count = 0;
    for (std::size_t i = 0; i < p.size(); ++i) {
      if (!inside(p[i])) continue;
      double nearest = 1e9;
      for (std::size_t j = 0; j < p.size(); ++j) {
        if (j != i) nearest = std::min(nearest, (p[i] - p[j]).squaredNorm());
      }
      nearest = std::sqrt(nearest);
      least = std::min(least, nearest);
      sum += nearest;
      ++count;
    }
    std::vector<Eigen::Vector3i> inner;
    for (const Eigen::Vector3i& t : result.samples.triangles) {
      if (inside(p[t[0]]) && inside(p[t[1]]) && inside(p[t[2]])) inner.push_back(t);
    }
    radius += least / r_max / kSeeds;
    nearest_distance += sum / count / r_max / kSeeds;
    cv += quality::MeasureCapacities(p, inner).cv / kSeeds;
    held += static_cast<double>(count) / kSeeds;
  }
  std::printf(
      "planar, %.0f samples in the window, mean of %d seeds: relative radius %.4f, mean nearest "
      "distance %.4f r_max, capacity cv %.4f\n",
      held, kSeeds, radius, nearest_distance, cv);
  EXPECT_NEAR(held, 1024.0, 30.0);
  EXPECT_GE(radius, kRelativeRadius * (1.0 - kTolerance));
  EXPECT_GE(nearest_distance, kMeanNearest * (1.0 - kTolerance));
  EXPECT_LE(nearest_distance, kMeanNearest * (1.0 + kTolerance));
  EXPECT_LE(cv, kCapacityCv * (1.0 + kTolerance));
}

}  // namespace
}  // namespace ccst
