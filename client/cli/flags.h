#pragma once

#include <optional>
#include <string>
#include <variant>

#include "client/cli/server_flags.h"
#include "core/sampling/sampling.h"

namespace ccst::cli {

/// How progress is shown on standard error.
enum class ProgressStyle {
  kAuto,   ///< A bar on a terminal, lines elsewhere.
  kBar,    ///< One line that is drawn again and again.
  kLines,  ///< A line an alternation.
  kJson,   ///< A JSON object a line an alternation, and nothing else but errors.
  kNone,
};

/// `ccst sample`. Output paths are empty where none is wanted; `-` is standard output.
struct SampleCommand {
  std::string mesh;
  SamplingOptions options;
  std::string texture_path;  ///< Image of a texture density.
  std::string samples_path;
  std::string mesh_path;
  std::string picture_path;
  std::string summary_path;
  std::string server;  ///< HOST:PORT; empty: in the process.
  ServerFlags server_flags;
  ProgressStyle progress = ProgressStyle::kAuto;
  std::optional<int> quantization_bits;
};

/// `ccst info`.
struct InfoCommand {
  std::string server;
  ServerFlags server_flags;
  bool json = false;
};

/// Nothing to do: help or the version was printed, or the command line was wrong and the error
/// printed.
struct Done {
  int exit_code = 0;
};

using Command = std::variant<Done, SampleCommand, InfoCommand>;

/// What `--method` calls it.
std::string MethodName(SamplingMethod method);

/// Parses a command line; `environment_server` is the value of CCST_SERVER, null without one.
Command ParseCommandLine(int argc, const char* const* argv, const char* environment_server);

}  // namespace ccst::cli
