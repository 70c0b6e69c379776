// What stores of earlier versions have, built here from messages of the API as those versions did.
#include "server/formats/earlier_formats.h"

#include <string>

#include <gtest/gtest.h>

#include "ccst/v1/sampling_service.pb.h"
#include "core/base/limit_error.h"
#include "core/base/status.h"
#include "google/protobuf/io/zero_copy_stream_impl_lite.h"
#include "google/protobuf/util/delimited_message_util.h"
#include "proto/convert/options.h"
#include "proto/convert/progress.h"
#include "proto/convert/status.h"
#include "server/formats/job_definition.h"
#include "server/formats/job_history.h"
#include "server/formats/job_outcome.h"
#include "server/formats/mesh_facts.h"

namespace ccst::server {
namespace {

TEST(EarlierFormats, DefinitionMeansTheSame) {
  SamplingOptions options;
  options.sample_count = 3'000'000;
  options.seed = 77;
  options.max_iterations = 9;
  options.time_limit_seconds = 12.5;
  options.crease_angle = 0.7;
  options.density.source = DensitySource::kTexture;
  options.density.exponent = 2.0;
  v1::CreateJobRequest request;
  *request.mutable_spec()->mutable_options() = ToProto(options);
  request.mutable_spec()->mutable_origin()->set_y(0.1);
  request.mutable_abandon_timeout()->set_seconds(2);
  (*request.mutable_labels())["ends-with-caller"] = "";
  const JobDefinition expected{.options = options,
                               .origin = Eigen::Vector3d(0.0, 0.1, 0.0),
                               .abandon_seconds = 2.0,
                               .ends_with_caller = true};
  EXPECT_EQ(*UpgradeDefinition(request.SerializeAsString()), EncodeDefinition(expected));
}

TEST(EarlierFormats, DefinitionWithoutTheLabelSurvivesItsCaller) {
  SamplingOptions options;
  options.sample_count = 10;
  options.time_limit_seconds = 3600.0;
  v1::CreateJobRequest request;
  *request.mutable_spec()->mutable_options() = ToProto(options);
  const JobDefinition expected{
      .options = options, .origin = {}, .abandon_seconds = {}, .ends_with_caller = false};
  EXPECT_EQ(*UpgradeDefinition(request.SerializeAsString()), EncodeDefinition(expected));
}

TEST(EarlierFormats, OutcomeKeepsItsResult) {
  v1::Job job;
  v1::SamplingResult& result = *job.mutable_result();
  result.set_termination_reason(v1::TERMINATION_REASON_TIME_LIMIT);
  result.set_sample_count(5);
  result.set_sample_mesh_face_count(6);
  result.set_capacity_cv(0.01);
  result.mutable_samples_digest()->set_sha256("abc");
  result.mutable_samples_digest()->set_size_bytes(9);
  result.mutable_durations()->mutable_queue_duration()->set_nanos(500'000'000);
  result.mutable_surface()->set_flipped_face_count(3);
  result.add_warnings("careful");
  job.mutable_progress()->set_phase(v1::JOB_PHASE_FINALIZING);
  job.mutable_progress()->set_iteration(7);
  const JobOutcome read = *DecodeOutcome(*UpgradeOutcome(job.SerializeAsString()));
  ASSERT_NE(read.result, nullptr);
  EXPECT_EQ(read.result->run.termination, Termination::kTimeLimit);
  EXPECT_EQ(read.result->sample_count, 5);
  EXPECT_EQ(read.result->triangle_count, 6);
  EXPECT_EQ(read.result->run.capacity_cv, 0.01);
  EXPECT_EQ(read.result->samples_sha256, "abc");
  EXPECT_EQ(read.result->samples_bytes, 9);
  EXPECT_EQ(read.result->queue_seconds, 0.5);
  EXPECT_EQ(read.result->run.surface.repairs.flipped_faces, 3);
  EXPECT_EQ(read.result->warnings, std::vector<std::string>{"careful"});
  EXPECT_EQ(read.phase, Phase::kFinalizing);
  EXPECT_EQ(read.last_report->alternation, 7);
}

TEST(EarlierFormats, OutcomeKeepsItsErrorAsCallersSeeIt) {
  const absl::Status error = OverLimit({"max_faces", 5, 7}, "the mesh has 7 faces");
  v1::Job job;
  *job.mutable_error() = ToProto(error);
  const JobOutcome read = *DecodeOutcome(*UpgradeOutcome(job.SerializeAsString()));
  EXPECT_EQ(read.result, nullptr);
  EXPECT_EQ(ToProto(read.error).SerializeAsString(), job.error().SerializeAsString());
}

TEST(EarlierFormats, HistoryKeepsEveryReport) {
  std::string bytes;
  {
    google::protobuf::io::StringOutputStream out(&bytes);
    for (int i = 1; i <= 3; ++i) {
      AlternationReport report;
      report.alternation = i;
      report.energy = 1.0 / i;
      report.elapsed_seconds = 0.25 * i;
      google::protobuf::util::SerializeDelimitedToZeroCopyStream(ToProto(report, Phase::kRelaxing),
                                                                 &out);
    }
  }
  const auto read = *DecodeHistory(*UpgradeHistory(bytes));
  ASSERT_EQ(read.size(), 3u);
  EXPECT_EQ(read[2].alternation, 3);
  EXPECT_EQ(read[2].energy, 1.0 / 3);
  EXPECT_EQ(read[2].elapsed_seconds, 0.75);
}

TEST(EarlierFormats, FactsMeanTheSame) {
  v1::Mesh mesh;
  mesh.set_vertex_count(1);
  mesh.set_face_count(2);
  mesh.set_component_count(3);
  mesh.set_boundary_loop_count(4);
  mesh.set_surface_area(5.5);
  mesh.mutable_bounds_max()->set_z(3.0);
  mesh.mutable_bounds_min()->set_x(-1.0);
  v1::MeshAttribute& attribute = *mesh.add_attributes();
  attribute.set_attribute_name("heat");
  attribute.set_component_count(2);
  attribute.set_min_value(-1.5);
  attribute.set_max_value(7.25);
  mesh.add_warnings("one");
  const MeshFacts expected{
      .vertices = 1,
      .file_faces = 2,
      .components = 3,
      .boundary_loops = 4,
      .area = 5.5,
      .bounds_min = {-1.0, 0.0, 0.0},
      .bounds_max = {0.0, 0.0, 3.0},
      .attributes = {{.name = "heat", .components = 2, .min_value = -1.5, .max_value = 7.25}},
      .warnings = {"one"}};
  EXPECT_EQ(*UpgradeFacts(mesh.SerializeAsString()), EncodeFacts(expected));
}

TEST(EarlierFormats, NoOutcomeAndNoHistoryStayNone) {
  EXPECT_EQ(*UpgradeOutcome(""), "");
  EXPECT_EQ(*UpgradeHistory(""), "");
}

TEST(EarlierFormats, DamageIsNoticed) {
  EXPECT_FALSE(UpgradeDefinition("\xff\xff").ok());
  EXPECT_FALSE(UpgradeDefinition("").ok());  // Of no number of samples.
  EXPECT_FALSE(UpgradeOutcome("\xff\xff").ok());
  EXPECT_FALSE(UpgradeHistory("\x7f").ok());
  EXPECT_FALSE(UpgradeFacts("\xff\xff").ok());
}

// What was left as it was for damage is not taken for something of today.
TEST(EarlierFormats, AreNotReadAsTheyAre) {
  SamplingOptions options;
  options.sample_count = 10;
  v1::CreateJobRequest request;
  *request.mutable_spec()->mutable_options() = ToProto(options);
  EXPECT_FALSE(DecodeDefinition(request.SerializeAsString()).ok());
  v1::Job job;
  job.mutable_progress()->set_iteration(7);
  EXPECT_FALSE(DecodeOutcome(job.SerializeAsString()).ok());
  v1::Mesh mesh;
  mesh.set_face_count(2);
  EXPECT_FALSE(DecodeFacts(mesh.SerializeAsString()).ok());
}

}  // namespace
}  // namespace ccst::server
