#include <cmath>
#include <limits>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/status.h"
#include "core/sampling/sampling.h"
#include "tests/support/shapes.h"

namespace ccst {
namespace {

using testing::AllOf;
using testing::HasSubstr;

SamplingOptions Good() {
  SamplingOptions options;
  options.sample_count = 100;
  return options;
}

std::string Refusal(const SamplingOptions& options) {
  const absl::Status status = options.Validate();
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(GetErrorReason(status), ErrorReason::kOptionInvalid);
  EXPECT_EQ(SampleSurface(shapes::Tetrahedron(), options).status(), status);
  return std::string(status.message());
}

TEST(SamplingOptions, DefaultsNeedOnlyACount) {
  EXPECT_TRUE(Good().Validate().ok());
  EXPECT_THAT(Refusal(SamplingOptions()), HasSubstr("sample_count is 0"));
}

TEST(SamplingOptions, LimitsAreInclusive) {
  SamplingOptions options = Good();
  options.sample_count = kMinSampleCount;
  options.max_iterations = 0;
  EXPECT_TRUE(options.Validate().ok());
  options.sample_count = kMaxSampleCount;
  options.max_iterations = kMaxAlternations;
  EXPECT_TRUE(options.Validate().ok());
}

TEST(SamplingOptions, SampleCountOutOfRangeIsNamed) {
  for (const std::int64_t bad : {std::int64_t{-5}, kMinSampleCount - 1, kMaxSampleCount + 1,
                                 std::numeric_limits<std::int64_t>::max()}) {
    SamplingOptions options = Good();
    options.sample_count = bad;
    EXPECT_THAT(Refusal(options), AllOf(HasSubstr("sample_count"), HasSubstr(std::to_string(bad)),
                                        HasSubstr("[4, 10000000]")));
  }
}

TEST(SamplingOptions, IterationsOutOfRangeAreNamed) {
  for (const int bad : {-1, kMaxAlternations + 1}) {
    SamplingOptions options = Good();
    options.max_iterations = bad;
    EXPECT_THAT(Refusal(options),
                AllOf(HasSubstr("max_iterations"), HasSubstr(std::to_string(bad))));
  }
}

TEST(SamplingOptions, ToleranceMustBePositiveAndFinite) {
  for (const double bad : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    SamplingOptions options = Good();
    options.relative_tolerance = bad;
    EXPECT_THAT(Refusal(options), HasSubstr("relative_tolerance"));
  }
}

TEST(SamplingOptions, TimeLimitMustBePositive) {
  for (const double bad : {0.0, -1.0, std::nan("")}) {
    SamplingOptions options = Good();
    options.time_limit_seconds = bad;
    EXPECT_THAT(Refusal(options), HasSubstr("time_limit_seconds"));
  }
}

TEST(SamplingOptions, WeldToleranceMustBeALength) {
  for (const double bad : {-1e-9, std::nan(""), std::numeric_limits<double>::infinity()}) {
    SamplingOptions options = Good();
    options.weld_tolerance = bad;
    EXPECT_THAT(Refusal(options), HasSubstr("weld_tolerance"));
  }
}

TEST(SamplingOptions, ThreadCountMustBePositive) {
  for (const int bad : {0, -3}) {
    SamplingOptions options = Good();
    options.thread_count = bad;
    EXPECT_THAT(Refusal(options), HasSubstr("thread_count"));
  }
}

TEST(SamplingOptions, OptionsAreCheckedBeforeTheMesh) {
  EXPECT_EQ(GetErrorReason(SampleSurface({}, SamplingOptions()).status()),
            ErrorReason::kOptionInvalid);
}

}  // namespace
}  // namespace ccst
