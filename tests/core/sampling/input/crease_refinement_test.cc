#include "core/sampling/input/crease_refinement.h"

#include <algorithm>
#include <utility>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "core/quality/capacity.h"
#include "core/quality/mesh_topology.h"
#include "core/quality/surface_distance.h"
#include "core/quality/triangle_tree.h"
#include "core/sampling/input/source_map.h"
#include "core/sampling/sampling.h"
#include "tests/core/sampling/sampling_test_util.h"
#include "tests/support/shapes.h"

namespace ccst::internal {
namespace {

RepairedMesh Refined(const TriangleMesh& mesh, double longest, std::int64_t most_new = 1'000'000) {
  RepairedMesh repaired = *Repair(mesh);
  const Surface surface = *Surface::Build(repaired.mesh);
  RefineCreases(surface, longest / surface.unit(), most_new, &repaired);
  return repaired;
}

double LongestSide(const TriangleMesh& mesh, std::size_t face) {
  double longest = 0.0;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d& from = mesh.positions[mesh.faces[face][k]];
    longest = std::max(longest, (mesh.positions[mesh.faces[face][(k + 1) % 3]] - from).norm());
  }
  return longest;
}

// On the edges of the cube [-1, 1]^3.
bool AtEdge(const Eigen::Vector3d& p) { return (p.array().abs() == 1.0).count() >= 2; }

TEST(CreaseRefinement, FacesAtTheEdgesOfACubeBecomeSmall) {
  const TriangleMesh refined = Refined(shapes::Cube(), 0.1).mesh;
  bool any_large = false;
  for (std::size_t f = 0; f < refined.faces.size(); ++f) {
    const Eigen::Vector3i& t = refined.faces[f];
    const bool at_edge = AtEdge(refined.positions[t[0]]) || AtEdge(refined.positions[t[1]]) ||
                         AtEdge(refined.positions[t[2]]);
    if (at_edge) {
      EXPECT_LE(LongestSide(refined, f), 0.1);
    }
    any_large = any_large || LongestSide(refined, f) > 0.2;
  }
  EXPECT_TRUE(any_large);  // Only there.
}

TEST(CreaseRefinement, ShapeAndTopologyStay) {
  const TriangleMesh cube = shapes::Cube();
  const TriangleMesh refined = Refined(cube, 0.1).mesh;
  const quality::MeshTopology topology =
      quality::MeasureTopology(static_cast<std::int64_t>(refined.positions.size()), refined.faces);
  EXPECT_EQ(topology.first_defect, "");
  EXPECT_EQ(topology.euler, 2);
  EXPECT_TRUE(topology.boundary_loops.empty());
  EXPECT_NEAR(quality::TotalArea(refined.positions, refined.faces), 24.0, 1e-12);
  const quality::TriangleTree tree(cube.positions, cube.faces);
  EXPECT_EQ(quality::LargestDistance(refined.positions, tree), 0.0);
}

TEST(CreaseRefinement, NewFacesKnowTheirPlaceOnTheInput) {
  const TriangleMesh cube = shapes::Cube();
  const RepairedMesh refined = Refined(cube, 0.3);
  const SourceMap sources(cube, refined);
  for (std::size_t f = 0; f < refined.mesh.faces.size(); ++f) {
    const Eigen::Vector3i& source = cube.faces[sources.Face(static_cast<std::int32_t>(f))];
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d w = sources.Corner(static_cast<std::int32_t>(f), k);
      const Eigen::Vector3d place = w[0] * cube.positions[source[0]] +
                                    w[1] * cube.positions[source[1]] +
                                    w[2] * cube.positions[source[2]];
      EXPECT_LE((place - refined.mesh.positions[refined.mesh.faces[f][k]]).norm(), 1e-14);
    }
  }
}

TEST(CreaseRefinement, SmoothSurfaceStaysAsItIs) {
  RepairedMesh repaired = *Repair(shapes::Icosphere(2));
  const std::size_t faces = repaired.mesh.faces.size();
  EXPECT_FALSE(RefineCreases(*Surface::Build(repaired.mesh), 1e-3, 1'000'000, &repaired));
  EXPECT_EQ(repaired.mesh.faces.size(), faces);
}

TEST(CreaseRefinement, NewFacesAreBounded) {
  // One split makes two.
  EXPECT_LE(Refined(shapes::Cube(), 1e-3, 100).mesh.faces.size(), 12u + 101u);
}

// A cube of twelve faces: its corners were cut off and its sides taken for bulges.
TEST(CreaseRefinement, CubeIsSampledAsEvenlyAsASmoothSurface) {
  const TriangleMesh cube = shapes::Cube();
  SamplingOptions options;
  options.sample_count = 4000;
  const SamplingResult result = *SampleSurface(cube, options);
  EXPECT_EQ(sampling_test::FindFault(cube, 4000, result), "");
  EXPECT_EQ(result.surface.faces, 12);
  EXPECT_EQ(result.surface.vertices, 8);
  EXPECT_LE(result.capacity_cv, 0.027);
  EXPECT_GE(result.relative_radius, 0.62);
  const quality::TriangleTree tree(result.samples.positions, result.samples.triangles);
  EXPECT_LE(quality::LargestDistance(cube.positions, tree) / result.surface.diagonal, 0.015);
}

}  // namespace
}  // namespace ccst::internal
