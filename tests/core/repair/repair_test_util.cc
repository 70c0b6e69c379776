#include "tests/core/repair/repair_test_util.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <set>

#include <gtest/gtest.h>

#include "core/quality/mesh_topology.h"
#include "core/surface/closest_point.h"
#include "core/surface/surface.h"

namespace ccst::testing {
namespace {

void ExpectCountsAddUp(const TriangleMesh& mesh, const RepairedMesh& result) {
  const RepairReport& r = result.report;
  EXPECT_EQ(static_cast<std::int64_t>(result.mesh.positions.size()),
            static_cast<std::int64_t>(mesh.positions.size()) - r.isolated_vertices -
                r.welded_vertices + r.cut_vertices);
  EXPECT_EQ(static_cast<std::int64_t>(result.mesh.faces.size()),
            static_cast<std::int64_t>(mesh.faces.size()) - r.repeated_index_faces -
                r.duplicate_faces - r.degenerate_faces + r.split_faces);
}

void ExpectFacesOnTheirSources(const TriangleMesh& mesh, const RepairOptions& options,
                               const RepairedMesh& result) {
  ASSERT_EQ(result.source_face.size(), result.mesh.faces.size());
  ASSERT_EQ(result.source_corner.size(), result.mesh.faces.size());
  for (std::size_t f = 0; f < result.mesh.faces.size(); ++f) {
    const std::int32_t source = result.source_face[f];
    ASSERT_GE(source, 0);
    ASSERT_LT(source, static_cast<std::int32_t>(mesh.faces.size()));
    const Eigen::Vector3i& t = mesh.faces[source];
    const Eigen::Vector3d& a = mesh.positions[t[0]];
    const Eigen::Vector3d& b = mesh.positions[t[1]];
    const Eigen::Vector3d& c = mesh.positions[t[2]];
    const double reach =
        std::max({a.cwiseAbs().maxCoeff(), b.cwiseAbs().maxCoeff(), c.cwiseAbs().maxCoeff()});
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d& p = result.mesh.positions[result.mesh.faces[f][k]];
      const int corner = result.source_corner[f][k];
      ASSERT_GE(corner, -1);
      ASSERT_LT(corner, 3);
      if (corner >= 0) {
        const double moved = (p - mesh.positions[t[corner]]).stableNorm();
        ASSERT_LE(moved, 2.0 * options.weld_tolerance) << "corner " << k << " of face " << f;
        continue;
      }
      const Eigen::Vector3d w = ClosestWeights(p, a, b, c);
      const double distance = (w[0] * a + w[1] * b + w[2] * c - p).stableNorm();
      ASSERT_LE(distance, 2.0 * options.weld_tolerance + 1e-14 * reach) << "face " << f;
    }
  }
}

}  // namespace

TriangleMesh Separated(TriangleMesh mesh) {
  std::set<std::array<double, 3>> taken;
  for (Eigen::Vector3d& p : mesh.positions) {
    while (!taken.insert({p[0], p[1], p[2]}).second) {
      p[0] = std::nextafter(p[0], std::numeric_limits<double>::infinity());
    }
  }
  return mesh;
}

void RepairAndCheck(const TriangleMesh& mesh, const RepairOptions& options, RepairedMesh* result) {
  *result = {};
  auto repaired = Repair(mesh, options);
  ASSERT_TRUE(repaired.ok()) << repaired.status().ToString();
  const quality::MeshTopology topology =
      quality::MeasureTopology(repaired->mesh.positions.size(), repaired->mesh.faces);
  ASSERT_TRUE(topology.IsManifold()) << topology.first_defect;
  ExpectCountsAddUp(mesh, *repaired);
  ExpectFacesOnTheirSources(mesh, options, *repaired);

  const TriangleMesh separated = Separated(repaired->mesh);
  const auto surface = Surface::Build(separated);
  ASSERT_TRUE(surface.ok()) << surface.status().ToString();
  const auto again = Repair(separated);
  ASSERT_TRUE(again.ok()) << again.status().ToString();
  EXPECT_TRUE(again->report.IsClean());
  EXPECT_EQ(again->mesh.faces, repaired->mesh.faces);
  *result = *std::move(repaired);
}

RepairedMesh Repaired(const TriangleMesh& mesh, const RepairOptions& options) {
  RepairedMesh result;
  RepairAndCheck(mesh, options, &result);
  return result;
}

}  // namespace ccst::testing
