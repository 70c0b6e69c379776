#include "core/sampling/option_kinds.h"

#include <cmath>
#include <cstdint>

#include "absl/strings/str_cat.h"

namespace ccst {

std::string_view GroupName(OptionGroup group) {
  switch (group) {
    case OptionGroup::kSamples:
      return "Samples";
    case OptionGroup::kDensity:
      return "Density";
    case OptionGroup::kSurface:
      return "Surface";
    case OptionGroup::kStopping:
      return "When to stop";
  }
  return "";
}

std::string_view UseName(OptionUse use) {
  switch (use) {
    case OptionUse::kAlways:
      return "always";
    case OptionUse::kRelaxing:
      return "relaxing";
    case OptionUse::kCcst:
      return "ccst";
    case OptionUse::kDensity:
      return "density";
    case OptionUse::kCurvature:
      return "curvature";
    case OptionUse::kAttribute:
      return "attribute";
    case OptionUse::kTexture:
      return "texture";
  }
  return "";
}

std::string NumberWords(double value, Wording wording) {
  constexpr double kAllDigits = 1e15;
  if (wording == Wording::kApi && value == std::numbers::pi) return "pi";
  if (std::abs(value) < kAllDigits && value == std::trunc(value)) {
    return absl::StrCat(static_cast<std::int64_t>(value));
  }
  return absl::StrCat(value);
}

std::string RangeWords(const Range& range, Unit unit, Wording wording) {
  const UnitScale scale = wording == Wording::kUser ? ScaleOf(unit) : UnitScale();
  const std::string least = NumberWords(scale.ToUser(range.least), wording);
  const std::string most = NumberWords(scale.ToUser(range.most), wording);
  std::string what;
  if (unit == Unit::kAngle) what = wording == Wording::kUser ? " degrees" : " radians";
  if (unit == Unit::kDuration) what = " seconds";
  if (std::isfinite(range.most)) {
    return absl::StrCat("in ", range.has_least ? "[" : "(", least, ", ", most,
                        range.has_most ? "]" : ")", what);
  }
  return absl::StrCat(range.has_most ? "" : "finite and ",
                      range.has_least ? "at least " : "greater than ", least, what);
}

std::string DefaultWords(const NumberOption& option, std::optional<double> value) {
  if (!option.default_words.empty()) return std::string(option.default_words);
  if (!value.has_value() || !option.range.Contains(*value)) return "";
  return NumberWords(ScaleOf(option.unit).ToUser(*value), Wording::kUser);
}

}  // namespace ccst
