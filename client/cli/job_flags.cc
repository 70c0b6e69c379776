#include "client/cli/job_flags.h"

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "client/cli/flag_kinds.h"
#include "client/cli/listing.h"
#include "client/cli/outputs.h"
#include "core/io/sample_file.h"

namespace ccst::cli {
namespace {

CLI::App& Add(CLI::App& app, ServerAddress& server, const char* name, const char* help) {
  CLI::App* sub = app.add_subcommand(name, help);
  AddServer(*sub, server);
  return *sub;
}

void AddJob(CLI::App& app, std::string& job) {
  app.add_option("JOB", job, "Name of the job: jobs/ID, or its ID")->type_name("")->required();
}

void AddOutputs(CLI::App& app, OutputPaths& paths) {
  app.add_option(
         "-o,--output", paths.samples_path,
         "Write the samples: " + std::string(kSampleExtensions) + ", - for CSV on standard output")
      ->type_name("FILE");
  app.add_option("--mesh-output", paths.mesh_path,
                 "Write the sample mesh: .obj .ply .stl .off .glb .drc, - for OBJ")
      ->type_name("FILE");
  app.add_option("--summary", paths.summary_path, "Write what came out as JSON")->type_name("FILE");
}

void AddUpload(CLI::App& app, UploadCommand& c) {
  app.add_option("MESH", c.mesh,
                 "Mesh to store: .obj .ply .stl .off .glb .gltf .drc, - for standard input")
      ->type_name("")
      ->required();
  app.add_option("--name", c.display_name, "What to call the mesh in lists; else its file's name")
      ->type_name("TEXT");
  AddQuantization(app, c.quantization_bits);
  AddProgress(app, c.progress);
}

void AddJobs(CLI::App& app, JobsCommand& c) {
  app.add_option("--state", c.states,
                 "Only these: queued, running, cancelling, succeeded, failed, cancelled")
      ->type_name("STATE")
      ->expected(1)
      ->take_all();
  AddLabels(app, c.labels, "Only jobs with this label; may be given again");
  app.add_flag("--json", c.json, "Print a JSON array");
}

void AddFetch(CLI::App& app, FetchCommand& c) {
  AddJob(app, c.job);
  AddOutputs(app, c);
  app.add_option("--surface", c.surface,
                 "The mesh file that was sampled, where the server does not have the mesh any more")
      ->type_name("MESH");
  AddQuantization(app, c.quantization_bits);
}

std::string JobNameOf(const std::string& text) {
  return text.find('/') == std::string::npos ? "jobs/" + text : text;
}

JobsCommand Finish(const JobsCommand& command) {
  for (const std::string& state : command.states) {
    if (!StateFromName(state).has_value()) {
      throw CLI::ValidationError(
          "--state",
          "'" + state + "' is none of queued, running, cancelling, succeeded, failed, cancelled");
    }
  }
  return command;
}

FetchCommand Finish(FetchCommand command, const ServerFlags& server) {
  command.job = JobNameOf(command.job);
  if (command.samples_path.empty() && command.mesh_path.empty() && command.summary_path.empty()) {
    throw CLI::ValidationError("nothing to fetch: name a file with -o, --mesh-output or --summary");
  }
  std::vector<NamedFile> inputs = FilesOf(server);
  inputs.push_back({"the mesh", command.surface});
  if (const absl::Status status = CheckOutputs(command, inputs); !status.ok()) {
    throw CLI::ValidationError(std::string(status.message()));
  }
  return command;
}

}  // namespace

void AddJobCommands(CLI::App& app, ServerAddress& server, JobFlags& flags) {
  AddUpload(Add(app, server, "upload", "Store a mesh on a server and print its name"),
            flags.upload);
  Add(app, server, "meshes", "List the meshes you have stored")
      .add_flag("--json", flags.meshes.json, "Print a JSON array");
  AddJobs(Add(app, server, "jobs", "List your jobs, newest first"), flags.jobs);
  CLI::App& watch = Add(app, server, "watch", "Follow a job until it ends");
  AddJob(watch, flags.watch.job);
  AddProgress(watch, flags.watch.progress);
  watch
      .add_option("--patience", flags.watch.patience_seconds,
                  "How long to try to reach a server that went away")
      ->type_name("SECONDS")
      ->check(CLI::NonNegativeNumber.description(""))
      ->capture_default_str();
  AddJob(Add(app, server, "cancel", "Ask a job to stop"), flags.cancel.job);
  AddFetch(Add(app, server, "fetch", "Write the samples of a job that has ended"), flags.fetch);
  Add(app, server, "delete", "Drop an ended job with its samples, or a mesh")
      .add_option("NAME", flags.remove.name, "jobs/ID, the ID of a job, or meshes/SHA256")
      ->type_name("")
      ->required();
}

Command FinishJobCommand(const CLI::App& app, const ServerAddress& server, JobFlags flags) {
  const std::string name = app.get_subcommands().front()->get_name();
  flags.watch.job = JobNameOf(flags.watch.job);
  flags.cancel.job = JobNameOf(flags.cancel.job);
  flags.remove.name = JobNameOf(flags.remove.name);
  if (name == "upload") return flags.upload;
  if (name == "meshes") return flags.meshes;
  if (name == "jobs") return Finish(flags.jobs);
  if (name == "watch") return flags.watch;
  if (name == "cancel") return flags.cancel;
  if (name == "delete") return flags.remove;
  return Finish(flags.fetch, server.server_flags);
}

}  // namespace ccst::cli
