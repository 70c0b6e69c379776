#include "core/surface/projection.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/random/random.h"
#include "core/surface/surface.h"
#include "tests/support/shapes.h"

namespace ccst {
namespace {

constexpr double kSpacing = 0.02;

TEST(Projection, SmallMovesAreFollowed) {
  const Surface surface = *Surface::Build(shapes::Torus(1, 0.35, 120, 60));
  const Parallel parallel;
  Projection projection(&surface, kSpacing, &parallel);
  for (int f = 0; f < surface.face_count(); f += 17) {
    const Eigen::Vector3d& a = surface.positions()[surface.faces()[f][0]];
    const Eigen::Vector3d target = a + 0.001 * surface.normals()[surface.faces()[f][0]];
    const SurfacePoint followed = surface.Follow(f, target);
    const SurfacePoint point = projection.Project(
        f, target, surface.NormalAt(f, Eigen::Vector3d::Constant(1.0 / 3.0)), 0.01);
    EXPECT_EQ(point.face, followed.face);
    EXPECT_EQ(point.position, followed.position);
  }
}

TEST(Projection, NeverEndsFartherThanFollowing) {
  const Surface surface = *Surface::Build(shapes::PlateWithHoles(2, 2));
  const Parallel parallel;
  Projection projection(&surface, kSpacing, &parallel);
  const CounterRandom random(1, 3);
  for (int i = 0; i < 1000; ++i) {
    const int f = static_cast<int>(random.Bits(4 * i) % surface.face_count());
    const Eigen::Vector3d target(random.Uniform(4 * i + 1) - 0.5, random.Uniform(4 * i + 2) - 0.5,
                                 0.3 * (random.Uniform(4 * i + 3) - 0.5));
    const Eigen::Vector3d normal = surface.NormalAt(f, Eigen::Vector3d::Constant(1.0 / 3.0));
    const SurfacePoint point = projection.Project(f, target, normal, 0.01);
    EXPECT_LE((point.position - target).norm(),
              (surface.Follow(f, target).position - target).norm());
    EXPECT_NEAR(point.weights.sum(), 1.0, 1e-12);
    EXPECT_GE(point.weights.minCoeff(), 0.0);
  }
}

TEST(Projection, NeverTakesAnotherSheet) {
  const double gap = 0.01;
  const std::vector<TriangleMesh> sheets = {
      shapes::PlaneGrid(1, 1, 12, 12), shapes::Moved(shapes::PlaneGrid(1, 1, 12, 12), {0, 0, gap})};
  const Surface surface = *Surface::Build(shapes::DisjointUnion(sheets));
  const Parallel parallel;
  Projection projection(&surface, kSpacing, &parallel);
  const CounterRandom random(8, 8);
  for (int i = 0; i < 300; ++i) {
    const int f = static_cast<int>(random.Bits(3 * i) % surface.face_count());
    const Eigen::Vector3d in_mesh(random.Uniform(3 * i + 1), random.Uniform(3 * i + 2),
                                  surface.face_components()[f] == 0 ? gap : 0.0);
    const Eigen::Vector3d target = (in_mesh - surface.ToMesh({0, 0, 0})) / surface.unit();
    // No tolerance: the search is always made.
    const SurfacePoint point = projection.Project(f, target, Eigen::Vector3d::UnitZ(), 0.0);
    EXPECT_EQ(surface.face_components()[point.face], surface.face_components()[f]);
  }
}

}  // namespace
}  // namespace ccst
