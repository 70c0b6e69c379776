#include "proto/convert/option_fields.h"

#include <algorithm>
#include <concepts>
#include <cstdint>
#include <optional>
#include <string_view>
#include <type_traits>

#include <google/protobuf/descriptor.h>

#include "absl/strings/str_cat.h"
#include "core/sampling/option_table.h"
#include "proto/convert/enums.h"
#include "proto/convert/scalars.h"

namespace ccst {
namespace {

using google::protobuf::Duration;
using google::protobuf::EnumDescriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::Reflection;

// Null where the message has no such field.
const FieldDescriptor* FindField(const Message& message, const OptionInfo& info) {
  if (info.field.empty()) return nullptr;
  return message.GetDescriptor()->FindFieldByName(std::string(info.field));
}

bool IsDuration(const FieldDescriptor& field) {
  return field.message_type() == Duration::descriptor();
}

class Writer {
 public:
  explicit Writer(Message& message) : message_(message), reflection_(*message.GetReflection()) {}

  template <typename Kind, typename Field>
  void operator()(const Kind& option, const Field& value) {
    if (const FieldDescriptor* const field = FindField(message_, option.info)) Set(*field, value);
  }
  // The bytes of an image are the caller's matter, and so is the source, which is a field of its
  // own.
  template <typename Pointer>
  void operator()(const ImageOption& /*option*/, const Pointer& /*value*/) {}
  void operator()(const ChoiceOption<DensitySource>& /*option*/, const DensitySource& /*value*/) {}

 private:
  template <typename Number>
  void Set(const FieldDescriptor& field, const std::optional<Number>& value) {
    if (value.has_value()) Set(field, *value);
  }
  template <typename Enum>
  requires std::is_enum_v<Enum>
  void Set(const FieldDescriptor& field, Enum value) {
    reflection_.SetEnumValue(&message_, &field, ToProto(value));
  }
  void Set(const FieldDescriptor& field, std::int32_t value) {
    reflection_.SetInt32(&message_, &field, value);
  }
  void Set(const FieldDescriptor& field, std::int64_t value) {
    reflection_.SetInt64(&message_, &field, value);
  }
  void Set(const FieldDescriptor& field, std::uint64_t value) {
    reflection_.SetUInt64(&message_, &field, value);
  }
  void Set(const FieldDescriptor& field, double value) {
    if (IsDuration(field)) {
      reflection_.MutableMessage(&message_, &field)->CopyFrom(DurationToProto(value));
    } else {
      reflection_.SetDouble(&message_, &field, value);
    }
  }
  void Set(const FieldDescriptor& field, bool value) {
    reflection_.SetBool(&message_, &field, value);
  }
  void Set(const FieldDescriptor& field, const std::string& value) {
    reflection_.SetString(&message_, &field, value);
  }

  Message& message_;
  const Reflection& reflection_;
};

// What the server advertises under this name.
std::optional<std::int64_t> LimitNamed(std::string_view name, const RequestLimits& limits) {
  if (name == "max_sample_count") return limits.max_sample_count;
  if (name == "max_iterations") return limits.max_iterations;
  return std::nullopt;
}

// All values but the first, which stands for one that is not given.
std::string ValueWords(const EnumDescriptor& type) {
  std::string words;
  for (int i = 1; i < type.value_count(); ++i) {
    const bool is_last = i + 1 == type.value_count();
    if (i > 1) words += is_last ? " or " : ", ";
    absl::StrAppend(&words, type.value(i)->name(), " (", type.value(i)->number(), ")");
  }
  return words;
}

class Reader {
 public:
  Reader(const Message& message, const RequestLimits& limits, const std::string& prefix,
         Violations& violations)
      : message_(message),
        reflection_(*message.GetReflection()),
        limits_(limits),
        prefix_(prefix),
        violations_(violations) {}

  template <typename Number>
  void operator()(const NumberOption& option, Number& value) {
    const FieldDescriptor* const field = FindField(message_, option.info);
    if (field == nullptr) return;
    const auto limit = LimitNamed(option.limit, limits_);
    if (field->has_presence() && !reflection_.HasField(message_, field)) {
      if (limit.has_value()) value = std::min(value, static_cast<Number>(*limit));
      return;
    }
    if (!Get(*field, option, value)) return;
    if (limit.has_value() && value > static_cast<Number>(*limit)) {
      violations_.AddLimit(PathOf(*field), std::string(option.limit), *limit,
                           static_cast<std::int64_t>(value));
    } else if (!option.range.Contains(static_cast<double>(value))) {
      Range range = option.range;
      if (limit.has_value()) range.most = static_cast<double>(*limit);
      violations_.Add(PathOf(*field), absl::StrCat("is ", value, ", must be ",
                                                   RangeWords(range, option.unit, Wording::kApi)));
    }
  }
  template <typename Number>
  void operator()(const NumberOption& option, std::optional<Number>& value) {
    const FieldDescriptor* const field = FindField(message_, option.info);
    if (field == nullptr || !reflection_.HasField(message_, field)) return;
    Number given = {};
    (*this)(option, given);
    value = given;
  }
  template <typename Enum>
  void operator()(const ChoiceOption<Enum>& option, Enum& value) {
    const FieldDescriptor* const field = FindField(message_, option.info);
    if (field == nullptr) return;
    using ProtoEnum = decltype(ToProto(value));
    const int number = reflection_.GetEnumValue(message_, field);
    if (const auto known = FromProto(static_cast<ProtoEnum>(number)); known.has_value()) {
      value = *known;
    } else {
      violations_.Add(PathOf(*field),
                      absl::StrCat("is ", number, ", must be ", ValueWords(*field->enum_type())));
    }
  }
  void operator()(const SwitchOption& option, bool& value) {
    const FieldDescriptor* const field = FindField(message_, option.info);
    if (field != nullptr) value = reflection_.GetBool(message_, field);
  }
  void operator()(const TextOption& option, std::string& value) {
    const FieldDescriptor* const field = FindField(message_, option.info);
    if (field == nullptr) return;
    value = reflection_.GetString(message_, field);
    if (value.empty()) violations_.Add(PathOf(*field), "is missing");
  }
  // As in the Writer.
  template <typename Pointer>
  void operator()(const ImageOption& /*option*/, Pointer& /*value*/) {}
  void operator()(const ChoiceOption<DensitySource>& /*option*/, DensitySource& /*value*/) {}

 private:
  std::string PathOf(const FieldDescriptor& field) const { return prefix_ + field.name(); }

  // False, with a violation, for what is no number at all.
  bool Get(const FieldDescriptor& field, const NumberOption& /*option*/, std::int32_t& value) {
    value = reflection_.GetInt32(message_, &field);
    return true;
  }
  bool Get(const FieldDescriptor& field, const NumberOption& /*option*/, std::int64_t& value) {
    value = reflection_.GetInt64(message_, &field);
    return true;
  }
  bool Get(const FieldDescriptor& field, const NumberOption& /*option*/, std::uint64_t& value) {
    value = reflection_.GetUInt64(message_, &field);
    return true;
  }
  bool Get(const FieldDescriptor& field, const NumberOption& option, double& value) {
    if (!IsDuration(field)) {
      value = reflection_.GetDouble(message_, &field);
      return true;
    }
    const auto& duration = static_cast<const Duration&>(reflection_.GetMessage(message_, &field));
    value = SecondsFromProto(duration);
    if (IsPositiveDuration(duration)) return true;
    violations_.Add(PathOf(field), "must be a valid duration, " +
                                       RangeWords(option.range, option.unit, Wording::kApi));
    return false;
  }

  const Message& message_;
  const Reflection& reflection_;
  const RequestLimits& limits_;
  const std::string& prefix_;
  Violations& violations_;
};

}  // namespace

void WriteOptionFields(const SamplingOptions& options, Message& message) {
  VisitOptions(options, Writer(message));
}

void WriteOptionFields(const DensityOptions& options, Message& message) {
  VisitOptions(options, Writer(message));
}

void ReadOptionFields(const Message& message, const RequestLimits& limits,
                      const std::string& prefix, Violations& violations, SamplingOptions& options) {
  VisitOptions(options, Reader(message, limits, prefix, violations));
}

void ReadOptionFields(const Message& message, const RequestLimits& limits,
                      const std::string& prefix, Violations& violations, DensityOptions& options) {
  VisitOptions(options, Reader(message, limits, prefix, violations));
}

}  // namespace ccst
