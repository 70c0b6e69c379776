#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "absl/status/status.h"
#include "core/sampling/option_kinds.h"
#include "core/sampling/options.h"

namespace ccst::cli {

/// Adds the flag of each option that has one, with its range and default in the help. All arguments
/// must outlive the app. `texture_path` is the image that a density is to be read from. Whether a
/// number is in its range is told by CheckOptions(); here it only has to be one.
void AddOptions(CLI::App& app, SamplingOptions& options, std::string& texture_path);
void AddOptions(CLI::App& app, DensityOptions& density, std::string& texture_path);

/// OPTION_INVALID naming the first flag whose number is out of its range, in the user's units.
absl::Status CheckOptions(const SamplingOptions& options);
absl::Status CheckOptions(const DensityOptions& density);

/// Takes one of the names of `option`; CLI11's own transformers would also take the numbers. Throws
/// CLI::ValidationError.
template <typename Enum>
Enum ParseChoice(const ChoiceOption<Enum>& option, const std::string& text) {
  if (const Choice<Enum>* const choice = option.Find(text)) return choice->value;
  throw CLI::ValidationError("--" + std::string(option.info.word),
                             "'" + text + "' is none of " + option.Names());
}

/// What the help says of such a flag.
template <typename Enum>
std::string ChoiceHelp(const ChoiceOption<Enum>& option) {
  return std::string(option.info.help) + "; one of " + option.Names() + "; by default " +
         std::string(option.choices.front().name);
}

/// Adds a flag that takes one of the names of `option`; both must outlive the app.
template <typename Enum>
CLI::Option* AddChoice(CLI::App& app, const ChoiceOption<Enum>& option, Enum& value) {
  const auto assign = [&option, &value](const std::string& text) {
    value = ParseChoice(option, text);
  };
  return app
      .add_option_function<std::string>("--" + std::string(option.info.word), assign,
                                        ChoiceHelp(option))
      ->type_name("NAME");
}

}  // namespace ccst::cli
