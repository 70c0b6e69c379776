#include "core/sampling/option_table.h"

#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "absl/strings/str_cat.h"

namespace ccst {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

struct Seen {
  OptionInfo info;
  const void* field;
};

std::vector<Seen> AllSeen(const SamplingOptions& options) {
  std::vector<Seen> seen;
  VisitOptions(options, [&seen](const auto& option, const auto& field) {
    seen.push_back({option.info, &field});
  });
  return seen;
}

TEST(OptionTable, EachFieldIsVisitedOnce) {
  const SamplingOptions options;
  std::set<const void*> fields;
  std::set<std::string_view> names;
  std::set<std::string_view> words;
  for (const auto& [info, field] : AllSeen(options)) {
    EXPECT_TRUE(fields.insert(field).second) << info.name << " has the field of another option";
    EXPECT_TRUE(names.insert(info.name).second) << info.name;
    EXPECT_TRUE(info.word.empty() || words.insert(info.word).second) << info.word;
  }
  // The density is seen as its own fields.
  EXPECT_EQ(fields.size(), FieldCount<SamplingOptions>() - 1 + FieldCount<DensityOptions>());
}

TEST(OptionTable, WhatUsersSeeHasWords) {
  for (const auto& [info, field] : AllSeen(SamplingOptions())) {
    EXPECT_FALSE(info.help.empty()) << info.name;
    EXPECT_FALSE(info.help.ends_with('.')) << info.name << ": ranges are said behind it";
    if (info.field.empty()) continue;
    EXPECT_FALSE(info.word.empty()) << info.name;
    EXPECT_FALSE(info.label.empty()) << info.name;
  }
}

// Every choice has a name of its own, and the default is the first.
TEST(OptionTable, ChoicesBeginWithTheDefault) {
  const SamplingOptions defaults;
  VisitOptions(defaults, [](const auto& option, const auto& value) {
    if constexpr (requires { option.choices; }) {
      std::set<std::string_view> names;
      ASSERT_FALSE(option.choices.empty());
      EXPECT_EQ(option.choices.front().value, value) << option.info.name;
      for (const auto& choice : option.choices) {
        EXPECT_TRUE(names.insert(choice.name).second) << choice.name;
        EXPECT_EQ(option.Find(choice.value), &choice);
        EXPECT_EQ(option.Find(choice.name), &choice);
      }
      EXPECT_EQ(option.Find("no such name"), nullptr);
    }
  });
}

TEST(OptionTable, WordsOfTheDefaultIterationsAreThoseOfTheMethods) {
  std::string words;
  for (const auto& choice : kMethodChoices) {
    const int iterations = DefaultMaxIterations(choice.value);
    if (choice.value == SamplingMethod::kCcst) {
      absl::StrAppend(&words, iterations);
    } else if (iterations != SamplingOptions().max_iterations) {
      absl::StrAppend(&words, ", ", std::string(choice.name), " ", iterations);
    }
  }
  const SamplingOptions defaults;
  VisitOptions(defaults, [&words](const auto& option, const auto& /*value*/) {
    if constexpr (requires { option.default_words; }) {
      if (option.info.name != "max_iterations") return;
      EXPECT_EQ(option.default_words, words);
    }
  });
}

// The ranges once more, as they were announced: a bound is not moved by mistake.
struct Bounds {
  std::vector<double> taken;
  std::vector<double> refused;
};
const std::map<std::string_view, Bounds>& AnnouncedBounds() {
  static const double kInfinity = std::numeric_limits<double>::infinity();
  static const auto* const kBounds = new std::map<std::string_view, Bounds>{
      {"sample_count", {{4, 10'000'000}, {3, 10'000'001}}},
      {"max_iterations", {{0, 10'000}, {-1, 10'001}}},
      {"relative_tolerance", {{1e-300, 1e300}, {0.0, -1.0, kInfinity}}},
      {"seed", {{0, 4'000'000'000}, {}}},
      {"crease_angle", {{1e-300, 3.14159}, {0.0, std::numbers::pi, kInfinity}}},
      {"time_limit_seconds", {{1e-300, 1e300, kInfinity}, {0.0, -1.0}}},
      {"thread_count", {{1, 1'000'000}, {0, -3}}},
      {"weld_tolerance", {{0.0, 1e300}, {-1e-300, kInfinity}}},
      {"density.exponent", {{0.0, 4.0}, {-1e-300, 4.0001, kInfinity}}},
      {"density.max_contrast", {{1.0001, 1e6}, {1.0, 1'000'001.0, kInfinity}}},
  };
  return *kBounds;
}

template <typename Number>
void Assign(Number& field, double value) {
  field = static_cast<Number>(value);
}
template <typename Number>
void Assign(std::optional<Number>& field, double value) {
  field = static_cast<Number>(value);
}
template <typename Number>
constexpr bool kCanBeNaN = std::is_same_v<Number, double>;
template <typename Number>
constexpr bool kCanBeNaN<std::optional<Number>> = kCanBeNaN<Number>;

// Calls `visit(option, value, is_taken)` for the bounds of every number, in turn in `options`.
template <typename Visitor>
void TryBounds(SamplingOptions& options, Visitor visit) {
  VisitOptions(options, [&visit](const auto& option, auto& field) {
    if constexpr (requires { option.range; }) {
      const auto bounds = AnnouncedBounds().find(option.info.name);
      ASSERT_NE(bounds, AnnouncedBounds().end()) << option.info.name << ": announce its range here";
      const auto before = field;
      for (const double value : bounds->second.taken) {
        Assign(field, value);
        visit(option, value, true);
      }
      std::vector<double> refused = bounds->second.refused;
      if (kCanBeNaN<std::remove_reference_t<decltype(field)>>) refused.push_back(std::nan(""));
      for (const double value : refused) {
        Assign(field, value);
        visit(option, value, false);
      }
      field = before;
    }
  });
}

TEST(OptionTable, ValidateTakesTheAnnouncedRanges) {
  SamplingOptions options;
  options.sample_count = 100;
  TryBounds(options, [&options](const NumberOption& option, double value, bool is_taken) {
    const absl::Status status = options.Validate();
    if (is_taken) {
      EXPECT_TRUE(status.ok()) << value << ": " << status;
      return;
    }
    EXPECT_THAT(std::string(status.message()), StartsWith(std::string(option.info.name) + " is "))
        << value;
    EXPECT_THAT(std::string(status.message()),
                HasSubstr(RangeWords(option.range, option.unit, Wording::kApi)))
        << value;
  });
}

TEST(OptionTable, ValidateRefusesWhatIsNoChoice) {
  SamplingOptions options;
  options.sample_count = 100;
  options.energy = static_cast<Energy>(77);
  EXPECT_EQ(options.Validate().message(), "energy is 77; it must be one of target, squared-area");
}

TEST(RangeWords, SayWhichEndsBelong) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(RangeWords({4, 1e7}, Unit::kPure, Wording::kApi), "in [4, 10000000]");
  EXPECT_EQ(RangeWords({1, 1e6, false}, Unit::kPure, Wording::kApi), "in (1, 1000000]");
  EXPECT_EQ(RangeWords({.least = 1}, Unit::kPure, Wording::kApi), "at least 1");
  EXPECT_EQ(RangeWords({0, kInfinity, false}, Unit::kDuration, Wording::kUser),
            "greater than 0 seconds");
  EXPECT_EQ(RangeWords({0, kInfinity, false, false}, Unit::kPure, Wording::kUser),
            "finite and greater than 0");
  EXPECT_EQ(RangeWords({0, kInfinity, true, false}, Unit::kLength, Wording::kUser),
            "finite and at least 0");
  const Range angle = {0, std::numbers::pi, false, false};
  EXPECT_EQ(RangeWords(angle, Unit::kAngle, Wording::kApi), "in (0, pi) radians");
  EXPECT_EQ(RangeWords(angle, Unit::kAngle, Wording::kUser), "in (0, 180) degrees");
}

TEST(UnitScale, AnglesAreDegreesForUsers) {
  EXPECT_EQ(ScaleOf(Unit::kAngle).FromUser(90.0), std::numbers::pi / 2.0);
  EXPECT_EQ(ScaleOf(Unit::kAngle).ToUser(std::numbers::pi), 180.0);
  EXPECT_EQ(ScaleOf(Unit::kLength).FromUser(0.1), 0.1);
}

}  // namespace
}  // namespace ccst
