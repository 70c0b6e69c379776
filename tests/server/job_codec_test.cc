#include "server/rpc/job_codec.h"

#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/status.h"

namespace ccst::server {
namespace {

JobSpec Spec() {
  JobSpec spec;
  spec.mesh_sha256 = "mesh";
  spec.texture_sha256 = "image";
  spec.options.sample_count = 3'000'000;
  spec.options.seed = 77;
  spec.options.max_iterations = 9;
  spec.options.time_limit_seconds = 12.5;
  spec.options.crease_angle = 0.7;
  spec.options.density.source = DensitySource::kTexture;
  spec.options.density.exponent = 2.0;
  spec.origin = Eigen::Vector3d(1e7, 0.1, 0.0);
  spec.abandon_seconds = 2.0;
  spec.ends_with_caller = true;
  return spec;
}

TEST(JobCodec, DefinitionMeansTheSameAfterwards) {
  const JobCodec codec = ProtoJobCodec();
  JobSpec read;
  ASSERT_TRUE(codec.decode_definition(codec.encode_definition(Spec()), read).ok());
  read.mesh_sha256 = "mesh";
  read.texture_sha256 = "image";
  EXPECT_EQ(SpecDigest(read), SpecDigest(Spec()));
  EXPECT_EQ(read.options.time_limit_seconds, 12.5);
  EXPECT_EQ(read.origin, Spec().origin);
  EXPECT_EQ(read.abandon_seconds, 2.0);
  EXPECT_TRUE(read.ends_with_caller);
  EXPECT_EQ(read.options.density.encoded_image, nullptr);
}

TEST(JobCodec, OutcomeKeepsResultOrError) {
  const JobCodec codec = ProtoJobCodec();
  JobView view;
  view.phase = Phase::kFinalizing;
  auto result = std::make_shared<JobResult>();
  result->sample_count = 5;
  result->triangle_count = 6;
  result->samples_sha256 = "abc";
  result->run.capacity_cv = 0.01;
  result->warnings = {"careful"};
  view.result = result;
  JobView read;
  ASSERT_TRUE(codec.decode_outcome(codec.encode_outcome(view), read).ok());
  EXPECT_EQ(read.result->sample_count, 5);
  EXPECT_EQ(read.result->triangle_count, 6);
  EXPECT_EQ(read.result->samples_sha256, "abc");
  EXPECT_EQ(read.result->run.capacity_cv, 0.01);
  EXPECT_EQ(read.result->warnings, view.result->warnings);
  EXPECT_EQ(read.phase, Phase::kFinalizing);

  JobView failed;
  failed.error = MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kMeshEmpty, "flat");
  JobView read_failed;
  ASSERT_TRUE(codec.decode_outcome(codec.encode_outcome(failed), read_failed).ok());
  EXPECT_EQ(GetErrorReason(read_failed.error), ErrorReason::kMeshEmpty);
  EXPECT_EQ(read_failed.result, nullptr);
}

TEST(JobCodec, HistoryKeepsEveryReport) {
  const JobCodec codec = ProtoJobCodec();
  std::vector<AlternationReport> reports(1000);
  for (int i = 0; i < 1000; ++i) {
    reports[i].alternation = i;
    reports[i].energy = 1.0 / (i + 1);
  }
  const auto read = codec.decode_history(codec.encode_history(reports));
  ASSERT_TRUE(read.ok());
  ASSERT_EQ(read->size(), 1000U);
  EXPECT_EQ((*read)[999].energy, 1.0 / 1000);
  EXPECT_TRUE(codec.decode_history("")->empty());
}

TEST(JobCodec, DamageIsNoticed) {
  const JobCodec codec = ProtoJobCodec();
  JobSpec spec;
  JobView view;
  EXPECT_EQ(GetErrorReason(codec.decode_definition("\xff\xff", spec)), ErrorReason::kStorageFailed);
  EXPECT_EQ(GetErrorReason(codec.decode_outcome("\xff\xff", view)), ErrorReason::kStorageFailed);
  EXPECT_EQ(GetErrorReason(codec.decode_history("\x7f").status()), ErrorReason::kStorageFailed);
}

}  // namespace
}  // namespace ccst::server
