#pragma once

#include <map>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "client/cli/flags.h"

namespace ccst::cli {

/// Adds --progress.
void AddProgress(CLI::App& app, ProgressStyle& progress);
/// Adds --quantization-bits.
void AddQuantization(CLI::App& app, std::optional<int>& bits);
/// Adds --label KEY=VALUE, as often as wanted.
void AddLabels(CLI::App& app, std::map<std::string, std::string>& labels, const std::string& help);
/// Adds --server and the flags that say how it is reached.
void AddServer(CLI::App& app, ServerAddress& server);

}  // namespace ccst::cli
