#include "tests/support/shapes.h"

#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "core/quality/capacity.h"
#include "core/quality/mesh_topology.h"

namespace ccst::shapes {
namespace {

using quality::MeasureTopology;
using quality::MeshTopology;

constexpr double kPi = std::numbers::pi;

MeshTopology Topology(const TriangleMesh& mesh) {
  return MeasureTopology(static_cast<std::int64_t>(mesh.positions.size()), mesh.faces);
}

double Area(const TriangleMesh& mesh) { return quality::TotalArea(mesh.positions, mesh.faces); }

// Positive for a closed mesh oriented outwards.
double Volume(const TriangleMesh& mesh) {
  double volume = 0.0;
  for (const Eigen::Vector3i& t : mesh.faces) {
    volume += mesh.positions[t[0]].dot(mesh.positions[t[1]].cross(mesh.positions[t[2]])) / 6.0;
  }
  return volume;
}

struct Expected {
  std::string name;
  TriangleMesh mesh;
  int euler;
  int components;
  int loops;
};

class ManifoldShape : public testing::TestWithParam<Expected> {};

TEST_P(ManifoldShape, HasItsTopology) {
  const MeshTopology topology = Topology(GetParam().mesh);
  EXPECT_EQ(topology.first_defect, "");
  EXPECT_EQ(topology.euler, GetParam().euler);
  EXPECT_EQ(topology.components, GetParam().components);
  EXPECT_EQ(static_cast<int>(topology.boundary_loops.size()), GetParam().loops);
}

TEST_P(ManifoldShape, HasNoFaceWithoutArea) {
  const TriangleMesh& mesh = GetParam().mesh;
  EXPECT_GT(quality::MeasureCapacities(mesh.positions, mesh.faces).smallest, 0.0);
}

INSTANTIATE_TEST_SUITE_P(
    All, ManifoldShape,
    testing::Values(Expected{"Tetrahedron", Tetrahedron(), 2, 1, 0},
                    Expected{"Cube", Cube(), 2, 1, 0}, Expected{"Icosphere", Icosphere(3), 2, 1, 0},
                    Expected{"UvSphere", UvSphere(8, 12), 2, 1, 0},
                    Expected{"Octahedron", UvSphere(2, 4), 2, 1, 0},
                    Expected{"Torus", Torus(1.0, 0.3, 24, 12), 0, 1, 0},
                    Expected{"SmallestTorus", Torus(1.0, 0.3, 3, 3), 0, 1, 0},
                    Expected{"Plate", PlateWithHoles(0, 0), 2, 1, 0},
                    Expected{"DoubleTorus", PlateWithHoles(2, 2, 4), -2, 1, 0},
                    Expected{"GenusFive", PlateWithHoles(5, 1), -8, 1, 0},
                    Expected{"Cylinder", Cylinder(1.0, 2.0, 16, 4), 0, 1, 2},
                    Expected{"PlaneGrid", PlaneGrid(2.0, 1.0, 6, 3), 1, 1, 1},
                    Expected{"Saddle", Saddle(8), 1, 1, 1},
                    Expected{"SphereWithSmallHole", SphereWithHole(0.05, 12, 24), 1, 1, 1},
                    Expected{"SphereWithLargeHole", SphereWithHole(2.0, 12, 24), 1, 1, 1},
                    Expected{"SingleTriangle", SingleTriangle(), 1, 1, 1},
                    Expected{
                        "Union",
                        DisjointUnion(std::vector{Icosphere(1), Torus(1.0, 0.3, 8, 6), Saddle(2)}),
                        3, 3, 1},
                    Expected{"Subdivided", Subdivided(Torus(1.0, 0.3, 8, 6)), 0, 1, 0},
                    Expected{"Unwelded", Unwelded(Tetrahedron()), 4, 4, 4}),
    [](const auto& param_info) { return param_info.param.name; });

TEST(Shapes, ClosedOnesAreOrientedOutwards) {
  EXPECT_NEAR(Volume(Tetrahedron()), 8.0 / 3.0, 1e-12);
  EXPECT_NEAR(Volume(Cube()), 8.0, 1e-12);
  EXPECT_NEAR(Volume(Icosphere(5)), 4.0 / 3.0 * kPi, 5e-3);
  EXPECT_NEAR(Volume(UvSphere(100, 200)), 4.0 / 3.0 * kPi, 5e-3);
  EXPECT_NEAR(Volume(Torus(1.0, 0.3, 200, 100)), 2.0 * kPi * kPi * 0.09, 5e-3);
  EXPECT_NEAR(Volume(PlateWithHoles(2, 0)), 13.0, 1e-12);
  EXPECT_NEAR(Volume(Unwelded(Cube())), 8.0, 1e-12);
}

TEST(Shapes, OpenOnesFaceTheStatedWay) {
  for (const TriangleMesh& mesh : {PlaneGrid(1.0, 1.0, 3, 3), Saddle(4), SingleTriangle()}) {
    for (const Eigen::Vector3i& t : mesh.faces) {
      EXPECT_GT((mesh.positions[t[1]] - mesh.positions[t[0]])
                    .cross(mesh.positions[t[2]] - mesh.positions[t[0]])
                    .z(),
                0.0);
    }
  }
  for (const TriangleMesh& mesh : {Cylinder(1.0, 2.0, 16, 4), SphereWithHole(0.5, 8, 16)}) {
    for (const Eigen::Vector3i& t : mesh.faces) {
      const Eigen::Vector3d& a = mesh.positions[t[0]];
      const Eigen::Vector3d outwards(a.x(), a.y(), 0.0);
      const Eigen::Vector3d normal = (mesh.positions[t[1]] - a).cross(mesh.positions[t[2]] - a);
      if (outwards.norm() > 0.5) {
        EXPECT_GT(normal.dot(outwards), 0.0);
      }
    }
  }
}

TEST(Shapes, AreasConvergeToTheirClosedForms) {
  EXPECT_NEAR(Area(Icosphere(5, 2.0)), 16.0 * kPi, 0.05);
  EXPECT_NEAR(Area(Torus(1.0, 0.35, 200, 100)), 4.0 * kPi * kPi * 0.35, 0.01);
  EXPECT_NEAR(Area(Cylinder(0.5, 3.0, 200, 10)), 3.0 * kPi, 0.01);
  EXPECT_NEAR(Area(PlaneGrid(2.0, 3.0, 7, 5)), 6.0, 1e-12);
  EXPECT_NEAR(Area(SphereWithHole(1.0, 100, 200)), 2.0 * kPi * (1.0 + std::cos(1.0)), 0.01);
}

TEST(Shapes, BrokenOnesHaveTheStatedDefectOnly) {
  const MeshTopology fins = Topology(ThreeFins());
  EXPECT_EQ(fins.crowded_edges, 1);
  EXPECT_EQ(fins.inconsistent_edges, 0);

  const MeshTopology pinched = Topology(TetrahedraSharingVertex());
  EXPECT_EQ(pinched.split_vertices, 1);
  EXPECT_EQ(pinched.crowded_edges + pinched.inconsistent_edges, 0);
  EXPECT_EQ(pinched.components, 2);
  EXPECT_GT(Volume(TetrahedraSharingVertex()), 5.0);

  const MeshTopology flipped = Topology(WithFlippedFace(Icosphere(1), 7));
  EXPECT_EQ(flipped.inconsistent_edges, 3);

  const MeshTopology moebius = Topology(MoebiusStrip(20, 4));
  EXPECT_EQ(moebius.inconsistent_edges, 4);
  EXPECT_EQ(moebius.crowded_edges + moebius.split_vertices, 0);
  EXPECT_EQ(moebius.euler, 0);

  const MeshTopology padded = Topology(WithIsolatedVertices(Cube(), 5));
  EXPECT_EQ(padded.unused_vertices, 5);
  EXPECT_EQ(padded.euler, 2);
}

}  // namespace
}  // namespace ccst::shapes
