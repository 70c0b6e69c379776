#include "client/cli/flags.h"

#include <algorithm>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>

#include "client/cli/analyze_flags.h"
#include "client/cli/exit_code.h"
#include "client/cli/flag_kinds.h"
#include "client/cli/job_flags.h"
#include "client/cli/option_flags.h"
#include "client/cli/outputs.h"
#include "client/cli/stage_files.h"
#include "core/base/printable_text.h"
#include "core/base/version.h"
#include "core/io/sample_file.h"
#include "core/sampling/option_table.h"

namespace ccst::cli {
namespace {

constexpr char kDefaultServer[] = "localhost:50051";

// Flags as given, before they are made one command.
struct Flags {
  SampleCommand sample;
  JobFlags jobs;
  AnalyzeFlags analyze;
  InfoCommand info;
  ServerAddress server;
  bool local = false;
  std::optional<int> threads;
};

CLI::App* AddSample(CLI::App& app, Flags& flags) {
  CLI::App* sub = app.add_subcommand("sample", "Put blue-noise samples on a mesh");
  SampleCommand& c = flags.sample;
  sub->add_option("MESH", c.mesh,
                  "Mesh to sample: .obj .ply .stl .off .glb .gltf .drc, - for standard input")
      ->type_name("")
      ->required();
  sub->add_option(
         "-o,--output", c.samples_path,
         "Write the samples: " + std::string(kSampleExtensions) + ", - for CSV on standard output")
      ->type_name("FILE");
  sub->add_option("--mesh-output", c.mesh_path,
                  "Write the sample mesh: .obj .ply .stl .off .glb .drc, - for OBJ")
      ->type_name("FILE");
  sub->add_option("--picture", c.picture_path, "Draw samples and sample mesh: .png")
      ->type_name("FILE");
  sub->add_option("--summary", c.summary_path, "Write what came out as JSON")->type_name("FILE");
  AddOptions(*sub, c.options, c.texture_path);
  AddServer(*sub, flags.server);
  sub->add_flag("--local", flags.local, "Compute in this process; gives the same samples");
  sub->add_option("--threads", flags.threads, "Threads of a local run; by default all cores")
      ->type_name("N")
      ->check(CLI::Range(1, 1024).description(""));
  sub->add_option("--dump-stages", c.stages_folder,
                  "Write the mesh at each stage of a local run into this folder, as .ply")
      ->type_name("DIR");
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
  if (!sample.stages_folder.empty() && !flags.local) {
    throw CLI::ValidationError("--dump-stages needs --local; a server gives the result alone");
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
        "--mesh-output needs --method ccst; the others make no mesh: write their samples with "
        "-o");
  }
  std::vector<NamedFile> inputs = FilesOf(flags.server.server_flags);
  inputs.push_back({"the mesh", sample.mesh});
  inputs.push_back({"the image", sample.texture_path});
  absl::Status status = CheckOutputs(sample, inputs);
  if (status.ok() && !sample.stages_folder.empty()) {
    for (const std::string& path :
         {sample.samples_path, sample.mesh_path, sample.picture_path, sample.summary_path}) {
      inputs.push_back({"another output", path});
    }
    status = CheckStageFiles(sample.stages_folder, inputs);
  }
  if (!status.ok()) throw CLI::ValidationError(std::string(status.message()));
}

std::string AddressOf(const std::string& given, const char* environment_server) {
  if (!given.empty()) return given;
  if (environment_server != nullptr && *environment_server != '\0') return environment_server;
  return kDefaultServer;
}

// Throws CLI::ValidationError.
SampleCommand FinishSample(const CLI::App& sample, const Flags& flags) {
  CheckSample(flags);
  SampleCommand command = flags.sample;
  if (sample.count("--max-iterations") == 0) {
    command.options.max_iterations = DefaultMaxIterations(command.options.method);
  }
  if (flags.local) {
    command.options.thread_count =
        flags.threads.value_or(std::max(1, static_cast<int>(std::thread::hardware_concurrency())));
  }
  return command;
}

}  // namespace

std::string MethodName(SamplingMethod method) {
  const Choice<SamplingMethod>* const choice = kMethodOption.Find(method);
  return choice == nullptr ? "unknown" : std::string(choice->name);
}

Command ParseCommandLine(int argc, const char* const* argv, const char* environment_server) {
  Flags flags;
  CLI::App app("Blue-noise samples on triangle meshes, exactly as many as asked for.", "ccst");
  app.set_version_flag("--version", "ccst " + std::string(ProjectVersion()) + " (" +
                                        std::string(SourceRevision()) + ")");
  app.require_subcommand(1);
  app.failure_message([](const CLI::App*, const CLI::Error& error) {
    return "ccst: " + PrintableText(error.what(), "\n") +
           "\nccst sample --help says what is right\n";
  });
  const CLI::App* sample = AddSample(app, flags);
  const CLI::App* info = AddInfo(app, flags);
  AddJobCommands(app, flags.server, flags.jobs);
  AddAnalyzeCommands(app, flags.analyze);
  Command command;
  try {
    app.parse(argc, argv);
    if (sample->parsed()) {
      command = FinishSample(*sample, flags);
    } else if (info->parsed()) {
      command = flags.info;
    } else if (IsAnalyzeCommand(app)) {
      command = FinishAnalyzeCommand(app, flags.analyze);
    } else {
      command = FinishJobCommand(app, flags.server, flags.jobs);
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
