// Input that has to be repaired first: samples still lie on the faces as they were given.

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/sampling/input/source_map.h"
#include "core/sampling/sampling.h"
#include "tests/core/sampling/sampling_test_util.h"
#include "tests/support/shapes.h"

namespace ccst::internal {
namespace {

using sampling_test::FindFault;

SamplingResult Sample(const TriangleMesh& mesh, std::int64_t count, double weld_tolerance = 0.0) {
  SamplingOptions options;
  options.sample_count = count;
  options.max_iterations = 40;  // Long enough for what is turned over to be mended.
  options.weld_tolerance = weld_tolerance;
  const absl::StatusOr<SamplingResult> result = SampleSurface(mesh, options);
  EXPECT_TRUE(result.ok()) << result.status();
  if (!result.ok()) return {};
  EXPECT_EQ(FindFault(mesh, count, *result), "");
  return *result;
}

// Two triangles of a square and, along their diagonal, one without area whose middle vertex is a
// corner of a third on the other side: the diagonal of the first is cut in two.
TriangleMesh SquareWithTJunction() {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 0}};
  mesh.faces = {{0, 1, 2}, {0, 2, 4}, {0, 4, 3}, {4, 2, 3}};
  return mesh;
}

TEST(RepairedInput, TurnedFacesKeepTheirCorners) {
  TriangleMesh mesh = shapes::Icosphere(3);
  for (std::size_t f = 0; f < mesh.faces.size(); f += 3) {
    mesh = shapes::WithFlippedFace(mesh, static_cast<int>(f));
  }
  const SamplingResult result = Sample(mesh, 500);
  EXPECT_EQ(result.surface.repairs.flipped_faces, 427);
  EXPECT_EQ(result.surface.euler, 2);
  for (std::size_t i = 0; i < result.samples.positions.size(); ++i) {
    EXPECT_GT(result.samples.normals[i].dot(result.samples.positions[i]), 0.9);
  }
}

TEST(RepairedInput, SamplesOnASplitFaceNameTheWholeFace) {
  const TriangleMesh mesh = SquareWithTJunction();
  const SamplingResult result = Sample(mesh, 400);
  EXPECT_EQ(result.surface.repairs.degenerate_faces, 1);
  EXPECT_EQ(result.surface.repairs.split_faces, 1);
  EXPECT_EQ(result.surface.boundary_loops, 1);
  std::vector<int> count(mesh.faces.size(), 0);
  for (const std::int32_t face : result.samples.faces) ++count[face];
  EXPECT_NEAR(count[0], 200, 25);  // Half of the square.
  EXPECT_EQ(count[1], 0);
}

TEST(RepairedInput, CutSurfaceIsSampledInPieces) {
  const SamplingResult result = Sample(shapes::TetrahedraSharingVertex(), 300);
  EXPECT_EQ(result.surface.repairs.cut_vertices, 1);
  EXPECT_EQ(result.surface.components, 2);
}

TEST(RepairedInput, MoebiusStripIsCutOpen) {
  const SamplingResult result = Sample(shapes::MoebiusStrip(60, 8), 600);
  EXPECT_EQ(result.surface.repairs.non_orientable_cuts, 8);
  EXPECT_EQ(result.surface.euler, 1);
  EXPECT_EQ(result.surface.boundary_loops, 1);
}

TEST(RepairedInput, ToleranceJoinsWhatIsNearAndSamplesStayOnTheInput) {
  TriangleMesh mesh = shapes::Unwelded(shapes::Icosphere(3));
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const auto angle = static_cast<double>(i);
    mesh.positions[i] += 1e-5 * Eigen::Vector3d(std::sin(angle), std::cos(angle), 0.0);
  }
  EXPECT_EQ(Sample(mesh, 5000).surface.components, 1280);
  const SamplingResult joined = Sample(mesh, 5000, 4e-5);
  EXPECT_EQ(joined.surface.components, 1);
  EXPECT_EQ(joined.surface.euler, 2);
  EXPECT_EQ(joined.surface.repairs.welded_vertices, 3840 - 642);
}

TEST(SourceMap, SoundMeshMapsOntoItselfBitByBit) {
  const TriangleMesh mesh = shapes::Icosphere(2);
  const SourceMap map(mesh, *Repair(mesh));
  const Eigen::Vector3d weights(0.1, 0.3, 1.0 - 0.1 - 0.3);
  for (std::int32_t f = 0; f < 320; ++f) {
    EXPECT_EQ(map.Face(f), f);
    EXPECT_EQ(map.Weights(f, weights), weights);
  }
}

TEST(SourceMap, CornersLieWhereTheRepairedMeshHasThem) {
  for (const double scale : {1.0, 1e-200, 1e150}) {
    const TriangleMesh mesh = shapes::Moved(SquareWithTJunction(), {0, 0, 0}, scale);
    const RepairedMesh repaired = *Repair(mesh);
    ASSERT_EQ(repaired.mesh.faces.size(), 4u);
    const SourceMap map(mesh, repaired);
    for (std::int32_t f = 0; f < 4; ++f) {
      const Eigen::Vector3i& source = mesh.faces[map.Face(f)];
      for (int k = 0; k < 3; ++k) {
        const Eigen::Vector3d weights = map.Corner(f, k);
        Eigen::Vector3d place = Eigen::Vector3d::Zero();
        for (int c = 0; c < 3; ++c) place += weights[c] * mesh.positions[source[c]];
        const Eigen::Vector3d& corner = repaired.mesh.positions[repaired.mesh.faces[f][k]];
        EXPECT_LE((place - corner).cwiseAbs().maxCoeff(), 1e-15 * scale);
      }
    }
  }
}

}  // namespace
}  // namespace ccst::internal
