#include "client/cli/option_flags.h"

#include <optional>
#include <string_view>
#include <type_traits>

#include "absl/strings/str_cat.h"
#include "core/base/status.h"
#include "core/sampling/option_table.h"

namespace ccst::cli {
namespace {

std::string FlagOf(const OptionInfo& info) { return "--" + std::string(info.word); }

// Also the short one.
std::string FlagsOf(const OptionInfo& info) {
  if (info.letter == '\0') return FlagOf(info);
  return absl::StrCat("-", std::string(1, info.letter), ",", FlagOf(info));
}

// What the help calls a number.
std::string TypeName(Unit unit, bool is_whole) {
  switch (unit) {
    case Unit::kAngle:
      return "DEGREES";
    case Unit::kDuration:
      return "SECONDS";
    case Unit::kLength:
      return "LENGTH";
    case Unit::kPure:
      break;
  }
  return is_whole ? "N" : "X";
}

// Whole numbers have no units that differ; as doubles they would lose digits.
template <typename Number>
Number FieldOf(UnitScale scale, Number given) {
  if constexpr (std::is_floating_point_v<Number>) return scale.FromUser(given);
  return given;
}

std::string NumberHelp(const NumberOption& option, const std::string& default_words) {
  std::string text = absl::StrCat(std::string(option.info.help), "; ",
                                  RangeWords(option.range, option.unit, Wording::kUser));
  if (!default_words.empty()) absl::StrAppend(&text, "; by default ", default_words);
  return text;
}

// uniform, curvature, attribute:NAME or texture:IMAGE. Throws CLI::ValidationError.
void ParseDensity(const ChoiceOption<DensitySource>& option, const std::string& text,
                  DensityOptions& density, std::string& texture_path) {
  const std::size_t colon = text.find(':');
  const std::string rest = colon == std::string::npos ? "" : text.substr(colon + 1);
  const Choice<DensitySource>* const choice = option.Find(text.substr(0, colon));
  if (choice == nullptr || rest.empty() != choice->takes.empty() ||
      (rest.empty() && colon != std::string::npos)) {
    throw CLI::ValidationError(FlagOf(option.info), "'" + text + "' is none of " + option.Names());
  }
  density.source = choice->value;
  texture_path.clear();
  if (choice->value == DensitySource::kAttribute) density.attribute = rest;
  if (choice->value == DensitySource::kTexture) texture_path = rest;
}

class FlagAdder {
 public:
  FlagAdder(CLI::App& app, DensityOptions& density, std::string& texture_path)
      : app_(app), density_(density), texture_path_(texture_path) {}

  template <typename Number>
  void operator()(const NumberOption& option, Number& value) {
    if (!option.info.has_flag) return;
    const std::string default_words = DefaultWords(option, static_cast<double>(value));
    AddNumber<Number>(option, default_words, value)->required(default_words.empty());
  }
  template <typename Number>
  void operator()(const NumberOption& option, std::optional<Number>& value) {
    if (option.info.has_flag) {
      AddNumber<Number>(option, DefaultWords(option, std::nullopt), value);
    }
  }
  template <typename Enum>
  void operator()(const ChoiceOption<Enum>& option, Enum& value) {
    AddChoice(app_, option, value);
  }
  void operator()(const ChoiceOption<DensitySource>& option, DensitySource& /*value*/) {
    const auto assign = [&option, &density = density_,
                         &texture_path = texture_path_](const std::string& text) {
      ParseDensity(option, text, density, texture_path);
    };
    app_.add_option_function<std::string>(FlagOf(option.info), assign, ChoiceHelp(option))
        ->type_name("SOURCE");
  }
  void operator()(const SwitchOption& option, bool& value) {
    app_.add_flag(FlagOf(option.info), value, std::string(option.info.help));
  }
  // The name and the image follow `--density`.
  void operator()(const TextOption& /*option*/, std::string& /*value*/) {}
  template <typename Pointer>
  void operator()(const ImageOption& /*option*/, Pointer& /*value*/) {}

 private:
  template <typename Number, typename Field>
  CLI::Option* AddNumber(const NumberOption& option, const std::string& default_words,
                         Field& value) {
    const UnitScale scale = ScaleOf(option.unit);
    const auto assign = [&value, scale](const Number& given) { value = FieldOf(scale, given); };
    CLI::Option* const flag = app_.add_option_function<Number>(FlagsOf(option.info), assign,
                                                               NumberHelp(option, default_words));
    flag->type_name(TypeName(option.unit, std::is_integral_v<Number>));
    if constexpr (std::is_unsigned_v<Number>) {
      const auto has_no_sign = [](const std::string& text) {
        // A minus sign would wrap around.
        return text.find('-') == std::string::npos ? "" : "must be a whole number, at least 0";
      };
      flag->check(has_no_sign, "");
    }
    return flag;
  }

  CLI::App& app_;
  DensityOptions& density_;
  std::string& texture_path_;
};

class RangeChecker {
 public:
  template <typename Number>
  void operator()(const NumberOption& option, const Number& value) {
    if (!status_.ok() || !option.info.has_flag ||
        option.range.Contains(static_cast<double>(value))) {
      return;
    }
    std::string given = absl::StrCat(value);
    if constexpr (std::is_floating_point_v<Number>) {
      given = NumberWords(ScaleOf(option.unit).ToUser(value), Wording::kUser);
    }
    status_ = MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kOptionInvalid,
                        absl::StrCat(FlagOf(option.info), " is ", given, "; it must be ",
                                     RangeWords(option.range, option.unit, Wording::kUser)));
  }
  template <typename Number>
  void operator()(const NumberOption& option, const std::optional<Number>& value) {
    if (value.has_value()) (*this)(option, *value);
  }
  // The flags of the others take only what is right.
  template <typename Kind, typename Field>
  void operator()(const Kind& /*option*/, const Field& /*value*/) {}

  const absl::Status& status() const { return status_; }

 private:
  absl::Status status_;
};

}  // namespace

void AddOptions(CLI::App& app, SamplingOptions& options, std::string& texture_path) {
  VisitOptions(options, FlagAdder(app, options.density, texture_path));
}

void AddOptions(CLI::App& app, DensityOptions& density, std::string& texture_path) {
  VisitOptions(density, FlagAdder(app, density, texture_path));
}

absl::Status CheckOptions(const SamplingOptions& options) {
  RangeChecker checker;
  VisitOptions(options, checker);
  return checker.status();
}

absl::Status CheckOptions(const DensityOptions& density) {
  RangeChecker checker;
  VisitOptions(density, checker);
  return checker.status();
}

}  // namespace ccst::cli
