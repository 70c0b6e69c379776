#include "core/sampling/start/vertex_removal.h"

#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "core/sampling/mesh/faults.h"
#include "tests/core/sampling/sampling_test_util.h"
#include "tests/support/shapes.h"

namespace ccst::internal {
namespace {

using sampling_test::Topology;

struct Removed {
  SampleMesh mesh;
  std::vector<std::int32_t> waiting;
};

// Removes the vertices from `keep` on of a mesh that faces upwards.
Removed Remove(const TriangleMesh& input, std::int32_t keep) {
  const auto count = static_cast<std::int32_t>(input.positions.size());
  Removed removed;
  removed.mesh.SetTriangles(count, input.faces);
  const std::vector<Eigen::Vector3d> up(input.positions.size(), Eigen::Vector3d::UnitZ());
  Interrupt interrupt;
  removed.waiting = *RemoveVertices(keep, input.positions, up, &interrupt, &removed.mesh);
  return removed;
}

TEST(RemoveVertices, AllButTheKeptOnesGo) {
  const Removed removed = Remove(shapes::PlaneGrid(1, 1, 8, 8), 40);
  EXPECT_TRUE(removed.waiting.empty());
  EXPECT_EQ(FindFault(removed.mesh), "");
  EXPECT_EQ(Topology(removed.mesh).euler, 1);
}

// Vertex 4 is on the boundary; vertex 3 has three edges, one of them to it, and may lose none. No
// edge of vertex 4 can be turned, so the one beyond vertex 3 must be.
TEST(RemoveVertices, BoundaryVertexBesideAVertexOfThreeEdgesGoes) {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {2, 0, 0}, {1, 2, 0}, {1, -0.3, 0}, {1, -1, 0}};
  mesh.faces = {{4, 3, 0}, {4, 1, 3}, {0, 3, 1}, {0, 1, 2}};
  const Removed removed = Remove(mesh, 4);
  EXPECT_TRUE(removed.waiting.empty());
  EXPECT_EQ(FindFault(removed.mesh), "");
  EXPECT_EQ(Topology(removed.mesh).euler, 1);
}

}  // namespace
}  // namespace ccst::internal
