#include "core/sampling/start/initial_mesh.h"

#include <stop_token>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/interrupt.h"
#include "core/quality/sample_mesh_quality.h"
#include "core/sampling/mesh/faults.h"
#include "core/sampling/start/initial_points.h"
#include "tests/core/sampling/sampling_test_util.h"
#include "tests/support/shapes.h"

namespace ccst::internal {
namespace {

using sampling_test::MakeStart;
using sampling_test::Start;
using sampling_test::Topology;

struct Case {
  std::string name;
  TriangleMesh mesh;
  std::int64_t euler;
  std::int64_t components = 1;
  std::size_t loops = 0;
};

std::vector<Case> Cases() {
  const std::vector<TriangleMesh> mixed = {shapes::Torus(1, 0.4, 30, 15),
                                           shapes::Moved(shapes::Icosphere(2), {4, 0, 0}),
                                           shapes::Moved(shapes::Cylinder(1, 2, 24, 8), {8, 0, 0})};
  return {{"genus 0", shapes::Icosphere(3), 2},
          {"genus 0, coarse", shapes::Tetrahedron(), 2},
          {"genus 0, slivers", shapes::UvSphere(20, 200), 2},
          {"genus 1", shapes::Torus(1, 0.35, 60, 24), 0},
          {"genus 2", shapes::PlateWithHoles(2, 2, 2), -2},
          {"genus 3", shapes::PlateWithHoles(3, 2, 2), -4},
          {"genus 3, coarse", shapes::PlateWithHoles(3, 0), -4},
          {"disk", shapes::PlaneGrid(2, 1, 20, 10), 1, 1, 1},
          {"one face", shapes::SingleTriangle(), 1, 1, 1},
          {"tube", shapes::Cylinder(1, 2, 30, 10), 0, 1, 2},
          {"cap", shapes::SphereWithHole(0.8, 20, 30), 1, 1, 1},
          {"three components", shapes::DisjointUnion(mixed), 2, 3, 2}};
}

TEST(BuildInitialMesh, TopologyIsThatOfTheSurface) {
  for (const Case& c : Cases()) {
    for (const std::int64_t count : {60, 400, 3000}) {
      SCOPED_TRACE(c.name + ", n = " + std::to_string(count));
      const absl::StatusOr<Start> start = MakeStart(c.mesh, count, 1);
      ASSERT_TRUE(start.ok()) << start.status();
      const quality::MeshTopology topology = Topology(start->mesh);
      EXPECT_TRUE(topology.IsManifold()) << topology.first_defect;
      EXPECT_EQ(topology.vertices, count);
      EXPECT_EQ(topology.euler, c.euler + start->plan.closed_loops);
      EXPECT_EQ(topology.components, c.components);
      EXPECT_EQ(static_cast<std::int64_t>(topology.boundary_loops.size()),
                static_cast<std::int64_t>(c.loops) - start->plan.closed_loops);
      EXPECT_EQ(FindFault(start->mesh), "");
      std::int64_t triangles = 0;
      for (const ComponentPlan& part : start->plan.components) triangles += part.triangles;
      EXPECT_EQ(topology.faces, triangles);
    }
  }
}

TEST(BuildInitialMesh, BoundaryOfTheMeshIsTheSamplesOfTheLoops) {
  const Start start = *MakeStart(shapes::Cylinder(1, 2, 30, 10), 500, 2);
  for (std::int32_t v = 0; v < start.mesh.vertex_count(); ++v) {
    EXPECT_EQ(start.mesh.IsBoundary(v), start.samples.kind[v] != SampleMesh::Kind::kInterior);
  }
  for (const std::vector<std::int32_t>& loop : Topology(start.mesh).boundary_loops) {
    for (const std::int32_t v : loop) {
      EXPECT_EQ(start.samples.loop[v], start.samples.loop[loop[0]]);
    }
  }
}

TEST(BuildInitialMesh, SmallHolesAreClosed) {
  const Start start = *MakeStart(shapes::SphereWithHole(0.05, 60, 60), 300, 0);
  EXPECT_EQ(start.plan.closed_loops, 1);
  const quality::MeshTopology topology = Topology(start.mesh);
  EXPECT_TRUE(topology.IsManifold()) << topology.first_defect;
  EXPECT_EQ(topology.euler, 2);
  EXPECT_TRUE(topology.boundary_loops.empty());
}

std::int64_t CountTurnedOver(const TriangleMesh& mesh, std::int64_t count) {
  const Start start = *MakeStart(mesh, count, 4);
  return quality::CountTurnedOver(start.samples.position, start.samples.normal,
                                  sampling_test::Triangles(start.mesh));
}

TEST(BuildInitialMesh, SmoothClosedSurfacesHaveNoTriangleTurnedOver) {
  EXPECT_EQ(CountTurnedOver(shapes::Icosphere(3), 1500), 0);
  EXPECT_EQ(CountTurnedOver(shapes::Torus(1, 0.35, 60, 24), 1500), 0);
  EXPECT_EQ(CountTurnedOver(shapes::UvSphere(20, 200), 1500), 0);
}

TEST(BuildInitialMesh, FacesAloneHaveNoTriangleTurnedOver) {
  // Every vertex of the surface is a corner with a sample: nothing is removed.
  EXPECT_EQ(CountTurnedOver(shapes::SingleTriangle(), 1500), 0);
  EXPECT_EQ(CountTurnedOver(shapes::PlaneGrid(1, 1, 1, 1), 1500), 0);
}

TEST(BuildInitialMesh, BoundariesLeaveFewTrianglesTurnedOver) {
  // Removing a vertex of the boundary may fold a few triangles; relocation mends them.
  EXPECT_LE(CountTurnedOver(shapes::PlaneGrid(1, 1, 10, 10), 1500), 30);
  EXPECT_LE(CountTurnedOver(shapes::SphereWithHole(0.8, 20, 30), 1500), 30);
}

// So many faces that blocks of them are thinned side by side.
TEST(BuildInitialMesh, ThreadsGiveTheSameBits) {
  for (const TriangleMesh& mesh :
       {shapes::Torus(1, 0.35, 200, 60), shapes::SphereWithHole(0.8, 60, 120)}) {
    const Surface surface = *Surface::Build(mesh);
    const Density density = Density::Uniform(surface);
    std::int64_t smallest = 0;
    const Plan plan = *MakePlan(surface, density, {}, 5000, 3, &smallest);
    Interrupt never;
    const Samples samples = *DrawInitialPoints(surface, density, plan, 3, &never);
    const SampleMesh base = *BuildInitialMesh(surface, plan, samples, &never);
    for (const int threads : {2, 3, 8}) {
      const Parallel parallel(threads);
      const Samples others = *DrawInitialPoints(surface, density, plan, 3, &never, parallel);
      EXPECT_EQ(others.position, samples.position);
      const SampleMesh other = *BuildInitialMesh(surface, plan, samples, &never, nullptr, parallel);
      EXPECT_EQ(other.origin, base.origin);
      EXPECT_EQ(other.twin, base.twin);
      EXPECT_EQ(other.outgoing, base.outgoing);
    }
  }
}

TEST(BuildInitialMesh, StopGivesCancelled) {
  const Surface surface = *Surface::Build(shapes::Icosphere(4));
  std::int64_t smallest = 0;
  const Plan plan = *MakePlan(surface, Density::Uniform(surface), {}, 20000, 0, &smallest);
  Interrupt never;
  const Samples samples = *DrawInitialPoints(surface, Density::Uniform(surface), plan, 0, &never);
  std::stop_source stop;
  stop.request_stop();
  Interrupt interrupt(stop.get_token());
  EXPECT_EQ(BuildInitialMesh(surface, plan, samples, &interrupt).status().code(),
            absl::StatusCode::kCancelled);
}

}  // namespace
}  // namespace ccst::internal
