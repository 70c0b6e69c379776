#pragma once

#include <algorithm>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace ccst {

/// The numbers that an option takes. NaN is in no range; a bound that is infinite and excluded
/// leaves the finite numbers.
struct Range {
  double least = -std::numeric_limits<double>::infinity();
  double most = std::numeric_limits<double>::infinity();
  bool has_least = true;  ///< Whether `least` itself is in the range.
  bool has_most = true;

  constexpr bool Contains(double x) const {
    return (has_least ? x >= least : x > least) && (has_most ? x <= most : x < most);
  }
};

/// What an option's number counts or measures.
enum class Unit {
  kPure,      ///< A count or a ratio.
  kAngle,     ///< [rad] in the structs and the API, degrees for users.
  kDuration,  ///< [s].
  kLength,    ///< In units of the mesh.
};

/// A value of the structs is the user's value * times / over, rounded twice. The only place that
/// knows how the two differ.
struct UnitScale {
  double times = 1.0;
  double over = 1.0;

  constexpr double FromUser(double value) const { return value * times / over; }
  constexpr double ToUser(double value) const { return value * over / times; }
};
constexpr UnitScale ScaleOf(Unit unit) {
  if (unit == Unit::kAngle) return {.times = std::numbers::pi, .over = 180.0};
  return {};
}

/// The part of a form in which an option stands.
enum class OptionGroup { kSamples, kDensity, kSurface, kStopping };
/// For example `Density`.
std::string_view GroupName(OptionGroup group);

/// The runs to which an option makes a difference.
enum class OptionUse {
  kAlways,
  kRelaxing,  ///< Methods that improve their samples step by step.
  kCcst,      ///< SamplingMethod::kCcst.
  kDensity,   ///< Densities that are not uniform; the others are those of one source.
  kCurvature,
  kAttribute,
  kTexture,
};
/// For example `density`.
std::string_view UseName(OptionUse use);

/// What every kind of option has.
struct OptionInfo {
  std::string_view name;   ///< Of the field, for example `density.exponent`.
  std::string_view field;  ///< Its name in the API's messages; empty: it does not travel.
  std::string_view word;   ///< Its name for users: the flag without dashes; empty: it has none.
  std::string_view label;  ///< In a form.
  std::string_view help;   ///< What it does; a sentence without its full stop.
  OptionGroup group = OptionGroup::kSamples;
  OptionUse use = OptionUse::kAlways;
  bool changes_samples = true;  ///< False: equal samples whatever it is, unless time runs out.
  bool has_flag = true;         ///< False: no flag of `ccst` sets it alone.
  char letter = '\0';           ///< Of a short flag beside the long one; '\0': none.
};

/// A number, of whatever type; std::optional where it can be left out.
struct NumberOption {
  OptionInfo info;
  Range range;  ///< Of the field, as the structs have it.
  Unit unit = Unit::kPure;
  /// The default in words, where it is not one number.
  std::string_view default_words = {};
  /// The field of the API's `ServerLimits` that bounds it instead of `range.most`.
  std::string_view limit = {};
};

/// One of the values of a ChoiceOption.
template <typename Enum>
struct Choice {
  Enum value;
  std::string_view name;   ///< On the command line.
  std::string_view words;  ///< In a form.
  /// What the command line wants behind the name and a colon.
  std::string_view takes = {};
};

/// An enumeration.
template <typename Enum>
struct ChoiceOption {
  OptionInfo info;
  std::span<const Choice<Enum>> choices;  ///< All enumerators; the first is the default.

  /// Null where `value` is none of them.
  constexpr const Choice<Enum>* Find(Enum value) const {
    const auto found = std::find_if(choices.begin(), choices.end(),
                                    [value](const auto& choice) { return choice.value == value; });
    return found == choices.end() ? nullptr : &*found;
  }
  constexpr const Choice<Enum>* Find(std::string_view name) const {
    const auto found = std::find_if(choices.begin(), choices.end(),
                                    [name](const auto& choice) { return choice.name == name; });
    return found == choices.end() ? nullptr : &*found;
  }
  /// Their names: `a, b, c`.
  std::string Names() const {
    std::string names;
    for (const auto& choice : choices) {
      if (!names.empty()) names += ", ";
      names += choice.name;
      if (!choice.takes.empty()) names.append(":").append(choice.takes);
    }
    return names;
  }
};

/// A bool, false by default.
struct SwitchOption {
  OptionInfo info;
};

/// A text, empty by default.
struct TextOption {
  OptionInfo info;
};

/// An image, decoded or not. Callers name it by a digest of its bytes.
struct ImageOption {
  OptionInfo info;
};

/// Whom a text is for: readers of the API, or users, who see degrees.
enum class Wording { kApi, kUser };

/// What a right value is, to follow "must be" or "is": `in (0, 180) degrees`, `at least 1`.
std::string RangeWords(const Range& range, Unit unit, Wording wording);
/// A number as people write it: `0.12`, `1000000`, `pi`.
std::string NumberWords(double value, Wording wording);
/// The default for users; empty where `value`, that of a new struct, is out of range, so that the
/// option must be given.
std::string DefaultWords(const NumberOption& option, std::optional<double> value);

}  // namespace ccst
