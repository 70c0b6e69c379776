// Thin meshes, made by random stretches of small ones: exactly n samples or a refusal, soon and in
// little memory.

#include <cstdint>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/status.h"
#include "core/sampling/sampling.h"
#include "tests/core/sampling/sampling_test_util.h"
#include "tests/support/memory_meter.h"
#include "tests/support/shapes.h"
#include "tests/support/stretched.h"
#include "tests/support/whole_job.h"

namespace ccst {
namespace {

using sampling_test::SmallestNamed;
using test::FindMisbehaviour;
using test::MakeStretchedCase;
using test::Pile;
using test::StretchedCase;
using test::Strip;
using testing::HasSubstr;

SamplingOptions Options(std::int64_t count, SamplingMethod method = SamplingMethod::kCcst) {
  SamplingOptions options;
  options.sample_count = count;
  options.method = method;
  return options;
}

void ExpectSamplesOrARefusal(std::uint64_t first, std::uint64_t end) {
  for (std::uint64_t number = first; number < end; ++number) {
    const StretchedCase made = MakeStretchedCase(number);
    EXPECT_EQ(FindMisbehaviour(made.mesh, made.options), "") << made.name;
  }
}

TEST(StretchedMeshes, GiveSamplesOrARefusal) { ExpectSamplesOrARefusal(0, 300); }

// Minutes: the long tests run it.
TEST(StretchedMeshes, DISABLED_TwentyThousandGiveSamplesOrARefusal) {
  ExpectSamplesOrARefusal(1000, 21000);
}

TEST(StretchedMeshes, StripOfABillionSpacingsIsRefusedInLittleMemory) {
  for (const double length : {1e9, 1e11}) {
    const TriangleMesh mesh = Strip(length, 0.01);
    const test::MemoryMeter meter(std::int64_t{4} << 20);
    const absl::Status status = SampleSurface(mesh, Options(64)).status();
    EXPECT_EQ(GetErrorReason(status), ErrorReason::kCountTooSmall) << status;
    EXPECT_THAT(std::string(status.message()), HasSubstr("sample_count 64 is too small"));
    EXPECT_THAT(std::string(status.message()), HasSubstr("boundary"));
  }
}

TEST(StretchedMeshes, StripThatFewMoreSamplesCoverNamesThem) {
  const TriangleMesh mesh = Strip(1e6, 1.0);
  const std::int64_t smallest = SmallestNamed(SampleSurface(mesh, Options(64)).status());
  ASSERT_GT(smallest, 64);
  EXPECT_EQ(FindMisbehaviour(mesh, Options(smallest)), "");
  EXPECT_TRUE(SampleSurface(mesh, Options(smallest)).ok());
}

// No more are tried than could be asked for in their stead.
TEST(StretchedMeshes, StripThatNeedsVeryManySaysAtLeastHowMany) {
  const absl::Status status = SampleSurface(Strip(1e9, 0.01), Options(64)).status();
  EXPECT_EQ(GetErrorReason(status), ErrorReason::kCountTooSmall);
  EXPECT_THAT(std::string(status.message()), HasSubstr("at least this many are needed: "));
}

TEST(StretchedMeshes, EveryOtherMethodSamplesAStripOfABillionSpacings) {
  for (const SamplingMethod method :
       {SamplingMethod::kWhiteNoise, SamplingMethod::kPoissonDisk,
        SamplingMethod::kSampleElimination, SamplingMethod::kLloyd, SamplingMethod::kCcvt}) {
    EXPECT_EQ(FindMisbehaviour(Strip(1e9, 0.01), Options(64, method)), "")
        << static_cast<int>(method);
    EXPECT_TRUE(SampleSurface(Strip(1e9, 0.01), Options(64, method)).ok());
  }
}

// A piece with a boundary that its share of the samples cannot hold gets points.
TEST(StretchedMeshes, StripBesideASphereGetsPoints) {
  const std::vector<TriangleMesh> parts = {Strip(1e5, 1e-3),
                                           shapes::Moved(shapes::Icosphere(2), {0, 50, 0}, 3.0)};
  const SamplingResult result = *SampleSurface(shapes::DisjointUnion(parts), Options(300));
  EXPECT_EQ(result.surface.untriangulated_components, 1);
  EXPECT_GT(result.surface.untriangulated_samples, 50);
  EXPECT_EQ(result.samples.positions.size(), 300u);
}

// Every sample is near every other: lists of neighbours would grow with the square.
TEST(StretchedMeshes, PileOfSheetsIsSampledInLittleMemory) {
  const TriangleMesh pile = Pile(600);
  for (const SamplingMethod method :
       {SamplingMethod::kPoissonDisk, SamplingMethod::kSampleElimination}) {
    const SamplingOptions options = Options(600, method);
    EXPECT_EQ(FindMisbehaviour(pile, options, {.bytes = std::int64_t{8} << 20}), "")
        << static_cast<int>(method);
  }
}

}  // namespace
}  // namespace ccst
