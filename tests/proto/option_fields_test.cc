// The messages of the API are written by hand; here they are held against the table of options.
#include "proto/convert/option_fields.h"

#include <fstream>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <type_traits>
#include <vector>

#include <gmock/gmock.h>
#include <google/protobuf/descriptor.h>
#include <gtest/gtest.h>

#include "absl/strings/str_cat.h"
#include "ccst/v1/job.pb.h"
#include "core/sampling/option_table.h"
#include "proto/convert/status.h"

namespace ccst {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;
using testing::HasSubstr;

// The messages that hold options, and whether those are of the density.
struct OptionMessage {
  const Descriptor* descriptor;
  bool is_density;
};
std::vector<OptionMessage> OptionMessages() {
  const Descriptor* const options = v1::SamplingOptions::descriptor();
  std::vector<OptionMessage> messages = {{options, false}};
  const auto* const density = options->FindOneofByName("density");
  for (int i = 0; i < density->field_count(); ++i) {
    messages.push_back({density->field(i)->message_type(), true});
  }
  return messages;
}

bool IsInDensity(const OptionInfo& info) {
  return info.name.starts_with("density.") && info.name != "density.source";
}

// The fields of an option; there are several of those that all densities have.
std::vector<const FieldDescriptor*> FieldsNamedBy(const OptionInfo& info) {
  std::vector<const FieldDescriptor*> fields;
  for (const auto& [descriptor, is_density] : OptionMessages()) {
    const FieldDescriptor* const field = descriptor->FindFieldByName(std::string(info.field));
    if (is_density == IsInDensity(info) && field != nullptr) fields.push_back(field);
  }
  return fields;
}

TEST(OptionFields, TableNamesEachFieldOfTheMessages) {
  std::set<const FieldDescriptor*> named;
  const SamplingOptions options;
  VisitOptions(options, [&named](const auto& option, const auto& /*value*/) {
    const auto fields = FieldsNamedBy(option.info);
    named.insert(fields.begin(), fields.end());
    const bool travels = !option.info.field.empty() && option.info.name != "density.source";
    EXPECT_EQ(travels, !fields.empty())
        << option.info.name << " has no field " << option.info.field;
  });
  for (const auto& [descriptor, is_density] : OptionMessages()) {
    for (int i = 0; i < descriptor->field_count(); ++i) {
      const FieldDescriptor* const field = descriptor->field(i);
      if (field->real_containing_oneof() != nullptr) continue;  // The densities themselves.
      EXPECT_TRUE(named.contains(field)) << field->full_name() << " is in no option's description";
    }
  }
}

// A number that is left out reads as 0 where the message does not say that it was left out.
TEST(OptionFields, NumbersWithoutPresenceAreZeroByDefault) {
  const SamplingOptions defaults;
  VisitOptions(defaults, [](const auto& option, const auto& value) {
    if constexpr (std::is_arithmetic_v<std::remove_cvref_t<decltype(value)>>) {
      for (const FieldDescriptor* const field : FieldsNamedBy(option.info)) {
        if (field->has_presence()) continue;
        EXPECT_EQ(value, 0) << field->full_name() << ": make it optional";
      }
    }
  });
}

// The comment above each field of the messages in job.proto, by `Message.field`, on one line.
std::map<std::string, std::string> Comments() {
  std::ifstream in(CCST_SOURCES "/proto/ccst/v1/job.proto");
  EXPECT_TRUE(in.is_open());
  std::map<std::string, std::string> comments;
  std::string message;
  std::string comment;
  for (std::string line; std::getline(in, line);) {
    const std::size_t start = line.find_first_not_of(' ');
    const std::string text = start == std::string::npos ? "" : line.substr(start);
    if (text.starts_with("// ")) {
      comment += text.substr(2);
      continue;
    }
    if (line.starts_with("message ")) message = line.substr(8, line.find(' ', 8) - 8);
    if (const std::size_t equals = text.find(" = "); equals != std::string::npos) {
      const std::size_t name = text.rfind(' ', equals - 1) + 1;
      comments[message + "." + text.substr(name, equals - name)] = comment;
    }
    comment.clear();
  }
  return comments;
}

std::string RangeInComments(const NumberOption& option) {
  if (option.limit.empty()) {
    // The unit is in the name of the field or in the comment's words.
    return RangeWords(option.range, Unit::kPure, Wording::kApi);
  }
  return absl::StrCat("in [", NumberWords(option.range.least, Wording::kApi), ", ServerLimits.",
                      std::string(option.limit), "]");
}

template <typename Number>
std::optional<double> DefaultOf(const Number& value) {
  return static_cast<double>(value);
}
template <typename Number>
std::optional<double> DefaultOf(const std::optional<Number>& /*value*/) {
  return std::nullopt;
}

TEST(OptionFields, CommentsOfTheProtoSayTheRangesAndDefaults) {
  const auto comments = Comments();
  const SamplingOptions defaults;
  VisitOptions(defaults, [&comments](const auto& option, const auto& value) {
    if constexpr (std::is_same_v<std::remove_cvref_t<decltype(option)>, NumberOption>) {
      int told = 0;
      const auto fields = FieldsNamedBy(option.info);
      for (const FieldDescriptor* const field : fields) {
        const auto found = comments.find(field->containing_type()->name() + "." + field->name());
        ASSERT_NE(found, comments.end()) << field->full_name();
        if (found->second.starts_with(" As in ")) continue;
        ++told;
        // All values of the seed's type are right.
        if (option.info.name != "seed") {
          EXPECT_THAT(found->second, HasSubstr(RangeInComments(option))) << field->full_name();
        }
        const std::optional<double> number = DefaultOf(value);
        if (field->has_presence() && number.has_value()) {
          EXPECT_THAT(found->second, HasSubstr("nset means " + NumberWords(*number, Wording::kApi)))
              << field->full_name();
        }
      }
      EXPECT_EQ(told > 0, !fields.empty()) << option.info.name;
    }
  });
}

std::string RefusalOf(const v1::SamplingOptions& options) {
  return std::string(FromProto(options).status().message());
}

TEST(OptionFields, RefusalsSayTheValueAndTheRange) {
  v1::SamplingOptions options;
  options.set_sample_count(3);
  EXPECT_EQ(RefusalOf(options), "sample_count: is 3, must be in [4, 10000000]");
  options.set_sample_count(4);
  options.set_crease_angle_radians(4.0);
  EXPECT_EQ(RefusalOf(options), "crease_angle_radians: is 4, must be in (0, pi) radians");
  options.clear_crease_angle_radians();
  options.mutable_attribute()->set_exponent(4.5);
  EXPECT_EQ(RefusalOf(options),
            "attribute.attribute_name: is missing; attribute.exponent: is 4.5, must be in [0, 4]");
  options.mutable_curvature()->set_measure(static_cast<v1::CurvatureDensity::Measure>(9));
  EXPECT_EQ(RefusalOf(options),
            "curvature.measure: is 9, must be MEASURE_GAUSSIAN (1), MEASURE_MEAN (2) or "
            "MEASURE_MAXIMUM (3)");
  options.clear_density();
  options.mutable_time_limit()->set_nanos(-1);
  EXPECT_EQ(RefusalOf(options), "time_limit: must be a valid duration, greater than 0 seconds");
}

TEST(OptionFields, LimitsOfTheServerTakeThePlaceOfTheRange) {
  v1::SamplingOptions options;
  options.set_sample_count(3);
  RequestLimits limits;
  limits.max_sample_count = 50;
  limits.max_iterations = 60;
  EXPECT_EQ(FromProto(options, limits).status().message(),
            "sample_count: is 3, must be in [4, 50]");
  options.set_sample_count(50);
  EXPECT_EQ(FromProto(options, limits)->max_iterations, 60) << "the default is 130";
  options.set_max_iterations(61);
  EXPECT_EQ(FromProto(options, limits).status().message(),
            "max_iterations: is 61, must be at most 60 (max_iterations)");
  options.clear_max_iterations();
  options.set_method(v1::SAMPLING_METHOD_LLOYD);
  EXPECT_EQ(FromProto(options)->max_iterations, DefaultMaxIterations(SamplingMethod::kLloyd));
}

}  // namespace
}  // namespace ccst
