#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "core/quality/triangle_tree.h"
#include "core/random/random.h"
#include "core/surface/frame.h"
#include "core/surface/surface.h"
#include "tests/support/shapes.h"

namespace ccst {
namespace {

// Targets within `reach` along the surface and from `low` to `high` off it, from random points of
// the surface: Follow() from the face of the point must do as well as a search over all faces, up
// to `slack`. Before a dent of the faces, as deep as they leave the smooth surface, several places
// are closest to a target each in its surroundings; so far may the two be apart.
void ExpectAsCloseAsASearch(const TriangleMesh& mesh, double reach, double low, double high,
                            double slack) {
  const Surface surface = *Surface::Build(mesh);
  const quality::TriangleTree tree(surface.positions(), surface.faces());
  const CounterRandom random(6, 6);
  for (int i = 0; i < 3000; ++i) {
    const auto draw = [&](int k) { return random.Uniform(6 * i + k); };
    const int f = static_cast<int>(draw(0) * surface.face_count());
    const double u = draw(1);
    const double v = draw(2) * (1.0 - u);
    const Eigen::Vector3d weights(u, v, 1.0 - u - v);
    Eigen::Vector3d from = Eigen::Vector3d::Zero();
    for (int k = 0; k < 3; ++k) from += weights[k] * surface.positions()[surface.faces()[f][k]];
    const Eigen::Vector3d normal = surface.NormalAt(f, weights);
    Eigen::Vector3d t1;
    Eigen::Vector3d t2;
    TangentFrame(normal, &t1, &t2);
    const double angle = 2.0 * std::numbers::pi * draw(3);
    const Eigen::Vector3d target = from +
                                   draw(4) * reach * (std::cos(angle) * t1 + std::sin(angle) * t2) +
                                   (low + draw(5) * (high - low)) * normal;
    const SurfacePoint point = surface.Follow(f, target);
    ASSERT_GE(point.face, 0);
    ASSERT_GE(point.weights.minCoeff(), 0.0);
    EXPECT_NEAR(point.weights.sum(), 1.0, 1e-12);
    EXPECT_LE((point.position - target).norm(), tree.FindClosest(target).distance + slack + 1e-12);
  }
}

// Largest distance between the faces and the smooth surface, in the unit frame.
double Dent(const TriangleMesh& mesh, double curvature) {
  double longest = 0.0;
  for (const Eigen::Vector3i& f : mesh.faces) {
    for (int k = 0; k < 3; ++k) {
      longest = std::max(longest, (mesh.positions[f[k]] - mesh.positions[f[(k + 1) % 3]]).norm());
    }
  }
  return longest * longest * curvature / 8.0 / Surface::Build(mesh)->unit();
}

TEST(Follow, FindsTheClosestPointOutsideAConvexSurface) {
  ExpectAsCloseAsASearch(shapes::Icosphere(4), 0.2, 0.0, 0.1, 0.0);
}

TEST(Follow, FindsTheClosestPointInsideASphere) {
  const TriangleMesh mesh = shapes::Icosphere(4);
  ExpectAsCloseAsASearch(mesh, 0.1, -0.01, 0.0, Dent(mesh, 1.0));
}

TEST(Follow, FindsTheClosestPointBesideATorus) {
  const TriangleMesh mesh = shapes::Torus(1, 0.35, 120, 60);
  ExpectAsCloseAsASearch(mesh, 0.05, -0.01, 0.01, Dent(mesh, 1.0 / 0.35));
}

TEST(Follow, FindsTheClosestPointBesideASaddle) {
  const TriangleMesh mesh = shapes::Saddle(40);
  ExpectAsCloseAsASearch(mesh, 0.05, -0.01, 0.01, Dent(mesh, 2.0));
}

TEST(Follow, CrossesAPlaneFromAnywhere) {
  const Surface plane = *Surface::Build(shapes::PlaneGrid(1, 1, 30, 30));
  const CounterRandom random(7, 7);
  // The unit frame spans [-1/4, 1/4]^2 or [-1/2, 1/2]^2; ask the surface.
  const double half = 0.5 / plane.unit();
  for (int i = 0; i < 1000; ++i) {
    const int f = static_cast<int>(random.Bits(4 * i) % plane.face_count());
    const Eigen::Vector3d target =
        4.0 * half *
        Eigen::Vector3d(random.Uniform(4 * i + 1) - 0.5, random.Uniform(4 * i + 2) - 0.5,
                        0.1 * (random.Uniform(4 * i + 3) - 0.5));
    const Eigen::Vector3d expected(std::clamp(target.x(), -half, half),
                                   std::clamp(target.y(), -half, half), 0.0);
    EXPECT_LT((plane.Follow(f, target).position - expected).norm(), 1e-9);
  }
}

TEST(Follow, NeverJumpsToAParallelSheet) {
  const double gap = 0.01;
  const std::vector<TriangleMesh> sheets = {
      shapes::PlaneGrid(1, 1, 12, 12), shapes::Moved(shapes::PlaneGrid(1, 1, 12, 12), {0, 0, gap})};
  const Surface surface = *Surface::Build(shapes::DisjointUnion(sheets));
  const int faces_a_sheet = surface.face_count() / 2;
  const CounterRandom random(8, 8);
  for (int i = 0; i < 500; ++i) {
    const int f = static_cast<int>(random.Bits(4 * i) % faces_a_sheet);
    const Eigen::Vector3d mesh_target(random.Uniform(4 * i + 1), random.Uniform(4 * i + 2),
                                      2.0 * gap * random.Uniform(4 * i + 3));
    const Eigen::Vector3d target = (mesh_target - surface.ToMesh({0, 0, 0})) / surface.unit();
    const SurfacePoint lower = surface.Follow(f, target);
    EXPECT_EQ(surface.face_components()[lower.face], 0);
    EXPECT_NEAR(surface.ToMesh(lower.position).z(), 0.0, 1e-12);
    const SurfacePoint upper = surface.Follow(f + faces_a_sheet, target);
    EXPECT_EQ(surface.face_components()[upper.face], 1);
    EXPECT_NEAR(surface.ToMesh(upper.position).z(), gap, 1e-12);
  }
}

TEST(Follow, NeverJumpsThroughAThinPlate) {
  TriangleMesh mesh = shapes::Subdivided(shapes::Subdivided(shapes::Cube()));
  for (Eigen::Vector3d& p : mesh.positions) p.z() *= 0.01;
  const Surface surface = *Surface::Build(mesh);
  for (int f = 0; f < surface.face_count(); ++f) {
    Eigen::Vector3d center = Eigen::Vector3d::Zero();
    for (int k = 0; k < 3; ++k) center += surface.positions()[surface.faces()[f][k]] / 3.0;
    const double height = surface.ToMesh(center).z();
    if (std::abs(height) < 0.0099) continue;  // On the rim.
    const Eigen::Vector3d through(center.x(), center.y(), -1.2 * center.z());
    EXPECT_NEAR(surface.ToMesh(surface.Follow(f, through).position).z(), height, 1e-12);
  }
}

TEST(Follow, StaysAtBoundaries) {
  const Surface surface = *Surface::Build(shapes::Cylinder(1, 1, 40, 10));
  for (int f = 0; f < surface.face_count(); ++f) {
    Eigen::Vector3d center = Eigen::Vector3d::Zero();
    for (int k = 0; k < 3; ++k) center += surface.positions()[surface.faces()[f][k]] / 3.0;
    const Eigen::Vector3d above = center + Eigen::Vector3d(0, 0, 2.0);
    const SurfacePoint point = surface.Follow(f, above);
    EXPECT_NEAR(surface.ToMesh(point.position).z(), 1.0, 1e-12);
    EXPECT_LT(std::hypot(point.position.x() - center.x(), point.position.y() - center.y()), 1e-9);
  }
}

TEST(Follow, TargetOnTheSurfaceIsReachedExactly) {
  const Surface surface = *Surface::Build(shapes::Icosphere(3));
  for (int v = 0; v < surface.vertex_count(); ++v) {
    const SurfacePoint point = surface.Follow(surface.outgoing()[v] / 3, surface.positions()[v]);
    EXPECT_LT((point.position - surface.positions()[v]).norm(), 1e-15);
  }
}

}  // namespace
}  // namespace ccst
