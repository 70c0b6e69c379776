#include "core/sampling/mesh/faults.h"

#include <cmath>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/core/sampling/sampling_test_util.h"
#include "tests/support/shapes.h"

namespace ccst::internal {
namespace {

using sampling_test::MakeStart;
using sampling_test::Start;
using testing::HasSubstr;

// Four triangles around vertex 4, in a square whose corners are the others.
SampleMesh Square() {
  SampleMesh mesh;
  mesh.SetTriangles(5, {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}});
  return mesh;
}

TEST(SampleMeshFault, SoundMeshesHaveNone) {
  EXPECT_EQ(FindFault(SampleMesh()), "");
  EXPECT_EQ(FindFault(Square()), "");
  SampleMesh thinned = Square();
  thinned.SetTriangles(5, {{0, 1, 4}, {1, 2, 4}, {-1, -1, -1}, {2, 0, 4}});
  EXPECT_EQ(FindFault(thinned), "");
}

TEST(SampleMeshFault, TwinsThatDoNotMatchAreNamed) {
  SampleMesh mesh = Square();
  mesh.twin[1] = 0;
  EXPECT_THAT(FindFault(mesh), HasSubstr("half-edge 1 and its twin 0 do not match"));
}

TEST(SampleMeshFault, CornersThatAreNoVerticesAreNamed) {
  SampleMesh mesh = Square();
  mesh.origin[1] = 9;
  EXPECT_THAT(FindFault(mesh), HasSubstr("half-edge 1 starts at 9, which is no vertex"));
  mesh = Square();
  mesh.origin[1] = 0;
  EXPECT_THAT(FindFault(mesh), HasSubstr("half-edge 0 ends where it starts"));
}

TEST(SampleMeshFault, VerticesThatLeaveElsewhereAreNamed) {
  SampleMesh mesh = Square();
  mesh.outgoing[2] = 0;
  EXPECT_THAT(FindFault(mesh), HasSubstr("outgoing half-edge of 2 starts elsewhere"));
  mesh.outgoing[2] = -1;
  EXPECT_THAT(FindFault(mesh), HasSubstr("vertex 2 has triangles but no half-edge"));
}

TEST(SampleMeshFault, BoundaryVerticesLeaveThroughTheBoundary) {
  SampleMesh mesh = Square();
  // Vertex 1 leaves through 1 -> 2 on the boundary; the other half-edge from it is 1 -> 4.
  for (std::int32_t h = 0; h < 12; ++h) {
    if (mesh.origin[h] == 1 && mesh.twin[h] >= 0) mesh.outgoing[1] = h;
  }
  EXPECT_NE(FindFault(mesh), "");
}

TEST(SampleMeshFault, TwoFansAtAVertexAreNamed) {
  SampleMesh mesh;
  mesh.SetTriangles(5, {{0, 1, 2}, {0, 3, 4}});
  EXPECT_THAT(FindFault(mesh), HasSubstr("walking around 0 sees 1 of 2 triangles"));
}

TEST(SampleMeshFault, EdgesLockedOnOneSideAreNamed) {
  SampleMesh mesh = Square();
  mesh.Lock(1);
  EXPECT_EQ(FindFault(mesh), "");
  mesh.locked[mesh.twin[1]] = 0;
  EXPECT_THAT(FindFault(mesh), HasSubstr("are not both locked"));
}

class SamplesFault : public testing::Test {
 protected:
  std::string Found() const { return FindFault(start_.samples, start_.surface); }

  Start start_ = *MakeStart(shapes::Torus(1.0, 0.4, 30, 16), 100);
};

TEST_F(SamplesFault, InitialSamplesHaveNone) { EXPECT_EQ(Found(), ""); }

TEST_F(SamplesFault, ArraysOfOtherLengthsAreNamed) {
  start_.samples.arc.pop_back();
  EXPECT_THAT(Found(), HasSubstr("there are 100 samples, but 99"));
}

TEST_F(SamplesFault, HostsThatAreNoFacesAreNamed) {
  start_.samples.face[3] = -1;
  EXPECT_THAT(Found(), HasSubstr("the host of sample 3 is -1"));
}

TEST_F(SamplesFault, WeightsOutsideTheHostAreNamed) {
  start_.samples.weights[3] = {1.5, -0.25, -0.25};
  EXPECT_THAT(Found(), HasSubstr("the weights of sample 3"));
  start_.samples.weights[3] = {std::nan(""), 0.0, 1.0};
  EXPECT_THAT(Found(), HasSubstr("the weights of sample 3"));
}

TEST_F(SamplesFault, PositionsOffTheHostAreNamed) {
  start_.samples.position[3].z() += 1e-6;
  EXPECT_THAT(Found(), HasSubstr("sample 3 is not where its host and weights say"));
}

TEST_F(SamplesFault, NormalsOfOtherLengthsAreNamed) {
  start_.samples.normal[3] *= 1.1;
  EXPECT_THAT(Found(), HasSubstr("the normal of sample 3"));
}

}  // namespace
}  // namespace ccst::internal
