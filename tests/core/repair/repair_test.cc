#include "core/repair/repair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/status.h"
#include "core/quality/mesh_topology.h"
#include "tests/core/repair/repair_test_util.h"
#include "tests/support/shapes.h"

namespace ccst {
namespace {

using ::ccst::testing::Repaired;
using ::testing::HasSubstr;

quality::MeshTopology Topology(const TriangleMesh& mesh) {
  return quality::MeasureTopology(mesh.positions.size(), mesh.faces);
}

double SignedVolume(const TriangleMesh& mesh) {
  double volume = 0.0;
  for (const Eigen::Vector3i& t : mesh.faces) {
    volume += mesh.positions[t[0]].cross(mesh.positions[t[1]]).dot(mesh.positions[t[2]]) / 6.0;
  }
  return volume;
}

void ExpectUnchanged(const TriangleMesh& mesh) {
  const RepairedMesh result = Repaired(mesh);
  EXPECT_TRUE(result.report.IsClean());
  EXPECT_EQ(result.mesh.positions, mesh.positions);
  EXPECT_EQ(result.mesh.faces, mesh.faces);
  ASSERT_EQ(result.source_face.size(), mesh.faces.size());
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    ASSERT_EQ(result.source_face[f], static_cast<std::int32_t>(f));
  }
}

void ExpectRefused(const TriangleMesh& mesh, const RepairOptions& options, ErrorReason reason,
                   const std::string& part) {
  const auto result = Repair(mesh, options);
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(GetErrorReason(result.status()), reason) << result.status().ToString();
  EXPECT_THAT(std::string(result.status().message()), HasSubstr(part));
}

TEST(Repair, ManifoldsComeBackAsTheyAre) {
  ExpectUnchanged(shapes::Tetrahedron());
  ExpectUnchanged(shapes::Icosphere(3));
  ExpectUnchanged(shapes::Torus(1.0, 0.3, 20, 10));
  ExpectUnchanged(shapes::PlateWithHoles(4, 1));
  ExpectUnchanged(shapes::PlaneGrid(1.0, 2.0, 5, 4));
  ExpectUnchanged(shapes::Cylinder(1.0, 1.0, 12, 3));
  ExpectUnchanged(shapes::SingleTriangle());
}

TEST(Repair, InwardManifoldStaysInward) {
  TriangleMesh mesh = shapes::Icosphere(2);
  for (Eigen::Vector3i& face : mesh.faces) std::swap(face[1], face[2]);
  ExpectUnchanged(mesh);
}

TEST(Repair, ExtremeScalesAndOffsetsComeBackAsTheyAre) {
  for (const double scale : {1e-200, 1e-12, 1e-3, 1e12, 1e30, 1e200}) {
    ExpectUnchanged(shapes::Moved(shapes::Icosphere(3), {0.0, 0.0, 0.0}, scale));
    ExpectUnchanged(shapes::Moved(shapes::Torus(1.0, 0.3, 30, 10),
                                  scale * 1e7 * Eigen::Vector3d::Ones(), scale));
  }
}

TEST(Repair, PiecesThatTouchButAreManifoldAsIndexedComeBackAsTheyAre) {
  // Two cubes with vertices of their own, at one vertex, at one edge, and with a gap of nothing
  // between two whole sides (whose diagonals differ, or the sides would be duplicates).
  const TriangleMesh cube = shapes::Cube();
  for (const Eigen::Vector3d& offset : {Eigen::Vector3d(2, 2, 2), Eigen::Vector3d(2, 2, 0)}) {
    ExpectUnchanged(shapes::DisjointUnion(std::array{cube, shapes::Moved(cube, offset)}));
  }
}

TEST(Repair, UnweldedFacesAreJoined) {
  const TriangleMesh sphere = shapes::Icosphere(2);
  const RepairedMesh result = Repaired(shapes::Unwelded(sphere));
  RepairReport expected;
  expected.welded_vertices = static_cast<std::int64_t>(3 * sphere.faces.size() - 162);
  EXPECT_EQ(result.report, expected);
  EXPECT_EQ(Topology(result.mesh).euler, 2);
}

TEST(Repair, NegativeZeroIsZero) {
  TriangleMesh mesh = shapes::Unwelded(shapes::PlaneGrid(1.0, 1.0, 2, 2));
  for (std::size_t i = 0; i < mesh.positions.size(); i += 2) {
    if (mesh.positions[i][0] == 0.0) mesh.positions[i][0] = -0.0;
  }
  EXPECT_EQ(Repaired(mesh).mesh.positions.size(), 9u);
}

TEST(Repair, ToleranceJoinsWhatIsWithinItAndNothingElse) {
  const TriangleMesh sphere = shapes::Icosphere(2);
  TriangleMesh mesh = shapes::Unwelded(sphere);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    mesh.positions[i][i % 3] += 1e-6 * static_cast<double>(i % 5);
  }
  const RepairedMesh result = Repaired(mesh, {.weld_tolerance = 1e-5});
  EXPECT_EQ(result.mesh.positions.size(), sphere.positions.size());
  EXPECT_EQ(Topology(result.mesh).euler, 2);
  EXPECT_GT(Topology(Repaired(mesh, {.weld_tolerance = 1e-9}).mesh).components, 100);
}

TEST(Repair, ToleranceOfASideCollapsesSmallFaces) {
  const RepairedMesh result = Repaired(shapes::UvSphere(24, 24), {.weld_tolerance = 0.05});
  EXPECT_GT(result.report.repeated_index_faces, 0);
  EXPECT_GT(result.report.welded_vertices, 0);
  EXPECT_EQ(Topology(result.mesh).euler, 2);
}

TEST(Repair, RepeatedIndexFacesAreDropped) {
  TriangleMesh mesh = shapes::Icosphere(1);
  mesh.faces.insert(mesh.faces.begin(), Eigen::Vector3i(4, 4, 7));
  mesh.faces.push_back(Eigen::Vector3i(3, 3, 3));
  const RepairedMesh result = Repaired(mesh);
  EXPECT_EQ(result.report, (RepairReport{.repeated_index_faces = 2}));
  EXPECT_EQ(result.source_face.front(), 1);
}

TEST(Repair, DuplicatesOfEitherOrientationAreDroppedAndTheFirstKept) {
  TriangleMesh mesh = shapes::Icosphere(1);
  const std::vector<Eigen::Vector3i> faces = mesh.faces;
  for (std::size_t i = 0; i < faces.size(); i += 3) {
    const Eigen::Vector3i& t = faces[i];
    mesh.faces.push_back(i % 2 == 0 ? Eigen::Vector3i(t[1], t[2], t[0])
                                    : Eigen::Vector3i(t[2], t[1], t[0]));
  }
  const RepairedMesh result = Repaired(mesh);
  EXPECT_EQ(result.report, (RepairReport{.duplicate_faces = static_cast<std::int64_t>(
                                             mesh.faces.size() - faces.size())}));
  EXPECT_EQ(result.mesh.faces, faces);
}

TEST(Repair, IsolatedVerticesAreDropped) {
  const TriangleMesh sphere = shapes::Icosphere(1);
  const RepairedMesh result = Repaired(shapes::WithIsolatedVertices(sphere, 17));
  EXPECT_EQ(result.report, (RepairReport{.isolated_vertices = 17}));
  EXPECT_EQ(result.mesh.positions, sphere.positions);
  EXPECT_EQ(result.mesh.faces, sphere.faces);
}

TEST(Repair, FlippedFaceIsTurnedBack) {
  const TriangleMesh sphere = shapes::Icosphere(2);
  for (const int face : {0, 7, 100}) {
    const RepairedMesh result = Repaired(shapes::WithFlippedFace(sphere, face));
    EXPECT_EQ(result.report, (RepairReport{.flipped_faces = 1}));
    EXPECT_GT(SignedVolume(result.mesh), 0.0);
  }
}

TEST(Repair, MajorityOrientsAndOfEqualsOutwardsWins) {
  const TriangleMesh sphere = shapes::Icosphere(2);
  TriangleMesh mesh = sphere;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    if (f % 3 != 0) std::swap(mesh.faces[f][0], mesh.faces[f][1]);
  }
  EXPECT_LT(SignedVolume(Repaired(mesh).mesh), 0.0);
  for (const std::size_t parity : {0u, 1u}) {
    mesh = sphere;
    for (std::size_t f = parity; f < mesh.faces.size(); f += 2) {
      std::swap(mesh.faces[f][0], mesh.faces[f][1]);
    }
    // Faces in another order, so that vertices are not met in theirs.
    std::reverse(mesh.faces.begin(), mesh.faces.end());
    const RepairedMesh result = Repaired(mesh);
    EXPECT_GT(SignedVolume(result.mesh), 0.0);
    EXPECT_EQ(result.report.flipped_faces, static_cast<std::int64_t>(mesh.faces.size() / 2));
  }
}

TEST(Repair, ThreeFinsKeepTheFlattestPair) {
  const RepairedMesh result = Repaired(shapes::ThreeFins());
  EXPECT_EQ(result.report.cut_edges, 1);
  EXPECT_EQ(result.report.cut_vertices, 2);
  EXPECT_EQ(Topology(result.mesh).components, 2);
}

TEST(Repair, FinOnASheetComesOffAndTheSheetStaysWhole) {
  TriangleMesh mesh = shapes::PlaneGrid(1.0, 1.0, 4, 4);
  const Eigen::Vector3i inner = mesh.faces[12];
  const auto tip = static_cast<std::int32_t>(mesh.positions.size());
  mesh.positions.push_back(mesh.positions[inner[0]] + Eigen::Vector3d(0.1, 0.0, 1.0));
  mesh.faces.insert(mesh.faces.begin(), Eigen::Vector3i(inner[0], inner[1], tip));
  const RepairedMesh result = Repaired(mesh);
  EXPECT_EQ(result.report, (RepairReport{.cut_edges = 1, .cut_vertices = 2}));
  const quality::MeshTopology topology = Topology(result.mesh);
  EXPECT_EQ(topology.components, 2);
  EXPECT_EQ(topology.boundary_loops.size(), 2u);
}

/// Two cubes of edge 2 that share the vertices at one edge.
TriangleMesh CubesSharingEdge() {
  TriangleMesh mesh = shapes::DisjointUnion(
      std::array{shapes::Cube(), shapes::Moved(shapes::Cube(), {2.0, 2.0, 0.0})});
  for (Eigen::Vector3i& face : mesh.faces) {
    for (int k = 0; k < 3; ++k) {
      for (int i = 0; i < 8; ++i) {
        if (mesh.positions[face[k]] == mesh.positions[i]) face[k] = i;
      }
    }
  }
  return mesh;
}

TEST(Repair, CubesSharingAnEdgeBecomeTwoCubes) {
  const RepairedMesh result = Repaired(CubesSharingEdge());
  EXPECT_EQ(result.report.cut_edges, 1);
  EXPECT_EQ(result.report.cut_vertices, 2);
  EXPECT_EQ(result.report.flipped_faces, 0);
  const quality::MeshTopology topology = Topology(result.mesh);
  EXPECT_EQ(topology.components, 2);
  EXPECT_EQ(topology.euler, 4);
  EXPECT_TRUE(topology.boundary_loops.empty());
}

TEST(Repair, CrossingSheetsComeApartAlongTheFlatPairs) {
  // A cross of four half-planes, all with the same axis; opposite ones continue each other.
  TriangleMesh mesh;
  for (int i = 0; i <= 6; ++i) mesh.positions.emplace_back(0.0, 0.0, i);
  const std::array<Eigen::Vector3d, 4> out = {
      Eigen::Vector3d{1.0, 0.1, 0.0}, {-0.1, 1.0, 0.0}, {-1.0, -0.1, 0.0}, {0.1, -1.0, 0.0}};
  for (int wing = 0; wing < 4; ++wing) {
    const auto base = static_cast<std::int32_t>(mesh.positions.size());
    for (int i = 0; i <= 6; ++i) mesh.positions.push_back(mesh.positions[i] + out[wing]);
    for (int i = 0; i < 6; ++i) {
      const bool turned = wing >= 2;
      const Eigen::Vector3i low(i, base + i, i + 1);
      const Eigen::Vector3i high(i + 1, base + i, base + i + 1);
      for (Eigen::Vector3i face : {low, high}) {
        if (turned) std::swap(face[0], face[1]);
        mesh.faces.push_back(face);
      }
    }
  }
  const RepairedMesh result = Repaired(mesh);
  EXPECT_EQ(result.report, (RepairReport{.cut_edges = 6, .cut_vertices = 7}));
  const quality::MeshTopology topology = Topology(result.mesh);
  EXPECT_EQ(topology.components, 2);
  EXPECT_EQ(topology.euler, 2);
}

TEST(Repair, SharedVertexIsSplit) {
  const RepairedMesh result = Repaired(shapes::TetrahedraSharingVertex());
  EXPECT_EQ(result.report, (RepairReport{.cut_vertices = 1}));
  EXPECT_EQ(Topology(result.mesh).components, 2);
}

TEST(Repair, MoebiusStripIsCutOnceAcrossWhereItsOrientationBreaks) {
  const RepairedMesh result = Repaired(shapes::MoebiusStrip(40, 6));
  EXPECT_EQ(result.report.non_orientable_cuts, 6);
  EXPECT_EQ(result.report.cut_vertices, 7);
  EXPECT_EQ(result.report.flipped_faces, 0);
  const quality::MeshTopology topology = Topology(result.mesh);
  EXPECT_EQ(topology.components, 1);
  EXPECT_EQ(topology.euler, 1);  // A disk.
  EXPECT_EQ(topology.boundary_loops.size(), 1u);
}

TEST(Repair, MoebiusStripWithFlippedFacesIsCutShort) {
  TriangleMesh mesh = shapes::MoebiusStrip(40, 6);
  for (std::size_t f = 0; f < mesh.faces.size(); f += 3) {
    std::swap(mesh.faces[f][0], mesh.faces[f][1]);
  }
  const RepairedMesh result = Repaired(mesh);
  EXPECT_GE(result.report.non_orientable_cuts, 6);
  EXPECT_LE(result.report.non_orientable_cuts, 30);
}

/// A 4 x 4 square whose face below the diagonal ab is cut off at c, the middle of the diagonal,
/// and the sliver (a, c, b) that an exporter fills the gap with.
TriangleMesh SliverInASquare() {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {4, 4, 0}, {2, 2, 0}, {4, 0, 0}, {0, 4, 0}};
  mesh.faces = {{0, 3, 2}, {3, 1, 2}, {0, 2, 1}, {0, 1, 4}};
  return mesh;
}

TEST(Repair, CapIsReplacedBySplittingItsNeighbour) {
  const RepairedMesh result = Repaired(SliverInASquare());
  EXPECT_EQ(result.report, (RepairReport{.degenerate_faces = 1, .split_faces = 1}));
  EXPECT_EQ(result.source_face, (std::vector<std::int32_t>{0, 1, 3, 3}));
  const quality::MeshTopology topology = Topology(result.mesh);
  EXPECT_EQ(topology.boundary_loops.size(), 1u);
  EXPECT_EQ(topology.boundary_loops[0].size(), 4u);
}

TEST(Repair, CapFarFromTheOriginOnAnObliqueLineIsReplacedToo) {
  TriangleMesh mesh = SliverInASquare();
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1.0, 2.0, 3.0).normalized()).toRotationMatrix();
  for (Eigen::Vector3d& p : mesh.positions) p = 1e-3 * (turn * p) + Eigen::Vector3d(1e4, -2e4, 7e3);
  EXPECT_EQ(Repaired(mesh).report, (RepairReport{.degenerate_faces = 1, .split_faces = 1}));
}

TEST(Repair, FanOfCapsAlongOneSideIsReplacedOneByOne) {
  // Side ab of the upper face meets three vertices of the lower faces; the gap is a fan at a.
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}, {2, 3, 0}, {2, -3, 0}};
  mesh.faces = {{0, 4, 5}, {0, 1, 2}, {0, 2, 3}, {0, 3, 4},
                {1, 0, 6}, {2, 1, 6}, {3, 2, 6}, {4, 3, 6}};
  const RepairedMesh result = Repaired(mesh);
  EXPECT_EQ(result.report, (RepairReport{.degenerate_faces = 3, .split_faces = 3}));
  EXPECT_EQ(Topology(result.mesh).boundary_loops.at(0).size(), 4u);
}

TEST(Repair, SliversThatHangOnAClosedEdgeAreDropped) {
  TriangleMesh mesh = shapes::Icosphere(1);
  const auto sphere_faces = mesh.faces;
  for (std::size_t f = 0; f < sphere_faces.size(); f += 2) {
    const Eigen::Vector3i& t = sphere_faces[f];
    const auto middle = static_cast<std::int32_t>(mesh.positions.size());
    // Within nine decimals of the edge, as text files have it.
    const Eigen::Vector3d m = 0.5 * (mesh.positions[t[0]] + mesh.positions[t[1]]);
    mesh.positions.push_back((m * 1e9).array().round().matrix() / 1e9);
    mesh.faces.push_back({t[0], t[1], middle});
  }
  const RepairedMesh result = Repaired(mesh);
  const auto slivers = static_cast<std::int64_t>(mesh.faces.size() - sphere_faces.size());
  EXPECT_EQ(result.report,
            (RepairReport{.degenerate_faces = slivers, .isolated_vertices = slivers}));
  EXPECT_EQ(result.mesh.faces, sphere_faces);
}

TEST(Repair, NeedlesStay) {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {0, 1e-6, 0}, {1, 0, 0}, {1, 1e-6, 0}, {0, 1, 0}};
  mesh.faces = {{0, 2, 1}, {1, 2, 3}, {1, 3, 4}};
  ExpectUnchanged(mesh);
}

TEST(Repair, ManyFacesAtOneVertexAndOneEdgeAreQuick) {
  // A wheel of 100,000 faces, and a book of as many pages whose spine ends at the hub: a page at
  // every spoke.
  const int count = 100'000;
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {0, 0, 1}};
  for (int i = 0; i < count; ++i) {
    const double angle = 2.0 * M_PI * i / count;
    mesh.positions.emplace_back(std::cos(angle), std::sin(angle), 0.5);
    mesh.faces.emplace_back(0, 1, 2 + i);
    mesh.faces.emplace_back(0, 2 + i, 2 + (i + 1) % count);
  }
  const auto result = Repair(mesh);
  ASSERT_TRUE(result.ok());
  EXPECT_TRUE(Topology(result->mesh).IsManifold());
  EXPECT_EQ(result->report.cut_edges, count + 1);
}

TEST(Repair, EqualInputGivesEqualBits) {
  TriangleMesh mesh = shapes::Unwelded(shapes::MoebiusStrip(30, 3));
  const RepairedMesh one = Repaired(mesh);
  const RepairedMesh two = Repaired(mesh);
  EXPECT_EQ(one.mesh.positions, two.mesh.positions);
  EXPECT_EQ(one.mesh.faces, two.mesh.faces);
  EXPECT_EQ(one.source_face, two.source_face);
}

// So many faces that several threads look for defects; one is in the last piece.
TEST(Repair, ThreadsFindTheSameDefects) {
  const TriangleMesh clean = shapes::Torus(1, 0.35, 200, 100);
  TriangleMesh flipped = clean;
  std::swap(flipped.faces.back()[0], flipped.faces.back()[1]);
  TriangleMesh doubled = clean;
  doubled.positions.back() = doubled.positions.front();
  TriangleMesh flat = clean;
  flat.faces.back() = Eigen::Vector3i(0, 1, 1);
  for (const TriangleMesh& mesh : {clean, flipped, doubled, flat}) {
    const RepairedMesh base = *Repair(mesh);
    for (const int threads : {2, 3, 8}) {
      const RepairedMesh other = *Repair(mesh, {}, nullptr, Parallel(threads));
      EXPECT_EQ(other.report, base.report);
      EXPECT_EQ(other.mesh.faces, base.mesh.faces);
      EXPECT_EQ(other.mesh.positions, base.mesh.positions);
    }
  }
}

TEST(Repair, AllDefectsTogetherAreRepairedAndCounted) {
  TriangleMesh mesh = shapes::DisjointUnion(std::array{
      shapes::WithFlippedFace(shapes::Unwelded(shapes::Icosphere(2)), 5), shapes::ThreeFins(),
      shapes::MoebiusStrip(30, 3), shapes::TetrahedraSharingVertex(), SliverInASquare()});
  mesh.faces.push_back(mesh.faces[3]);
  mesh.faces.push_back({0, 0, 1});
  mesh.positions.emplace_back(9.0, 9.0, 9.0);
  const RepairReport report = Repaired(mesh).report;
  EXPECT_GT(report.welded_vertices, 0);
  EXPECT_EQ(report.repeated_index_faces, 1);
  EXPECT_GE(report.duplicate_faces, 1);
  EXPECT_GE(report.degenerate_faces, 1);
  EXPECT_GE(report.cut_edges, 1);
  EXPECT_GE(report.non_orientable_cuts, 3);
  EXPECT_GE(report.cut_vertices, 3);
  EXPECT_GE(report.flipped_faces, 1);
  EXPECT_EQ(report.isolated_vertices, 1);
}

TEST(Repair, ImpossibleInputIsRefusedNamingTheFirstCulprit) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const TriangleMesh sphere = shapes::Icosphere(1);
  ExpectRefused(sphere, {.weld_tolerance = -1.0}, ErrorReason::kOptionInvalid, "-1");
  ExpectRefused(sphere, {.weld_tolerance = nan}, ErrorReason::kOptionInvalid, "nan");
  ExpectRefused({}, {}, ErrorReason::kMeshEmpty, "no faces");
  TriangleMesh mesh = sphere;
  mesh.positions[7][1] = nan;
  mesh.positions[9][1] = nan;
  ExpectRefused(mesh, {}, ErrorReason::kMeshDegenerate, "vertex 7");
  mesh = sphere;
  mesh.faces[5][2] = 42;
  ExpectRefused(mesh, {}, ErrorReason::kMeshDegenerate, "face 5 refers to vertex 42");
  mesh.faces[4][0] = -1;
  ExpectRefused(mesh, {}, ErrorReason::kMeshDegenerate, "face 4 refers to vertex -1");
  mesh = sphere;
  for (Eigen::Vector3d& p : mesh.positions) p = Eigen::Vector3d(1.0, 2.0, 3.0);
  ExpectRefused(mesh, {}, ErrorReason::kMeshEmpty, "face 0");
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    mesh.positions[i] = static_cast<double>(i) * Eigen::Vector3d(1.0, 0.1, 0.3);
  }
  ExpectRefused(mesh, {}, ErrorReason::kMeshEmpty, "face 0");
  ExpectRefused(sphere, {.weld_tolerance = 10.0}, ErrorReason::kMeshEmpty, "face 0");
  ExpectRefused(sphere, {.weld_tolerance = 1e308}, ErrorReason::kMeshEmpty, "face 0");
  ExpectRefused(shapes::Moved(sphere, {0.0, 0.0, 0.0}, 1e308), {}, ErrorReason::kMeshDegenerate,
                "extends");
}

}  // namespace
}  // namespace ccst
