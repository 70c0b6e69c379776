#include "core/sampling/relax/ring_batch.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include "core/base/interrupt.h"
#include "core/sampling/relax/geometry_phase.h"
#include "tests/core/sampling/sampling_test_util.h"
#include "tests/support/shapes.h"

namespace ccst::internal {
namespace {

using sampling_test::MakeStart;
using sampling_test::Start;

// Inner samples of small rings, no two with a common neighbour.
std::vector<std::int32_t> FarApart(const Start& start, int count) {
  std::vector<std::int32_t> found;
  std::vector<std::uint8_t> taken(start.samples.count(), 0);
  for (std::int32_t v = 0; v < start.samples.count() && static_cast<int>(found.size()) < count;
       ++v) {
    bool fits = start.samples.kind[v] == SampleMesh::Kind::kInterior &&
                start.mesh.Degree(v) <= SmallRing::kMost;
    start.mesh.ForEachOutgoing(
        v, [&](std::int32_t h) { fits = fits && !taken[start.mesh.Target(h)]; });
    if (!fits || taken[v]) continue;
    found.push_back(v);
    taken[v] = 1;
    start.mesh.ForEachOutgoing(v, [&](std::int32_t h) { taken[start.mesh.Target(h)] = 1; });
  }
  return found;
}

// Where `free` are after one pass in which nothing else may move.
std::vector<Eigen::Vector3d> AfterOnePass(Start start, const std::vector<std::int32_t>& free) {
  Interrupt never;
  std::vector<SampleMesh::Kind> kind(start.samples.count(), SampleMesh::Kind::kFixed);
  for (const std::int32_t v : free) kind[v] = start.samples.kind[v];
  start.samples.kind = kind;
  GeometryPhase geometry(&start.surface, &start.density, &start.plan, Energy::kTarget, &start.mesh,
                         &start.samples, &sampling_test::kOneThread);
  geometry.Pass(&never);
  std::vector<Eigen::Vector3d> positions;
  for (const std::int32_t v : free) positions.push_back(start.samples.position[v]);
  return positions;
}

void ExpectEightMoveAsEachAlone(const Start& start) {
  // Alone they are visited one at a time, see ring.h; by eights as here.
  const std::vector<std::int32_t> free = FarApart(start, 10 * Batch::kSize);
  ASSERT_EQ(free.size(), 10U * Batch::kSize);
  const std::vector<Eigen::Vector3d> together = AfterOnePass(start, free);
  int moved = 0;
  for (std::size_t i = 0; i < free.size(); ++i) {
    const Eigen::Vector3d alone = AfterOnePass(start, {free[i]}).front();
    EXPECT_LT((together[i] - alone).norm(), 1e-4 * start.plan.spacing) << "sample " << free[i];
    moved += alone != start.samples.position[free[i]];
  }
  EXPECT_GT(moved, 60);
}

TEST(RingBatch, EightMoveAsEachAloneOnLargeFaces) {
  ExpectEightMoveAsEachAlone(*MakeStart(shapes::Torus(1, 0.35, 24, 12), 3000, 3));
}

TEST(RingBatch, EightMoveAsEachAloneOnSmallFaces) {
  ExpectEightMoveAsEachAlone(*MakeStart(shapes::Torus(1, 0.35, 240, 80), 3000, 3));
}

TEST(RingBatch, EightMoveAsEachAloneWithADensity) {
  Start start = *MakeStart(shapes::Torus(1, 0.35, 24, 12), 3000, 3);
  std::vector<double> corners;
  for (const Eigen::Vector3i& face : start.surface.faces()) {
    for (int k = 0; k < 3; ++k) {
      corners.push_back(std::exp(2.0 * start.surface.positions()[face[k]].x()));
    }
  }
  start.density = *Density::Linear(start.surface, corners, 100.0);
  ExpectEightMoveAsEachAlone(start);
}

// Eight samples on a torus and what Step() reads of them.
struct BatchFixture {
  BatchFixture() : start(*MakeStart(shapes::Torus(1, 0.35, 60, 24), 2000, 3)) {
    const std::vector<std::int32_t> chosen = FarApart(start, Batch::kSize);
    std::copy(chosen.begin(), chosen.end(), batch.vertex);
    std::fill_n(batch.scale, Batch::kSize,
                static_cast<float>(0.5 / start.plan.components[0].target));
    const std::int32_t count = start.samples.count();
    places.resize(count);
    normals.resize(count);
    rings.resize(count);
    valences.assign(count, 0);
    for (std::int32_t v = 0; v < count; ++v) {
      const Eigen::Vector3d& p = start.samples.position[v];
      const Eigen::Vector3f n = start.samples.normal[v].cast<float>();
      places[v] = {p[0], p[1], p[2], 0.0};
      normals[v] = {n[0], n[1], n[2], 0.0F};
    }
    for (const std::int32_t v : batch.vertex) {
      start.mesh.ForEachOutgoing(
          v, [&](std::int32_t h) { rings[v].vertex[valences[v]++] = start.mesh.Target(h); });
      std::fill(rings[v].vertex + valences[v], rings[v].vertex + SmallRing::kMost,
                rings[v].vertex[0]);
    }
    hosts.resize(start.surface.vertex_count());
    for (std::int32_t v = 0; v < start.surface.vertex_count(); ++v) {
      hosts[v] = {};
      Eigen::Vector3d::Map(hosts[v].position) = start.surface.positions()[v];
      hosts[v].shape[1] = 1.0F;
      Eigen::Vector3f::Map(hosts[v].normal) = start.surface.normals()[v].cast<float>();
    }
    sources = {.places = places.data(),
               .normals = normals.data(),
               .rings = rings.data(),
               .valences = valences.data(),
               .faces = start.samples.face.data(),
               .weights = start.samples.weights.data(),
               .corners = start.surface.faces().data(),
               .vertices = hosts.data(),
               .surface = &start.surface,
               .stretch = 1.0F,
               .longest = 0.5F};
  }

  Start start;
  std::vector<RingPlace> places;
  std::vector<RingNormal> normals;
  std::vector<SmallRing> rings;
  std::vector<std::uint8_t> valences;
  std::vector<HostVertex> hosts;
  BatchSources sources;
  Batch batch;
};

TEST(RingBatch, WideRegistersGiveTheSameBits) {
  if (WidestRegisters() == Registers::kPortable) GTEST_SKIP() << "this processor has no others";
  BatchFixture fixture;
  Batch other = fixture.batch;
  Step(fixture.sources, Registers::kPortable, &fixture.batch);
  Step(fixture.sources, Registers::kAvx2, &other);
  EXPECT_NE(fixture.batch.moves, 0U);
  EXPECT_EQ(fixture.batch.settled, other.settled);
  EXPECT_EQ(fixture.batch.moves, other.moves);
  for (int k = 0; k < Batch::kSize; ++k) {
    EXPECT_EQ(fixture.batch.move[k], other.move[k]);
    EXPECT_EQ(fixture.batch.spoilt[k], other.spoilt[k]);
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(fixture.batch.position[k][i], other.position[k][i]);
      EXPECT_EQ(fixture.batch.weights[k][i], other.weights[k][i]);
      EXPECT_EQ(fixture.batch.normal[i][k], other.normal[i][k]);
    }
  }
}

void ExpectOnItsHost(const Surface& surface, const Batch& batch, int k) {
  const Eigen::Vector3i& corner = surface.faces()[batch.face[k]];
  Eigen::Vector3d expected = Eigen::Vector3d::Zero();
  double sum = 0.0;
  for (int i = 0; i < 3; ++i) {
    EXPECT_GE(batch.weights[k][i], 0.0);
    sum += batch.weights[k][i];
    expected += batch.weights[k][i] * surface.positions()[corner[i]];
  }
  EXPECT_NEAR(sum, 1.0, 1e-15);
  EXPECT_LT((Eigen::Vector3d::Map(batch.position[k]) - expected).norm(), 1e-15);
}

TEST(RingBatch, MovedSamplesAreOnTheirHosts) {
  BatchFixture fixture;
  Step(fixture.sources, WidestRegisters(), &fixture.batch);
  int left = 0;
  for (int k = 0; k < Batch::kSize; ++k) {
    if ((fixture.batch.moves >> k & 1) == 0) continue;
    left += fixture.batch.face[k] != fixture.start.samples.face[fixture.batch.vertex[k]] ? 1 : 0;
    ExpectOnItsHost(fixture.start.surface, fixture.batch, k);
  }
  EXPECT_GT(left, 0) << "none is followed over an edge";
}

// No plane tells where on its host a step ends.
TEST(RingBatch, StepFromADegenerateHostIsFollowed) {
  BatchFixture fixture;
  Batch other = fixture.batch;
  Step(fixture.sources, WidestRegisters(), &other);
  int k = 0;
  while ((other.moves >> k & 1) == 0) ++k;
  const std::int32_t v = fixture.batch.vertex[k];
  const Eigen::Vector3i& corner = fixture.start.surface.faces()[fixture.start.samples.face[v]];
  std::memcpy(fixture.hosts[corner[1]].position, fixture.hosts[corner[0]].position,
              sizeof fixture.hosts[corner[1]].position);
  Step(fixture.sources, WidestRegisters(), &fixture.batch);
  EXPECT_EQ(fixture.batch.settled >> k & 1, 1U);
  ExpectOnItsHost(fixture.start.surface, fixture.batch, k);
}

TEST(RingBatch, NeighboursAreFound) {
  BatchFixture fixture;
  EXPECT_FALSE(HasNeighbours(fixture.rings.data(), WidestRegisters(), fixture.batch));
  // Whichever of the two is first.
  for (const auto& [of, at] : {std::pair(1, 6), std::pair(6, 1)}) {
    Batch batch = fixture.batch;
    const std::int32_t neighbour = fixture.rings[batch.vertex[of]].vertex[2];
    const std::int32_t v = batch.vertex[of];
    fixture.rings[neighbour] = fixture.rings[batch.vertex[at]];
    fixture.rings[neighbour].vertex[4] = v;
    batch.vertex[at] = neighbour;
    EXPECT_TRUE(HasNeighbours(fixture.rings.data(), WidestRegisters(), batch));
    EXPECT_TRUE(HasNeighbours(fixture.rings.data(), Registers::kPortable, batch));
  }
}

}  // namespace
}  // namespace ccst::internal
