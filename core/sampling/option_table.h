#pragma once

#include <array>
#include <concepts>
#include <tuple>
#include <type_traits>

#include "core/base/field_count.h"
#include "core/sampling/option_kinds.h"
#include "core/sampling/options.h"

// Every sampling option, described once. Its checks, the digest of a request, its conversion to and
// from the API, the flags of `ccst` and the form of the page are all made from this table. See
// README.md for what else a new option needs.

namespace ccst {

/// The names of the methods and so on, as on the command line; the first is the default.
inline constexpr auto kMethodChoices = std::to_array<Choice<SamplingMethod>>({
    {SamplingMethod::kCcst, "ccst", "CCST"},
    {SamplingMethod::kWhiteNoise, "white", "White noise"},
    {SamplingMethod::kPoissonDisk, "poisson", "Dart throwing (Poisson disk)"},
    {SamplingMethod::kSampleElimination, "elimination", "Sample elimination (Poisson disk)"},
    {SamplingMethod::kLloyd, "lloyd", "Lloyd relaxation"},
    {SamplingMethod::kCcvt, "ccvt", "CCVT, at most 20,000"},
});
inline constexpr auto kEnergyChoices = std::to_array<Choice<Energy>>({
    {Energy::kTarget, "target", "Target: variance about equal shares"},
    {Energy::kSquaredArea, "squared-area", "Squared area"},
});
inline constexpr auto kSourceChoices = std::to_array<Choice<DensitySource>>({
    {DensitySource::kUniform, "uniform", "Uniform"},
    {DensitySource::kCurvature, "curvature", "Where the surface bends"},
    {DensitySource::kAttribute, "attribute", "An attribute of the mesh", "NAME"},
    {DensitySource::kTexture, "texture", "An image over its texture coordinates", "IMAGE"},
});
inline constexpr auto kMeasureChoices = std::to_array<Choice<CurvatureMeasure>>({
    {CurvatureMeasure::kGaussian, "gaussian", "Gaussian"},
    {CurvatureMeasure::kMean, "mean", "Mean"},
    {CurvatureMeasure::kMaximum, "maximum", "Maximum"},
});

inline constexpr ChoiceOption<SamplingMethod> kMethodOption = {
    .info = {.name = "method",
             .field = "method",
             .word = "method",
             .label = "Method",
             .help = "ccst gives even samples and a mesh over them; the others are there to "
                     "compare with"},
    .choices = kMethodChoices,
};

namespace internal {

/// A field and its description.
template <typename Owner, typename Field, typename Kind>
struct OptionEntry {
  Field Owner::*field;
  Kind kind;
};

template <typename Owner, typename Field, typename Kind>
constexpr OptionEntry<Owner, Field, Kind> Describe(Field Owner::*field, const Kind& kind) {
  return {field, kind};
}

/// Stands for the options of a struct within another one.
struct OptionsWithin {};

inline constexpr auto kDensityOptions = std::make_tuple(
    Describe(&DensityOptions::source,
             ChoiceOption<DensitySource>{
                 .info = {.name = "density.source",
                          .field = "density",
                          .word = "density",
                          .label = "Where more samples belong",
                          .help = "Where the density is twice as high there are twice as many "
                                  "samples; dark places of an image are dense",
                          .group = OptionGroup::kDensity},
                 .choices = kSourceChoices}),
    Describe(&DensityOptions::measure,
             ChoiceOption<CurvatureMeasure>{
                 .info = {.name = "density.measure",
                          .field = "measure",
                          .word = "curvature",
                          .label = "Curvature",
                          .help = "Which curvature a density by curvature follows",
                          .group = OptionGroup::kDensity,
                          .use = OptionUse::kCurvature},
                 .choices = kMeasureChoices}),
    Describe(&DensityOptions::attribute,
             TextOption{{.name = "density.attribute",
                         .field = "attribute_name",
                         .word = "attribute",
                         .label = "Attribute",
                         .help = "Name of a number that the mesh carries at its vertices; a PLY "
                                 "property, for example",
                         .group = OptionGroup::kDensity,
                         .use = OptionUse::kAttribute,
                         .has_flag = false}}),
    Describe(&DensityOptions::image, ImageOption{{.name = "density.image",
                                                  .field = "",
                                                  .word = "",
                                                  .label = "",
                                                  .help = "The image, decoded",
                                                  .group = OptionGroup::kDensity,
                                                  .use = OptionUse::kTexture,
                                                  .has_flag = false}}),
    Describe(&DensityOptions::encoded_image,
             ImageOption{{.name = "density.encoded_image",
                          .field = "image",
                          .word = "image",
                          .label = "Image",
                          .help = "PNG or JPEG; dark places get more samples",
                          .group = OptionGroup::kDensity,
                          .use = OptionUse::kTexture,
                          .has_flag = false}}),
    Describe(&DensityOptions::bright_is_dense,
             SwitchOption{{.name = "density.bright_is_dense",
                           .field = "bright_is_dense",
                           .word = "bright-is-dense",
                           .label = "Bright places get more samples instead",
                           .help = "Bright places of the image get more samples, not dark ones",
                           .group = OptionGroup::kDensity,
                           .use = OptionUse::kTexture}}),
    Describe(&DensityOptions::exponent,
             NumberOption{.info = {.name = "density.exponent",
                                   .field = "exponent",
                                   .word = "density-exponent",
                                   .label = "Exponent",
                                   .help = "Power of the source that the density is",
                                   .group = OptionGroup::kDensity,
                                   .use = OptionUse::kDensity},
                          .range = {.least = 0.0, .most = kMaxDensityExponent}}),
    Describe(
        &DensityOptions::max_contrast,
        NumberOption{.info = {.name = "density.max_contrast",
                              .field = "max_contrast",
                              .word = "density-contrast",
                              .label = "Contrast",
                              .help = "Largest density over smallest; smaller ones are raised",
                              .group = OptionGroup::kDensity,
                              .use = OptionUse::kDensity},
                     .range = {.least = 1.0, .most = kMaxDensityContrast, .has_least = false}}));

inline constexpr auto kSamplingOptions = std::make_tuple(
    Describe(&SamplingOptions::sample_count,
             NumberOption{.info = {.name = "sample_count",
                                   .field = "sample_count",
                                   .word = "count",
                                   .label = "Count",
                                   .help = "How many samples; you get exactly as many",
                                   .letter = 'n'},
                          .range = {.least = static_cast<double>(kMinSampleCount),
                                    .most = static_cast<double>(kMaxSampleCount)},
                          .limit = "max_sample_count"}),
    Describe(&SamplingOptions::method, kMethodOption),
    Describe(&SamplingOptions::seed,
             NumberOption{.info = {.name = "seed",
                                   .field = "seed",
                                   .word = "seed",
                                   .label = "Seed",
                                   .help = "Another seed gives other, equally good samples"},
                          .range = {.least = 0.0}}),
    Describe(&SamplingOptions::density, OptionsWithin()),
    Describe(&SamplingOptions::crease_angle,
             NumberOption{.info = {.name = "crease_angle",
                                   .field = "crease_angle_radians",
                                   .word = "crease-angle",
                                   .label = "Crease angle (degrees)",
                                   .help = "Keep samples on edges at which the faces turn by more "
                                           "than this",
                                   .group = OptionGroup::kSurface,
                                   .use = OptionUse::kCcst},
                          .range = {.least = 0.0,
                                    .most = std::numbers::pi,
                                    .has_least = false,
                                    .has_most = false},
                          .unit = Unit::kAngle,
                          .default_words = "off"}),
    Describe(&SamplingOptions::weld_tolerance,
             NumberOption{.info = {.name = "weld_tolerance",
                                   .field = "weld_tolerance",
                                   .word = "weld-tolerance",
                                   .label = "Weld tolerance",
                                   .help = "Join vertices at most this far apart first, in units "
                                           "of the mesh",
                                   .group = OptionGroup::kSurface},
                          .range = {.least = 0.0, .has_most = false},
                          .unit = Unit::kLength}),
    Describe(&SamplingOptions::max_iterations,
             NumberOption{.info = {.name = "max_iterations",
                                   .field = "max_iterations",
                                   .word = "max-iterations",
                                   .label = "Most alternations",
                                   .help = "Most alternations; 0 gives the initial set",
                                   .group = OptionGroup::kStopping,
                                   .use = OptionUse::kRelaxing},
                          .range = {.least = 0.0, .most = kMaxAlternations},
                          .default_words = "130, lloyd 100, ccvt 1000",
                          .limit = "max_iterations"}),
    Describe(&SamplingOptions::relative_tolerance,
             NumberOption{.info = {.name = "relative_tolerance",
                                   .field = "relative_tolerance",
                                   .word = "tolerance",
                                   .label = "Tolerance",
                                   .help = "Stop when the capacities' variation improves by less "
                                           "than this share",
                                   .group = OptionGroup::kStopping,
                                   .use = OptionUse::kRelaxing},
                          .range = {.least = 0.0, .has_least = false, .has_most = false}}),
    Describe(&SamplingOptions::time_limit_seconds,
             NumberOption{.info = {.name = "time_limit_seconds",
                                   .field = "time_limit",
                                   .word = "time-limit",
                                   .label = "Time limit (seconds)",
                                   .help = "Return what there is after this long; the samples then "
                                           "depend on the machine",
                                   .group = OptionGroup::kStopping,
                                   .changes_samples = false},
                          .range = {.least = 0.0, .has_least = false},
                          .unit = Unit::kDuration,
                          .default_words = "none"}),
    Describe(&SamplingOptions::energy,
             ChoiceOption<Energy>{
                 .info = {.name = "energy",
                          .field = "energy",
                          .word = "energy",
                          .label = "Energy",
                          .help = "What is minimised; squared-area is what the paper prints, to "
                                  "compare with",
                          .group = OptionGroup::kStopping,
                          .use = OptionUse::kCcst},
                 .choices = kEnergyChoices}),
    // `--threads` belongs to the program, which takes it for more than samples.
    Describe(&SamplingOptions::thread_count,
             NumberOption{.info = {.name = "thread_count",
                                   .field = "",
                                   .word = "threads",
                                   .label = "",
                                   .help = "Threads of the computation",
                                   .changes_samples = false,
                                   .has_flag = false},
                          .range = {.least = 1.0}}));

static_assert(std::tuple_size_v<decltype(kDensityOptions)> == FieldCount<DensityOptions>(),
              "describe each field of DensityOptions once");
static_assert(std::tuple_size_v<decltype(kSamplingOptions)> == FieldCount<SamplingOptions>(),
              "describe each field of SamplingOptions once");

template <typename Options>
constexpr const auto& OptionTable() {
  if constexpr (std::same_as<std::remove_const_t<Options>, SamplingOptions>) {
    return kSamplingOptions;
  } else {
    return kDensityOptions;
  }
}

}  // namespace internal

/// Calls `visit(kind, field)` for each field of `options`, which are SamplingOptions or
/// DensityOptions, const or not; `kind` is its description: a NumberOption, ChoiceOption,
/// SwitchOption, TextOption or ImageOption. Those of the density come among the others.
template <typename Options, typename Visitor>
requires std::same_as<std::remove_const_t<Options>, SamplingOptions> ||
    std::same_as<std::remove_const_t<Options>, DensityOptions>
void VisitOptions(Options& options, Visitor&& visit) {
  const auto visit_one = [&options, &visit](const auto& entry) {
    auto& field = options.*entry.field;
    if constexpr (std::same_as<std::remove_cvref_t<decltype(entry.kind)>,
                               internal::OptionsWithin>) {
      VisitOptions(field, visit);
    } else {
      visit(entry.kind, field);
    }
  };
  std::apply([&visit_one](const auto&... entries) { (visit_one(entries), ...); },
             internal::OptionTable<Options>());
}

}  // namespace ccst
