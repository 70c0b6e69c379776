#include "server/meshes/measure_mesh.h"

#include <cmath>
#include <limits>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/server/store/store_fixture.h"
#include "tests/support/shapes.h"

namespace ccst::server {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

TEST(MeshFactsTest, CubeHasItsCountsAreaAndBounds) {
  const MeshFacts facts = *MeasureMesh(shapes::Cube());
  EXPECT_EQ(facts.vertices, 8);
  EXPECT_EQ(facts.file_faces, 12);
  EXPECT_EQ(facts.components, 1);
  EXPECT_EQ(facts.boundary_loops, 0);
  EXPECT_DOUBLE_EQ(facts.area, 24.0);
  EXPECT_EQ(facts.bounds_min, Eigen::Vector3d(-1, -1, -1));
  EXPECT_EQ(facts.bounds_max, Eigen::Vector3d(1, 1, 1));
  EXPECT_THAT(facts.attributes, IsEmpty());
  EXPECT_THAT(facts.warnings, IsEmpty());
}

TEST(MeshFactsTest, PiecesAndLoopsAreCounted) {
  const TriangleMesh pieces[] = {
      shapes::Cylinder(1.0, 2.0, 8, 2),
      shapes::Moved(shapes::SingleTriangle(), Eigen::Vector3d(10, 0, 0))};
  const MeshFacts facts = *MeasureMesh(shapes::DisjointUnion(pieces));
  EXPECT_EQ(facts.components, 2);
  EXPECT_EQ(facts.boundary_loops, 3);
}

TEST(MeshFactsTest, RepairsAreCountedInWarnings) {
  TriangleMesh mesh = shapes::WithIsolatedVertices(shapes::Unwelded(shapes::Cube()), 2);
  mesh.faces.push_back(mesh.faces.front());
  const MeshFacts facts = *MeasureMesh(mesh);
  EXPECT_EQ(facts.vertices, 8);
  EXPECT_EQ(facts.file_faces, 13);
  EXPECT_DOUBLE_EQ(facts.area, 24.0);
  EXPECT_THAT(facts.warnings,
              ElementsAre(HasSubstr("28 vertices"), HasSubstr("2 vertices"), HasSubstr("1 faces")));
}

TEST(MeshFactsTest, AttributesHaveTheirFiniteRange) {
  TriangleMesh mesh = shapes::Tetrahedron();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  mesh.attributes = {
      {.name = "heat", .components = 1, .values = {nan, 2.0F, -3.0F, 1.0F}},
      {.name = "flow", .components = 2, .values = {1.0F, 2.0F, 3.0F, 4.0F, 5.0F, 6.0F, 7.0F, 8.0F}},
      {.name = "none", .components = 1, .values = {nan, nan, nan, nan}}};
  const MeshFacts facts = *MeasureMesh(mesh);
  ASSERT_THAT(facts.attributes, SizeIs(3));
  EXPECT_EQ(facts.attributes[0].name, "heat");
  EXPECT_EQ(facts.attributes[0].components, 1);
  EXPECT_EQ(facts.attributes[0].min_value, -3.0);
  EXPECT_EQ(facts.attributes[0].max_value, 2.0);
  EXPECT_EQ(facts.attributes[1].components, 2);
  EXPECT_EQ(facts.attributes[1].min_value, 1.0);
  EXPECT_EQ(facts.attributes[1].max_value, 8.0);
  EXPECT_EQ(facts.attributes[2].min_value, 0.0);
  EXPECT_EQ(facts.attributes[2].max_value, 0.0);
}

TEST(MeshFactsTest, MeshThatCannotBeSampledIsRefusedAsSamplingWould) {
  TriangleMesh flat = shapes::SingleTriangle();
  flat.positions[2] = flat.positions[1];
  ExpectError(MeasureMesh(flat).status(), absl::StatusCode::kInvalidArgument, "MESH_EMPTY");
  TriangleMesh broken = shapes::Cube();
  broken.positions[3].x() = std::nan("");
  ExpectError(MeasureMesh(broken).status(), absl::StatusCode::kInvalidArgument, "MESH_DEGENERATE");
}

}  // namespace
}  // namespace ccst::server
