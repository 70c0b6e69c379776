#include "core/sampling/relax/relocation.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <set>
#include <stop_token>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/interrupt.h"
#include "core/sampling/mesh/faults.h"
#include "core/surface/projection.h"
#include "tests/core/sampling/sampling_test_util.h"
#include "tests/support/shapes.h"

namespace ccst::internal {
namespace {

using sampling_test::MakeStart;
using sampling_test::Start;

// Random samples crowd: with these limits about every tenth is a defect.
constexpr DefectLimits kLimits = {.least_separation = 0.5, .all_near = true};

std::vector<Defect> Find(const Start& start, const DefectLimits& limits) {
  Interrupt never;
  const std::vector<std::uint8_t> everywhere(start.samples.count(), 1);
  return FindDefects(start.surface, start.density, start.plan, start.mesh, start.samples, limits,
                     limits, everywhere, Parallel(), &never);
}

TEST(FindDefects, NamesInteriorSamplesOnceInOrder) {
  const Start start = *MakeStart(shapes::Cylinder(1, 2, 40, 20), 1000, 1);
  const std::vector<Defect> defects = Find(start, kLimits);
  ASSERT_GT(defects.size(), 5u);
  for (std::size_t i = 0; i < defects.size(); ++i) {
    EXPECT_EQ(start.samples.kind[defects[i].sample], SampleMesh::Kind::kInterior);
    if (i > 0) {
      EXPECT_LT(defects[i - 1].sample, defects[i].sample);
    }
  }
}

TEST(FindDefects, LooserLimitsFindLess) {
  const Start start = *MakeStart(shapes::Icosphere(3), 1000, 1);
  const std::size_t strict = Find(start, {.least_separation = 0.7, .all_near = true}).size();
  const std::size_t loose = Find(start, {.least_separation = 0.3, .all_near = true}).size();
  EXPECT_GT(strict, loose);
  EXPECT_TRUE(Find(start, {.least_facing = -1.0, .least_separation = 0.0}).empty());
}

TEST(FindDefects, LooksOnlyInItsScope) {
  Interrupt never;
  const Start start = *MakeStart(shapes::Icosphere(3), 1000, 1);
  const std::vector<std::uint8_t> nowhere(start.samples.count(), 0);
  EXPECT_TRUE(FindDefects(start.surface, start.density, start.plan, start.mesh, start.samples,
                          kLimits, kLimits, nowhere, Parallel(), &never)
                  .empty());
}

std::vector<std::set<std::int32_t>> NeighboursByHand(const SampleMesh& mesh) {
  std::vector<std::set<std::int32_t>> neighbours(mesh.vertex_count());
  for (std::size_t t = 0; t < mesh.origin.size(); t += 3) {
    for (int k = 0; k < 3; ++k) {
      for (int l = 1; l < 3; ++l) {
        neighbours[mesh.origin[t + k]].insert(mesh.origin[t + (k + l) % 3]);
      }
    }
  }
  return neighbours;
}

// Every pair up to two edges apart, found by sets, has one of its two named, and none else is.
TEST(FindDefects, NamesOneOfEveryNearPairOfTheScope) {
  const Start start = *MakeStart(shapes::Cylinder(1, 2, 40, 20), 1000, 1);
  const std::vector<std::set<std::int32_t>> neighbours = NeighboursByHand(start.mesh);
  std::vector<std::uint8_t> scope(start.samples.count(), 0);
  for (std::size_t v = 0; v < scope.size(); ++v) scope[v] = v % 3 == 0 ? 1 : 0;
  DefectLimits limits = kLimits;
  limits.least_facing = -2.0;  // Triangles that are turned over are none of it.
  // Of equilateral triangles of the target capacity.
  const double spacing =
      limits.least_separation * std::sqrt(4.0 / std::sqrt(3.0) * start.plan.components[0].target);
  std::vector<std::set<std::int32_t>> pairs(scope.size());
  for (std::int32_t v = 0; v < start.samples.count(); ++v) {
    for (const std::int32_t middle : neighbours[v]) {
      std::set<std::int32_t> others = neighbours[middle];
      others.insert(middle);
      others.erase(v);
      for (const std::int32_t u : others) {
        if (scope[v] == 0 && scope[u] == 0) continue;
        if ((start.samples.position[v] - start.samples.position[u]).norm() < spacing) {
          pairs[v].insert(u);
        }
      }
    }
  }
  Interrupt never;
  const std::vector<Defect> found =
      FindDefects(start.surface, start.density, start.plan, start.mesh, start.samples, limits,
                  limits, scope, Parallel(), &never);
  ASSERT_GT(found.size(), 5u);
  std::set<std::int32_t> named;
  for (const Defect& defect : found) named.insert(defect.sample);
  const auto is_interior = [&](std::int32_t v) {
    return start.samples.kind[v] == SampleMesh::Kind::kInterior;
  };
  for (std::int32_t v = 0; v < start.samples.count(); ++v) {
    if (named.count(v) != 0) {
      EXPECT_FALSE(pairs[v].empty()) << v;
    }
    for (const std::int32_t u : pairs[v]) {
      if (!is_interior(u) && !is_interior(v)) continue;
      EXPECT_TRUE(named.count(u) != 0 || named.count(v) != 0) << u << " and " << v;
    }
  }
}

TEST(FindDefects, CloseSheetsAreNone) {
  // Two plates nearer than the spacing, each with samples in a good order.
  const std::vector<TriangleMesh> sheets = {
      shapes::PlaneGrid(1, 1, 10, 10),
      shapes::Moved(shapes::PlaneGrid(1, 1, 10, 10), {0, 0, 1e-3})};
  Start both = *MakeStart(shapes::DisjointUnion(sheets), 800, 1);
  Start one = *MakeStart(sheets[0], 400, 1);
  // The same share of defects, up to chance, though every sample has one very near it opposite.
  EXPECT_LT(Find(both, kLimits).size(), 3 * Find(one, kLimits).size() + 20);
}

TEST(Relocate, KeepsCountsTopologyAndHosts) {
  const std::vector<TriangleMesh> meshes = {
      shapes::Icosphere(3), shapes::Torus(1, 0.35, 60, 24), shapes::Cylinder(1, 2, 40, 20),
      shapes::PlateWithHoles(2, 2, 1), sampling_test::Jack(4)};
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    SCOPED_TRACE(m);
    Start start = *MakeStart(meshes[m], 900, m);
    const quality::MeshTopology before = sampling_test::Topology(start.mesh);
    GeometryPhase geometry(&start.surface, &start.density, &start.plan, Energy::kTarget,
                           &start.mesh, &start.samples, &sampling_test::kOneThread);
    const Parallel parallel;
    Projection projection(&start.surface, 0.5 * start.plan.spacing, &parallel);
    EdgeFlips flips = geometry.packed().MakeFlips();
    const std::vector<Defect> defects = Find(start, kLimits);
    Interrupt never;
    const std::int64_t moved =
        Relocate(defects, {}, start.surface, &projection, &geometry, &flips, &never);
    EXPECT_GT(moved, 0);
    EXPECT_LE(moved, static_cast<std::int64_t>(defects.size()));
    EXPECT_EQ(start.samples.count(), 900);
    const quality::MeshTopology after = sampling_test::Topology(start.mesh);
    EXPECT_TRUE(after.IsManifold()) << after.first_defect;
    EXPECT_EQ(after.vertices, 900);
    EXPECT_EQ(after.faces, before.faces);
    EXPECT_EQ(after.euler, before.euler);
    EXPECT_EQ(after.boundary_loops.size(), before.boundary_loops.size());
    EXPECT_EQ(FindFault(start.mesh), "");
    for (std::int32_t i = 0; i < 900; ++i) {
      Eigen::Vector3d position = Eigen::Vector3d::Zero();
      for (int k = 0; k < 3; ++k) {
        position += start.samples.weights[i][k] *
                    start.surface.positions()[start.surface.faces()[start.samples.face[i]][k]];
      }
      EXPECT_LT((position - start.samples.position[i]).norm(), 1e-14);
    }
  }
}

TEST(Relocate, UncoveredPlaceGetsASample) {
  Start start = *MakeStart(shapes::Icosphere(3), 400, 1);
  GeometryPhase geometry(&start.surface, &start.density, &start.plan, Energy::kTarget, &start.mesh,
                         &start.samples, &sampling_test::kOneThread);
  const Parallel parallel;
  Projection projection(&start.surface, 0.5 * start.plan.spacing, &parallel);
  EdgeFlips flips = geometry.packed().MakeFlips();
  // The surface's vertex nearest the middle of the largest triangle.
  TriangleIndex largest(0);
  for (std::int32_t i = 0; i < start.mesh.triangle_count(); ++i) {
    const TriangleIndex t(i);
    if (geometry.Capacity(t) > geometry.Capacity(largest)) largest = t;
  }
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (int k = 0; k < 3; ++k) {
    center += start.samples.position[start.mesh.origin[3 * largest + k]] / 3.0;
  }
  const auto nearer = [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return (a - center).squaredNorm() < (b - center).squaredNorm();
  };
  const std::vector<Eigen::Vector3d>& p = start.surface.positions();
  const auto vertex =
      static_cast<std::int32_t>(std::min_element(p.begin(), p.end(), nearer) - p.begin());
  Interrupt never;
  EXPECT_EQ(
      Relocate({}, {{vertex, largest, 1.0}}, start.surface, &projection, &geometry, &flips, &never),
      1);
  EXPECT_EQ(std::count(start.samples.position.begin(), start.samples.position.end(), p[vertex]), 1);
  EXPECT_TRUE(sampling_test::Topology(start.mesh).IsManifold());
}

TEST(Relocate, NothingToDoChangesNothing) {
  Start start = *MakeStart(shapes::Icosphere(3), 400, 1);
  GeometryPhase geometry(&start.surface, &start.density, &start.plan, Energy::kTarget, &start.mesh,
                         &start.samples, &sampling_test::kOneThread);
  const Parallel parallel;
  Projection projection(&start.surface, 0.5 * start.plan.spacing, &parallel);
  EdgeFlips flips = geometry.packed().MakeFlips();
  const std::vector<std::int32_t> before = start.mesh.origin;
  Interrupt never;
  EXPECT_EQ(Relocate({}, {}, start.surface, &projection, &geometry, &flips, &never), 0);
  EXPECT_EQ(start.mesh.origin, before);
}

TEST(Relocate, StopLeavesEverySampleWhereItIs) {
  Start start = *MakeStart(shapes::Torus(1, 0.35, 60, 24), 900, 1);
  GeometryPhase geometry(&start.surface, &start.density, &start.plan, Energy::kTarget, &start.mesh,
                         &start.samples, &sampling_test::kOneThread);
  const Parallel parallel;
  Projection projection(&start.surface, 0.5 * start.plan.spacing, &parallel);
  EdgeFlips flips = geometry.packed().MakeFlips();
  const std::vector<Defect> defects = Find(start, kLimits);
  ASSERT_FALSE(defects.empty());
  std::stop_source stop;
  stop.request_stop();
  Interrupt interrupt(stop.get_token());
  EXPECT_EQ(Relocate(defects, {}, start.surface, &projection, &geometry, &flips, &interrupt), 0);
  EXPECT_TRUE(sampling_test::Topology(start.mesh).IsManifold());
}

}  // namespace
}  // namespace ccst::internal
