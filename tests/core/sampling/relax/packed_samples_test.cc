#include "core/sampling/relax/packed_samples.h"

#include <array>
#include <cstdint>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/interrupt.h"
#include "core/sampling/mesh/faults.h"
#include "core/sampling/relax/geometry_phase.h"
#include "tests/core/sampling/sampling_test_util.h"
#include "tests/support/shapes.h"

namespace ccst::internal {
namespace {

using sampling_test::kOneThread;
using sampling_test::MakeStart;
using sampling_test::Start;

// With all rings that there are looked up.
struct Packed {
  explicit Packed(const TriangleMesh& mesh = shapes::Icosphere(3), bool with_triangles = true)
      : start(*MakeStart(mesh, 500, 1)),
        samples(&start.surface, with_triangles, &start.mesh, &start.samples) {
    LearnAll();
  }

  void LearnAll() {
    for (std::int32_t v = 0; v < start.samples.count(); ++v) samples.LearnRing(v);
  }

  Start start;
  PackedSamples samples;
};

// The middle of the host of `v`.
SurfacePoint MiddleOfHost(const Start& start, std::int32_t v) {
  SurfacePoint point;
  point.face = start.samples.face[v];
  point.weights.setConstant(1.0 / 3.0);
  for (const std::int32_t corner : start.surface.faces()[point.face]) {
    point.position += start.surface.positions()[corner] / 3.0;
  }
  return point;
}

// A half-edge along which its origin can be merged.
std::int32_t Collapsible(const SampleMesh& mesh) {
  std::int32_t h = 0;
  while (!mesh.CanCollapse(h)) ++h;
  return h;
}

TEST(PackedSamples, RingsAreTheNeighbours) {
  Packed packed;
  int small = 0;
  for (std::int32_t v = 0; v < 500; ++v) {
    const bool expected = packed.start.mesh.Degree(v) <= SmallRing::kMost;
    EXPECT_EQ(packed.samples.LearnRing(v), expected);
    small += expected;
  }
  EXPECT_GT(small, 400);
  EXPECT_EQ(FindFault(packed.samples), "");
}

TEST(PackedSamples, RingsAreFilledUpWithTheirFirst) {
  Packed packed;
  for (std::int32_t v = 0; v < 500; ++v) {
    if (!packed.samples.LearnRing(v)) continue;
    const SmallRing& ring = packed.samples.rings()[v];
    const SmallRing& triangles = packed.samples.triangles()[v];
    for (int i = packed.samples.valences()[v]; i < SmallRing::kMost; ++i) {
      EXPECT_EQ(ring.vertex[i], ring.vertex[0]);
      EXPECT_EQ(triangles.vertex[i], triangles.vertex[0]);
    }
  }
}

TEST(PackedSamples, SamplesOnABoundaryHaveNoSmallRing) {
  Packed packed(shapes::PlaneGrid(1.0, 1.0, 10, 10));
  int boundary = 0;
  for (std::int32_t v = 0; v < 500; ++v) {
    if (packed.start.samples.kind[v] == SampleMesh::Kind::kInterior) continue;
    EXPECT_FALSE(packed.samples.LearnRing(v));
    ++boundary;
  }
  EXPECT_GT(boundary, 20);
}

TEST(PackedSamples, TrianglesAreKeptOnRequestOnly) {
  EXPECT_TRUE(Packed(shapes::Icosphere(3), false).samples.triangles().empty());
}

TEST(PackedSamples, MoveTakesThePlaceAlong) {
  Packed packed;
  const SurfacePoint middle = MiddleOfHost(packed.start, 7);
  packed.samples.Move(7, middle, packed.start.surface.NormalAt(middle.face, middle.weights));
  EXPECT_EQ(packed.start.samples.position[7], middle.position);
  EXPECT_EQ(FindFault(packed.samples), "");
  EXPECT_EQ(FindFault(packed.start.samples, packed.start.surface), "");
}

TEST(PackedSamples, MoveAlongSetsTheArc) {
  Packed packed(shapes::PlaneGrid(1.0, 1.0, 10, 10));
  const Samples& samples = packed.start.samples;
  const SurfacePoint point = {samples.face[0], samples.weights[0], samples.position[0]};
  packed.samples.MoveAlong(0, 0.125, point, samples.normal[0]);
  EXPECT_EQ(packed.start.samples.arc[0], 0.125);
  EXPECT_EQ(FindFault(packed.samples), "");
}

TEST(PackedSamples, FlipsForgetTheRingsTheyChange) {
  Packed packed;
  EdgeFlips flips = packed.samples.MakeFlips();
  for (std::int32_t v = 0; v < 500; ++v) {
    const SurfacePoint middle = MiddleOfHost(packed.start, v);
    packed.samples.Move(v, middle, packed.start.surface.NormalAt(middle.face, middle.weights));
  }
  ASSERT_GT(flips.FlipAll(), 0);
  EXPECT_EQ(FindFault(packed.samples), "");
}

TEST(PackedSamples, CollapseForgetsTheRingsItChanges) {
  Packed packed;
  packed.samples.Collapse(Collapsible(packed.start.mesh));
  EXPECT_EQ(FindFault(packed.samples), "");
  packed.LearnAll();
  EXPECT_EQ(FindFault(packed.samples), "");
}

TEST(PackedSamples, InsertPutsASampleWhereItWasTold) {
  Packed packed;
  const std::int32_t h = Collapsible(packed.start.mesh);
  const std::int32_t v = packed.start.mesh.origin[h];
  const std::array<TriangleIndex, 2> slots = {SampleMesh::TriangleOf(h),
                                              SampleMesh::TriangleOf(packed.start.mesh.twin[h])};
  packed.samples.Collapse(h);
  packed.LearnAll();
  const SurfacePoint middle = MiddleOfHost(packed.start, v);
  TriangleIndex t(0);
  while (packed.start.mesh.IsDead(t)) t = TriangleIndex(t + 1);
  packed.samples.Insert(v, middle, t, slots);
  EXPECT_EQ(packed.start.samples.position[v], middle.position);
  EXPECT_EQ(packed.start.mesh.Degree(v), 3);
  EXPECT_EQ(FindFault(packed.samples), "");
  EXPECT_EQ(FindFault(packed.start.mesh), "");
}

// Going back used to leave the rings of the mesh before.
TEST(PackedSamples, RestoreForgetsPlacesAndRings) {
  Packed packed;
  Snapshot snapshot;
  snapshot.Take(packed.start.mesh, packed.start.samples);
  Interrupt never;
  GeometryPhase geometry(&packed.start.surface, &packed.start.density, &packed.start.plan,
                         Energy::kTarget, &packed.start.mesh, &packed.start.samples, &kOneThread);
  geometry.Alternate(3, &never);
  ASSERT_NE(FindFault(packed.samples), "");
  geometry.Restore(&snapshot, &never);
  EXPECT_EQ(FindFault(geometry.packed()), "");
  EXPECT_EQ(FindFault(packed.start.mesh), "");
}

TEST(PackedSamples, PassesAfterRestoreGoAsBefore) {
  Start start = *MakeStart(shapes::Icosphere(3), 500, 1);
  Interrupt never;
  GeometryPhase geometry(&start.surface, &start.density, &start.plan, Energy::kTarget, &start.mesh,
                         &start.samples, &kOneThread);
  Snapshot snapshot;
  snapshot.Take(start.mesh, start.samples);
  geometry.Alternate(3, &never);
  geometry.Restore(&snapshot, &never);
  for (std::int32_t v = 0; v < 500; ++v) geometry.Activate(v);
  geometry.Alternate(3, &never);
  EXPECT_EQ(FindFault(geometry.packed()), "");
  EXPECT_EQ(FindFault(start.mesh), "");
}

TEST(PackedSamples, RefineNormalsGivesThoseOfTheSurface) {
  Packed packed;
  for (Eigen::Vector3d& normal : packed.start.samples.normal) {
    normal = normal.cast<float>().cast<double>();
  }
  packed.samples.RefineNormals(kOneThread);
  for (std::int32_t v = 0; v < 500; ++v) {
    EXPECT_EQ(packed.start.samples.normal[v],
              packed.start.surface.NormalAt(packed.start.samples.face[v],
                                            packed.start.samples.weights[v]));
  }
  EXPECT_EQ(FindFault(packed.samples), "");
}

TEST(PackedSamples, FaultsAreNamed) {
  {
    Packed packed;
    packed.start.samples.position[3].x() += 1e-3;
    EXPECT_THAT(FindFault(packed.samples), testing::HasSubstr("place of sample 3"));
  }
  {
    Packed packed;
    packed.start.samples.normal[4] = -packed.start.samples.normal[4];
    EXPECT_THAT(FindFault(packed.samples), testing::HasSubstr("normal of sample 4"));
  }
  Packed packed;
  std::int32_t h = 0;
  while (!packed.start.mesh.CanFlip(h)) ++h;
  packed.start.mesh.Flip(h);  // Past the owner.
  EXPECT_THAT(FindFault(packed.samples), testing::HasSubstr("ring of sample"));
}

}  // namespace
}  // namespace ccst::internal
