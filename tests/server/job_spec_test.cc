#include "server/jobs/job_spec.h"

#include <functional>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace ccst::server {
namespace {

// Changes of everything that can change the samples.
std::vector<std::function<void(JobSpec&)>> Changes() {
  return {
      [](JobSpec& s) { s.mesh_sha256 = std::string("other"); },
      [](JobSpec& s) { s.texture_sha256 = std::string("other"); },
      [](JobSpec& s) { s.options.method = SamplingMethod::kLloyd; },
      [](JobSpec& s) { s.options.sample_count = 11; },
      [](JobSpec& s) { s.options.max_iterations = 7; },
      [](JobSpec& s) { s.options.relative_tolerance = 0.125; },
      [](JobSpec& s) { s.options.seed = 1; },
      [](JobSpec& s) { s.options.energy = Energy::kSquaredArea; },
      [](JobSpec& s) { s.options.crease_angle = 0.5; },
      [](JobSpec& s) { s.options.weld_tolerance = 1e-9; },
      [](JobSpec& s) { s.options.density.source = DensitySource::kCurvature; },
      [](JobSpec& s) { s.options.density.attribute = std::string("mass"); },
      [](JobSpec& s) { s.options.density.measure = CurvatureMeasure::kMean; },
      [](JobSpec& s) { s.options.density.bright_is_dense = true; },
      [](JobSpec& s) { s.options.density.exponent = 2.0; },
      [](JobSpec& s) { s.options.density.max_contrast = 10.0; },
  };
}

TEST(SpecDigest, EveryChangeThatCountsGivesAnother) {
  std::set<std::string> digests = {SpecDigest(JobSpec())};
  for (const auto& change : Changes()) {
    JobSpec spec;
    change(spec);
    EXPECT_TRUE(digests.insert(SpecDigest(spec)).second) << digests.size();
  }
}

TEST(SpecDigest, WhatDoesNotChangeTheSamplesDoesNotChangeIt) {
  JobSpec spec;
  spec.owner = std::string("a");
  spec.request_id = std::string("b");
  spec.labels = {{"c", "d"}};
  spec.origin = Eigen::Vector3d(1, 2, 3);
  spec.options.thread_count = 8;
  spec.options.time_limit_seconds = 5.0;
  spec.ends_with_caller = true;
  EXPECT_EQ(SpecDigest(spec), SpecDigest(JobSpec()));
}

TEST(SpecDigest, NoFieldForgesAnother) {
  JobSpec a;
  a.options.density.attribute = std::string("x\nmeasure:1=1");
  JobSpec b;
  b.options.density.attribute = std::string("x");
  b.options.density.measure = CurvatureMeasure::kMean;
  EXPECT_NE(SpecDigest(a), SpecDigest(b));
}

TEST(EstimateMemory, GrowsWithEverythingThatTakesMemory) {
  SamplingOptions options;
  options.sample_count = 1000;
  const std::int64_t base = EstimateMemory(100, 200, options);
  EXPECT_GT(EstimateMemory(101, 200, options), base);
  EXPECT_GT(EstimateMemory(100, 201, options), base);
  options.sample_count = 1001;
  EXPECT_GT(EstimateMemory(100, 200, options), base);
}

}  // namespace
}  // namespace ccst::server
