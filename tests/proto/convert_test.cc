// Round trips. Messages are filled field by field from their descriptors, so that a field that is
// added to a message and not to its conversion is lost on the way and fails here.
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ccst/v1/error.pb.h"
#include "ccst/v1/job.pb.h"
#include "ccst/v1/mesh.pb.h"
#include "ccst/v1/sampling_service.pb.h"
#include "core/base/status.h"
#include "google/protobuf/descriptor.h"
#include "google/protobuf/util/message_differencer.h"
#include "proto/convert/enums.h"
#include "proto/convert/options.h"
#include "proto/convert/progress.h"
#include "proto/convert/result.h"
#include "proto/convert/samples.h"
#include "proto/convert/scalars.h"
#include "proto/convert/status.h"

namespace ccst {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::Reflection;
using google::protobuf::util::MessageDifferencer;

// Sets every field to a value of its own that is not its default.
void Fill(Message& message, int& next) {
  const Reflection& reflection = *message.GetReflection();
  const Descriptor& descriptor = *message.GetDescriptor();
  for (int i = 0; i < descriptor.field_count(); ++i) {
    const FieldDescriptor* field = descriptor.field(i);
    ++next;
    if (field->is_repeated()) {
      ASSERT_EQ(field->cpp_type(), FieldDescriptor::CPPTYPE_STRING) << field->full_name();
      reflection.AddString(&message, field, "text " + std::to_string(next));
      continue;
    }
    switch (field->cpp_type()) {
      case FieldDescriptor::CPPTYPE_INT32:
        reflection.SetInt32(&message, field, next);
        break;
      case FieldDescriptor::CPPTYPE_INT64:
        reflection.SetInt64(&message, field, next);
        break;
      case FieldDescriptor::CPPTYPE_UINT64:
        reflection.SetUInt64(&message, field, static_cast<std::uint64_t>(next));
        break;
      case FieldDescriptor::CPPTYPE_DOUBLE:
        // In the range of every option.
        reflection.SetDouble(&message, field, 1.0 + next / 1024.0);
        break;
      case FieldDescriptor::CPPTYPE_BOOL:
        reflection.SetBool(&message, field, true);
        break;
      case FieldDescriptor::CPPTYPE_STRING:
        reflection.SetString(&message, field, "text " + std::to_string(next));
        break;
      case FieldDescriptor::CPPTYPE_ENUM: {
        const auto* type = field->enum_type();
        // What a result and its last report say of the phase: always the last one.
        reflection.SetEnum(&message, field, type->value(type->value_count() - 1));
        break;
      }
      case FieldDescriptor::CPPTYPE_MESSAGE:
        Fill(*reflection.MutableMessage(&message, field), next);
        break;
      default:
        FAIL() << "teach Fill the type of " << field->full_name();
    }
  }
}

template <typename T>
T Filled() {
  T message;
  int next = 10;
  Fill(message, next);
  return message;
}

template <typename T>
void ExpectSame(const T& expected, const T& actual) {
  std::string difference;
  MessageDifferencer differencer;
  differencer.ReportDifferencesToString(&difference);
  EXPECT_TRUE(differencer.Compare(expected, actual)) << difference;
}

TEST(Convert, SamplingOptionsKeepEveryField) {
  const auto message = Filled<v1::SamplingOptions>();
  const auto options = FromProto(message);
  ASSERT_TRUE(options.ok()) << options.status();
  ExpectSame(message, ToProto(*options));
}

TEST(Convert, DensitiesKeepEveryField) {
  auto message = Filled<v1::SamplingOptions>();
  int next = 10;
  Fill(*message.mutable_attribute(), next);
  ExpectSame(message, ToProto(*FromProto(message)));
  Fill(*message.mutable_curvature(), next);
  ExpectSame(message, ToProto(*FromProto(message)));
}

TEST(Convert, SurfaceSummaryKeepsEveryField) {
  const auto message = Filled<v1::SurfaceSummary>();
  ExpectSame(message, ToProto(FromProto(message)));
}

TEST(Convert, IterationProgressKeepsEveryField) {
  const auto message = Filled<v1::IterationProgress>();
  ExpectSame(message, ToProto(FromProto(message), FromProto(message.phase())));
}

TEST(Convert, SamplingResultKeepsEveryField) {
  const auto message = Filled<v1::SamplingResult>();
  const auto figures = FromProto(message);
  ASSERT_TRUE(figures.ok()) << figures.status();
  ExpectSame(message, ToProto(*figures));
}

TEST(Convert, Vector3KeepsEveryField) {
  const auto message = Filled<v1::Vector3>();
  ExpectSame(message, ToProto(FromProto(message)));
}

TEST(Convert, SampleRequestHasNoFieldThatIsNotRead) {
  // FromProto(SampleRequest) reads these; a new one belongs there, and then here.
  const std::set<std::string> read = {"inline_mesh",          "mesh_name", "options",
                                      "preview_sample_count", "origin",    "skip_cache_lookup",
                                      "display_name",         "labels"};
  const Descriptor& request = *v1::SampleRequest::descriptor();
  for (int i = 0; i < request.field_count(); ++i) {
    EXPECT_TRUE(read.contains(request.field(i)->name())) << request.field(i)->full_name();
  }
  const std::set<std::string> mesh = {"format", "data", "origin"};
  const Descriptor& inline_mesh = *v1::InlineMesh::descriptor();
  for (int i = 0; i < inline_mesh.field_count(); ++i) {
    EXPECT_TRUE(mesh.contains(inline_mesh.field(i)->name())) << inline_mesh.field(i)->full_name();
  }
}

template <typename ProtoEnum>
void ExpectEnumRoundTrip() {
  const auto* type = google::protobuf::GetEnumDescriptor<ProtoEnum>();
  for (int i = 1; i < type->value_count(); ++i) {
    const auto value = static_cast<ProtoEnum>(type->value(i)->number());
    const auto core = FromProto(value);
    ASSERT_TRUE(core.has_value()) << type->value(i)->full_name();
    EXPECT_EQ(ToProto(*core), value);
  }
}

TEST(Convert, EnumsKnowEveryValue) {
  ExpectEnumRoundTrip<v1::Energy>();
  ExpectEnumRoundTrip<v1::JobPhase>();
  ExpectEnumRoundTrip<v1::TerminationReason>();
  ExpectEnumRoundTrip<v1::AttributeKind>();
  EXPECT_EQ(FromProto(v1::ATTRIBUTE_KIND_UNSPECIFIED), AttributeKind::kScalar);
  EXPECT_EQ(FromProto(v1::ENERGY_UNSPECIFIED), Energy::kTarget);
  EXPECT_EQ(FromProto(v1::JOB_PHASE_UNSPECIFIED), std::nullopt);
  EXPECT_EQ(FromProto(static_cast<v1::Energy>(99)), std::nullopt);
}

SampleSet ManySamples(int count) {
  SampleSet samples;
  for (int i = 0; i < count; ++i) {
    samples.faces.push_back(i % 7);
    samples.barycentrics.emplace_back(1.0 / (i + 3), 0.1);
    samples.positions.emplace_back(i, 0.5, -i);
    samples.normals.emplace_back(0.0, 0.0, 1.0);
    samples.triangles.emplace_back(i, (i + 1) % count, (i + 2) % count);
  }
  samples.attributes = {{.name = "color", .kind = AttributeKind::kColor, .components = 3},
                        {.name = "uv", .kind = AttributeKind::kTextureCoordinates, .components = 2},
                        {.name = "heat"}};
  for (Attribute& attribute : samples.attributes) {
    for (int i = 0; i < count * attribute.components; ++i) {
      attribute.values.push_back(1.0F / static_cast<float>(i + attribute.components));
    }
  }
  return samples;
}

TEST(Convert, ChunksTogetherAreTheSamples) {
  const SampleSet samples = ManySamples(10);
  SampleSet read;
  for (const auto& [start, count] : {std::pair{0, 4}, {4, 4}, {8, 2}}) {
    const v1::SampleChunk chunk = SampleChunkToProto(samples, start, count);
    std::vector<const FieldDescriptor*> set;
    chunk.GetReflection()->ListFields(chunk, &set);
    // proto3 does not list a start_index of 0.
    EXPECT_EQ(static_cast<int>(set.size()), chunk.GetDescriptor()->field_count() - (start == 0));
    ASSERT_TRUE(AppendChunk(chunk, read).ok());
  }
  ASSERT_TRUE(AppendChunk(SampleMeshChunkToProto(samples, 0, 7), read).ok());
  ASSERT_TRUE(AppendChunk(SampleMeshChunkToProto(samples, 7, 3), read).ok());
  EXPECT_EQ(read.faces, samples.faces);
  EXPECT_EQ(read.barycentrics, samples.barycentrics);
  EXPECT_EQ(read.positions, samples.positions);
  EXPECT_EQ(read.normals, samples.normals);
  EXPECT_EQ(read.triangles, samples.triangles);
  ASSERT_EQ(read.attributes.size(), samples.attributes.size());
  for (std::size_t i = 0; i < read.attributes.size(); ++i) {
    EXPECT_EQ(read.attributes[i].name, samples.attributes[i].name);
    EXPECT_EQ(read.attributes[i].kind, samples.attributes[i].kind);
    EXPECT_EQ(read.attributes[i].components, samples.attributes[i].components);
    EXPECT_EQ(read.attributes[i].values, samples.attributes[i].values);
  }
}

TEST(Convert, AttributesThatDoNotFitAreRefused) {
  const SampleSet samples = ManySamples(10);
  const v1::SampleChunk first = SampleChunkToProto(samples, 0, 4);
  const auto refused = [](const v1::SampleChunk& chunk, SampleSet read) {
    const std::size_t before = read.faces.size();
    return !AppendChunk(chunk, read).ok() && read.faces.size() == before;
  };
  v1::SampleChunk chunk = first;
  chunk.mutable_attributes(1)->add_values(0.0F);
  EXPECT_TRUE(refused(chunk, {}));
  for (const int components : {-1, 0, 5, 1 << 30}) {
    chunk = first;
    chunk.mutable_attributes(2)->set_component_count(components);
    EXPECT_TRUE(refused(chunk, {})) << components;
  }
  chunk = first;
  chunk.mutable_attributes(0)->set_name(std::string(65, 'x'));
  EXPECT_TRUE(refused(chunk, {}));
  chunk = first;
  for (int i = 0; i < 62; ++i) *chunk.add_attributes() = first.attributes(2);
  EXPECT_TRUE(refused(chunk, {}));

  SampleSet read;
  ASSERT_TRUE(AppendChunk(first, read).ok());
  const v1::SampleChunk second = SampleChunkToProto(samples, 4, 4);
  chunk = second;
  chunk.mutable_attributes()->RemoveLast();
  EXPECT_TRUE(refused(chunk, read));
  chunk = second;
  chunk.mutable_attributes(2)->set_name("cold");
  EXPECT_TRUE(refused(chunk, read));
  chunk = second;
  chunk.mutable_attributes(0)->set_kind(v1::ATTRIBUTE_KIND_SCALAR);
  EXPECT_TRUE(refused(chunk, read));
  EXPECT_TRUE(AppendChunk(second, read).ok());
}

TEST(Convert, WideAttributesMakeShorterChunks) {
  SampleSet samples = ManySamples(static_cast<int>(kMaxChunkLength));
  samples.attributes.clear();
  EXPECT_EQ(SamplesPerChunk(samples.attributes), kMaxChunkLength);
  for (int i = 0; i < 64; ++i) {
    samples.attributes.push_back({.name = std::string(62, 'x') + std::to_string(10 + i),
                                  .components = 4,
                                  .values = std::vector<float>(4 * kMaxChunkLength, 1.0F)});
  }
  const std::int64_t count = SamplesPerChunk(samples.attributes);
  const std::size_t bytes = SampleChunkToProto(samples, 0, count).ByteSizeLong();
  EXPECT_LT(bytes, 1U << 18);
  EXPECT_GT(bytes, 1U << 17);
}

TEST(Convert, BrokenChunksAreRefused) {
  const SampleSet samples = ManySamples(10);
  SampleSet read;
  EXPECT_FALSE(AppendChunk(SampleChunkToProto(samples, 1, 2), read).ok());
  v1::SampleChunk uneven = SampleChunkToProto(samples, 0, 2);
  uneven.add_normals(0.0F);
  EXPECT_FALSE(AppendChunk(uneven, read).ok());
  EXPECT_TRUE(read.faces.empty());
  EXPECT_FALSE(AppendChunk(SampleMeshChunkToProto(samples, 0, 1), read).ok());
  ASSERT_TRUE(AppendChunk(SampleChunkToProto(samples, 0, 10), read).ok());
  v1::SampleMeshChunk torn = SampleMeshChunkToProto(samples, 0, 1);
  torn.add_vertex_indices(0);
  EXPECT_FALSE(AppendChunk(torn, read).ok());
  EXPECT_FALSE(AppendChunk(SampleMeshChunkToProto(samples, 1, 1), read).ok());
  EXPECT_TRUE(read.triangles.empty());
}

TEST(Convert, FullChunksFitTheDefaultMessageLimit) {
  const SampleSet samples = ManySamples(static_cast<int>(kMaxChunkLength));
  EXPECT_LT(SampleChunkToProto(samples, 0, SamplesPerChunk(samples.attributes)).ByteSizeLong(),
            1U << 20);
  EXPECT_LT(SampleMeshChunkToProto(samples, 0, kMaxChunkLength).ByteSizeLong(), 1U << 20);
}

TEST(Convert, DurationsRoundToNanoseconds) {
  EXPECT_EQ(DurationToProto(1.5).seconds(), 1);
  EXPECT_EQ(DurationToProto(1.5).nanos(), 500'000'000);
  EXPECT_EQ(DurationToProto(0.9999999999).seconds(), 1);
  EXPECT_EQ(DurationToProto(0.9999999999).nanos(), 0);
  EXPECT_EQ(DurationToProto(-1.5).nanos(), -500'000'000);
  EXPECT_EQ(DurationToProto(std::numeric_limits<double>::quiet_NaN()).seconds(), 0);
  EXPECT_EQ(DurationToProto(std::numeric_limits<double>::infinity()).seconds(), 315'576'000'000);
  EXPECT_DOUBLE_EQ(SecondsFromProto(DurationToProto(12.25)), 12.25);
}

TEST(ConvertStatus, RoundTripKeepsCodeReasonAndDetails) {
  absl::Status status = MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kMeshNotManifold,
                                  "edge 3-4 has 3 faces");
  v1::LimitViolation violation;
  violation.set_limit("max_sample_count");
  SetDetail(violation, status);
  const v1::Status message = ToProto(status);
  EXPECT_EQ(message.code(), 3);
  ASSERT_EQ(message.details_size(), 2);
  v1::ErrorInfo info;
  ASSERT_TRUE(message.details(0).UnpackTo(&info));
  EXPECT_EQ(info.reason(), "MESH_NOT_MANIFOLD");
  EXPECT_EQ(info.domain(), "ccst.v1");
  const absl::Status back = FromProto(message);
  EXPECT_EQ(back.code(), status.code());
  EXPECT_EQ(back.message(), status.message());
  EXPECT_EQ(GetErrorReason(back), ErrorReason::kMeshNotManifold);
  v1::LimitViolation read;
  EXPECT_TRUE(GetDetail(back, read));
  EXPECT_EQ(read.limit(), "max_sample_count");
  ExpectSame(message, ToProto(back));
}

TEST(ConvertStatus, ReasonIsNeverMissing) {
  v1::ErrorInfo info;
  ASSERT_TRUE(ToProto(absl::UnknownError("?")).details(0).UnpackTo(&info));
  EXPECT_EQ(info.reason(), "INTERNAL");
  ASSERT_TRUE(ToProto(absl::CancelledError("?")).details(0).UnpackTo(&info));
  EXPECT_EQ(info.reason(), "CANCELLED");
}

TEST(ConvertStatus, UnknownReasonStaysReadable) {
  v1::Status message;
  message.set_code(9);
  v1::ErrorInfo info;
  info.set_reason("OF_A_LATER_VERSION");
  info.set_domain("ccst.v1");
  message.add_details()->PackFrom(info);
  const absl::Status status = FromProto(message);
  EXPECT_EQ(GetErrorReason(status), std::nullopt);
  v1::ErrorInfo read;
  ASSERT_TRUE(GetDetail(status, read));
  EXPECT_EQ(read.reason(), "OF_A_LATER_VERSION");
}

TEST(ConvertStatus, LongMessagesAreCutAtACharacter) {
  std::string text;
  while (text.size() < 3000) text += "\xE2\x82\xAC";  // Three bytes each; 1024 is no multiple.
  const std::string message = ToProto(absl::InternalError(text)).message();
  EXPECT_EQ(message.size(), 1023U);
}

}  // namespace
}  // namespace ccst
