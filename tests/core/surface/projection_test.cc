#include "core/surface/projection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
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

// The same by making all dense points and looking at each.
SurfacePoint ProjectByBruteForce(const Surface& surface, double spacing, std::int32_t face,
                                 const Eigen::Vector3d& target, const Eigen::Vector3d& normal) {
  std::vector<std::tuple<double, std::size_t, std::int32_t>> found;  // Distance, number, face.
  for (std::int32_t f = 0; f < surface.face_count(); ++f) {
    std::array<Eigen::Vector3d, 3> corner;
    for (int k = 0; k < 3; ++k) corner[k] = surface.positions()[surface.faces()[f][k]];
    double longest = 0.0;
    for (int k = 0; k < 3; ++k) {
      longest = std::max(longest, (corner[(k + 1) % 3] - corner[k]).norm());
    }
    const int rows = static_cast<int>(std::clamp(longest / spacing, 1.0, 64.0));
    for (int i = 0; i < rows; ++i) {
      for (int j = 0; i + j < rows; ++j) {
        const double u = (i + 1.0 / 3.0) / rows;
        const double v = (j + 1.0 / 3.0) / rows;
        const Eigen::Vector3d place = (1.0 - u - v) * corner[0] + u * corner[1] + v * corner[2];
        found.emplace_back((place - target).squaredNorm(), found.size(), f);
      }
    }
  }
  std::sort(found.begin(), found.end());
  SurfacePoint best = surface.Follow(face, target);
  const SurfacePoint host = surface.ClosestOnFace(face, best.position);
  for (std::size_t i = 0; i < std::min<std::size_t>(8, found.size()); ++i) {
    const SurfacePoint point = surface.Follow(std::get<2>(found[i]), target);
    if ((point.position - target).norm() >= (best.position - target).norm() ||
        surface.NormalAt(point.face, point.weights).dot(normal) <= 0.0 ||
        (surface.Follow(point.face, host.position).position - host.position).norm() > 1e-9) {
      continue;
    }
    best = point;
  }
  return best;
}

TEST(Projection, FindsWhatALookAtEveryDensePointFinds) {
  TriangleMesh needles = shapes::UvSphere(3, 60);
  for (Eigen::Vector3d& p : needles.positions) p.z() *= 8.0;
  for (const TriangleMesh& mesh : {needles, shapes::PlateWithHoles(2, 1), shapes::Cube()}) {
    const Surface surface = *Surface::Build(mesh);
    const Parallel parallel;
    for (const double spacing : {0.3, 0.04}) {
      Projection projection(&surface, spacing, &parallel);
      const CounterRandom random(5, 9);
      for (int i = 0; i < 60; ++i) {
        const auto face = static_cast<std::int32_t>(random.Bits(4 * i) % surface.face_count());
        const Eigen::Vector3d target(random.Uniform(4 * i + 1) - 0.5,
                                     random.Uniform(4 * i + 2) - 0.5,
                                     random.Uniform(4 * i + 3) - 0.5);
        const Eigen::Vector3d normal = surface.NormalAt(face, Eigen::Vector3d::Constant(1.0 / 3.0));
        const SurfacePoint point = projection.Project(face, target, normal, 0.0);
        const SurfacePoint wanted = ProjectByBruteForce(surface, spacing, face, target, normal);
        EXPECT_EQ(point.face, wanted.face);
        EXPECT_EQ(point.position, wanted.position);
      }
    }
  }
}

}  // namespace
}  // namespace ccst
