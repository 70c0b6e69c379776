#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/status.h"
#include "core/surface/surface.h"
#include "tests/support/shapes.h"

namespace ccst {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// Builds `mesh`, which must be refused. @return the message.
std::string Refusal(const TriangleMesh& mesh, absl::StatusCode code, ErrorReason reason) {
  const absl::Status status = Surface::Build(mesh).status();
  EXPECT_EQ(status.code(), code) << status;
  EXPECT_EQ(GetErrorReason(status), reason) << status;
  return std::string(status.message());
}

std::string Degenerate(const TriangleMesh& mesh) {
  return Refusal(mesh, absl::StatusCode::kInvalidArgument, ErrorReason::kMeshDegenerate);
}
std::string Empty(const TriangleMesh& mesh) {
  return Refusal(mesh, absl::StatusCode::kInvalidArgument, ErrorReason::kMeshEmpty);
}
std::string NotManifold(const TriangleMesh& mesh) {
  return Refusal(mesh, absl::StatusCode::kFailedPrecondition, ErrorReason::kMeshNotManifold);
}

TEST(SurfaceBuild, NonFiniteCoordinateIsNamed) {
  for (const double bad : {std::numeric_limits<double>::infinity(),
                           -std::numeric_limits<double>::infinity(), std::nan("")}) {
    TriangleMesh mesh = shapes::Icosphere(1);
    mesh.positions[17].y() = bad;
    EXPECT_THAT(Degenerate(mesh), AllOf(HasSubstr("vertex 17"), HasSubstr("not finite")));
  }
}

TEST(SurfaceBuild, IndexOutOfRangeIsNamed) {
  for (const int bad : {-1, 42, 2147483647}) {
    TriangleMesh mesh = shapes::Icosphere(1);
    mesh.faces[33][2] = bad;
    EXPECT_THAT(Degenerate(mesh),
                AllOf(HasSubstr("face 33"), HasSubstr(std::to_string(bad)), HasSubstr("0 to 41")));
  }
}

TEST(SurfaceBuild, RepeatedVertexIsNamed) {
  TriangleMesh mesh = shapes::Icosphere(1);
  mesh.faces[12][1] = mesh.faces[12][0];
  EXPECT_THAT(Degenerate(mesh), HasSubstr("face 12"));
}

TEST(SurfaceBuild, MeshWithoutFacesIsEmpty) {
  EXPECT_THAT(Empty({}), HasSubstr("no faces"));
  EXPECT_THAT(Empty({{{0, 0, 0}, {1, 0, 0}}, {}}), HasSubstr("no faces"));
}

TEST(SurfaceBuild, MeshWithoutAreaIsEmpty) {
  const TriangleMesh line = {{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}, {{0, 1, 2}}};
  EXPECT_THAT(Empty(line), HasSubstr("area"));
}

TEST(SurfaceBuild, EdgeOfThreeFacesIsNamed) {
  EXPECT_THAT(NotManifold(shapes::ThreeFins()),
              AllOf(HasSubstr("the edge between vertices 0 and 1"), HasSubstr("near ("),
                    HasSubstr("faces (")));
}

TEST(SurfaceBuild, VertexOfTwoFansIsNamed) {
  EXPECT_THAT(NotManifold(shapes::TetrahedraSharingVertex()),
              AllOf(HasSubstr("vertex 0 at"), HasSubstr("6 faces"), HasSubstr("only 3")));
}

TEST(SurfaceBuild, FlippedNeighbourIsNamed) {
  const TriangleMesh mesh = shapes::WithFlippedFace(shapes::Icosphere(1), 40);
  EXPECT_THAT(NotManifold(mesh), AllOf(HasSubstr("same direction"), HasSubstr("40")));
}

TEST(SurfaceBuild, DuplicateFaceIsRefused) {
  TriangleMesh mesh = shapes::SingleTriangle();
  mesh.faces.push_back(mesh.faces[0]);
  EXPECT_THAT(NotManifold(mesh), HasSubstr("faces 0 and 1"));
}

TEST(SurfaceBuild, MoebiusStripIsRefused) {
  EXPECT_THAT(NotManifold(shapes::MoebiusStrip(20, 3)), HasSubstr("same direction"));
}

TEST(SurfaceBuild, EqualPositionsStayApart) {
  const TriangleMesh mesh = shapes::Unwelded(shapes::Icosphere(2));
  const absl::StatusOr<Surface> surface = Surface::Build(mesh);
  ASSERT_TRUE(surface.ok()) << surface.status();
  EXPECT_EQ(surface->faces(), mesh.faces);
  EXPECT_EQ(surface->boundary_loops().size(), mesh.faces.size());
}

TEST(SurfaceBuild, VertexOfNoFaceIsNamed) {
  TriangleMesh mesh = shapes::Tetrahedron();
  mesh.positions.emplace_back(0, 0, 0);
  EXPECT_THAT(NotManifold(mesh), HasSubstr("vertex 4 at"));
}

class SurfaceScale : public testing::TestWithParam<double> {};

TEST_P(SurfaceScale, UnitFrameIsTheSameAtEveryScale) {
  const double scale = GetParam();
  const TriangleMesh mesh = shapes::Torus(1.0, 0.35, 20, 12);
  const Surface base = *Surface::Build(mesh);
  const absl::StatusOr<Surface> scaled = Surface::Build(shapes::Moved(mesh, {0, 0, 0}, scale));
  ASSERT_TRUE(scaled.ok()) << scaled.status();
  // The unit is a power of two, so the unit frames agree up to a factor of two.
  const double ratio = scaled->diagonal() / base.diagonal();
  EXPECT_GT(ratio, 0.49);
  EXPECT_LT(ratio, 2.01);
  EXPECT_EQ(std::exp2(std::round(std::log2(scaled->unit()))), scaled->unit());
  const double longest = 2.7 * scale / scaled->unit();
  EXPECT_GE(longest, 0.5 - 1e-12);
  EXPECT_LT(longest, 1.0 + 1e-12);
  for (int v = 0; v < base.vertex_count(); ++v) {
    EXPECT_LT((scaled->normals()[v] - base.normals()[v]).norm(), 1e-9);
    EXPECT_LT((scaled->ToMesh(scaled->positions()[v]) / scale - mesh.positions[v]).norm(), 1e-12);
  }
  EXPECT_NEAR(scaled->area() / (ratio * ratio), base.area(), 1e-9);
}

INSTANTIATE_TEST_SUITE_P(, SurfaceScale, testing::Values(1e-30, 1e-12, 1.0, 3.0, 1e12, 1e30));

TEST(SurfaceBuild, LargeOffsetKeepsWhatTheCoordinatesHold) {
  const Eigen::Vector3d offset(1e7, -1e7, 1e7);
  const TriangleMesh mesh = shapes::Moved(shapes::Icosphere(2), offset);
  const absl::StatusOr<Surface> surface = Surface::Build(mesh);
  ASSERT_TRUE(surface.ok()) << surface.status();
  for (int v = 0; v < surface->vertex_count(); ++v) {
    EXPECT_LT((surface->ToMesh(surface->positions()[v]) - mesh.positions[v]).norm(), 1e-8);
    EXPECT_LT((surface->normals()[v] - (mesh.positions[v] - offset).normalized()).norm(), 0.03);
  }
}

// So many faces that they are several pieces.
TEST(SurfaceBuild, ThreadsGiveTheSameBits) {
  const TriangleMesh mesh = shapes::SphereWithHole(0.8, 100, 150);
  Interrupt never;
  const Surface base = *Surface::Build(mesh);
  for (const int threads : {2, 3, 8}) {
    const Surface other = *Surface::Build(mesh, &never, Parallel(threads));
    EXPECT_EQ(other.normals(), base.normals());
    EXPECT_EQ(other.face_areas(), base.face_areas());
    EXPECT_EQ(other.area(), base.area());
    EXPECT_EQ(other.twins(), base.twins());
    EXPECT_EQ(other.outgoing(), base.outgoing());
    for (int f = 0; f < base.face_count(); ++f) {
      for (int k = 0; k < 3; ++k) {
        ASSERT_EQ(other.ShapeAt(f, Eigen::Vector3d::Unit(k)),
                  base.ShapeAt(f, Eigen::Vector3d::Unit(k)));
      }
    }
  }
}

// The culprits lie in different pieces; whichever is found first in time, the first in order is
// told.
TEST(SurfaceBuild, ThreadsNameTheSameCulprit) {
  TriangleMesh mesh = shapes::PlaneGrid(1, 1, 150, 100);
  mesh.faces[29000] = Eigen::Vector3i(5, 5, 6);
  mesh.faces[9000] = Eigen::Vector3i(7, 7, 8);
  TriangleMesh flipped = shapes::PlaneGrid(1, 1, 150, 150);
  std::swap(flipped.faces[40000][0], flipped.faces[40000][1]);
  std::swap(flipped.faces[20000][0], flipped.faces[20000][1]);
  Interrupt never;
  for (const TriangleMesh& bad : {mesh, flipped}) {
    const absl::Status base = Surface::Build(bad).status();
    ASSERT_FALSE(base.ok());
    for (const int threads : {2, 3, 8}) {
      EXPECT_EQ(Surface::Build(bad, &never, Parallel(threads)).status(), base);
    }
  }
}

}  // namespace
}  // namespace ccst
