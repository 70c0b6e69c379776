#include "core/sampling/start/initial_points.h"

#include <cmath>
#include <set>
#include <stop_token>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/random/random.h"
#include "tests/core/sampling/sampling_test_util.h"
#include "tests/support/shapes.h"

namespace ccst::internal {
namespace {

struct Drawn {
  Surface surface;
  Plan plan;
  Samples samples;
};

Drawn Draw(const TriangleMesh& mesh, std::int64_t count, std::uint64_t seed) {
  Surface surface = *Surface::Build(mesh);
  std::int64_t smallest = 0;
  Plan plan = *MakePlan(surface, Density::Uniform(surface), {}, count, seed, &smallest);
  Interrupt never;
  Samples samples = *DrawInitialPoints(surface, Density::Uniform(surface), plan, seed, &never);
  return {std::move(surface), std::move(plan), std::move(samples)};
}

TEST(DrawInitialPoints, CountIsExact) {
  const std::vector<TriangleMesh> meshes = {shapes::Icosphere(3), shapes::Torus(1, 0.3, 30, 15),
                                            shapes::Cylinder(1, 1, 20, 5),
                                            shapes::PlaneGrid(3, 1, 4, 4)};
  for (const TriangleMesh& mesh : meshes) {
    for (const std::int64_t count : {50, 101, 1000, 4097}) {
      const Drawn drawn = Draw(mesh, count, 3);
      EXPECT_EQ(drawn.samples.count(), count);
      EXPECT_EQ(drawn.samples.face.size(), static_cast<std::size_t>(count));
    }
  }
}

TEST(DrawInitialPoints, SamplesLieOnTheirHosts) {
  const Drawn drawn = Draw(shapes::Cylinder(1, 2, 20, 5), 500, 1);
  const Samples& s = drawn.samples;
  for (int i = 0; i < s.count(); ++i) {
    ASSERT_GE(s.face[i], 0);
    EXPECT_GE(s.weights[i].minCoeff(), 0.0);
    EXPECT_NEAR(s.weights[i].sum(), 1.0, 1e-12);
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    for (int k = 0; k < 3; ++k) {
      position += s.weights[i][k] * drawn.surface.positions()[drawn.surface.faces()[s.face[i]][k]];
    }
    EXPECT_LT((position - s.position[i]).norm(), 1e-14);
    EXPECT_LT((drawn.surface.NormalAt(s.face[i], s.weights[i]) - s.normal[i]).norm(), 1e-14);
    if (s.kind[i] == SampleMesh::Kind::kInterior) continue;
    const SurfacePoint on_loop = PointOnLoop(drawn.surface, drawn.plan, s.loop[i], s.arc[i]);
    EXPECT_LT((on_loop.position - s.position[i]).norm(), 1e-14);
  }
}

// Octants of a torus off centre: parts of known area that the strata do not follow. Independent
// draws would give a chi-square of about the degrees of freedom; strata give less.
TEST(DrawInitialPoints, RegionsGetSamplesInProportionToArea) {
  constexpr int kSectors = 40;
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    const Drawn drawn = Draw(shapes::Torus(1, 0.35, 200, 40), 4000, seed);
    std::vector<double> area(2 * kSectors, 0.0);
    std::vector<double> count(2 * kSectors, 0.0);
    const auto region = [&](const Eigen::Vector3d& p) {
      const double turn = std::atan2(p.y(), p.x()) / 6.283185307179586 + 0.5;
      const bool outer = std::hypot(p.x(), p.y()) * drawn.surface.unit() > 1.0;
      return 2 * std::min(kSectors - 1, static_cast<int>(turn * kSectors)) + outer;
    };
    for (int f = 0; f < drawn.surface.face_count(); ++f) {
      Eigen::Vector3d center = Eigen::Vector3d::Zero();
      for (const int v : drawn.surface.faces()[f]) center += drawn.surface.positions()[v] / 3.0;
      area[region(center)] += drawn.surface.face_areas()[f];
    }
    for (const Eigen::Vector3d& p : drawn.samples.position) count[region(p)] += 1.0;
    double chi_square = 0.0;
    for (int r = 0; r < 2 * kSectors; ++r) {
      const double expected = 4000.0 * area[r] / drawn.surface.area();
      chi_square += (count[r] - expected) * (count[r] - expected) / expected;
    }
    EXPECT_LT(chi_square, 2 * kSectors);
  }
}

TEST(DrawInitialPoints, SeedsDiffer) {
  const Drawn a = Draw(shapes::Icosphere(2), 200, 1);
  const Drawn b = Draw(shapes::Icosphere(2), 200, 2);
  const Drawn c = Draw(shapes::Icosphere(2), 200, 1);
  EXPECT_NE(a.samples.position, b.samples.position);
  EXPECT_EQ(a.samples.position, c.samples.position);
}

TEST(DrawInitialPoints, FacesWithoutAreaAreFine) {
  TriangleMesh mesh = shapes::PlaneGrid(1, 1, 4, 4);
  // A vertex on an edge, joined to both of its faces' ends: two slivers without area.
  const Eigen::Vector3i face = mesh.faces[0];
  const int middle = static_cast<int>(mesh.positions.size());
  mesh.positions.push_back(0.5 * (mesh.positions[face[0]] + mesh.positions[face[1]]));
  mesh.faces.emplace_back(face[1], face[0], middle);
  const absl::StatusOr<Surface> surface = Surface::Build(mesh);
  ASSERT_TRUE(surface.ok()) << surface.status();
  std::int64_t smallest = 0;
  const absl::StatusOr<Plan> plan =
      MakePlan(*surface, Density::Uniform(*surface), {}, 300, 0, &smallest);
  ASSERT_TRUE(plan.ok()) << plan.status();
  Interrupt never;
  const Samples samples =
      *DrawInitialPoints(*surface, Density::Uniform(*surface), *plan, 0, &never);
  EXPECT_EQ(samples.count(), 300);
  for (const Eigen::Vector3d& p : samples.position) EXPECT_TRUE(p.allFinite());
}

TEST(DrawInitialPoints, StopGivesCancelled) {
  const Surface surface = *Surface::Build(shapes::Icosphere(2));
  std::int64_t smallest = 0;
  const Plan plan = *MakePlan(surface, Density::Uniform(surface), {}, 100, 0, &smallest);
  std::stop_source stop;
  stop.request_stop();
  Interrupt interrupt(stop.get_token());
  EXPECT_EQ(
      DrawInitialPoints(surface, Density::Uniform(surface), plan, 0, &interrupt).status().code(),
      absl::StatusCode::kCancelled);
}

}  // namespace
}  // namespace ccst::internal
