#include "tests/benchmark/subjects.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "core/repair/repair.h"
#include "core/surface/surface.h"

namespace ccst::benchmarks {
namespace {

TEST(Subjects, HaveAboutTheFacesAskedFor) {
  for (const std::string name : {"torus", "scan", "saddle", "soup"}) {
    for (const double faces : {200.0, 5000.0, 70'000.0}) {
      const TriangleMesh mesh = *MakeSubject(name, static_cast<std::int64_t>(faces));
      EXPECT_NEAR(mesh.faces.size() / faces, 1.0, 0.05) << name << " " << faces;
    }
  }
}

TEST(Subjects, ScanIsClosedAndUneven) {
  const absl::StatusOr<Surface> surface = Surface::Build(Scan(20'000));
  ASSERT_TRUE(surface.ok()) << surface.status();
  EXPECT_TRUE(surface->boundary_loops().empty());
  EXPECT_EQ(surface->component_eulers()[0], 0);
  const auto [smallest, largest] =
      std::minmax_element(surface->face_areas().begin(), surface->face_areas().end());
  EXPECT_GT(*largest, 4.0 * *smallest);
}

TEST(Subjects, SoupIsRepairedToTheScan) {
  const TriangleMesh scan = Scan(2000);
  const RepairedMesh repaired = *Repair(*MakeSubject("soup", 2000));
  EXPECT_EQ(repaired.mesh.positions.size(), scan.positions.size());
  EXPECT_EQ(repaired.mesh.faces.size(), scan.faces.size());
  EXPECT_NEAR(repaired.report.flipped_faces, scan.faces.size() / 9.0, 1.0);
}

TEST(Subjects, UnknownNameIsRefusedWithThoseThereAre) {
  const absl::Status status = MakeSubject("cube", 100).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_NE(status.message().find("torus"), std::string::npos);
}

TEST(Subjects, PointsLieWithinAnEdgeOfTheMesh) {
  const TriangleMesh mesh = Scan(2000);
  const std::vector<Eigen::Vector3d> points = PointsNear(mesh, 50);
  ASSERT_EQ(points.size(), 50u);
  const double edge = (mesh.positions[mesh.faces[0][0]] - mesh.positions[mesh.faces[0][1]]).norm();
  for (const Eigen::Vector3d& point : points) {
    double nearest = 1e9;
    for (const Eigen::Vector3d& p : mesh.positions) nearest = std::min(nearest, (p - point).norm());
    EXPECT_LT(nearest, edge);
  }
}

TEST(Subjects, RisingValuesSpanOneToFour) {
  const TriangleMesh mesh = Scan(2000);
  const std::vector<double> values = RisingValues(mesh);
  ASSERT_EQ(values.size(), 3 * mesh.faces.size());
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  EXPECT_DOUBLE_EQ(*low, 1.0);
  EXPECT_DOUBLE_EQ(*high, 4.0);
}

}  // namespace
}  // namespace ccst::benchmarks
