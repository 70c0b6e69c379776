#include "client/cli/flags.h"

#include <algorithm>
#include <map>
#include <thread>

#include <CLI/CLI.hpp>

#include "client/cli/exit_code.h"
#include "client/cli/outputs.h"
#include "core/base/version.h"

namespace ccst::cli {
namespace {

constexpr char kDefaultServer[] = "localhost:50051";

const std::map<std::string, Energy> kEnergies = {{"target", Energy::kTarget},
                                                 {"squared-area", Energy::kSquaredArea}};
const std::map<std::string, ProgressStyle> kProgressStyles = {{"auto", ProgressStyle::kAuto},
                                                              {"bar", ProgressStyle::kBar},
                                                              {"lines", ProgressStyle::kLines},
                                                              {"json", ProgressStyle::kJson},
                                                              {"none", ProgressStyle::kNone}};

// Flags as given, before they are made one command.
struct Flags {
  SampleCommand sample;
  InfoCommand info;
  std::string server;
  bool local = false;
  std::optional<int> threads;
};

CLI::App* AddSample(CLI::App& app, Flags& flags) {
  CLI::App* sub = app.add_subcommand("sample", "Put blue-noise samples on a mesh");
  SampleCommand& c = flags.sample;
  sub->add_option("MESH", c.mesh, "Mesh to sample: .obj .ply .stl .off .drc, - for standard input")
      ->required();
  sub->add_option("-n,--count", c.options.sample_count, "How many samples")->required();
  sub->add_option("-o,--output", c.samples_path,
                  "Write the samples: .ply .csv .xyz .obj .drc, - for CSV on standard output");
  sub->add_option("--mesh-output", c.mesh_path,
                  "Write the sample mesh: .obj .ply .stl .off .glb .drc, - for OBJ");
  sub->add_option("--picture", c.picture_path, "Draw samples and sample mesh: .png");
  sub->add_option("--summary", c.summary_path, "Write what came out as JSON");
  sub->add_option("--seed", c.options.seed, "Other seeds give other, equally good samples")
      ->capture_default_str();
  sub->add_option("--energy", c.options.energy,
                  "What is minimised: target, or squared-area as printed in the paper")
      ->transform(CLI::CheckedTransformer(kEnergies))
      ->default_str("target");
  sub->add_option("--max-iterations", c.options.max_iterations, "Most alternations")
      ->capture_default_str();
  sub->add_option("--tolerance", c.options.relative_tolerance,
                  "Stop when the capacities' variation improves by less than this share")
      ->capture_default_str();
  sub->add_option("--time-limit", c.options.time_limit_seconds,
                  "Seconds after which the run returns what it has");
  sub->add_option("--server", flags.server,
                  "HOST:PORT of the server; else $CCST_SERVER, else localhost:50051");
  sub->add_flag("--local", flags.local, "Compute in this process; gives the same samples");
  sub->add_option("--threads", flags.threads, "Threads of a local run; by default all cores")
      ->check(CLI::Range(1, 1024));
  sub->add_option("--quantization-bits", c.quantization_bits,
                  "Send coordinates with so many bits: smaller uploads, moved vertices")
      ->check(CLI::Range(1, 30));
  sub->add_option("--progress", c.progress, "auto, bar, lines, json or none, on standard error")
      ->transform(CLI::CheckedTransformer(kProgressStyles))
      ->default_str("auto");
  return sub;
}

CLI::App* AddInfo(CLI::App& app, Flags& flags) {
  CLI::App* sub = app.add_subcommand("info", "Show a server's version, limits and load");
  sub->add_option("--server", flags.server,
                  "HOST:PORT of the server; else $CCST_SERVER, else localhost:50051");
  sub->add_flag("--json", flags.info.json, "Print one JSON object");
  return sub;
}

// Throws CLI::ValidationError.
void CheckSample(const Flags& flags) {
  if (flags.local && !flags.server.empty()) {
    throw CLI::ValidationError("--local and --server exclude each other");
  }
  if (flags.threads.has_value() && !flags.local) {
    throw CLI::ValidationError("--threads needs --local; a server chooses its own");
  }
  if (const absl::Status status = CheckOutputs(flags.sample); !status.ok()) {
    throw CLI::ValidationError(std::string(status.message()));
  }
}

std::string ServerAddress(const Flags& flags, const char* environment_server) {
  if (!flags.server.empty()) return flags.server;
  if (environment_server != nullptr && *environment_server != '\0') return environment_server;
  return kDefaultServer;
}

}  // namespace

Command ParseCommandLine(int argc, const char* const* argv, const char* environment_server) {
  Flags flags;
  CLI::App app("Blue-noise samples on triangle meshes, exactly as many as asked for.", "ccst");
  app.set_version_flag("--version", "ccst " + std::string(ProjectVersion()) + " (" +
                                        std::string(SourceRevision()) + ")");
  app.require_subcommand(1);
  const CLI::App* sample = AddSample(app, flags);
  AddInfo(app, flags);
  try {
    app.parse(argc, argv);
    if (sample->parsed()) CheckSample(flags);
  } catch (const CLI::ParseError& error) {
    return Done{app.exit(error) == 0 ? kOk : kUsage};
  }
  const std::string server = ServerAddress(flags, environment_server);
  if (!sample->parsed()) {
    flags.info.server = server;
    return flags.info;
  }
  if (flags.local) {
    flags.sample.options.thread_count =
        flags.threads.value_or(std::max(1, static_cast<int>(std::thread::hardware_concurrency())));
  } else {
    flags.sample.server = server;
  }
  return flags.sample;
}

}  // namespace ccst::cli
