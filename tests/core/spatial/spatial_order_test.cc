#include "core/spatial/spatial_order.h"

#include <algorithm>
#include <numeric>
#include <stop_token>

#include <gtest/gtest.h>

#include "core/random/random.h"
#include "tests/core/spatial/random_points.h"

namespace ccst {
namespace {

using spatial_test::RandomPoints;

TEST(HilbertOrder, IsAPermutationAlongWhichStepsAreShort) {
  const std::vector<Eigen::Vector3d> points = RandomPoints(20000, -0.5);
  Interrupt never;
  std::vector<std::int32_t> order = HilbertOrder(points, &never);
  double steps = 0.0;
  for (std::size_t k = 1; k < order.size(); ++k) {
    steps += (points[order[k]] - points[order[k - 1]]).norm();
  }
  // The mean distance of points in a cube is 0.66, the edge of a cube a point 20000^(-1/3) = 0.037.
  EXPECT_LE(steps / 20000.0, 2.0 * 0.037);
  std::sort(order.begin(), order.end());
  std::vector<std::int32_t> all(points.size());
  std::iota(all.begin(), all.end(), 0);
  EXPECT_EQ(order, all);
}

TEST(HilbertOrder, EqualPointsKeepTheirOrder) {
  const std::vector<Eigen::Vector3d> points(100, Eigen::Vector3d(0.1, 0.2, 0.3));
  Interrupt never;
  const std::vector<std::int32_t> order = HilbertOrder(points, &never);
  EXPECT_TRUE(std::is_sorted(order.begin(), order.end()));
  EXPECT_EQ(order.size(), 100u);
}

TEST(HilbertOrder, PointsOutsideAndOnTheBorderAreTaken) {
  const std::vector<Eigen::Vector3d> points = {
      {0.5, 0.5, 0.5}, {-0.5, -0.5, -0.5}, {9.0, -9.0, 1e300}};
  Interrupt never;
  EXPECT_EQ(HilbertOrder(points, &never).size(), 3u);
}

TEST(HilbertOrder, EndsWhenStopped) {
  std::stop_source stop;
  stop.request_stop();
  Interrupt interrupt(stop.get_token());
  EXPECT_TRUE(HilbertOrder(RandomPoints(10, -0.5), &interrupt).empty());
}

TEST(HilbertOrder, ThreadsGiveTheSameOrder) {
  const std::vector<Eigen::Vector3d> points = RandomPoints(30000, -0.5);
  Interrupt never;
  const std::vector<std::int32_t> order = HilbertOrder(points, &never);
  for (const int threads : {2, 3, 8}) {
    EXPECT_EQ(HilbertOrder(points, &never, Parallel(threads)), order);
  }
}

}  // namespace
}  // namespace ccst
