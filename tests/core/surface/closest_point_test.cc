#include "core/surface/closest_point.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/random/random.h"
#include "core/surface/surface.h"
#include "tests/support/shapes.h"

namespace ccst {
namespace {

Eigen::Vector3d RandomPoint(const CounterRandom& random, int i, double size) {
  return size * Eigen::Vector3d(random.Uniform(3 * i) - 0.5, random.Uniform(3 * i + 1) - 0.5,
                                random.Uniform(3 * i + 2) - 0.5);
}

void ExpectWeights(const Eigen::Vector3d& w) {
  EXPECT_GE(w.minCoeff(), 0.0);
  EXPECT_NEAR(w.sum(), 1.0, 1e-12);
}

TEST(ClosestWeights, NoPointOfADenseGridIsNearer) {
  const CounterRandom random(1, 1);
  constexpr int kGrid = 60;
  for (int trial = 0; trial < 100; ++trial) {
    const Eigen::Vector3d a = RandomPoint(random, 4 * trial, 1.0);
    const Eigen::Vector3d b = RandomPoint(random, 4 * trial + 1, 1.0);
    const Eigen::Vector3d c = RandomPoint(random, 4 * trial + 2, 1.0);
    const Eigen::Vector3d p = RandomPoint(random, 4 * trial + 3, 3.0);
    const Eigen::Vector3d w = ClosestWeights(p, a, b, c);
    ExpectWeights(w);
    const double found = (w[0] * a + w[1] * b + w[2] * c - p).norm();
    double least = 1e9;
    for (int i = 0; i <= kGrid; ++i) {
      for (int j = 0; i + j <= kGrid; ++j) {
        const Eigen::Vector3d q = (i * a + j * b + (kGrid - i - j) * c) / kGrid;
        least = std::min(least, (q - p).norm());
      }
    }
    EXPECT_LE(found, least + 1e-12);
    // The grid is at most a cell away from the closest point.
    EXPECT_GE(found, least - 2.0 / kGrid);
  }
}

TEST(ClosestWeights, DegenerateTrianglesGiveTheirClosestPoint) {
  const Eigen::Vector3d a(0, 0, 0);
  const Eigen::Vector3d b(1, 0, 0);
  const Eigen::Vector3d c(2, 0, 0);
  for (const Eigen::Vector3d& p : {Eigen::Vector3d(1.5, 1, 0), Eigen::Vector3d(-1, 0, 0),
                                   Eigen::Vector3d(3, 1, 1), Eigen::Vector3d(0.25, 0, 2)}) {
    const Eigen::Vector3d w = ClosestWeights(p, a, b, c);
    ExpectWeights(w);
    const double x = std::min(2.0, std::max(0.0, p.x()));
    EXPECT_NEAR((w[1] * b + w[2] * c - p).norm(), (Eigen::Vector3d(x, 0, 0) - p).norm(), 1e-12);
  }
  ExpectWeights(ClosestWeights({1, 2, 3}, a, a, a));
}

TEST(Surface, ClosestOnFaceAgreesWithDenseSampling) {
  const Surface surface = *Surface::Build(shapes::Icosphere(1));
  const CounterRandom random(2, 1);
  constexpr int kGrid = 40;
  for (int trial = 0; trial < 200; ++trial) {
    const int f = static_cast<int>(random.Bits(100000 + trial) % surface.face_count());
    const Eigen::Vector3d target = RandomPoint(random, trial, 2.0);
    const SurfacePoint point = surface.ClosestOnFace(f, target);
    EXPECT_EQ(point.face, f);
    ExpectWeights(point.weights);
    const Eigen::Vector3i& corner = surface.faces()[f];
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    for (int k = 0; k < 3; ++k) position += point.weights[k] * surface.positions()[corner[k]];
    EXPECT_LT((position - point.position).norm(), 1e-14);
    for (int i = 0; i <= kGrid; ++i) {
      for (int j = 0; i + j <= kGrid; ++j) {
        const Eigen::Vector3d q =
            (i * surface.positions()[corner[0]] + j * surface.positions()[corner[1]] +
             (kGrid - i - j) * surface.positions()[corner[2]]) /
            kGrid;
        EXPECT_LE((point.position - target).norm(), (q - target).norm() + 1e-12);
      }
    }
  }
}

}  // namespace
}  // namespace ccst
