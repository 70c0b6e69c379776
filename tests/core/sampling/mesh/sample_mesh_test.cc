#include "core/sampling/mesh/sample_mesh.h"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "core/parallel/parallel.h"
#include "core/random/random.h"
#include "core/sampling/mesh/faults.h"
#include "tests/core/sampling/sampling_test_util.h"
#include "tests/support/shapes.h"

namespace ccst::internal {
namespace {

using sampling_test::Topology;

SampleMesh From(const TriangleMesh& mesh) {
  SampleMesh result;
  result.SetTriangles(static_cast<std::int32_t>(mesh.positions.size()), mesh.faces);
  return result;
}

// The count of defects that make a complex no manifold; vertices without faces are none here.
std::int64_t Defects(const quality::MeshTopology& topology) {
  return topology.bad_faces + topology.duplicate_faces + topology.crowded_edges +
         topology.inconsistent_edges + topology.split_vertices;
}

// Applies `steps` random operations where they are allowed and checks the complex by and by.
void ExpectManifoldUnderRandomOperations(const TriangleMesh& shape, std::uint64_t seed, int steps) {
  SampleMesh mesh = From(shape);
  const quality::MeshTopology before = Topology(mesh);
  const CounterRandom random(seed, 1);
  std::vector<TriangleIndex> dead_triangles;
  std::vector<std::int32_t> dead_vertices;
  const auto slot = [&] {
    if (dead_triangles.empty()) return mesh.NewTriangle();
    const TriangleIndex t = dead_triangles.back();
    dead_triangles.pop_back();
    return t;
  };
  int flips = 0;
  int collapses = 0;
  int inserts = 0;
  for (int step = 0; step < steps; ++step) {
    const auto h = static_cast<std::int32_t>(random.Bits(2 * step) % mesh.origin.size());
    if (mesh.IsDead(SampleMesh::TriangleOf(h))) continue;
    switch (random.Bits(2 * step + 1) % 4) {
      case 0:
      case 1:
        if (!mesh.CanFlip(h)) break;
        mesh.Flip(h);
        ++flips;
        break;
      case 2: {
        if (!mesh.CanCollapse(h)) break;
        const std::int32_t g = mesh.twin[h];
        dead_vertices.push_back(mesh.origin[h]);
        dead_triangles.push_back(SampleMesh::TriangleOf(h));
        if (g >= 0) dead_triangles.push_back(SampleMesh::TriangleOf(g));
        mesh.Collapse(h);
        EXPECT_LT(mesh.outgoing[dead_vertices.back()], 0);
        ++collapses;
        break;
      }
      default: {
        if (dead_vertices.empty()) break;
        const std::int32_t v = dead_vertices.back();
        dead_vertices.pop_back();
        const TriangleIndex slot1 = slot();
        if (mesh.twin[h] < 0) {
          mesh.InsertIntoBoundaryEdge(v, h, slot1);
        } else {
          const TriangleIndex slot2 = slot();
          mesh.InsertIntoTriangle(v, SampleMesh::TriangleOf(h), slot1, slot2);
        }
        ++inserts;
        break;
      }
    }
    if (step % 16 != 0 && step + 1 != steps) continue;
    ASSERT_EQ(FindFault(mesh), "") << "step " << step;
    const quality::MeshTopology now = Topology(mesh);
    ASSERT_EQ(Defects(now), 0) << now.first_defect << ", step " << step;
    ASSERT_EQ(now.euler, before.euler);
    ASSERT_EQ(now.components, before.components);
    ASSERT_EQ(now.boundary_loops.size(), before.boundary_loops.size());
    ASSERT_EQ(now.vertices + static_cast<std::int64_t>(dead_vertices.size()), mesh.vertex_count());
  }
  EXPECT_GT(flips, 10);
  EXPECT_GT(collapses + inserts, 10);
}

TEST(SampleMesh, RandomOperationsKeepAClosedManifold) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    ExpectManifoldUnderRandomOperations(shapes::Icosphere(1), seed, 2000);
    ExpectManifoldUnderRandomOperations(shapes::Torus(1, 0.3, 8, 6), seed, 2000);
    ExpectManifoldUnderRandomOperations(shapes::PlateWithHoles(2, 0), seed, 2000);
  }
}

TEST(SampleMesh, RandomOperationsKeepAnOpenManifold) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    ExpectManifoldUnderRandomOperations(shapes::PlaneGrid(1, 1, 6, 5), seed, 2000);
    ExpectManifoldUnderRandomOperations(shapes::Cylinder(1, 1, 7, 4), seed, 2000);
    ExpectManifoldUnderRandomOperations(shapes::SphereWithHole(0.8, 6, 8), seed, 2000);
  }
}

// Collapses whatever can be collapsed until nothing can: small complexes are the hard ones.
TEST(SampleMesh, CollapsingAsFarAsAllowedKeepsTheTopology) {
  const std::vector<TriangleMesh> meshes = {
      shapes::Icosphere(1),         shapes::Torus(1, 0.3, 8, 6),
      shapes::PlateWithHoles(2, 0), shapes::PlaneGrid(1, 1, 6, 5),
      shapes::Cylinder(1, 1, 7, 4), shapes::SphereWithHole(0.8, 6, 8),
      shapes::PlateWithHoles(1, 1), shapes::Cylinder(1, 1, 3, 1)};
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    SampleMesh mesh = From(meshes[i]);
    const quality::MeshTopology before = Topology(mesh);
    const CounterRandom random(i, 2);
    int idle = 0;
    for (int step = 0; idle < 3000; ++step, ++idle) {
      const auto h = static_cast<std::int32_t>(random.Bits(step) % mesh.origin.size());
      if (mesh.IsDead(SampleMesh::TriangleOf(h)) || !mesh.CanCollapse(h)) continue;
      mesh.Collapse(h);
      idle = 0;
      ASSERT_EQ(FindFault(mesh), "");
      const quality::MeshTopology now = Topology(mesh);
      ASSERT_EQ(Defects(now), 0) << now.first_defect;
      ASSERT_EQ(now.euler, before.euler);
      ASSERT_EQ(now.boundary_loops.size(), before.boundary_loops.size());
    }
    EXPECT_LT(Topology(mesh).vertices, 12) << "shape " << i;
  }
}

TEST(SampleMesh, TetrahedronRefusesEverything) {
  const SampleMesh mesh = From(shapes::Tetrahedron());
  for (std::int32_t h = 0; h < 12; ++h) {
    EXPECT_FALSE(mesh.CanFlip(h));
    EXPECT_FALSE(mesh.CanCollapse(h));
  }
}

TEST(SampleMesh, SingleTriangleRefusesEverything) {
  const SampleMesh mesh = From(shapes::SingleTriangle());
  for (std::int32_t h = 0; h < 3; ++h) {
    EXPECT_FALSE(mesh.CanFlip(h));
    EXPECT_FALSE(mesh.CanCollapse(h));
  }
}

TEST(SampleMesh, CollapseThatWouldPinchATubeIsRefused) {
  // Around a prism of three sides, an edge of the waist closes a triangle that is no face.
  const SampleMesh mesh = From(shapes::Cylinder(1, 2, 3, 2));
  int waist = 0;
  for (std::int32_t h = 0; h < static_cast<std::int32_t>(mesh.origin.size()); ++h) {
    const bool from_waist = mesh.origin[h] >= 3 && mesh.origin[h] < 6;
    const bool to_waist = mesh.Target(h) >= 3 && mesh.Target(h) < 6;
    if (!from_waist || !to_waist) continue;
    ++waist;
    EXPECT_FALSE(mesh.CanCollapse(h));
  }
  EXPECT_EQ(waist, 6);
}

TEST(SampleMesh, BoundaryVertexLeavesAlongTheBoundaryOnly) {
  const SampleMesh mesh = From(shapes::PlaneGrid(1, 1, 4, 4));
  for (std::int32_t h = 0; h < static_cast<std::int32_t>(mesh.origin.size()); ++h) {
    if (mesh.IsBoundary(mesh.origin[h]) && mesh.twin[h] >= 0) {
      EXPECT_FALSE(mesh.CanCollapse(h));
    }
  }
}

TEST(SampleMesh, BoundaryLoopOfThreeKeepsItsVertices) {
  const SampleMesh mesh = From(shapes::Cylinder(1, 1, 3, 3));
  for (std::int32_t h = 0; h < static_cast<std::int32_t>(mesh.origin.size()); ++h) {
    if (mesh.twin[h] < 0) {
      EXPECT_FALSE(mesh.CanCollapse(h));
    }
  }
}

TEST(SampleMesh, FlipTwiceTurnsTheDiagonalBack) {
  SampleMesh mesh = From(shapes::PlaneGrid(1, 1, 1, 1));
  std::int32_t h = 0;
  while (mesh.twin[h] < 0) ++h;
  const std::int32_t a = mesh.origin[h];
  const std::int32_t b = mesh.Target(h);
  ASSERT_TRUE(mesh.CanFlip(h));
  mesh.Flip(h);
  EXPECT_LT(mesh.FindEdge(a, b), 0);
  ASSERT_TRUE(mesh.CanFlip(h));
  mesh.Flip(h);
  EXPECT_GE(mesh.FindEdge(a, b), 0);
  EXPECT_EQ(FindFault(mesh), "");
}

TEST(SampleMesh, DegreeAndFindEdgeAgreeWithTheTriangles) {
  const TriangleMesh shape = shapes::Cylinder(1, 1, 5, 3);
  const SampleMesh mesh = From(shape);
  const auto n = static_cast<std::int32_t>(shape.positions.size());
  std::vector<std::vector<bool>> joined(n, std::vector<bool>(n, false));
  for (const Eigen::Vector3i& t : shape.faces) {
    for (int k = 0; k < 3; ++k) {
      joined[t[k]][t[(k + 1) % 3]] = joined[t[(k + 1) % 3]][t[k]] = true;
    }
  }
  for (std::int32_t a = 0; a < n; ++a) {
    std::int32_t degree = 0;
    for (std::int32_t b = 0; b < n; ++b) {
      degree += joined[a][b];
      EXPECT_EQ(mesh.FindEdge(a, b) >= 0, joined[a][b]) << a << " " << b;
    }
    EXPECT_EQ(mesh.Degree(a), degree);
  }
}

TEST(SampleMesh, NeighboursAreTheOtherEndsOfTheEdges) {
  const TriangleMesh shape = shapes::Cylinder(1, 1, 5, 3);
  const SampleMesh mesh = From(shape);
  std::vector<std::set<std::int32_t>> joined(shape.positions.size());
  for (const Eigen::Vector3i& t : shape.faces) {
    for (int k = 0; k < 3; ++k) {
      joined[t[k]].insert(t[(k + 1) % 3]);
      joined[t[k]].insert(t[(k + 2) % 3]);
    }
  }
  for (std::int32_t v = 0; v < mesh.vertex_count(); ++v) {
    std::multiset<std::int32_t> found;
    mesh.ForEachNeighbour(v, [&](std::int32_t u) { found.insert(u); });
    EXPECT_EQ(found, std::multiset<std::int32_t>(joined[v].begin(), joined[v].end()));
  }
}

TEST(SampleMesh, NeighboursAreCountedAtHubsToo) {
  const SampleMesh mesh = From(shapes::UvSphere(4, 60));  // The poles have 60 edges each.
  std::vector<std::int32_t> some;
  for (std::int32_t u = 0; u < mesh.vertex_count(); u += 3) some.push_back(u);
  for (std::int32_t v = 0; v < mesh.vertex_count(); ++v) {
    const auto expected = std::count_if(some.begin(), some.end(), [&](std::int32_t u) {
      return u != v && mesh.FindEdge(u, v) >= 0;
    });
    EXPECT_EQ(mesh.CountNeighbours(v, some), expected) << v;
  }
}

TEST(SampleMesh, TrianglesFallAsForetold) {
  for (const TriangleMesh& shape : {shapes::Icosphere(2), shapes::PlaneGrid(1, 1, 6, 6)}) {
    const SampleMesh before = From(shape);
    for (std::int32_t h = 0; h < 3 * before.triangle_count(); h += 7) {
      if (!before.CanCollapse(h)) continue;
      SampleMesh after = before;
      after.Collapse(h);
      before.ForEachOutgoing(before.origin[h], [&](std::int32_t e) {
        EXPECT_EQ(before.FallsWith(h, e), after.IsDead(SampleMesh::TriangleOf(e)));
      });
    }
  }
}

TEST(SampleMesh, SeveralThreadsMayAskWhatCanCollapse) {
  const SampleMesh mesh = From(shapes::Icosphere(4));
  const std::int32_t count = 3 * mesh.triangle_count();
  std::vector<std::uint8_t> alone(count);
  for (std::int32_t h = 0; h < count; ++h) alone[h] = mesh.CanCollapse(h) ? 1 : 0;
  std::vector<std::uint8_t> together(count);
  Parallel(4).For(count, [&](std::int64_t h) {
    together[h] = mesh.CanCollapse(static_cast<std::int32_t>(h)) ? 1 : 0;
  });
  EXPECT_EQ(together, alone);
}

// Independent of the half-edges: the edge's vertices have just its triangles' third ones in common.
bool LinkConditionHolds(const std::vector<Eigen::Vector3i>& triangles, std::int32_t v,
                        std::int32_t w) {
  std::set<std::int32_t> around_v;
  std::set<std::int32_t> around_w;
  std::int32_t shared = 0;
  for (const Eigen::Vector3i& t : triangles) {
    const bool has_v = (t.array() == v).any();
    const bool has_w = (t.array() == w).any();
    shared += has_v && has_w;
    for (const std::int32_t u : t) {
      if (has_v) around_v.insert(u);
      if (has_w) around_w.insert(u);
    }
  }
  std::vector<std::int32_t> common;
  std::set_intersection(around_v.begin(), around_v.end(), around_w.begin(), around_w.end(),
                        std::back_inserter(common));
  return static_cast<std::int32_t>(common.size()) - 2 == shared;
}

// Vertices of very many edges are told from others; collapses beside them are right all the same.
TEST(SampleMesh, CollapsesBesideHubsKeepTheManifold) {
  SampleMesh mesh = From(shapes::UvSphere(4, 60));  // The poles have 60 edges each.
  const CounterRandom random(3, 1);
  int collapses = 0;
  for (int step = 0; step < 3000; ++step) {
    const auto h = static_cast<std::int32_t>(random.Bits(step) % mesh.origin.size());
    if (mesh.IsDead(SampleMesh::TriangleOf(h))) continue;
    const std::int32_t v = mesh.origin[h];
    const std::int32_t w = mesh.Target(h);
    const std::vector<Eigen::Vector3i> triangles = sampling_test::Triangles(mesh);
    const bool apexes_stay =
        mesh.HasMoreEdges(mesh.Apex(h), 3) && mesh.HasMoreEdges(mesh.Apex(mesh.twin[h]), 3);
    ASSERT_EQ(mesh.CanCollapse(h), apexes_stay && LinkConditionHolds(triangles, v, w))
        << v << " to " << w;
    if (!mesh.CanCollapse(h)) continue;
    mesh.Collapse(h);
    ASSERT_EQ(FindFault(mesh), "");
    ASSERT_EQ(Defects(Topology(mesh)), 0);
    ++collapses;
  }
  EXPECT_GT(collapses, 100);
}

TEST(SampleMesh, HasMoreEdgesCountsThoseOnTheBoundary) {
  const SampleMesh mesh = From(shapes::Cylinder(1, 1, 5, 3));
  for (std::int32_t v = 0; v < mesh.vertex_count(); ++v) {
    for (std::int32_t count = 0; count < 8; ++count) {
      EXPECT_EQ(mesh.HasMoreEdges(v, count), mesh.Degree(v) > count);
    }
  }
}

}  // namespace
}  // namespace ccst::internal
