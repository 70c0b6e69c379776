#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "client/cli/flags.h"

namespace ccst::cli {

/// Adds a flag that takes one of `names`, of which the first is the default; CLI11's own
/// transformers would also take the numbers. `names` must outlive the app.
template <typename T>
void AddChoice(CLI::App& app, const std::string& flag,
               const std::vector<std::pair<std::string, T>>& names, T& value,
               const std::string& help) {
  value = names.front().second;
  const auto assign = [&names, &value, flag](const std::string& text) {
    for (const auto& [name, meaning] : names) {
      if (name != text) continue;
      value = meaning;
      return;
    }
    std::string choices;
    for (const auto& [name, meaning] : names) choices += (choices.empty() ? "" : ", ") + name;
    throw CLI::ValidationError(flag, "'" + text + "' is none of " + choices);
  };
  app.add_option_function<std::string>(flag, assign, help)
      ->type_name("NAME")
      ->default_str(names.front().first);
}

/// Adds the flags that say what density samples follow; both must outlive the app.
void AddDensity(CLI::App& app, DensityOptions& density, std::string& texture_path);
/// Adds --progress.
void AddProgress(CLI::App& app, ProgressStyle& progress);
/// Adds --quantization-bits.
void AddQuantization(CLI::App& app, std::optional<int>& bits);
/// Adds --label KEY=VALUE, as often as wanted.
void AddLabels(CLI::App& app, std::map<std::string, std::string>& labels, const std::string& help);
/// Adds --server and the flags that say how it is reached.
void AddServer(CLI::App& app, ServerAddress& server);

}  // namespace ccst::cli
