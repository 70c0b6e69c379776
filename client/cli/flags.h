#pragma once

#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

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

/// A server, as every command that needs one has it.
struct ServerAddress {
  std::string server;  ///< HOST:PORT; of `ccst sample`, empty: in the process.
  ServerFlags server_flags;
};

/// Where to write what came out: empty where it is not wanted; `-` is standard output.
struct OutputPaths {
  std::string samples_path;
  std::string mesh_path;
  std::string picture_path;
  std::string summary_path;
};

/// `ccst sample`.
struct SampleCommand : ServerAddress, OutputPaths {
  std::string mesh;
  SamplingOptions options;
  std::string texture_path;   ///< Image of a texture density.
  std::string stages_folder;  ///< Where to write the stages of a local run; empty: nowhere.
  ProgressStyle progress = ProgressStyle::kAuto;
  std::optional<int> quantization_bits;
  bool detach = false;
  bool skip_cache_lookup = false;
  std::string display_name;
  std::map<std::string, std::string> labels;
};

/// `ccst info`.
struct InfoCommand : ServerAddress {
  bool json = false;
};

/// `ccst upload`.
struct UploadCommand : ServerAddress {
  std::string mesh;
  std::string display_name;
  ProgressStyle progress = ProgressStyle::kAuto;
  std::optional<int> quantization_bits;
};

/// `ccst meshes`.
struct MeshesCommand : ServerAddress {
  bool json = false;
};

/// `ccst jobs`.
struct JobsCommand : ServerAddress {
  std::vector<std::string> states;  ///< As StateName() calls them; empty: all.
  std::map<std::string, std::string> labels;
  bool json = false;
};

/// `ccst watch`. Jobs are `jobs/{id}`, here and below, also where the bare id was given.
struct WatchCommand : ServerAddress {
  std::string job;
  ProgressStyle progress = ProgressStyle::kAuto;
  double patience_seconds = 60.0;
};

/// `ccst cancel`.
struct CancelCommand : ServerAddress {
  std::string job;
};

/// `ccst delete`.
struct DeleteCommand : ServerAddress {
  std::string name;  ///< Of a job or a mesh.
};

/// `ccst fetch`.
struct FetchCommand : ServerAddress, OutputPaths {
  std::string job;
  std::string surface;  ///< The mesh file; empty: as the server has it.
  std::optional<int> quantization_bits;
};

/// Samples of one kind: the files of several seeds are judged together.
struct SampleGroup {
  std::string name;
  std::vector<std::string> paths;
};

/// `ccst analyze`, each file for itself, and `ccst compare`.
struct AnalyzeCommand {
  std::vector<SampleGroup> groups;
  std::string surface;     ///< Mesh file; empty: the sample meshes themselves.
  DensityOptions density;  ///< That the samples should follow.
  std::string texture_path;
  std::string json_path;  ///< Empty: none; as below.
  std::string html_path;
  int thread_count = 1;
};

/// Nothing to do: help or the version was printed, or the command line was wrong and the error
/// printed.
struct Done {
  int exit_code = 0;
};

using Command =
    std::variant<Done, SampleCommand, InfoCommand, UploadCommand, MeshesCommand, JobsCommand,
                 WatchCommand, CancelCommand, DeleteCommand, FetchCommand, AnalyzeCommand>;

/// What `--method` calls it.
std::string MethodName(SamplingMethod method);

/// Parses a command line; `environment_server` is the value of CCST_SERVER, null without one.
Command ParseCommandLine(int argc, const char* const* argv, const char* environment_server);

}  // namespace ccst::cli
