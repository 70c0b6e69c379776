#include "core/sampling/mesh/edge_flips.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "core/base/interrupt.h"
#include "core/quality/sample_mesh_quality.h"
#include "core/random/random.h"
#include "core/sampling/mesh/faults.h"
#include "core/sampling/relax/geometry_phase.h"
#include "tests/core/sampling/sampling_test_util.h"
#include "tests/support/shapes.h"

namespace ccst::internal {
namespace {

using sampling_test::Area;
using sampling_test::MakeStart;
using sampling_test::Start;

double AngleAt(const Eigen::Vector3d& apex, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2((a - apex).cross(b - apex).norm(), (a - apex).dot(b - apex));
}

// Interior edges whose opposite angles sum to more than pi.
int CountNotDelaunay(const SampleMesh& mesh, const std::vector<Eigen::Vector3d>& p) {
  int count = 0;
  for (std::int32_t h = 0; h < static_cast<std::int32_t>(mesh.origin.size()); ++h) {
    const std::int32_t g = mesh.twin[h];
    if (g < h) continue;
    const Eigen::Vector3d& a = p[mesh.origin[h]];
    const Eigen::Vector3d& b = p[mesh.origin[g]];
    count +=
        AngleAt(p[mesh.Apex(h)], a, b) + AngleAt(p[mesh.Apex(g)], a, b) > std::numbers::pi + 1e-6;
  }
  return count;
}

// Triangles are no longer Delaunay after the samples have moved.
Start Moved(const TriangleMesh& mesh, std::int64_t count) {
  Interrupt never;
  Start start = *MakeStart(mesh, count, 5);
  GeometryPhase geometry(&start.surface, &start.density, &start.plan, Energy::kTarget, &start.mesh,
                         &start.samples, &sampling_test::kOneThread);
  for (int pass = 0; pass < 10; ++pass) geometry.Pass(&never);
  return start;
}

TEST(EdgeFlips, FlipAllMakesEveryEdgeLocallyDelaunay) {
  for (const TriangleMesh& mesh :
       {shapes::Icosphere(4), shapes::Torus(1, 0.4, 80, 40), shapes::PlaneGrid(1, 1, 1, 1)}) {
    Start start = Moved(mesh, 2000);
    EXPECT_GT(CountNotDelaunay(start.mesh, start.samples.position), 20);
    EdgeFlips flips(&start.mesh, &start.samples.position, &start.samples.normal);
    EXPECT_GT(flips.FlipAll(), 20);
    EXPECT_EQ(CountNotDelaunay(start.mesh, start.samples.position), 0);
    EXPECT_EQ(flips.FlipAll(), 0);
    EXPECT_TRUE(sampling_test::Topology(start.mesh).IsManifold());
    EXPECT_EQ(FindFault(start.mesh), "");
  }
}

TEST(EdgeFlips, FlipsLowerTheArea) {
  for (const TriangleMesh& mesh :
       {shapes::Icosphere(4), shapes::Torus(1, 0.4, 80, 40), shapes::PlateWithHoles(2, 2)}) {
    Start start = Moved(mesh, 1000);
    const double before = Area(start.mesh, start.samples.position);
    EdgeFlips flips(&start.mesh, &start.samples.position, &start.samples.normal);
    EXPECT_GT(flips.FlipAll(), 0);
    EXPECT_LT(Area(start.mesh, start.samples.position), before);
  }
}

TEST(EdgeFlips, FlipsTurnNoTriangleOver) {
  for (const TriangleMesh& mesh : {shapes::Cube(), sampling_test::Jack(4)}) {
    Start start = Moved(mesh, 600);
    const auto count = [&] {
      return quality::CountTurnedOver(start.samples.position, start.samples.normal,
                                      sampling_test::Triangles(start.mesh));
    };
    const std::int64_t before = count();
    EdgeFlips(&start.mesh, &start.samples.position, &start.samples.normal).FlipAll();
    EXPECT_LE(count(), before);
  }
}

// In the plane locally Delaunay everywhere means Delaunay: every circumcircle is empty.
TEST(EdgeFlips, PlaneEndsWithEmptyCircles) {
  Start start = Moved(shapes::PlaneGrid(1, 1, 1, 1), 300);
  const std::vector<Eigen::Vector3d>& p = start.samples.position;
  // Start from far away: turn edges of convex quadrilaterals at random.
  const CounterRandom random(1, 1);
  int turned = 0;
  for (int i = 0; i < 3000; ++i) {
    const auto h = static_cast<std::int32_t>(random.Bits(i) % start.mesh.origin.size());
    if (!start.mesh.CanFlip(h)) continue;
    const std::int32_t g = start.mesh.twin[h];
    const auto up = [&](std::int32_t a, std::int32_t b, std::int32_t c) {
      return (p[b] - p[a]).cross(p[c] - p[a]).z();
    };
    const std::int32_t c = start.mesh.Apex(h);
    const std::int32_t d = start.mesh.Apex(g);
    if (up(d, c, start.mesh.origin[h]) < 1e-6 || up(c, d, start.mesh.origin[g]) < 1e-6) continue;
    start.mesh.Flip(h);
    ++turned;
  }
  EXPECT_GT(turned, 300);
  EdgeFlips(&start.mesh, &start.samples.position, &start.samples.normal).FlipAll();
  EXPECT_EQ(CountNotDelaunay(start.mesh, p), 0);
  for (const Eigen::Vector3i& t : sampling_test::Triangles(start.mesh)) {
    Eigen::Matrix2d m;
    m << (p[t[1]] - p[t[0]]).head<2>().transpose(), (p[t[2]] - p[t[0]]).head<2>().transpose();
    if (std::abs(m.determinant()) < 1e-9) continue;  // Three samples on one side of the square.
    const Eigen::Vector2d right(0.5 * (p[t[1]] - p[t[0]]).squaredNorm(),
                                0.5 * (p[t[2]] - p[t[0]]).squaredNorm());
    const Eigen::Vector2d center = m.inverse() * right;
    for (const Eigen::Vector3d& q : p) {
      EXPECT_GE(((q - p[t[0]]).head<2>() - center).norm(), center.norm() * (1.0 - 1e-5));
    }
  }
}

// Two halves of the samples side by side and then what lies between come to the same as all at
// once: every edge is locally Delaunay, and no half changes anything of the other.
TEST(EdgeFlips, RestrictedToHalvesLeaveTheRestToOthers) {
  Start start = Moved(shapes::Torus(1, 0.4, 80, 40), 2000);
  const std::int32_t count = start.samples.count();
  std::vector<std::int32_t> left;
  for (const auto& [first, end] : {std::pair(0, count / 2), std::pair(count / 2, count)}) {
    const SampleMesh before = start.mesh;
    EdgeFlips flips(&start.mesh, &start.samples.position, &start.samples.normal);
    flips.Restrict(first, end);
    EXPECT_GT(flips.FlipAll(), 20);
    for (const std::int32_t v : flips.touched) EXPECT_TRUE(v >= first && v < end);
    for (std::int32_t t = 0; t < before.triangle_count(); ++t) {
      const std::int32_t* corner = &before.origin[3 * t];
      if (std::all_of(corner, corner + 3, [&](std::int32_t v) { return v >= first && v < end; })) {
        continue;
      }
      EXPECT_TRUE(std::equal(corner, corner + 3, &start.mesh.origin[3 * t]));
    }
    left.insert(left.end(), flips.beyond.begin(), flips.beyond.end());
  }
  EXPECT_EQ(FindFault(start.mesh), "");
  EXPECT_GT(CountNotDelaunay(start.mesh, start.samples.position), 0);
  EdgeFlips rest(&start.mesh, &start.samples.position, &start.samples.normal);
  EXPECT_GT(rest.FlipThese(left), 0);
  EXPECT_EQ(CountNotDelaunay(start.mesh, start.samples.position), 0);
}

// Flipping what the passes name leaves what a search over all edges would leave, once the samples
// have come to rest: an edge spoilt late in one pass is named by the next.
TEST(EdgeFlips, SpoiltEdgesOfThePassesAreEnough) {
  Interrupt never;
  Start start = *MakeStart(shapes::Torus(1, 0.4, 80, 40), 1500, 5);
  GeometryPhase geometry(&start.surface, &start.density, &start.plan, Energy::kTarget, &start.mesh,
                         &start.samples, &sampling_test::kOneThread);
  EdgeFlips flips = geometry.packed().MakeFlips();
  for (int round = 0; round < 40; ++round) {
    geometry.Pass(&never);
    flips.touched.clear();
    const std::int64_t flipped = flips.FlipThese(geometry.spoilt_edges());
    EXPECT_EQ(flips.touched.empty(), flipped == 0);
    for (const std::int32_t v : flips.touched) geometry.Activate(v);
  }
  EXPECT_TRUE(sampling_test::Topology(start.mesh).IsManifold());
  const int left = CountNotDelaunay(start.mesh, start.samples.position);
  EXPECT_LE(left, 5);
}

TEST(Facing, IsTheCosineBetweenTriangleAndSurface) {
  const std::vector<Eigen::Vector3d> p = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 0, 0}};
  const std::vector<Eigen::Vector3d> up(4, Eigen::Vector3d::UnitZ());
  EXPECT_NEAR(Facing(p, up, 0, 1, 2), 1.0, 1e-15);
  EXPECT_NEAR(Facing(p, up, 0, 2, 1), -1.0, 1e-15);
  EXPECT_EQ(Facing(p, up, 0, 1, 3), 0.0);
  const std::vector<Eigen::Vector3d> tilted(4, Eigen::Vector3d(0, 0.6, 0.8));
  EXPECT_NEAR(Facing(p, tilted, 0, 1, 2), 0.8, 1e-15);
}

}  // namespace
}  // namespace ccst::internal
