#include "server/formats/job_outcome.h"

#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "ccst/store/v1/record.pb.h"
#include "core/base/limit_error.h"
#include "core/base/status.h"

namespace ccst::server {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

// Sets each number and text of `message` and of those within it, all to something else.
void FillIn(Message& message, int& next) {
  const auto& reflection = *message.GetReflection();
  for (int i = 0; i < message.GetDescriptor()->field_count(); ++i) {
    const FieldDescriptor* const field = message.GetDescriptor()->field(i);
    ++next;
    if (field->is_repeated()) {
      reflection.AddString(&message, field, std::to_string(next));
      continue;
    }
    switch (field->cpp_type()) {
      case FieldDescriptor::CPPTYPE_INT32:
        reflection.SetInt32(&message, field, next);
        break;
      case FieldDescriptor::CPPTYPE_INT64:
        reflection.SetInt64(&message, field, next);
        break;
      case FieldDescriptor::CPPTYPE_DOUBLE:
        reflection.SetDouble(&message, field, next + 1.0 / 3.0);
        break;
      case FieldDescriptor::CPPTYPE_STRING:
        reflection.SetString(&message, field, std::to_string(next));
        break;
      case FieldDescriptor::CPPTYPE_ENUM:
        reflection.SetEnumValue(&message, field, 1);
        break;
      case FieldDescriptor::CPPTYPE_MESSAGE:
        FillIn(*reflection.MutableMessage(&message, field), next);
        break;
      default:
        ADD_FAILURE() << field->full_name() << " has a type that is not filled in";
    }
  }
}

// A field that is added to a message and not read or not written fails here.
TEST(JobOutcomes, EveryFieldOfAResultComesBack) {
  store::v1::Outcome message;
  message.set_format(1);
  message.set_phase(store::v1::PHASE_FINALIZING);
  int next = 0;
  FillIn(*message.mutable_result(), next);
  FillIn(*message.mutable_last_report(), next);
  const std::string bytes = message.SerializeAsString();
  const auto read = DecodeOutcome(bytes);
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ(EncodeOutcome(*read), bytes);
  EXPECT_EQ(read->phase, Phase::kFinalizing);
  EXPECT_EQ(read->result->run.surface.repairs.isolated_vertices,
            message.result().surface().isolated_vertices());
}

TEST(JobOutcomes, EveryTerminationAndPhaseComesBack) {
  for (const auto termination : {Termination::kConverged, Termination::kIterationLimit,
                                 Termination::kTimeLimit, Termination::kStopped}) {
    auto result = std::make_shared<JobResult>();
    result->run.termination = termination;
    const JobOutcome outcome{.result = result, .error = {}, .phase = {}, .last_report = {}};
    EXPECT_EQ(DecodeOutcome(EncodeOutcome(outcome))->result->run.termination, termination);
  }
  for (const auto phase :
       {Phase::kPreparing, Phase::kInitializing, Phase::kRelaxing, Phase::kFinalizing}) {
    JobOutcome outcome;
    outcome.phase = phase;
    EXPECT_EQ(DecodeOutcome(EncodeOutcome(outcome))->phase, phase);
  }
}

TEST(JobOutcomes, ErrorKeepsCodeMessageReasonAndLimit) {
  JobOutcome failed;
  failed.error = OverLimit({"max_faces", 5, 7}, "the mesh has 7 faces");
  const JobOutcome read = *DecodeOutcome(EncodeOutcome(failed));
  EXPECT_EQ(read.error.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(read.error.message(), "the mesh has 7 faces");
  EXPECT_EQ(GetErrorReason(read.error), ErrorReason::kLimitExceeded);
  EXPECT_EQ(GetPassedLimit(read.error)->name, "max_faces");
  EXPECT_EQ(GetPassedLimit(read.error)->value, 5);
  EXPECT_EQ(GetPassedLimit(read.error)->requested, 7);
  EXPECT_EQ(read.result, nullptr);
  EXPECT_FALSE(read.phase.has_value());
  EXPECT_FALSE(read.last_report.has_value());
}

TEST(JobOutcomes, ErrorWithoutAReasonHasNone) {
  JobOutcome failed;
  failed.error = absl::InternalError("bug");
  EXPECT_EQ(DecodeOutcome(EncodeOutcome(failed))->error, absl::InternalError("bug"));
}

TEST(JobOutcomes, NoBytesAreNoOutcome) {
  const JobOutcome read = *DecodeOutcome("");
  EXPECT_EQ(read.result, nullptr);
  EXPECT_TRUE(read.error.ok());
}

TEST(JobOutcomes, DamageIsNoticed) {
  store::v1::Outcome message;
  message.set_format(1);
  message.mutable_result();  // Without a reason why it ended.
  for (const std::string& bytes :
       {std::string("\xff\xff"), std::string("\x12"), message.SerializeAsString()}) {
    EXPECT_EQ(GetErrorReason(DecodeOutcome(bytes).status()), ErrorReason::kStorageFailed);
  }
}

}  // namespace
}  // namespace ccst::server
