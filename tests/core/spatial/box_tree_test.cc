#include "core/spatial/box_tree.h"

#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "core/random/random.h"
#include "tests/core/spatial/random_points.h"

namespace ccst {
namespace {

using spatial_test::RandomPoints;

std::vector<std::int32_t> Within(const BoxTree& tree, const Eigen::Vector3d& center,
                                 double radius) {
  std::vector<std::int32_t> found;
  tree.ForEachWithin(center, radius, [&](std::int32_t i, double) { found.push_back(i); });
  return found;
}

TEST(BoxTree, FindsWhatBruteForceFinds) {
  const CounterRandom random(2, 1);
  BoxTree tree;
  // Grows and shrinks across the sizes at which levels come and go.
  for (const int count : {1, 8, 9, 64, 65, 1000, 513, 7}) {
    const std::vector<Eigen::Vector3d> points = RandomPoints(count);
    tree.Build(points);
    for (int q = 0; q < 100; ++q) {
      const Eigen::Vector3d center(3.0 * random.Uniform(4 * q) - 1.0, random.Uniform(4 * q + 1),
                                   random.Uniform(4 * q + 2));
      const double radius = random.Uniform(4 * q + 3);
      std::vector<std::int32_t> expected;
      for (int i = 0; i < count; ++i) {
        if ((points[i] - center).squaredNorm() < radius * radius) expected.push_back(i);
      }
      ASSERT_EQ(Within(tree, center, radius), expected) << count << " points, query " << q;
    }
  }
}

TEST(BoxTree, RunsHoldAllPairsOfNearPoints) {
  constexpr double kRadius = 0.1;
  for (const int count : {1, 8, 9, 65, 1000}) {
    const std::vector<Eigen::Vector3d> points = RandomPoints(count);
    BoxTree tree;
    tree.Build(points);
    std::vector<std::vector<bool>> seen(tree.run_count(), std::vector<bool>(tree.run_count()));
    for (std::size_t run = 0; run < tree.run_count(); ++run) {
      tree.ForEachRunWithin(run, kRadius, [&](std::size_t other) {
        EXPECT_GE(other, run);
        seen[run][other] = true;
      });
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
      for (std::size_t j = i; j < points.size(); ++j) {
        if ((points[i] - points[j]).norm() >= kRadius) continue;
        EXPECT_TRUE(seen[i / BoxTree::kRun][j / BoxTree::kRun]) << i << ", " << j;
      }
    }
  }
}

TEST(BoxTree, GivesSquaredDistances) {
  const std::vector<Eigen::Vector3d> points = {{1, 0, 0}, {0, 2, 0}, {0, 0, 3}};
  BoxTree tree;
  tree.Build(points);
  std::vector<double> squared;
  tree.ForEachWithin({0, 0, 0}, 2.5, [&](std::int32_t, double d) { squared.push_back(d); });
  EXPECT_EQ(squared, (std::vector<double>{1.0, 4.0}));
}

TEST(BoxTree, TheRadiusItselfIsOutside) {
  const std::vector<Eigen::Vector3d> points = {{1, 0, 0}, {1, 0, 0}};
  BoxTree tree;
  tree.Build(points);
  EXPECT_TRUE(Within(tree, {0, 0, 0}, 1.0).empty());
  EXPECT_EQ(Within(tree, {1, 0, 0}, 1e-9).size(), 2u);
  EXPECT_TRUE(Within(tree, {1, 0, 0}, 0.0).empty());
}

TEST(BoxTree, EmptyTreeFindsNothing) {
  const std::vector<Eigen::Vector3d> none;
  BoxTree tree;
  EXPECT_TRUE(Within(tree, {0, 0, 0}, 1.0).empty());
  tree.Build(none);
  EXPECT_TRUE(Within(tree, {0, 0, 0}, 1.0).empty());
}

}  // namespace
}  // namespace ccst
