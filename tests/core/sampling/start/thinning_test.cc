#include "core/sampling/start/thinning.h"

#include <cstdint>
#include <stop_token>
#include <vector>

#include <gtest/gtest.h>

#include "core/sampling/mesh/faults.h"
#include "tests/core/sampling/sampling_test_util.h"
#include "tests/support/shapes.h"

namespace ccst::internal {
namespace {

constexpr std::int32_t kKept = 600;

// A torus whose first vertices stay.
class ThinBlocksTest : public testing::Test {
 protected:
  ThinBlocksTest() : shape_(shapes::Torus(1, 0.4, 120, 60)) {
    for (const Eigen::Vector3d& p : shape_.positions) {
      const Eigen::Vector3d around = Eigen::Vector3d(p.x(), p.y(), 0).normalized();
      normals_.push_back((p - around).normalized());
    }
  }

  std::int32_t count() const { return static_cast<std::int32_t>(shape_.positions.size()); }

  // Blocks of so many vertices.
  std::vector<std::int32_t> Blocks(std::int32_t size) const {
    std::vector<std::int32_t> blocks;
    for (std::int32_t v = 0; v < count(); ++v) blocks.push_back(v / size);
    return blocks;
  }

  SampleMesh Thin(const std::vector<std::int32_t>& blocks, int threads = 1) const {
    SampleMesh mesh;
    mesh.SetTriangles(count(), shape_.faces);
    Interrupt never;
    ThinBlocks(kKept, blocks, shape_.positions, normals_, Parallel(threads), &never, &mesh);
    return mesh;
  }

  TriangleMesh shape_;
  std::vector<Eigen::Vector3d> normals_;
};

std::int32_t LiveVertices(const SampleMesh& mesh) {
  std::int32_t live = 0;
  for (const std::int32_t h : mesh.outgoing) live += h >= 0 ? 1 : 0;
  return live;
}

// Of what is left.
std::int32_t Euler(const SampleMesh& mesh) {
  std::int32_t faces = 0;
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t)
    faces += mesh.IsDead(TriangleIndex(t)) ? 0 : 1;
  return LiveVertices(mesh) - faces / 2;
}

TEST_F(ThinBlocksTest, OneBlockLeavesLittleMoreThanWhatIsKept) {
  const SampleMesh mesh = Thin(Blocks(count()));
  EXPECT_EQ(FindFault(mesh), "");
  EXPECT_EQ(Euler(mesh), 0);
  EXPECT_LT(LiveVertices(mesh), 1.5 * kKept);
  for (std::int32_t v = 0; v < kKept; ++v) EXPECT_GE(mesh.outgoing[v], 0);
}

TEST_F(ThinBlocksTest, WhatIsNextToAnotherBlockStays) {
  const std::vector<std::int32_t> blocks = Blocks(1800);
  const SampleMesh mesh = Thin(blocks);
  EXPECT_EQ(FindFault(mesh), "");
  EXPECT_LT(LiveVertices(mesh), count() / 2);
  for (const Eigen::Vector3i& face : shape_.faces) {
    for (int k = 0; k < 3; ++k) {
      if (blocks[face[k]] == blocks[face[(k + 1) % 3]]) continue;
      EXPECT_GE(mesh.outgoing[face[k]], 0);
      EXPECT_GE(mesh.outgoing[face[(k + 1) % 3]], 0);
    }
  }
}

TEST_F(ThinBlocksTest, LockedEdgesStay) {
  SampleMesh mesh;
  mesh.SetTriangles(count(), shape_.faces);
  const Eigen::Vector3i face = shape_.faces.back();
  mesh.Lock(mesh.FindEdge(face[0], face[1]));
  Interrupt never;
  ThinBlocks(kKept, Blocks(count()), shape_.positions, normals_, Parallel(), &never, &mesh);
  const std::int32_t h = mesh.FindEdge(face[0], face[1]);
  ASSERT_GE(h, 0);
  EXPECT_TRUE(mesh.IsLocked(h));
}

TEST_F(ThinBlocksTest, ThreadsGiveTheSameMesh) {
  const std::vector<std::int32_t> blocks = Blocks(900);
  const SampleMesh base = Thin(blocks);
  for (const int threads : {2, 3, 8}) {
    const SampleMesh other = Thin(blocks, threads);
    EXPECT_EQ(other.origin, base.origin);
    EXPECT_EQ(other.twin, base.twin);
    EXPECT_EQ(other.outgoing, base.outgoing);
  }
}

TEST_F(ThinBlocksTest, NothingHappensWhenStopped) {
  SampleMesh mesh;
  mesh.SetTriangles(count(), shape_.faces);
  const std::vector<std::int32_t> before = mesh.origin;
  std::stop_source stop;
  stop.request_stop();
  Interrupt interrupt(stop.get_token());
  ThinBlocks(kKept, Blocks(900), shape_.positions, normals_, Parallel(), &interrupt, &mesh);
  EXPECT_EQ(mesh.origin, before);
}

}  // namespace
}  // namespace ccst::internal
