#include "core/sampling/output/progressive_order.h"

#include <algorithm>
#include <cmath>
#include <stop_token>
#include <vector>

#include <gtest/gtest.h>

#include "core/quality/distances.h"
#include "core/sampling/sampling.h"
#include "tests/support/shapes.h"

namespace ccst::internal {
namespace {

// Relative radius, over its own r_max, of the first `count` samples of a run.
double PrefixRadius(const SamplingResult& result, std::size_t count) {
  const std::vector<Eigen::Vector3d> positions(result.samples.positions.begin(),
                                               result.samples.positions.begin() + count);
  const std::vector<Eigen::Vector3d> normals(result.samples.normals.begin(),
                                             result.samples.normals.begin() + count);
  return quality::MeasureDistances(positions, normals, result.surface.area)
      .relative_radius_same_side;
}

TEST(ProgressiveOrder, EveryPrefixIsWellSpread) {
  const std::vector<TriangleMesh> meshes = {shapes::Icosphere(4), shapes::Torus(1, 0.35, 96, 48),
                                            shapes::PlaneGrid(1, 1, 20, 20)};
  for (const TriangleMesh& mesh : meshes) {
    for (std::uint64_t seed = 0; seed < 2; ++seed) {
      SamplingOptions options;
      options.sample_count = 3000;
      options.seed = seed;
      const SamplingResult result = *SampleSurface(mesh, options);
      for (const double share : {0.9, 0.7, 0.5, 0.4, 0.3, 0.25, 0.18, 0.125, 0.06, 0.03}) {
        EXPECT_GE(PrefixRadius(result, static_cast<std::size_t>(3000 * share)), 0.4)
            << "the first " << share << ", seed " << seed;
      }
    }
  }
}

TEST(ProgressiveOrder, IsAPermutation) {
  std::vector<Eigen::Vector3d> positions;
  for (int i = 0; i < 500; ++i) positions.emplace_back(i % 25, i / 25, 0.0);
  positions.push_back(positions.front());  // Two at one place.
  const std::vector<Eigen::Vector3d> normals(positions.size(), Eigen::Vector3d::UnitZ());
  Interrupt never;
  std::vector<std::int32_t> order = ProgressiveOrder(positions, normals, {}, 1.07, 5, &never);
  ASSERT_EQ(order.size(), positions.size());
  std::sort(order.begin(), order.end());
  for (std::size_t i = 0; i < order.size(); ++i) EXPECT_EQ(order[i], static_cast<std::int32_t>(i));
}

// More than are sorted in one go.
TEST(ProgressiveOrder, ManyPointsAreAPermutationToo) {
  std::vector<Eigen::Vector3d> positions;
  for (int i = 0; i < 300'000; ++i) positions.emplace_back(i % 500, i / 500, 0.0);
  const std::vector<Eigen::Vector3d> normals(positions.size(), Eigen::Vector3d::UnitZ());
  Interrupt never;
  std::vector<std::int32_t> order = ProgressiveOrder(positions, normals, {}, 1.07, 5, &never);
  ASSERT_EQ(order.size(), positions.size());
  std::sort(order.begin(), order.end());
  for (std::size_t i = 0; i < order.size(); ++i) ASSERT_EQ(order[i], static_cast<std::int32_t>(i));
}

TEST(ProgressiveOrder, StopLeavesItUnfinished) {
  const std::vector<Eigen::Vector3d> positions(100, Eigen::Vector3d::Zero());
  const std::vector<Eigen::Vector3d> normals(100, Eigen::Vector3d::UnitZ());
  std::stop_source stop;
  stop.request_stop();
  Interrupt interrupt(stop.get_token());
  EXPECT_LT(ProgressiveOrder(positions, normals, {}, 1.0, 0, &interrupt).size(), 100u);
}

TEST(ProgressiveOrder, FewPointsAreAPermutationToo) {
  Interrupt never;
  for (std::size_t n = 1; n < 6; ++n) {
    const std::vector<Eigen::Vector3d> positions(n, Eigen::Vector3d::Zero());
    const std::vector<Eigen::Vector3d> normals(n, Eigen::Vector3d::UnitZ());
    EXPECT_EQ(ProgressiveOrder(positions, normals, {}, 1.0, 0, &never).size(), n);
  }
}

TEST(ProgressiveOrder, ThreadsGiveTheSameOrder) {
  std::vector<Eigen::Vector3d> positions;
  for (int i = 0; i < 40'000; ++i) positions.emplace_back(i % 200, i / 200, 0.0);
  const std::vector<Eigen::Vector3d> normals(positions.size(), Eigen::Vector3d::UnitZ());
  Interrupt never;
  const std::vector<std::int32_t> base = ProgressiveOrder(positions, normals, {}, 1.07, 5, &never);
  for (const int threads : {2, 3, 8}) {
    EXPECT_EQ(ProgressiveOrder(positions, normals, {}, 1.07, 5, &never, Parallel(threads)), base);
  }
}

}  // namespace
}  // namespace ccst::internal
