#include "proto/convert/job_request.h"

#include <limits>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "core/base/status.h"
#include "proto/convert/scalars.h"
#include "proto/convert/status.h"

namespace ccst {
namespace {

v1::SampleRequest RightRequest() {
  v1::SampleRequest request;
  request.mutable_inline_mesh()->set_format(v1::MESH_FORMAT_DRACO);
  request.mutable_inline_mesh()->set_data("DRACO");
  request.mutable_options()->set_sample_count(100);
  return request;
}

std::set<std::string> WrongFields(const absl::Status& status) {
  v1::FieldViolations violations;
  std::set<std::string> fields;
  if (!GetDetail(status, violations)) return fields;
  for (const auto& violation : violations.field_violations()) fields.insert(violation.field());
  return fields;
}

TEST(SampleRequest, UnsetFieldsTakeTheCoresDefaults) {
  const auto call = FromProto(RightRequest());
  ASSERT_TRUE(call.ok()) << call.status();
  const SamplingOptions defaults;
  EXPECT_EQ(call->options.sample_count, 100);
  EXPECT_EQ(call->options.max_iterations, defaults.max_iterations);
  EXPECT_EQ(call->options.relative_tolerance, defaults.relative_tolerance);
  EXPECT_EQ(call->options.seed, defaults.seed);
  EXPECT_EQ(call->options.energy, defaults.energy);
  EXPECT_EQ(call->options.weld_tolerance, defaults.weld_tolerance);
  EXPECT_EQ(call->options.time_limit_seconds, RequestLimits{}.max_job_seconds);
  EXPECT_FALSE(call->origin.has_value());
  EXPECT_EQ(call->preview_sample_count, 0);
}

TEST(SampleRequest, ZeroThatIsSetIsNotADefault) {
  v1::SampleRequest request = RightRequest();
  request.mutable_options()->set_max_iterations(0);
  const auto call = FromProto(request);
  ASSERT_TRUE(call.ok());
  EXPECT_EQ(call->options.max_iterations, 0);
}

TEST(SampleRequest, EverythingWrongIsNamedAtOnce) {
  v1::SampleRequest request = RightRequest();
  request.mutable_inline_mesh()->set_format(v1::MESH_FORMAT_UNSPECIFIED);
  request.mutable_inline_mesh()->clear_data();
  request.mutable_inline_mesh()->mutable_origin()->set_y(std::numeric_limits<double>::quiet_NaN());
  auto* options = request.mutable_options();
  options->set_sample_count(3);
  options->set_max_iterations(-1);
  options->set_relative_tolerance(0.0);
  options->mutable_time_limit()->set_seconds(-1);
  options->set_energy(static_cast<v1::Energy>(77));
  options->set_weld_tolerance(-1.0);
  request.set_preview_sample_count(-1);
  const auto call = FromProto(request);
  ASSERT_FALSE(call.ok());
  EXPECT_EQ(call.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(
      WrongFields(call.status()),
      (std::set<std::string>{"inline_mesh.format", "inline_mesh.data", "inline_mesh.origin",
                             "options.sample_count", "options.max_iterations",
                             "options.relative_tolerance", "options.time_limit", "options.energy",
                             "options.weld_tolerance", "preview_sample_count"}));
}

TEST(SampleRequest, EmptyOneSaysWhatIsMissing) {
  const auto call = FromProto(v1::SampleRequest());
  ASSERT_FALSE(call.ok());
  EXPECT_EQ(GetErrorReason(call.status()), ErrorReason::kRequestInvalid);
  EXPECT_EQ(WrongFields(call.status()), (std::set<std::string>{"inline_mesh", "options"}));
}

TEST(SampleRequest, LimitsAreNamedWithTheirValues) {
  v1::SampleRequest request = RightRequest();
  request.mutable_options()->set_sample_count(5001);
  RequestLimits limits;
  limits.max_sample_count = 5000;
  const auto call = FromProto(request, limits);
  ASSERT_FALSE(call.ok());
  EXPECT_EQ(GetErrorReason(call.status()), ErrorReason::kLimitExceeded);
  v1::LimitViolation violation;
  ASSERT_TRUE(GetDetail(call.status(), violation));
  EXPECT_EQ(violation.limit(), "max_sample_count");
  EXPECT_EQ(violation.limit_value(), 5000);
  EXPECT_EQ(violation.requested_value(), 5001);
}

TEST(SampleRequest, NamesOfLimitsAreFieldsOfServerLimits) {
  v1::SampleRequest request = RightRequest();
  request.mutable_inline_mesh()->set_data("too long");
  RequestLimits limits;
  limits.max_inline_mesh_bytes = 3;
  v1::LimitViolation violation;
  ASSERT_TRUE(GetDetail(FromProto(request, limits).status(), violation));
  EXPECT_EQ(violation.limit(), "max_inline_mesh_bytes");
  EXPECT_EQ(violation.requested_value(), 8);
}

TEST(SampleRequest, TimeLimitIsBoundedByTheServers) {
  v1::SampleRequest request = RightRequest();
  RequestLimits limits;
  limits.max_job_seconds = 60.0;
  *request.mutable_options()->mutable_time_limit() = DurationToProto(2.5);
  EXPECT_EQ(FromProto(request, limits)->options.time_limit_seconds, 2.5);
  *request.mutable_options()->mutable_time_limit() = DurationToProto(1e6);
  EXPECT_EQ(FromProto(request, limits)->options.time_limit_seconds, 60.0);
}

TEST(SampleRequest, StoredMeshTakesItsOriginFromTheRequest) {
  v1::SampleRequest request = RightRequest();
  request.set_mesh_name("meshes/" + std::string(64, 'a'));
  request.mutable_origin()->set_x(5.0);
  const auto call = FromProto(request);
  ASSERT_TRUE(call.ok()) << call.status();
  EXPECT_EQ(call->mesh_sha256, std::string(64, 'a'));
  EXPECT_EQ(call->origin->x(), 5.0);
}

TEST(CreateJobRequest, EverythingAskedForArrives) {
  v1::CreateJobRequest request;
  request.mutable_spec()->set_mesh("meshes/" + std::string(64, '0'));
  request.mutable_spec()->mutable_options()->set_sample_count(100);
  request.mutable_spec()->mutable_origin()->set_z(-1.0);
  request.set_request_id("abc");
  request.set_display_name("bunny");
  (*request.mutable_labels())["team"] = "a";
  request.set_skip_cache_lookup(true);
  request.set_validate_only(true);
  *request.mutable_abandon_timeout() = DurationToProto(1.5);
  const auto call = FromProto(request);
  ASSERT_TRUE(call.ok()) << call.status();
  EXPECT_EQ(call->mesh_sha256, std::string(64, '0'));
  EXPECT_EQ(call->options.sample_count, 100);
  EXPECT_EQ(call->origin->z(), -1.0);
  EXPECT_EQ(call->request_id, "abc");
  EXPECT_EQ(call->display_name, "bunny");
  EXPECT_EQ(call->labels.at("team"), "a");
  EXPECT_TRUE(call->skip_cache_lookup);
  EXPECT_TRUE(call->validate_only);
  EXPECT_EQ(call->abandon_seconds, 1.5);
}

TEST(CreateJobRequest, EverythingWrongIsNamedAtOnce) {
  v1::CreateJobRequest request;
  request.mutable_spec()->set_mesh("meshes/../../etc/passwd");
  request.mutable_spec()->mutable_options()->set_sample_count(0);
  request.mutable_spec()->mutable_origin()->set_x(std::numeric_limits<double>::infinity());
  request.set_request_id(std::string(65, 'x'));
  request.set_display_name(std::string(129, 'x'));
  (*request.mutable_labels())[""] = "no key";
  *request.mutable_abandon_timeout() = DurationToProto(0.0);
  EXPECT_EQ(WrongFields(FromProto(request).status()),
            (std::set<std::string>{"spec.mesh", "spec.options.sample_count", "spec.origin",
                                   "request_id", "display_name", "labels", "abandon_timeout"}));
}

TEST(CreateJobRequest, LengthsAreInCharacters) {
  v1::CreateJobRequest request;
  request.mutable_spec()->set_mesh("meshes/" + std::string(64, '0'));
  request.mutable_spec()->mutable_options()->set_sample_count(100);
  std::string name;
  for (int i = 0; i < 128; ++i) name += "\u00e4";
  request.set_display_name(name);
  EXPECT_TRUE(FromProto(request).ok());
}

}  // namespace
}  // namespace ccst
