#include "server/formats/job_definition.h"

#include <memory>
#include <string>
#include <type_traits>

#include <gtest/gtest.h>

#include "ccst/store/v1/record.pb.h"
#include "core/base/status.h"
#include "core/sampling/option_table.h"

namespace ccst::server {
namespace {

// Gives every option a value that is right and not its default.
class OtherValues {
 public:
  template <typename Number>
  void operator()(const NumberOption& option, Number& value) {
    const auto other = static_cast<Number>(std::is_floating_point_v<Number> ? 0.625 : 77);
    value = option.range.Contains(static_cast<double>(other)) ? other : static_cast<Number>(2);
  }
  template <typename Number>
  void operator()(const NumberOption& option, std::optional<Number>& value) {
    (*this)(option, value.emplace());
  }
  template <typename Enum>
  void operator()(const ChoiceOption<Enum>& option, Enum& value) {
    value = option.choices.back().value;
  }
  void operator()(const SwitchOption& /*option*/, bool& value) { value = true; }
  void operator()(const TextOption& /*option*/, std::string& value) { value = "heat"; }
  template <typename Pointer>
  void operator()(const ImageOption& /*option*/, Pointer& /*image*/) {}
};

// Compares with `other`, which is of the same type, option by option: both are written as text.
class Values {
 public:
  template <typename Kind, typename Field>
  void operator()(const Kind& option, const Field& value) {
    text_ += std::string(option.info.name) + "=" + Text(value) + "\n";
  }
  const std::string& text() const { return text_; }

 private:
  template <typename Field>
  static std::string Text(const Field& value) {
    if constexpr (std::is_enum_v<Field>) {
      return std::to_string(static_cast<int>(value));
    } else if constexpr (std::is_arithmetic_v<Field>) {
      return std::to_string(value);
    } else if constexpr (std::is_same_v<Field, std::string>) {
      return value;
    } else {
      return value ? "set" : "none";
    }
  }

  std::string text_;
};

std::string TextOf(const SamplingOptions& options) {
  Values values;
  VisitOptions(options, values);
  return values.text();
}

JobDefinition SomeDefinition() {
  JobDefinition definition;
  VisitOptions(definition.options, OtherValues());
  definition.options.thread_count = 1;
  definition.origin = Eigen::Vector3d(1e7, 0.1, -1.0 / 3.0);
  definition.abandon_seconds = 2.5;
  definition.ends_with_caller = true;
  return definition;
}

std::string Changed(void (*change)(store::v1::Definition&)) {
  store::v1::Definition message;
  EXPECT_TRUE(message.ParseFromString(EncodeDefinition(SomeDefinition())));
  change(message);
  return message.SerializeAsString();
}

void ExpectDamaged(const std::string& bytes) {
  const auto read = DecodeDefinition(bytes);
  EXPECT_EQ(read.status().code(), absl::StatusCode::kDataLoss);
  EXPECT_EQ(GetErrorReason(read.status()), ErrorReason::kStorageFailed);
}

TEST(JobDefinitions, ComeBackAsTheyWereWrittenDown) {
  const JobDefinition read = *DecodeDefinition(EncodeDefinition(SomeDefinition()));
  EXPECT_EQ(TextOf(read.options), TextOf(SomeDefinition().options));
  EXPECT_EQ(read.options.seed, 77u);
  EXPECT_EQ(read.options.time_limit_seconds, 0.625);
  EXPECT_EQ(read.origin, SomeDefinition().origin);
  EXPECT_EQ(read.abandon_seconds, 2.5);
  EXPECT_TRUE(read.ends_with_caller);
}

TEST(JobDefinitions, LeaveOutImagesAndThreads) {
  JobDefinition definition = SomeDefinition();
  definition.options.thread_count = 8;
  definition.options.density.encoded_image = std::make_shared<const std::string>("an image");
  EXPECT_EQ(EncodeDefinition(definition), EncodeDefinition(SomeDefinition()));
  EXPECT_EQ(DecodeDefinition(EncodeDefinition(definition))->options.density.encoded_image, nullptr);
}

TEST(JobDefinitions, HaveTheDefaultOfAnOptionTheyLack) {
  const std::string bytes = Changed([](store::v1::Definition& message) {
    for (auto& option : *message.mutable_options()) {
      if (option.name() == "relative_tolerance") option.set_name("not an option any more");
    }
  });
  EXPECT_EQ(DecodeDefinition(bytes)->options.relative_tolerance,
            SamplingOptions().relative_tolerance);
}

TEST(JobDefinitions, LackOfAnOptionWithoutADefaultIsDamage) {
  ExpectDamaged(Changed([](store::v1::Definition& message) {
    for (auto& option : *message.mutable_options()) {
      if (option.name() == "sample_count") option.set_name("not an option any more");
    }
  }));
  ExpectDamaged(Changed([](store::v1::Definition& message) { message.clear_options(); }));
}

TEST(JobDefinitions, DamageIsNoticed) {
  ExpectDamaged("");
  ExpectDamaged("\xff\xff");
  ExpectDamaged(Changed([](store::v1::Definition& message) { message.clear_format(); }));
  ExpectDamaged(Changed([](store::v1::Definition& message) {
    for (auto& option : *message.mutable_options()) {
      if (option.name() == "seed") option.set_real(1.0);
    }
  }));
  ExpectDamaged(Changed([](store::v1::Definition& message) {
    for (auto& option : *message.mutable_options()) {
      if (option.name() == "sample_count") option.set_whole(-1);
    }
  }));
  ExpectDamaged(Changed([](store::v1::Definition& message) {
    for (auto& option : *message.mutable_options()) {
      if (option.name() == "method") option.set_text("magic");
    }
  }));
}

}  // namespace
}  // namespace ccst::server
