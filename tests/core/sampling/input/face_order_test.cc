#include "core/sampling/input/face_order.h"

#include <algorithm>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/interrupt.h"
#include "tests/support/shapes.h"

namespace ccst::internal {
namespace {

/// The same triangles with faces and vertices numbered backwards.
TriangleMesh Backwards(const TriangleMesh& mesh) {
  TriangleMesh other = mesh;
  std::reverse(other.faces.begin(), other.faces.end());
  std::reverse(other.positions.begin(), other.positions.end());
  const auto last = static_cast<std::int32_t>(mesh.positions.size()) - 1;
  for (Eigen::Vector3i& face : other.faces) face = Eigen::Vector3i::Constant(last) - face;
  return other;
}

RepairedMesh Sorted(const TriangleMesh& mesh) {
  Interrupt never;
  RepairedMesh repaired = *Repair(mesh);
  SortFaces(&repaired, &never);
  return repaired;
}

TEST(SortFaces, SourcesFollowTheirFaces) {
  const TriangleMesh mesh = shapes::Torus(1, 0.35, 40, 20);
  const RepairedMesh sorted = Sorted(mesh);
  ASSERT_EQ(sorted.mesh.faces.size(), mesh.faces.size());
  std::vector<std::int32_t> seen = sorted.source_face;
  std::sort(seen.begin(), seen.end());
  std::vector<std::int32_t> all(mesh.faces.size());
  std::iota(all.begin(), all.end(), 0);
  EXPECT_EQ(seen, all);
  for (std::size_t f = 0; f < sorted.mesh.faces.size(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const int corner = sorted.source_corner[f][k];
      EXPECT_EQ(sorted.mesh.positions[sorted.mesh.faces[f][k]],
                mesh.positions[mesh.faces[sorted.source_face[f]][corner]]);
    }
  }
}

TEST(SortFaces, NumbersOfTheInputDoNotMatter) {
  const TriangleMesh mesh = shapes::Torus(1, 0.35, 40, 20);
  const RepairedMesh one = Sorted(mesh);
  const RepairedMesh other = Sorted(Backwards(mesh));
  EXPECT_EQ(one.mesh.positions, other.mesh.positions);
  EXPECT_EQ(one.mesh.faces, other.mesh.faces);
}

TEST(SortFaces, NeighboursAreNearInMemory) {
  const RepairedMesh sorted = Sorted(Backwards(shapes::PlaneGrid(1, 1, 100, 100)));
  std::vector<int> spans;
  for (const Eigen::Vector3i& face : sorted.mesh.faces) {
    spans.push_back(face.maxCoeff() - face.minCoeff());
  }
  // Row by row every one would be 101; along a curve that fills the plane a few are long.
  std::nth_element(spans.begin(), spans.begin() + spans.size() / 2, spans.end());
  EXPECT_LT(spans[spans.size() / 2], 50);
}

TEST(SortFaces, ExtremeScalesAreFine) {
  for (const double scale : {1e-12, 1e30}) {
    TriangleMesh mesh = shapes::Icosphere(2);
    for (Eigen::Vector3d& position : mesh.positions) position *= scale;
    const RepairedMesh sorted = Sorted(mesh);
    EXPECT_EQ(sorted.mesh.positions.size(), mesh.positions.size());
  }
}

TEST(SortFaces, ThreadsGiveTheSameOrder) {
  const RepairedMesh mesh = *Repair(Backwards(shapes::Torus(1, 0.35, 200, 100)));
  Interrupt never;
  RepairedMesh base = mesh;
  SortFaces(&base, &never);
  for (const int threads : {2, 3, 8}) {
    RepairedMesh other = mesh;
    SortFaces(&other, &never, Parallel(threads));
    EXPECT_EQ(other.mesh.positions, base.mesh.positions);
    EXPECT_EQ(other.mesh.faces, base.mesh.faces);
    EXPECT_EQ(other.source_face, base.source_face);
  }
}

}  // namespace
}  // namespace ccst::internal
