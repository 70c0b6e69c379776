#include "proto/convert/field_limits.h"

#include <map>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <google/protobuf/descriptor.h>
#include <gtest/gtest.h>

#include "ccst/v1/error.pb.h"
#include "ccst/v1/job.pb.h"
#include "ccst/v1/mesh.pb.h"
#include "ccst/v1/mesh_service.pb.h"
#include "ccst/v1/sampling_service.pb.h"
#include "ccst/v1/server_info_service.pb.h"
#include "core/base/status.h"
#include "google/protobuf/any.pb.h"
#include "proto/convert/status.h"
#include "tests/proto/api_fields.h"

namespace ccst {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using testing::HasSubstr;
using testing::IsEmpty;

std::map<std::string, FieldLimit> LimitsByField() {
  std::map<std::string, FieldLimit> limits;
  for (const FieldLimit& limit : FieldLimits()) {
    EXPECT_TRUE(limits.emplace(std::string(limit.field), limit).second) << limit.field << " twice";
  }
  return limits;
}

TEST(FieldLimits, EveryTextAndListOfRequestsAndOfWhatIsListedHasOne) {
  const auto limits = LimitsByField();
  std::set<std::string> found;
  for (const ApiField& field : FieldsOf(RequestsAndRecords())) {
    const FieldDescriptor& last = *field.path.back();
    found.insert(last.full_name());
    const auto limit = limits.find(last.full_name());
    ASSERT_NE(limit, limits.end()) << last.full_name() << " can be as long as a message";
    EXPECT_TRUE(limit->second.most > 0 || !limit->second.advertised.empty()) << last.full_name();
    if (last.is_repeated() && last.cpp_type() == FieldDescriptor::CPPTYPE_STRING) {
      EXPECT_GT(limit->second.most_each, 0) << last.full_name();
    }
  }
  for (const auto& [name, limit] : limits) {
    EXPECT_TRUE(found.contains(name)) << name << " is no such field any more";
  }
}

TEST(FieldLimits, AdvertisedOnesAreFieldsOfServerLimits) {
  for (const FieldLimit& limit : FieldLimits()) {
    if (limit.advertised.empty()) continue;
    EXPECT_NE(v1::ServerLimits::descriptor()->FindFieldByName(std::string(limit.advertised)),
              nullptr)
        << limit.advertised;
  }
}

TEST(FieldLimits, EveryRequestIsCheckedDownToItsLastField) {
  const auto limits = LimitsByField();
  for (const ApiField& field : FieldsOf(Requests())) {
    const std::int64_t most = limits.at(field.path.back()->full_name()).most;
    if (most == 0) continue;
    EXPECT_TRUE(CheckFieldLimits(*WithLength(field, most)).ok()) << field.Text();
    const absl::Status refused = CheckFieldLimits(*WithLength(field, most + 1));
    EXPECT_EQ(GetErrorReason(refused), ErrorReason::kRequestInvalid) << field.Text();
    EXPECT_THAT(std::string(refused.message()), HasSubstr(field.path.front()->name()));
  }
}

TEST(FieldLimits, ViolationSaysWhereAndHowLong) {
  v1::CreateJobRequest request;
  request.mutable_spec()->mutable_options()->mutable_attribute()->set_attribute_name(
      std::string(65, 'x'));
  (*request.mutable_labels())[std::string(65, 'k')] = "v";
  Violations violations;
  CheckFieldLimits(request, violations);
  v1::FieldViolations fields;
  ASSERT_TRUE(GetDetail(violations.ToStatus(), fields));
  ASSERT_EQ(fields.field_violations_size(), 2);
  EXPECT_EQ(fields.field_violations(0).field(), "spec.options.attribute.attribute_name");
  EXPECT_EQ(fields.field_violations(0).description(), "has 65 bytes, must have at most 64");
  EXPECT_EQ(fields.field_violations(1).field(), "labels");
  EXPECT_EQ(fields.field_violations(1).description(),
            "has 65 bytes in a key, must have at most 64");
}

TEST(FieldLimits, LettersOfSeveralBytesCountAsBytes) {
  v1::CreateJobRequest request;
  std::string letters;
  for (int i = 0; i < 33; ++i) letters += "\xc3\xa4";
  (*request.mutable_labels())["key"] = letters;
  EXPECT_FALSE(CheckFieldLimits(request).ok());
  (*request.mutable_labels())["key"] = letters.substr(2);
  EXPECT_TRUE(CheckFieldLimits(request).ok());
}

TEST(FieldLimits, ListsThatAreFarTooLongAreNotLookedThrough) {
  v1::FindMissingMeshesRequest request;
  for (int i = 0; i < 1200; ++i) request.add_digests()->set_sha256(std::string(65, 'a'));
  Violations violations;
  CheckFieldLimits(request, violations);
  const absl::Status status = violations.ToStatus();
  EXPECT_THAT(std::string(status.message()), HasSubstr("digests: has 1200 entries"));
  v1::FieldViolations fields;
  ASSERT_TRUE(GetDetail(status, fields));
  EXPECT_EQ(fields.field_violations_size(), Violations::kMost);
  EXPECT_LT(ToProto(status).ByteSizeLong(), 4096U) << "more than a trailer holds";
}

TEST(CutToFieldLimits, TextsEndAtACharacterAndListsAtTheirLastEntry) {
  v1::Mesh mesh;
  std::string letters;
  for (int i = 0; i < 65; ++i) letters += "\xe2\x82\xac";
  for (int i = 0; i < 70; ++i) mesh.add_attributes()->set_attribute_name(letters);
  mesh.add_warnings(std::string(5000, 'w'));
  CutToFieldLimits(mesh);
  ASSERT_EQ(mesh.attributes_size(), 64);
  EXPECT_EQ(mesh.attributes(63).attribute_name(), letters.substr(0, 63));
  EXPECT_EQ(mesh.warnings(0).size(), 1024U);
}

TEST(CutToFieldLimits, WhatFitsStaysAsItIs) {
  v1::Job job;
  job.set_name("jobs/a");
  (*job.mutable_labels())["key"] = "value";
  job.mutable_error()->set_message("broken");
  job.mutable_error()->add_details()->set_value("detail");
  const std::string before = job.SerializeAsString();
  CutToFieldLimits(job);
  EXPECT_EQ(job.SerializeAsString(), before);
}

}  // namespace
}  // namespace ccst
