#include "core/quality/mesh_topology.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/shapes.h"

namespace ccst::quality {
namespace {

using testing::HasSubstr;

MeshTopology Topology(const TriangleMesh& mesh) {
  return MeasureTopology(static_cast<std::int64_t>(mesh.positions.size()), mesh.faces);
}

// The topology of whole shapes is checked with the shapes (tests/support).

TEST(MeshTopology, CountsOfATetrahedronAreRight) {
  const MeshTopology topology = Topology(shapes::Tetrahedron());
  EXPECT_TRUE(topology.IsManifold());
  EXPECT_EQ(topology.vertices, 4);
  EXPECT_EQ(topology.edges, 6);
  EXPECT_EQ(topology.faces, 4);
  EXPECT_EQ(topology.euler, 2);
}

TEST(MeshTopology, LoopsRunAlongTheFaces) {
  const TriangleMesh grid = shapes::PlaneGrid(2.0, 1.0, 4, 2);
  const MeshTopology topology = Topology(grid);
  ASSERT_EQ(topology.boundary_loops.size(), 1u);
  const std::vector<std::int32_t>& loop = topology.boundary_loops[0];
  EXPECT_EQ(loop.size(), 12u);
  EXPECT_NEAR(LoopLength(grid.positions, loop), 6.0, 1e-12);
  double twice_area = 0.0;  // Positive: counter-clockwise, like the faces.
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Eigen::Vector3d& p = grid.positions[loop[i]];
    const Eigen::Vector3d& q = grid.positions[loop[(i + 1) % loop.size()]];
    twice_area += p.x() * q.y() - p.y() * q.x();
  }
  EXPECT_NEAR(twice_area, 4.0, 1e-12);
}

TEST(MeshTopology, RemovedFaceOpensALoop) {
  TriangleMesh mesh = shapes::Icosphere(2);
  mesh.faces.erase(mesh.faces.begin() + 11);
  const MeshTopology topology = Topology(mesh);
  EXPECT_TRUE(topology.IsManifold());
  EXPECT_EQ(topology.euler, 1);
  ASSERT_EQ(topology.boundary_loops.size(), 1u);
  EXPECT_EQ(topology.boundary_loops[0].size(), 3u);
}

TEST(MeshTopology, HolesThatTouchMakeASplitVertexAndTwoLoops) {
  TriangleMesh mesh = shapes::Icosphere(2);
  // Two faces that share vertex 0 alone.
  std::vector<std::size_t> at_vertex;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    if ((mesh.faces[f].array() == 0).any()) at_vertex.push_back(f);
  }
  std::size_t other = 0;
  for (const std::size_t f : at_vertex) {
    int shared = 0;
    for (const int v : mesh.faces[f]) shared += (mesh.faces[at_vertex[0]].array() == v).any();
    if (shared == 1) other = f;
  }
  ASSERT_GT(other, at_vertex[0]);
  mesh.faces.erase(mesh.faces.begin() + static_cast<std::ptrdiff_t>(other));
  mesh.faces.erase(mesh.faces.begin() + static_cast<std::ptrdiff_t>(at_vertex[0]));
  const MeshTopology topology = Topology(mesh);
  EXPECT_EQ(topology.split_vertices, 1);
  EXPECT_THAT(topology.first_defect, HasSubstr("vertex 0 form 2 fans"));
  std::size_t sides = 0;
  for (const auto& loop : topology.boundary_loops) sides += loop.size();
  EXPECT_EQ(sides, 6u);
}

TEST(MeshTopology, DefectsSayWhere) {
  TriangleMesh mesh = shapes::Tetrahedron();
  mesh.faces.emplace_back(0, 0, 1);
  EXPECT_THAT(Topology(mesh).first_defect, HasSubstr("face 4 (0, 0, 1) has a repeated index"));
  mesh.faces.back() = {0, 1, 9};
  EXPECT_THAT(Topology(mesh).first_defect, HasSubstr("index out of range"));
  mesh.faces.back() = {0, -1, 2};
  EXPECT_EQ(Topology(mesh).bad_faces, 1);
  mesh.faces.back() = mesh.faces[2];
  EXPECT_EQ(Topology(mesh).duplicate_faces, 1);
  EXPECT_EQ(Topology(mesh).crowded_edges, 3);
  mesh.faces.pop_back();
  mesh.positions.emplace_back(5, 5, 5);
  EXPECT_THAT(Topology(mesh).first_defect, HasSubstr("vertex 4 has no face"));
  EXPECT_THAT(Topology(shapes::WithFlippedFace(shapes::Cube(), 3)).first_defect,
              HasSubstr("opposite orientations"));
  EXPECT_THAT(Topology(shapes::ThreeFins()).first_defect, HasSubstr("edge (0, 1) has 3 faces"));
}

TEST(MeshTopology, DoubleCoveredTriangleIsNotManifold) {
  // Every edge is used twice in opposite directions, but one face covers the other.
  const std::vector<Eigen::Vector3i> faces = {{0, 1, 2}, {0, 2, 1}};
  const MeshTopology topology = MeasureTopology(3, faces);
  EXPECT_EQ(topology.duplicate_faces, 1);
  EXPECT_FALSE(topology.IsManifold());
}

TEST(MeshTopology, NothingHasNothing) {
  const MeshTopology topology = MeasureTopology(0, {});
  EXPECT_EQ(topology.euler, 0);
  EXPECT_EQ(topology.components, 0);
  EXPECT_TRUE(topology.boundary_loops.empty());
}

}  // namespace
}  // namespace ccst::quality
