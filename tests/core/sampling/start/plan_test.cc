#include "core/sampling/start/plan.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/status.h"
#include "tests/core/sampling/sampling_test_util.h"
#include "tests/support/shapes.h"

namespace ccst::internal {
namespace {

absl::StatusOr<Plan> Make(const Surface& surface, std::int64_t count, std::uint64_t seed) {
  std::int64_t smallest = 0;
  return MakePlan(surface, Density::Uniform(surface), {}, count, seed, &smallest);
}

TEST(MakePlan, ComponentsGetLargestRemainders) {
  // Cubes of areas 24, 24 * 4, 24 * 9: shares of 100 are 7.14, 28.57, 64.29.
  const std::vector<TriangleMesh> cubes = {shapes::Cube(),
                                           shapes::Moved(shapes::Cube(), {10, 0, 0}, 2.0),
                                           shapes::Moved(shapes::Cube(), {30, 0, 0}, 3.0)};
  const Surface surface = *Surface::Build(shapes::DisjointUnion(cubes));
  const Plan plan = *Make(surface, 100, 0);
  ASSERT_EQ(plan.components.size(), 3u);
  EXPECT_EQ(plan.components[0].samples, 7);
  EXPECT_EQ(plan.components[1].samples, 29);
  EXPECT_EQ(plan.components[2].samples, 64);
}

TEST(MakePlan, SharesAddUpAndAreWithinOneOfIdeal) {
  std::vector<TriangleMesh> spheres;
  for (int i = 0; i < 7; ++i) {
    spheres.push_back(shapes::Moved(shapes::Icosphere(1), {10.0 * i, 0, 0}, 1.0 + 0.37 * i));
  }
  const Surface surface = *Surface::Build(shapes::DisjointUnion(spheres));
  for (std::int64_t count = 400; count < 450; ++count) {
    const Plan plan = *Make(surface, count, 0);
    std::int64_t sum = 0;
    for (std::size_t c = 0; c < spheres.size(); ++c) {
      const double ideal =
          static_cast<double>(count) * surface.component_areas()[c] / surface.area();
      EXPECT_LT(std::abs(static_cast<double>(plan.components[c].samples) - ideal), 1.0);
      sum += plan.components[c].samples;
    }
    EXPECT_EQ(sum, count);
  }
}

TEST(MakePlan, EqualComponentsBreakTiesByIndex) {
  const std::vector<TriangleMesh> twins = {shapes::Cube(),
                                           shapes::Moved(shapes::Cube(), {10, 0, 0})};
  const Surface surface = *Surface::Build(shapes::DisjointUnion(twins));
  const Plan plan = *Make(surface, 101, 0);
  EXPECT_EQ(plan.components[0].samples, 51);
  EXPECT_EQ(plan.components[1].samples, 50);
}

TEST(MakePlan, TrianglesFollowFromEuler) {
  const Surface torus = *Surface::Build(shapes::Torus(1, 0.3, 20, 10));
  EXPECT_EQ(Make(torus, 500, 0)->components[0].triangles, 1000);
  const Surface sphere = *Surface::Build(shapes::Icosphere(2));
  const Plan plan = *Make(sphere, 500, 0);
  EXPECT_EQ(plan.components[0].triangles, 996);
  EXPECT_NEAR(plan.components[0].target, sphere.area() / 996.0, 1e-15);
  EXPECT_NEAR(plan.spacing, std::sqrt(2.0 * sphere.area() / (std::sqrt(3.0) * 500.0)), 1e-15);
}

TEST(MakePlan, LoopsGetSamplesAtTheSpacing) {
  const Surface surface = *Surface::Build(shapes::Cylinder(1, 2, 60, 20));
  const Plan plan = *Make(surface, 1000, 0);
  ASSERT_EQ(plan.loops.size(), 2u);
  std::int64_t sum = 0;
  for (const LoopPlan& loop : plan.loops) {
    EXPECT_FALSE(loop.closed);
    const auto samples = static_cast<double>(loop.arcs.size());
    EXPECT_NEAR(samples, loop.length / plan.spacing, 0.1 * samples);
    EXPECT_TRUE(std::is_sorted(loop.arcs.begin(), loop.arcs.end()));
    EXPECT_EQ(std::adjacent_find(loop.arcs.begin(), loop.arcs.end()), loop.arcs.end());
    EXPECT_GE(loop.arcs.front(), 0.0);
    EXPECT_LT(loop.arcs.back(), loop.length);
    EXPECT_EQ(std::accumulate(loop.fixed.begin(), loop.fixed.end(), 0), 0);
    sum += static_cast<std::int64_t>(loop.arcs.size());
  }
  EXPECT_EQ(plan.components[0].boundary_samples, sum);
}

TEST(MakePlan, CornersOfARectangleGetFixedSamples) {
  const Surface surface = *Surface::Build(shapes::PlaneGrid(3, 2, 12, 8));
  const Plan plan = *Make(surface, 300, 5);
  const LoopPlan& loop = plan.loops[0];
  std::vector<Eigen::Vector2d> corners;
  for (std::size_t i = 0; i < loop.arcs.size(); ++i) {
    if (!loop.fixed[i]) continue;
    const Eigen::Vector3d p = surface.ToMesh(PointOnLoop(surface, plan, 0, loop.arcs[i]).position);
    corners.emplace_back(p.x(), p.y());
    EXPECT_LT(std::min(std::abs(p.x()), std::abs(p.x() - 3)), 1e-12);
    EXPECT_LT(std::min(std::abs(p.y()), std::abs(p.y() - 2)), 1e-12);
  }
  EXPECT_EQ(corners.size(), 4u);
}

TEST(MakePlan, ShortLoopsAreClosedAndCounted) {
  const Surface surface = *Surface::Build(shapes::SphereWithHole(0.05, 60, 60));
  const Plan few = *Make(surface, 300, 0);
  EXPECT_EQ(few.closed_loops, 1);
  EXPECT_TRUE(few.loops[0].closed);
  EXPECT_TRUE(few.loops[0].arcs.empty());
  EXPECT_EQ(few.components[0].triangles, 596);
  const Plan many = *Make(surface, 30000, 0);
  EXPECT_EQ(many.closed_loops, 0);
  EXPECT_GE(many.loops[0].arcs.size(), 3u);
}

TEST(MakePlan, ComponentTooSmallForTrianglesGetsPoints) {
  const std::vector<TriangleMesh> parts = {
      shapes::Icosphere(2), shapes::Moved(shapes::SphereWithHole(0.8, 10, 20), {5, 0, 0}, 0.2)};
  const Surface surface = *Surface::Build(shapes::DisjointUnion(parts));
  const Plan plan = *Make(surface, 60, 0);
  EXPECT_FALSE(plan.components[0].points);
  EXPECT_TRUE(plan.components[1].points);
  EXPECT_EQ(plan.components[0].samples + plan.components[1].samples, 60);
  EXPECT_EQ(plan.components[1].boundary_samples, 0);
  EXPECT_EQ(plan.components[1].triangles, 0);
  EXPECT_TRUE(plan.loops[0].arcs.empty());
  EXPECT_EQ(plan.closed_loops, 0);
}

TEST(MakePlan, TooFewSamplesGiveTheNextCountWorthTrying) {
  const std::vector<TriangleMesh> all_kinds = {
      shapes::Torus(1, 0.3, 20, 10), shapes::PlateWithHoles(2, 1), shapes::PlateWithHoles(3, 1)};
  for (const TriangleMesh& mesh : all_kinds) {
    const Surface surface = *Surface::Build(mesh);
    std::int64_t smallest = 0;
    const absl::Status status =
        MakePlan(surface, Density::Uniform(surface), {}, 4, 0, &smallest).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
    EXPECT_EQ(GetErrorReason(status), ErrorReason::kCountTooSmall);
    EXPECT_THAT(std::string(status.message()), testing::HasSubstr("sample_count 4"));
    ASSERT_GT(smallest, 4) << status;
    EXPECT_TRUE(Make(surface, smallest, 0).ok()) << smallest;
    EXPECT_FALSE(Make(surface, smallest - 1, 0).ok()) << smallest;
  }
}

TEST(PointOnLoop, RunsAlongTheLoop) {
  const Surface surface = *Surface::Build(shapes::PlaneGrid(2, 1, 4, 2));
  const Plan plan = *Make(surface, 50, 0);
  const double length = plan.loops[0].length;
  EXPECT_NEAR(length * surface.unit(), 6.0, 1e-12);
  Eigen::Vector3d last = PointOnLoop(surface, plan, 0, 0.0).position;
  double travelled = 0.0;
  for (int i = 1; i <= 600; ++i) {
    const SurfacePoint point = PointOnLoop(surface, plan, 0, std::min(length * i / 600, length));
    EXPECT_NEAR(point.weights.sum(), 1.0, 1e-12);
    travelled += (point.position - last).norm();
    last = point.position;
  }
  EXPECT_NEAR(travelled, length, 1e-9);
}

}  // namespace
}  // namespace ccst::internal
