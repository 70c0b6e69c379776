#include "core/sampling/start/creases.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "core/base/status.h"
#include "core/sampling/sampling.h"
#include "tests/core/sampling/sampling_test_util.h"
#include "tests/support/shapes.h"

namespace ccst::internal {
namespace {

constexpr double kFortyDegrees = 40.0 * std::numbers::pi / 180.0;

TEST(Creases, CubeHasTwelveLinesBetweenItsCorners) {
  const Surface surface = *Surface::Build(shapes::Subdivided(shapes::Subdivided(shapes::Cube())));
  const std::vector<Crease> creases = FindCreases(surface, kFortyDegrees, 0.0);
  EXPECT_EQ(creases.size(), 12u);
  for (const Crease& crease : creases) {
    EXPECT_FALSE(crease.closed);
    EXPECT_EQ(crease.half_edges.size(), 4u);
    for (std::size_t i = 0; i + 1 < crease.half_edges.size(); ++i) {
      EXPECT_EQ(surface.Target(crease.half_edges[i]), surface.Origin(crease.half_edges[i + 1]));
    }
  }
}

TEST(Creases, SmoothSurfaceHasNone) {
  EXPECT_TRUE(FindCreases(*Surface::Build(shapes::Icosphere(3)), kFortyDegrees, 0.0).empty());
}

TEST(Creases, ShortLinesAreNoise) {
  const Surface surface = *Surface::Build(shapes::Cube());
  EXPECT_FALSE(FindCreases(surface, kFortyDegrees, 1.0).empty());
  EXPECT_TRUE(FindCreases(surface, kFortyDegrees, 100.0).empty());
}

// A can: a cylinder of 64 sides with lids, whose two rims are closed creases.
TriangleMesh Can() {
  constexpr int kAround = 64;
  TriangleMesh mesh;
  for (const double z : {0.0, 2.0}) {
    for (int i = 0; i < kAround; ++i) {
      const double turn = 2.0 * std::numbers::pi * i / kAround;
      mesh.positions.emplace_back(std::cos(turn), std::sin(turn), z);
    }
  }
  mesh.positions.emplace_back(0, 0, 0);
  mesh.positions.emplace_back(0, 0, 2);
  for (int i = 0; i < kAround; ++i) {
    const int j = (i + 1) % kAround;
    mesh.faces.emplace_back(i, j, kAround + j);
    mesh.faces.emplace_back(i, kAround + j, kAround + i);
    mesh.faces.emplace_back(j, i, 2 * kAround);
    mesh.faces.emplace_back(kAround + i, kAround + j, 2 * kAround + 1);
  }
  return mesh;
}

TEST(Creases, RimsOfACanAreClosed) {
  const std::vector<Crease> creases = FindCreases(*Surface::Build(Can()), kFortyDegrees, 0.0);
  ASSERT_EQ(creases.size(), 2u);
  for (const Crease& crease : creases) {
    EXPECT_TRUE(crease.closed);
    EXPECT_EQ(crease.half_edges.size(), 64u);
  }
}

SamplingResult Sample(const TriangleMesh& mesh, std::int64_t count, std::uint64_t seed) {
  SamplingOptions options;
  options.sample_count = count;
  options.seed = seed;
  options.crease_angle = kFortyDegrees;
  return *SampleSurface(mesh, options);
}

// Every edge of the sample mesh at which its triangles turn sharply.
std::vector<std::pair<int, int>> SharpEdges(const SampleSet& samples) {
  std::map<std::pair<int, int>, std::vector<Eigen::Vector3d>> normals;
  for (const Eigen::Vector3i& t : samples.triangles) {
    const Eigen::Vector3d normal = (samples.positions[t[1]] - samples.positions[t[0]])
                                       .cross(samples.positions[t[2]] - samples.positions[t[0]])
                                       .normalized();
    for (int k = 0; k < 3; ++k) {
      normals[std::minmax(t[k], t[(k + 1) % 3])].push_back(normal);
    }
  }
  std::vector<std::pair<int, int>> sharp;
  for (const auto& [edge, pair] : normals) {
    if (pair.size() == 2 && pair[0].dot(pair[1]) < std::cos(kFortyDegrees)) sharp.push_back(edge);
  }
  return sharp;
}

TEST(CreaseSampling, CubeKeepsItsCornersAndEdges) {
  const TriangleMesh mesh = shapes::Subdivided(shapes::Cube());
  for (std::uint64_t seed = 0; seed < 2; ++seed) {
    const SamplingResult result = Sample(mesh, 1500, seed);
    EXPECT_EQ(sampling_test::FindFault(mesh, 1500, result), "");
    EXPECT_EQ(result.surface.creases, 12);
    const auto& positions = result.samples.positions;
    int corners = 0;
    for (const Eigen::Vector3d& p : positions) {
      corners += (p.cwiseAbs() - Eigen::Vector3d::Ones()).norm() < 1e-9;
    }
    EXPECT_EQ(corners, 8);
    // Sharp edges lie on the cube's, and are all of them.
    double length = 0.0;
    for (const auto& [a, b] : SharpEdges(result.samples)) {
      for (const int v : {a, b}) {
        int extreme = 0;
        for (int k = 0; k < 3; ++k) extreme += std::abs(std::abs(positions[v][k]) - 1.0) < 1e-9;
        EXPECT_GE(extreme, 2) << positions[v].transpose();
      }
      length += (positions[a] - positions[b]).norm();
    }
    EXPECT_NEAR(length, 24.0, 1e-9);
    EXPECT_LE(result.capacity_cv, 0.06);
    EXPECT_GE(result.relative_radius, 0.6);
  }
}

TEST(CreaseSampling, RimsOfACanAreFollowed) {
  const TriangleMesh mesh = Can();
  const SamplingResult result = Sample(mesh, 1200, 1);
  EXPECT_EQ(sampling_test::FindFault(mesh, 1200, result), "");
  EXPECT_EQ(result.surface.creases, 2);
  double length = 0.0;
  for (const auto& [a, b] : SharpEdges(result.samples)) {
    for (const int v : {a, b}) {
      const Eigen::Vector3d& p = result.samples.positions[v];
      EXPECT_TRUE(std::abs(p.z()) < 1e-9 || std::abs(p.z() - 2.0) < 1e-9) << p.transpose();
      EXPECT_GT(std::hypot(p.x(), p.y()), std::cos(std::numbers::pi / 64) - 1e-9);
    }
    length += (result.samples.positions[a] - result.samples.positions[b]).norm();
  }
  // Chords of spacing 0.13 lose little of the two circles.
  EXPECT_NEAR(length, 4.0 * std::numbers::pi, 0.03);
}

TEST(CreaseSampling, BoundaryAndCreaseMeetInOneSample) {
  // Three sides of a box: creases end on the boundary.
  TriangleMesh mesh = shapes::Cube();
  mesh.faces.resize(10);
  mesh = shapes::Subdivided(mesh);
  const SamplingResult result = Sample(mesh, 600, 0);
  EXPECT_EQ(sampling_test::FindFault(mesh, 600, result), "");
  EXPECT_GE(result.relative_radius, 0.5);
}

TEST(CreaseSampling, SmoothSurfaceGivesTheSameSamplesAsWithout) {
  const TriangleMesh mesh = shapes::Torus(1, 0.35, 48, 24);
  SamplingOptions options;
  options.sample_count = 400;
  EXPECT_EQ(sampling_test::FindDifference(*SampleSurface(mesh, options), Sample(mesh, 400, 0)), "");
}

TEST(CreaseSampling, AngleOutOfRangeIsRefused) {
  for (const double wrong : {0.0, -1.0, 3.2, std::nan("")}) {
    SamplingOptions options;
    options.sample_count = 100;
    options.crease_angle = wrong;
    EXPECT_EQ(GetErrorReason(options.Validate()), ErrorReason::kOptionInvalid) << wrong;
  }
}

}  // namespace
}  // namespace ccst::internal
