// Components too small for a triangulation get points, spread by capacity.

#include <cmath>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/status.h"
#include "core/sampling/sampling.h"
#include "tests/core/sampling/sampling_test_util.h"
#include "tests/support/shapes.h"

namespace ccst {
namespace {

using sampling_test::FindFault;

SamplingResult Sample(const TriangleMesh& mesh, std::int64_t count, std::uint64_t seed = 0) {
  SamplingOptions options;
  options.sample_count = count;
  options.seed = seed;
  const absl::StatusOr<SamplingResult> result = SampleSurface(mesh, options);
  EXPECT_TRUE(result.ok()) << result.status();
  if (!result.ok()) return {};
  // So few samples on so many handles cannot help turning over; the rest must be right.
  const std::string fault = FindFault(mesh, count, *result);
  EXPECT_TRUE(fault.empty() || fault.find("turned over") != std::string::npos) << fault;
  return *result;
}

// `count` equal tetrahedra, four faces each.
TriangleMesh Tetrahedra(int count) {
  std::vector<TriangleMesh> parts;
  for (int i = 0; i < count; ++i) {
    parts.push_back(shapes::Moved(shapes::Tetrahedron(), {4.0 * (i % 40), 4.0 * (i / 40), 0}));
  }
  return shapes::DisjointUnion(parts);
}

// Samples per component of four faces.
std::map<int, int> PerTetrahedron(const SamplingResult& result) {
  std::map<int, int> samples;
  for (const std::int32_t face : result.samples.faces) ++samples[face / 4];
  return samples;
}

TEST(Untriangulated, ThousandTetrahedraShareFifteenHundredSamples) {
  const SamplingResult result = Sample(Tetrahedra(1000), 1500);
  EXPECT_EQ(result.surface.untriangulated_components, 1000);
  EXPECT_EQ(result.surface.untriangulated_samples, 1500);
  EXPECT_EQ(result.termination, Termination::kConverged);
  EXPECT_TRUE(result.samples.triangles.empty());
  EXPECT_EQ(result.capacity_cv, 0.0);
  const std::map<int, int> samples = PerTetrahedron(result);
  ASSERT_EQ(samples.size(), 1000u);
  for (const auto& [tetrahedron, count] : samples) {
    EXPECT_TRUE(count == 1 || count == 2) << tetrahedron;
  }
}

TEST(Untriangulated, FewerSamplesThanComponentsWork) {
  const SamplingResult result = Sample(Tetrahedra(50), 20);
  EXPECT_EQ(result.surface.untriangulated_components, 50);
  EXPECT_EQ(PerTetrahedron(result).size(), 20u);
}

TEST(Untriangulated, SpecksDoNotKeepASphereFromItsTriangles) {
  std::vector<TriangleMesh> parts = {shapes::Icosphere(4)};
  for (int i = 0; i < 5; ++i) {
    parts.push_back(shapes::Moved(shapes::Tetrahedron(), {3.0 + i, 0, 0}, 0.03));
  }
  const SamplingResult result = Sample(shapes::DisjointUnion(parts), 1000);
  EXPECT_EQ(result.surface.untriangulated_components, 5);
  EXPECT_LE(result.surface.untriangulated_samples, 5);
  const auto on_sphere = static_cast<std::int64_t>(1000 - result.surface.untriangulated_samples);
  EXPECT_EQ(static_cast<std::int64_t>(result.samples.triangles.size()), 2 * on_sphere - 4);
  EXPECT_LT(result.capacity_cv, 0.06);
  EXPECT_GT(result.relative_radius, 0.6);
}

TEST(Untriangulated, ComponentWithTooMuchTopologyGetsPointsSpreadByCapacity) {
  // The torus needs seven samples and gets six, one for each sixth of its area.
  const TriangleMesh torus = shapes::Torus(1.0, 0.3, 60, 20);
  const std::vector<TriangleMesh> parts = {torus,
                                           shapes::Moved(shapes::Icosphere(3), {5, 0, 0}, 3.0)};
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const SamplingResult result = Sample(shapes::DisjointUnion(parts), 62, seed);
    EXPECT_EQ(result.surface.untriangulated_components, 1);
    EXPECT_EQ(result.surface.untriangulated_samples, 6);
    std::vector<Eigen::Vector3d> on_torus;
    for (std::size_t i = 0; i < result.samples.faces.size(); ++i) {
      if (result.samples.faces[i] < 2400) on_torus.push_back(result.samples.positions[i]);
    }
    EXPECT_EQ(on_torus.size(), 6u);
    double nearest = 10.0;
    for (std::size_t i = 0; i < on_torus.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        nearest = std::min(nearest, (on_torus[i] - on_torus[j]).norm());
      }
    }
    // Of white noise every second set has a nearer pair.
    EXPECT_GT(nearest, 0.35) << "seed " << seed;
  }
}

TEST(Untriangulated, ComponentThatCannotBeTriangulatedDoesNotRefuseTheOthers) {
  // A plate with three holes has enough samples by the books and not enough for any collapse.
  const std::vector<TriangleMesh> parts = {shapes::PlateWithHoles(3, 1),
                                           shapes::Moved(shapes::Icosphere(3), {30, 0, 0}, 4.0)};
  int fallbacks = 0;
  for (std::int64_t count = 20; count < 120; count += 5) {
    const SamplingResult result = Sample(shapes::DisjointUnion(parts), count);
    const std::int64_t points = result.surface.untriangulated_samples;
    fallbacks += points >= 12;  // By Ringel's bound twelve would do for genus 3.
  }
  EXPECT_GT(fallbacks, 0);
}

TEST(Untriangulated, OnlyComponentIsStillRefused) {
  SamplingOptions options;
  options.sample_count = 5;
  EXPECT_EQ(GetErrorReason(SampleSurface(shapes::Torus(1, 0.3, 20, 10), options).status()),
            ErrorReason::kCountTooSmall);
}

TEST(Untriangulated, OpenSpecksLeaveNoBoundarySamples) {
  std::vector<TriangleMesh> parts = {shapes::PlaneGrid(1, 1, 10, 10)};
  for (int i = 0; i < 4; ++i) {
    parts.push_back(shapes::Moved(shapes::PlaneGrid(1, 1, 2, 2), {2.0 + i, 0, 0}, 0.05));
  }
  const SamplingResult result = Sample(shapes::DisjointUnion(parts), 500);
  EXPECT_EQ(result.surface.untriangulated_components, 4);
  EXPECT_GE(result.surface.untriangulated_samples, 4);
}

TEST(Untriangulated, ComponentWithoutAreaGetsNothing) {
  // A needle that repair keeps: two corners at nearly the same place.
  TriangleMesh needle;
  needle.positions = {{2, 0, 0}, {3, 0, 0}, {2, std::nextafter(0.0, 1.0), 0}};
  needle.faces = {{0, 1, 2}};
  const std::vector<TriangleMesh> parts = {shapes::Icosphere(3), needle};
  const SamplingResult result = Sample(shapes::DisjointUnion(parts), 300);
  EXPECT_EQ(result.surface.untriangulated_samples, 0);
  for (const std::int32_t face : result.samples.faces) EXPECT_LT(face, 1280);
}

}  // namespace
}  // namespace ccst
