#include "client/cli/analyze_flags.h"

#include <algorithm>
#include <filesystem>
#include <sstream>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>

#include "client/cli/option_flags.h"
#include "client/cli/outputs.h"
#include "core/base/status.h"

namespace ccst::cli {
namespace {

constexpr char kAnalyze[] = "analyze";
constexpr char kCompare[] = "compare";

void AddFlags(CLI::App& sub, AnalyzeFlags& flags) {
  AnalyzeCommand& c = flags.command;
  sub.add_option("--surface", c.surface,
                 "The mesh that was sampled; without it the sample meshes stand for it")
      ->type_name("MESH");
  AddOptions(sub, c.density, c.texture_path);
  sub.add_option("--json", c.json_path, "Write the figures as JSON, - for standard output")
      ->type_name("FILE");
  sub.add_option("--html", c.html_path, "Write one page with curves, pictures and a table")
      ->type_name("FILE");
  sub.add_option("--threads", flags.threads, "Threads; by default all cores")
      ->type_name("N")
      ->check(CLI::Range(1, 1024).description(""));
}

// [NAME=]FILE[,FILE...]
SampleGroup ParseSet(const std::string& text) {
  SampleGroup group;
  const std::size_t equals = text.find('=');
  std::string files = text;
  if (equals != std::string::npos && text.find('/') > equals) {
    group.name = text.substr(0, equals);
    files = text.substr(equals + 1);
  }
  std::istringstream stream(files);
  for (std::string path; std::getline(stream, path, ',');) {
    if (!path.empty()) group.paths.push_back(path);
  }
  if (group.paths.empty()) {
    throw CLI::ValidationError("'" + text + "' names no file; want [NAME=]FILE[,FILE...]");
  }
  if (group.name.empty()) group.name = std::filesystem::path(group.paths.front()).filename();
  return group;
}

absl::Status CheckFiles(const AnalyzeCommand& command) {
  for (const std::string& path : {command.json_path, command.html_path}) {
    CCST_RETURN_IF_ERROR(CheckWritable(path));
  }
  std::vector<NamedFile> inputs = {{"the mesh", command.surface},
                                   {"the image", command.texture_path}};
  for (const SampleGroup& group : command.groups) {
    for (const std::string& path : group.paths) inputs.push_back({"the samples", path});
  }
  return CheckDistinct({{"--json", command.json_path}, {"--html", command.html_path}}, inputs);
}

}  // namespace

void AddAnalyzeCommands(CLI::App& app, AnalyzeFlags& flags) {
  CLI::App* analyze = app.add_subcommand(kAnalyze, "Measure samples, whoever made them");
  analyze
      ->add_option("SAMPLES", flags.sets,
                   "Samples: .ply .xyz .csv .obj .off .drc, with faces or without; each for itself")
      ->type_name("")
      ->required();
  AddFlags(*analyze, flags);
  CLI::App* compare = app.add_subcommand(kCompare, "Measure samples side by side");
  compare
      ->add_option("SETS", flags.sets,
                   "[NAME=]FILE[,FILE...]: files as for analyze; those of one set are averaged")
      ->type_name("")
      ->required();
  AddFlags(*compare, flags);
}

bool IsAnalyzeCommand(const CLI::App& app) {
  return app.got_subcommand(kAnalyze) || app.got_subcommand(kCompare);
}

AnalyzeCommand FinishAnalyzeCommand(const CLI::App& app, const AnalyzeFlags& flags) {
  AnalyzeCommand command = flags.command;
  command.thread_count =
      flags.threads.value_or(std::max(1, static_cast<int>(std::thread::hardware_concurrency())));
  for (const std::string& set : flags.sets) {
    if (app.got_subcommand(kCompare)) {
      command.groups.push_back(ParseSet(set));
    } else {
      command.groups.push_back({std::filesystem::path(set).filename(), {set}});
    }
  }
  if (const absl::Status status = CheckFiles(command); !status.ok()) {
    throw CLI::ValidationError(std::string(status.message()));
  }
  return command;
}

}  // namespace ccst::cli
