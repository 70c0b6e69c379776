#include "core/quality/distances.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <stop_token>
#include <vector>

#include <gtest/gtest.h>

namespace ccst::quality {
namespace {

std::vector<Eigen::Vector3d> RandomPoints(int count, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::vector<Eigen::Vector3d> points(count);
  for (Eigen::Vector3d& p : points) {
    for (double& x : p) x = uniform(random);
  }
  return points;
}

struct Reference {
  double smallest = std::numeric_limits<double>::infinity();
  double smallest_same_side = std::numeric_limits<double>::infinity();
  double mean_nearest = 0.0;
};

Reference BruteForce(const std::vector<Eigen::Vector3d>& points,
                     const std::vector<Eigen::Vector3d>& normals, const Eigen::Vector3d& box) {
  Reference reference;
  for (std::size_t i = 0; i < points.size(); ++i) {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t j = 0; j < points.size(); ++j) {
      if (i == j) continue;
      Eigen::Vector3d d = (points[j] - points[i]).cwiseAbs();
      for (int axis = 0; axis < 3; ++axis) {
        if (box[axis] > 0.0) d[axis] = std::min(d[axis], box[axis] - d[axis]);
      }
      nearest = std::min(nearest, d.norm());
      if (normals[i].dot(normals[j]) > 0.0) {
        reference.smallest_same_side = std::min(reference.smallest_same_side, d.norm());
      }
    }
    reference.smallest = std::min(reference.smallest, nearest);
    reference.mean_nearest += nearest / static_cast<double>(points.size());
  }
  return reference;
}

TEST(Distances, HexagonalLatticeOnTorusHasRadiusOne) {
  const int rows = 20, columns = 20;
  std::vector<Eigen::Vector3d> points;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      points.emplace_back(column + 0.5 * (row % 2), row * std::sqrt(0.75), 0.0);
    }
  }
  const Eigen::Vector3d box(columns, rows * std::sqrt(0.75), 0.0);
  const DistanceFigures figures = MeasureDistances(points, {}, box.x() * box.y(), box);
  EXPECT_NEAR(figures.r_max, 1.0, 1e-12);
  EXPECT_NEAR(figures.relative_radius, 1.0, 1e-12);
  EXPECT_NEAR(figures.mean_nearest_distance, 1.0, 1e-12);
}

class DistancesAgainstBruteForce : public testing::TestWithParam<int> {};

TEST_P(DistancesAgainstBruteForce, Agree) {
  const auto seed = static_cast<std::uint32_t>(GetParam());
  const std::vector<Eigen::Vector3d> points = RandomPoints(300, seed);
  std::vector<Eigen::Vector3d> normals = RandomPoints(300, seed + 100);
  for (Eigen::Vector3d& n : normals) n = (n.array() - 0.5).matrix().normalized();
  for (const Eigen::Vector3d& box :
       {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, 1, 0), Eigen::Vector3d(1, 1, 1)}) {
    const Reference expected = BruteForce(points, normals, box);
    const DistanceFigures figures = MeasureDistances(points, normals, 7.0, box);
    EXPECT_NEAR(figures.closest.distance, expected.smallest, 1e-12);
    EXPECT_NEAR(figures.closest_same_side.distance, expected.smallest_same_side, 1e-12);
    EXPECT_NEAR(figures.mean_nearest_distance * figures.r_max, expected.mean_nearest, 1e-12);
    EXPECT_LT(figures.closest.first, figures.closest.second);
    if (box.isZero()) {
      EXPECT_NEAR(
          (points[figures.closest_same_side.first] - points[figures.closest_same_side.second])
              .norm(),
          expected.smallest_same_side, 1e-12);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, DistancesAgainstBruteForce, testing::Range(0, 5));

TEST(Distances, OppositeSidesOfAThinSheetDoNotCount) {
  std::vector<Eigen::Vector3d> points, normals;
  for (int i = 0; i < 10; ++i) {
    for (const double side : {-1.0, 1.0}) {
      points.emplace_back(i, 0.0, 0.001 * side);
      normals.emplace_back(0.0, 0.0, side);
    }
  }
  const DistanceFigures figures = MeasureDistances(points, normals, 20.0);
  EXPECT_NEAR(figures.closest.distance, 0.002, 1e-12);
  EXPECT_NEAR(figures.closest_same_side.distance, 1.0, 1e-12);
}

TEST(Distances, NormalsAtRightAnglesAreDifferentSides) {
  const std::vector<Eigen::Vector3d> points = {{0, 0, 0}, {1, 0, 0}};
  const std::vector<Eigen::Vector3d> normals = {{0, 0, 1}, {1, 0, 0}};
  const DistanceFigures figures = MeasureDistances(points, normals, 1.0);
  EXPECT_EQ(figures.closest_same_side.first, -1);
  EXPECT_EQ(figures.relative_radius_same_side, 0.0);
  EXPECT_GT(figures.relative_radius, 0.0);
}

TEST(Distances, EqualPointsAreAtDistanceZero) {
  const std::vector<Eigen::Vector3d> points(100, Eigen::Vector3d(1, 2, 3));
  const DistanceFigures figures = MeasureDistances(points, {}, 1.0);
  EXPECT_EQ(figures.closest.distance, 0.0);
  EXPECT_GE(figures.closest.first, 0);
  EXPECT_EQ(figures.mean_nearest_distance, 0.0);
}

TEST(Distances, StopEndsTheSearchForTheClosestPair) {
  const std::vector<Eigen::Vector3d> points = {{0, 0, 0}, {1, 0, 0}, {1.5, 0, 0}};
  Interrupt never;
  EXPECT_EQ(FindClosestSameSide(points, {}, {}, &never).distance, 0.5);
  std::stop_source stop;
  stop.request_stop();
  Interrupt interrupt(stop.get_token());
  EXPECT_EQ(FindClosestSameSide(points, {}, {}, &interrupt).first, -1);
}

TEST(Distances, FewerThanTwoPointsHaveNoPair) {
  EXPECT_EQ(MeasureDistances({}, {}, 1.0).closest.first, -1);
  const std::vector<Eigen::Vector3d> one = {{0, 0, 0}};
  const DistanceFigures figures = MeasureDistances(one, {}, 1.0);
  EXPECT_EQ(figures.closest.first, -1);
  EXPECT_EQ(figures.mean_nearest_distance, 0.0);
  EXPECT_GT(figures.r_max, 0.0);
}

TEST(Distances, ThreadsGiveTheSameBits) {
  const std::vector<Eigen::Vector3d> points = RandomPoints(20000, 9);
  std::vector<Eigen::Vector3d> normals;
  std::vector<double> scales;
  for (const Eigen::Vector3d& p : RandomPoints(20000, 10)) {
    normals.push_back((p - Eigen::Vector3d::Constant(0.5)).normalized());
    scales.push_back(1.0 + p.x());
  }
  const DistanceFigures base =
      MeasureDistances(points, normals, 1.0, Eigen::Vector3d::Zero(), scales);
  for (const int threads : {2, 3, 8}) {
    const DistanceFigures other =
        MeasureDistances(points, normals, 1.0, Eigen::Vector3d::Zero(), scales, Parallel(threads));
    EXPECT_EQ(other.nearest, base.nearest);
    EXPECT_EQ(other.mean_nearest_distance, base.mean_nearest_distance);
    EXPECT_EQ(other.closest.first, base.closest.first);
    EXPECT_EQ(other.closest_same_side.first, base.closest_same_side.first);
    EXPECT_EQ(other.closest_same_side.second, base.closest_same_side.second);
    EXPECT_EQ(other.closest_same_side.distance, base.closest_same_side.distance);
  }
}

TEST(FindClosestSameSide, AgreesWithAllPairs) {
  const std::vector<Eigen::Vector3d> points = RandomPoints(600, 3);
  std::vector<Eigen::Vector3d> normals;
  std::vector<double> scales;
  for (const Eigen::Vector3d& p : RandomPoints(600, 4)) {
    normals.push_back((p - Eigen::Vector3d::Constant(0.5)).normalized());
    scales.push_back(0.5 + p.y());
  }
  SamplePair expected;
  for (std::int32_t i = 0; i < 600; ++i) {
    for (std::int32_t j = i + 1; j < 600; ++j) {
      if (normals[i].dot(normals[j]) <= 0.0) continue;
      const double distance = (points[i] - points[j]).norm() / (0.5 * (scales[i] + scales[j]));
      if (expected.first < 0 || distance < expected.distance) expected = {i, j, distance};
    }
  }
  const SamplePair found = FindClosestSameSide(points, normals, scales);
  EXPECT_EQ(found.first, expected.first);
  EXPECT_EQ(found.second, expected.second);
  EXPECT_NEAR(found.distance, expected.distance, 1e-15);
}

TEST(FindClosestSameSide, EqualDistancesGoToTheSmallerIndices) {
  std::vector<Eigen::Vector3d> points;
  for (int i = 99; i >= 0; --i) points.emplace_back(i % 10, i / 10, 0.0);
  for (const int threads : {1, 2, 3, 8}) {
    const SamplePair pair = FindClosestSameSide(points, {}, {}, nullptr, Parallel(threads));
    EXPECT_EQ(pair.first, 0);
    EXPECT_EQ(pair.second, 1);
    EXPECT_EQ(pair.distance, 1.0);
  }
  points.assign(50, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(FindClosestSameSide(points, {}).second, 1);
}

TEST(FindClosestSameSide, WithoutAPairThereIsNone) {
  EXPECT_EQ(FindClosestSameSide({}, {}).first, -1);
  const std::vector<Eigen::Vector3d> points = {{0, 0, 0}, {1, 0, 0}};
  const std::vector<Eigen::Vector3d> normals = {{0, 0, 1}, {0, 0, -1}};
  EXPECT_EQ(FindClosestSameSide(points, normals).first, -1);
}

}  // namespace
}  // namespace ccst::quality
