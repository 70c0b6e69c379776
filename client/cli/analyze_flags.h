#pragma once

#include <optional>
#include <string>
#include <vector>

#include "client/cli/flags.h"

namespace CLI {  // NOLINT(readability-identifier-naming): the library's.
class App;
}

namespace ccst::cli {

/// The flags of `ccst analyze` and `ccst compare`.
struct AnalyzeFlags {
  AnalyzeCommand command;
  std::vector<std::string> sets;
  std::optional<int> threads;
};

/// Adds both commands; `flags` must outlive the app.
void AddAnalyzeCommands(CLI::App& app, AnalyzeFlags& flags);

/// Whether one of them was parsed.
bool IsAnalyzeCommand(const CLI::App& app);

/// The one that was parsed. Throws CLI::ValidationError.
AnalyzeCommand FinishAnalyzeCommand(const CLI::App& app, const AnalyzeFlags& flags);

}  // namespace ccst::cli
