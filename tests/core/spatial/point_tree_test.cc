#include "core/spatial/point_tree.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/random/random.h"
#include "tests/core/spatial/random_points.h"

namespace ccst {
namespace {

using spatial_test::RandomPoints;

std::vector<std::int32_t> NearestByHand(const std::vector<Eigen::Vector3d>& points,
                                        const Eigen::Vector3d& query, std::size_t count) {
  std::vector<std::pair<double, std::int32_t>> order;
  for (std::size_t i = 0; i < points.size(); ++i) {
    order.emplace_back((points[i] - query).squaredNorm(), static_cast<std::int32_t>(i));
  }
  std::sort(order.begin(), order.end());
  order.resize(std::min(order.size(), count));
  std::vector<std::int32_t> nearest;
  for (const auto& [distance, index] : order) nearest.push_back(index);
  return nearest;
}

TEST(PointTree, AgreesWithBruteForce) {
  const std::vector<Eigen::Vector3d> points = RandomPoints(1000);
  const PointTree tree(points);
  const CounterRandom random(2, 1);
  for (int q = 0; q < 200; ++q) {
    const Eigen::Vector3d query(3.0 * random.Uniform(3 * q) - 1.0, random.Uniform(3 * q + 1),
                                random.Uniform(3 * q + 2));
    for (const int count : {1, 2, 7, 40}) {
      ASSERT_EQ(tree.Nearest(query, count), NearestByHand(points, query, count));
    }
  }
}

TEST(PointTree, DoublePointsComeByIndex) {
  std::vector<Eigen::Vector3d> points = RandomPoints(100);
  points.insert(points.end(), points.begin(), points.end());
  const PointTree tree(points);
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(tree.Nearest(points[i], 2), (std::vector<std::int32_t>{i, i + 100}));
    EXPECT_EQ(tree.Nearest(points[i], 1), std::vector<std::int32_t>{i});
  }
}

// On a lattice many points are equally far: whichever the count cuts off, indices decide.
TEST(PointTree, ManyEqualDistancesAreBrokenByIndex) {
  std::vector<Eigen::Vector3d> points;
  for (int x = 0; x < 8; ++x) {
    for (int y = 0; y < 8; ++y) {
      for (int z = 0; z < 8; ++z) points.emplace_back(x, y, z);
    }
  }
  // Indices must not agree with the order in space.
  const CounterRandom random(3, 1);
  for (std::size_t i = points.size() - 1; i > 0; --i) {
    std::swap(points[i], points[random.Bits(i) % (i + 1)]);
  }
  const PointTree tree(points);
  for (const Eigen::Vector3d& query :
       {Eigen::Vector3d(3, 3, 3), Eigen::Vector3d(3.5, 3.5, 3.5), Eigen::Vector3d(3.5, 4, 4),
        Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(-5, 3.5, 3.5)}) {
    for (int count = 1; count <= 40; ++count) {
      ASSERT_EQ(tree.Nearest(query, count), NearestByHand(points, query, count))
          << query.transpose() << ", count " << count;
    }
  }
}

// Many times the points of one tree, in an order that has nothing to do with space: the answer is
// spread over all trees.
TEST(PointTree, ManyPointsInAnyOrderAgreeWithBruteForce) {
  std::vector<Eigen::Vector3d> points = RandomPoints(170'000);
  // Double, far apart in memory.
  for (std::size_t i = 0; i < 1000; ++i) points[points.size() - 1 - 3 * i] = points[i];
  const PointTree tree(points);
  const CounterRandom random(2, 1);
  for (int q = 0; q < 25; ++q) {
    const Eigen::Vector3d query(3.0 * random.Uniform(3 * q) - 1.0, random.Uniform(3 * q + 1),
                                random.Uniform(3 * q + 2));
    ASSERT_EQ(tree.Nearest(query, 9), NearestByHand(points, query, 9));
    ASSERT_EQ(tree.Nearest(points[q], 1), std::vector<std::int32_t>{q});
    ASSERT_EQ(tree.Nearest(points[q], 2), NearestByHand(points, points[q], 2));
  }
}

TEST(PointTree, AnswersAreTheSameOnAnyNumberOfThreads) {
  const std::vector<Eigen::Vector3d> points = RandomPoints(170'000);
  const PointTree one(points);
  const CounterRandom random(4, 1);
  for (const int threads : {2, 3, 8}) {
    const PointTree several(points, Parallel(threads));
    for (int q = 0; q < 1000; ++q) {
      const Eigen::Vector3d query(random.Uniform(3 * q), random.Uniform(3 * q + 1),
                                  random.Uniform(3 * q + 2));
      ASSERT_EQ(several.Nearest(query, 8), one.Nearest(query, 8)) << threads << " threads";
    }
  }
}

TEST(PointTree, FewerPointsThanAskedForAreAllReturned) {
  const std::vector<Eigen::Vector3d> points = {{0, 0, 0}, {2, 0, 0}, {1, 0, 0}};
  const PointTree tree(points);
  EXPECT_EQ(tree.Nearest({0, 0, 0}, 10), (std::vector<std::int32_t>{0, 2, 1}));
  EXPECT_EQ(tree.Nearest({0, 0, 0}, std::numeric_limits<int>::max()).size(), 3u);
  EXPECT_TRUE(tree.Nearest({0, 0, 0}, 0).empty());
}

TEST(PointTree, EmptyTreeFindsNothing) {
  const std::vector<Eigen::Vector3d> none;
  EXPECT_TRUE(PointTree(none).Nearest({0, 0, 0}, 3).empty());
}

}  // namespace
}  // namespace ccst
