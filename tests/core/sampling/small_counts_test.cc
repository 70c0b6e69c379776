// Few samples: a result, or a refusal that names a count which then works.

#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/status.h"
#include "core/sampling/sampling.h"
#include "tests/core/sampling/sampling_test_util.h"
#include "tests/support/shapes.h"

namespace ccst {
namespace {

using sampling_test::FindFault;
using sampling_test::SmallestNamed;

// Faults that so few samples cannot help: a tetrahedron in a torus faces where it can.
std::string FindGraveFault(const TriangleMesh& mesh, std::int64_t count,
                           const SamplingResult& result) {
  const std::string fault = FindFault(mesh, count, result);
  return fault.find("turned over") == std::string::npos ? fault : "";
}

void ExpectResultOrWayOut(const TriangleMesh& mesh, std::int64_t count, std::uint64_t seed) {
  SCOPED_TRACE("n = " + std::to_string(count) + ", seed " + std::to_string(seed));
  SamplingOptions options;
  options.sample_count = count;
  options.seed = seed;
  const absl::StatusOr<SamplingResult> result = SampleSurface(mesh, options);
  if (result.ok()) {
    EXPECT_EQ(FindGraveFault(mesh, count, *result), "");
    return;
  }
  EXPECT_EQ(GetErrorReason(result.status()), ErrorReason::kCountTooSmall) << result.status();
  const std::int64_t smallest = SmallestNamed(result.status());
  ASSERT_GT(smallest, count) << result.status();
  options.sample_count = smallest;
  const absl::StatusOr<SamplingResult> second = SampleSurface(mesh, options);
  ASSERT_TRUE(second.ok()) << "named " << smallest << ": " << second.status();
  EXPECT_EQ(FindGraveFault(mesh, smallest, *second), "");
}

void ExpectResultOrWayOut(const TriangleMesh& mesh) {
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    for (const std::int64_t count : {4, 5, 6, 7, 8, 9, 10, 12, 15, 20, 30, 100}) {
      ExpectResultOrWayOut(mesh, count, seed);
    }
  }
}

TEST(SmallCounts, SphereWorksFromFour) {
  const TriangleMesh mesh = shapes::Icosphere(3);
  ExpectResultOrWayOut(mesh);
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    for (const std::int64_t count : {4, 10, 100}) {
      SamplingOptions options;
      options.sample_count = count;
      options.seed = seed;
      const absl::StatusOr<SamplingResult> result = SampleSurface(mesh, options);
      ASSERT_TRUE(result.ok()) << result.status();
      EXPECT_EQ(FindGraveFault(mesh, count, *result), "");
    }
  }
}

TEST(SmallCounts, TorusWorksOrNamesACountThatDoes) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    for (const std::int64_t count : {4, 10, 100}) {
      ExpectResultOrWayOut(shapes::Torus(1, 0.35, 40, 20), count, seed);
    }
  }
  ExpectResultOrWayOut(shapes::Torus(1, 0.35, 40, 20));
}

TEST(SmallCounts, HigherGenusWorksOrNamesACountThatDoes) {
  ExpectResultOrWayOut(shapes::PlateWithHoles(2, 2));
  ExpectResultOrWayOut(shapes::PlateWithHoles(3, 1));
}

TEST(SmallCounts, OpenSurfacesWorkOrNameACountThatDoes) {
  ExpectResultOrWayOut(shapes::SingleTriangle());
  ExpectResultOrWayOut(shapes::PlaneGrid(2, 1, 8, 4));
  ExpectResultOrWayOut(shapes::Cylinder(1, 2, 20, 10));
  ExpectResultOrWayOut(shapes::SphereWithHole(0.8, 10, 20));
}

TEST(SmallCounts, ComponentsWorkOrNameACountThatDoes) {
  const std::vector<TriangleMesh> parts = {
      shapes::Icosphere(2), shapes::Moved(shapes::Icosphere(2), {4, 0, 0}, 0.5),
      shapes::Moved(shapes::Torus(1, 0.35, 30, 12), {8, 0, 0})};
  ExpectResultOrWayOut(shapes::DisjointUnion(parts));
}

}  // namespace
}  // namespace ccst
