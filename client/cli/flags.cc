#include "client/cli/flags.h"

#include <algorithm>
#include <numbers>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "client/cli/analyze_flags.h"
#include "client/cli/exit_code.h"
#include "client/cli/flag_kinds.h"
#include "client/cli/job_flags.h"
#include "client/cli/outputs.h"
#include "core/base/version.h"

namespace ccst::cli {
namespace {

constexpr char kDefaultServer[] = "localhost:50051";

// Names as on the command line; the first is the default.
const std::vector<std::pair<std::string, Energy>> kEnergies = {
    {"target", Energy::kTarget}, {"squared-area", Energy::kSquaredArea}};
const std::vector<std::pair<std::string, SamplingMethod>> kMethods = {
    {"ccst", SamplingMethod::kCcst},           {"white", SamplingMethod::kWhiteNoise},
    {"poisson", SamplingMethod::kPoissonDisk}, {"elimination", SamplingMethod::kSampleElimination},
    {"lloyd", SamplingMethod::kLloyd},         {"ccvt", SamplingMethod::kCcvt}};
// Flags as given, before they are made one command.
struct Flags {
  SampleCommand sample;
  JobFlags jobs;
  AnalyzeFlags analyze;
  InfoCommand info;
  ServerAddress server;
  bool local = false;
  std::optional<int> threads;
  std::optional<int> max_iterations;
  std::optional<double> crease_angle;  // Degrees.
};

CLI::App* AddSample(CLI::App& app, Flags& flags) {
  CLI::App* sub = app.add_subcommand("sample", "Put blue-noise samples on a mesh");
  SampleCommand& c = flags.sample;
  sub->add_option("MESH", c.mesh,
                  "Mesh to sample: .obj .ply .stl .off .glb .gltf .drc, - for standard input")
      ->type_name("")
      ->required();
  sub->add_option("-n,--count", c.options.sample_count, "How many samples")
      ->type_name("N")
      ->required();
  sub->add_option("-o,--output", c.samples_path,
                  "Write the samples: .ply .csv .xyz .obj .drc, - for CSV on standard output")
      ->type_name("FILE");
  sub->add_option("--mesh-output", c.mesh_path,
                  "Write the sample mesh: .obj .ply .stl .off .glb .drc, - for OBJ")
      ->type_name("FILE");
  sub->add_option("--picture", c.picture_path, "Draw samples and sample mesh: .png")
      ->type_name("FILE");
  sub->add_option("--summary", c.summary_path, "Write what came out as JSON")->type_name("FILE");
  sub->add_option("--seed", c.options.seed, "Other seeds give other, equally good samples")
      ->type_name("S")
      ->check(
          [](const std::string& text) {
            // A minus sign would wrap around.
            return text.find('-') == std::string::npos ? "" : "a seed is a whole number from 0 on";
          },
          "")
      ->capture_default_str();
  AddChoice(*sub, "--method", kMethods, c.options.method,
            "ccst, or one to compare with: white, poisson, elimination, lloyd, ccvt");
  AddDensity(*sub, c.options.density, c.texture_path);
  sub->add_option("--crease-angle", flags.crease_angle,
                  "Keep samples on edges at which the faces turn by more than this")
      ->type_name("DEGREES")
      ->check(CLI::Range(0.0, 180.0).description(""));
  AddChoice(*sub, "--energy", kEnergies, c.options.energy,
            "What is minimised: target, or squared-area as printed in the paper");
  sub->add_option("--max-iterations", flags.max_iterations,
                  "Most alternations; by default 130, of lloyd 100, of ccvt 1000")
      ->type_name("K");
  sub->add_option("--tolerance", c.options.relative_tolerance,
                  "Stop when the capacities' variation improves by less than this share")
      ->type_name("T")
      ->capture_default_str();
  sub->add_option("--time-limit", c.options.time_limit_seconds,
                  "Seconds after which the run returns what it has")
      ->type_name("SECONDS");
  sub->add_option("--weld-tolerance", c.options.weld_tolerance,
                  "Join vertices at most this far apart first, in units of the mesh")
      ->type_name("LENGTH")
      ->capture_default_str();
  AddServer(*sub, flags.server);
  sub->add_flag("--local", flags.local, "Compute in this process; gives the same samples");
  sub->add_option("--threads", flags.threads, "Threads of a local run; by default all cores")
      ->type_name("N")
      ->check(CLI::Range(1, 1024).description(""));
  AddQuantization(*sub, c.quantization_bits);
  AddProgress(*sub, c.progress);
  sub->add_flag("--detach", c.detach,
                "Print the job's name and leave; ccst watch and ccst fetch come back to it");
  sub->add_option("--name", c.display_name, "What to call the job in lists")->type_name("TEXT");
  AddLabels(*sub, c.labels, "Mark the job, for lists; may be given again");
  sub->add_flag("--no-cache", c.skip_cache_lookup,
                "Compute even what the server has computed before");
  return sub;
}

CLI::App* AddInfo(CLI::App& app, Flags& flags) {
  CLI::App* sub = app.add_subcommand("info", "Show a server's version, limits and load");
  AddServer(*sub, flags.server);
  sub->add_flag("--json", flags.info.json, "Print one JSON object");
  return sub;
}

void SetServer(const ServerAddress& server, ServerAddress& command) { command = server; }
void SetServer(const ServerAddress& /*server*/, Done& /*command*/) {}
void SetServer(const ServerAddress& /*server*/, AnalyzeCommand& /*command*/) {}

// Throws CLI::ValidationError.
void CheckSample(const Flags& flags) {
  const SampleCommand& sample = flags.sample;
  if (flags.local && !flags.server.server.empty()) {
    throw CLI::ValidationError("--local and --server exclude each other");
  }
  if (flags.threads.has_value() && !flags.local) {
    throw CLI::ValidationError("--threads needs --local; a server chooses its own");
  }
  if (flags.local && (sample.detach || sample.skip_cache_lookup || !sample.display_name.empty() ||
                      !sample.labels.empty())) {
    throw CLI::ValidationError("--detach, --name, --label and --no-cache need a server");
  }
  if (sample.detach && !(sample.samples_path.empty() && sample.mesh_path.empty() &&
                         sample.picture_path.empty() && sample.summary_path.empty())) {
    throw CLI::ValidationError(
        "--detach leaves before there is anything to write; ccst fetch writes it later");
  }
  if (sample.options.method != SamplingMethod::kCcst && !sample.mesh_path.empty()) {
    throw CLI::ValidationError(
        "--mesh-output needs --method ccst; the others make no mesh: write their samples with -o");
  }
  if (const absl::Status status = CheckOutputs(sample); !status.ok()) {
    throw CLI::ValidationError(std::string(status.message()));
  }
}

std::string AddressOf(const std::string& given, const char* environment_server) {
  if (!given.empty()) return given;
  if (environment_server != nullptr && *environment_server != '\0') return environment_server;
  return kDefaultServer;
}

// Throws CLI::ValidationError.
SampleCommand FinishSample(const Flags& flags) {
  CheckSample(flags);
  SampleCommand command = flags.sample;
  if (flags.crease_angle.has_value()) {
    command.options.crease_angle = *flags.crease_angle * std::numbers::pi / 180.0;
  }
  command.options.max_iterations =
      flags.max_iterations.value_or(DefaultMaxIterations(command.options.method));
  if (flags.local) {
    command.options.thread_count =
        flags.threads.value_or(std::max(1, static_cast<int>(std::thread::hardware_concurrency())));
  }
  return command;
}

}  // namespace

std::string MethodName(SamplingMethod method) {
  for (const auto& [name, meaning] : kMethods) {
    if (meaning == method) return name;
  }
  return "unknown";
}

Command ParseCommandLine(int argc, const char* const* argv, const char* environment_server) {
  Flags flags;
  CLI::App app("Blue-noise samples on triangle meshes, exactly as many as asked for.", "ccst");
  app.set_version_flag("--version", "ccst " + std::string(ProjectVersion()) + " (" +
                                        std::string(SourceRevision()) + ")");
  app.require_subcommand(1);
  app.failure_message([](const CLI::App*, const CLI::Error& error) {
    return "ccst: " + std::string(error.what()) + "\nccst sample --help says what is right\n";
  });
  const CLI::App* sample = AddSample(app, flags);
  const CLI::App* info = AddInfo(app, flags);
  AddJobCommands(app, flags.server, flags.jobs);
  AddAnalyzeCommands(app, flags.analyze);
  Command command;
  try {
    app.parse(argc, argv);
    if (sample->parsed()) {
      command = FinishSample(flags);
    } else if (info->parsed()) {
      command = flags.info;
    } else if (IsAnalyzeCommand(app)) {
      command = FinishAnalyzeCommand(app, flags.analyze);
    } else {
      command = FinishJobCommand(app, flags.jobs);
    }
  } catch (const CLI::ParseError& error) {
    return Done{app.exit(error) == 0 ? kOk : kUsage};
  }
  flags.server.server = AddressOf(flags.server.server, environment_server);
  if (!flags.local) {
    std::visit([&flags](auto& chosen) { SetServer(flags.server, chosen); }, command);
  }
  return command;
}

}  // namespace ccst::cli
