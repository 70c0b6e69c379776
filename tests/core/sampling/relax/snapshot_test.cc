#include "core/sampling/relax/snapshot.h"

#include <gtest/gtest.h>

#include "core/sampling/mesh/faults.h"
#include "tests/core/sampling/sampling_test_util.h"
#include "tests/support/shapes.h"

namespace ccst::internal {
namespace {

using sampling_test::kOneThread;
using sampling_test::MakeStart;
using sampling_test::Start;

// Places, on the surface, where no sample is: the middles of the hosts.
void MoveAll(Start* start) {
  for (std::int32_t v = 0; v < start->samples.count(); ++v) {
    SurfacePoint point;
    point.face = start->samples.face[v];
    point.weights.setConstant(1.0 / 3.0);
    for (const std::int32_t corner : start->surface.faces()[point.face]) {
      point.position += start->surface.positions()[corner] / 3.0;
    }
    start->samples.Place(v, start->surface, point);
  }
}

// Turns every edge that can be.
void FlipMany(SampleMesh* mesh) {
  for (std::int32_t h = 0; h < 3 * mesh->triangle_count(); h += 5) {
    if (mesh->CanFlip(h)) mesh->Flip(h);
  }
}

TEST(Snapshot, RestoreBringsTheMeshBack) {
  Start start = *MakeStart(shapes::Icosphere(3), 300);
  const SampleMesh before = start.mesh;
  Snapshot snapshot;
  snapshot.Take(start.mesh, start.samples);
  FlipMany(&start.mesh);
  ASSERT_NE(start.mesh.origin, before.origin);
  snapshot.Restore(start.surface, kOneThread, &start.mesh, &start.samples);
  EXPECT_EQ(start.mesh.origin, before.origin);
  EXPECT_EQ(start.mesh.twin, before.twin);
  EXPECT_EQ(start.mesh.outgoing, before.outgoing);
}

TEST(Snapshot, RestoreBringsTheSamplesBack) {
  Start start = *MakeStart(shapes::Icosphere(3), 300);
  const Samples before = start.samples;
  Snapshot snapshot;
  snapshot.Take(start.mesh, start.samples);
  MoveAll(&start);
  snapshot.Restore(start.surface, kOneThread, &start.mesh, &start.samples);
  EXPECT_EQ(start.samples.face, before.face);
  EXPECT_EQ(start.samples.weights, before.weights);
  for (std::size_t v = 0; v < before.position.size(); ++v) {
    EXPECT_LE((start.samples.position[v] - before.position[v]).norm(), 1e-15);
    EXPECT_LE((start.samples.normal[v] - before.normal[v]).norm(), 1e-14);
  }
  EXPECT_EQ(FindFault(start.samples, start.surface), "");
}

TEST(Snapshot, SamplesOnABoundaryGetTheirArcBack) {
  Start start = *MakeStart(shapes::PlaneGrid(1.0, 1.0, 10, 10), 200);
  const std::vector<double> before = start.samples.arc;
  Snapshot snapshot;
  snapshot.Take(start.mesh, start.samples);
  for (double& arc : start.samples.arc) arc = -1.0;
  snapshot.Restore(start.surface, kOneThread, &start.mesh, &start.samples);
  EXPECT_EQ(start.samples.arc, before);
}

TEST(Snapshot, SecondTakesThePlaceOfTheFirst) {
  Start start = *MakeStart(shapes::Icosphere(3), 300);
  Snapshot snapshot;
  snapshot.Take(start.mesh, start.samples);
  MoveAll(&start);
  const Samples later = start.samples;
  snapshot.Take(start.mesh, start.samples);
  start.samples.weights.assign(300, Eigen::Vector3d::UnitX());
  snapshot.Restore(start.surface, kOneThread, &start.mesh, &start.samples);
  EXPECT_EQ(start.samples.weights, later.weights);
}

}  // namespace
}  // namespace ccst::internal
