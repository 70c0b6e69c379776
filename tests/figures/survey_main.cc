// Samples every mesh file of a folder: what is refused and why, what misses a floor.
#include <algorithm>
#include <array>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "tests/figures/survey.h"

namespace {

using ccst::figures::Survey;

// Broken on purpose: most may be refused.
constexpr std::array<const char*, 3> kMadeToBreak = {"bad/", "stress/", "draco-corrupt/"};

struct Options {
  std::string folder;
  std::string below;
  std::string known;
  std::uint64_t seed = 1;
  int jobs = 1;
  std::ptrdiff_t most_refusals = 12;
  double least_share = 0.95;
};

std::vector<std::string> ListMeshes(const Options& options) {
  const std::set<std::string> extensions = {".obj", ".ply", ".stl", ".off",
                                            ".drc", ".glb", ".gltf"};
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(options.folder)) {
    const std::string name = entry.path().lexically_relative(options.folder).generic_string();
    if (entry.is_regular_file() && extensions.contains(entry.path().extension().string()) &&
        name.starts_with(options.below)) {
      names.push_back(name);
    }
  }
  std::sort(names.begin(), names.end());
  return names;
}

// The files that a list of known weaknesses names.
std::set<std::string> ReadKnown(const std::string& path) {
  std::set<std::string> names;
  if (path.empty()) return names;
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot read " + path);
  for (std::string line; std::getline(file, line);) {
    if (!line.empty() && line.front() != '#') names.insert(line.substr(0, line.find(' ')));
  }
  return names;
}

bool MadeToBreak(const Survey& survey) {
  return std::any_of(kMadeToBreak.begin(), kMadeToBreak.end(),
                     [&](const char* folder) { return survey.run.model.starts_with(folder); });
}

void PrintRefusals(const std::vector<Survey>& surveys, bool made_to_break, const char* heading) {
  std::printf("\n%s\n", heading);
  for (const Survey& survey : surveys) {
    if (survey.run.error.empty() || MadeToBreak(survey) != made_to_break) continue;
    std::printf("  %-46s %s\n", survey.run.model.c_str(), survey.run.error.c_str());
  }
}

int Run(const Options& options) {
  if (!std::filesystem::is_directory(options.folder)) {
    std::fprintf(stderr, "no mesh folder at %s: set CCST_MESHES or --meshes\n",
                 options.folder.c_str());
    return 2;
  }
  const std::set<std::string> known = ReadKnown(options.known);
  const std::vector<std::string> names = ListMeshes(options);
  std::vector<Survey> surveys(names.size());
  std::atomic<std::size_t> next = 0;
  {
    std::vector<std::jthread> workers;
    for (int job = 0; job < options.jobs; ++job) {
      workers.emplace_back([&] {
        for (std::size_t i = next++; i < names.size(); i = next++) {
          try {
            surveys[i] = ccst::figures::SurveyFile(options.folder + "/" + names[i], options.seed);
          } catch (const std::exception& e) {
            surveys[i].run.error = std::string("exception: ") + e.what();
          }
          surveys[i].run.model = names[i];
          if (!surveys[i].run.error.empty()) continue;
          std::fprintf(stderr, "%s: sampled in %.1f s\n", names[i].c_str(),
                       surveys[i].run.wall_seconds);
        }
      });
    }
  }

  constexpr int kWidth = 44;
  std::ptrdiff_t refused = 0;
  std::ptrdiff_t sampled = 0;
  std::ptrdiff_t held = 0;
  std::ptrdiff_t new_misses = 0;
  std::printf("%s  repairs; points\n", ccst::figures::FormatHeader(kWidth).c_str());
  for (const Survey& survey : surveys) {
    refused += !survey.run.error.empty() && !MadeToBreak(survey);
    if (!survey.run.error.empty()) continue;
    ++sampled;
    held += survey.run.Holds();
    std::string row = ccst::figures::FormatRow(survey.run, kWidth);
    std::string extra = "  " + ccst::figures::DescribeRepairs(survey.repairs);
    if (survey.run.figures.radius_same_side < survey.radius_on_sheet) {
      absl::StrAppendFormat(&extra, "; radius %.3f on one sheet", survey.radius_on_sheet);
    }
    if (survey.untriangulated_components > 0) {
      absl::StrAppend(&extra, "; ", survey.untriangulated_samples, " points on ",
                      survey.untriangulated_components, " of ", survey.components, " components");
    }
    row.insert(std::min(row.find('\n'), row.size()), extra);
    std::printf("%s\n", row.c_str());
  }
  PrintRefusals(surveys, true, "Refused of those made to break:");
  PrintRefusals(surveys, false, "Refused of the others:");
  std::printf("\nMissing a floor:\n");
  for (const Survey& survey : surveys) {
    if (survey.run.misses.empty()) continue;
    const bool is_known = known.contains(survey.run.model);
    new_misses += !is_known;
    std::printf("  %-46s", survey.run.model.c_str());
    for (const std::string& miss : survey.run.misses) std::printf(" %s", miss.c_str());
    std::printf("%s\n", is_known ? " (known)" : "");
  }
  const double share = sampled > 0 ? static_cast<double>(held) / static_cast<double>(sampled) : 0.0;
  std::printf(
      "\nfiles %zu, refused %td of those not made to break (at most %td), within all floors %td of "
      "%td sampled: %.1f %% (wanted %.1f %%); misses not known before: %td\n",
      names.size(), refused, options.most_refusals, held, sampled, 100.0 * share,
      100.0 * options.least_share, new_misses);
  const bool held_enough = known.empty() ? share >= options.least_share : new_misses == 0;
  return refused <= options.most_refusals && held_enough ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  const char* folder = std::getenv("CCST_MESHES");
  options.folder = folder != nullptr ? folder : CCST_SOURCE_DIR "/../shared/meshes";
  CLI::App app(
      "Samples every mesh file below a folder with n = max(4000, 40 per component). Exit code 1 "
      "when too many are refused or miss a floor, 2 when nothing could be run.");
  app.add_option("--meshes", options.folder, "Folder of the models; default $CCST_MESHES");
  app.add_option("--below", options.below, "Only paths that start with this");
  app.add_option("--known", options.known,
                 "List of files with known weaknesses, a line each; then the only misses allowed");
  app.add_option("--seed", options.seed, "Seed");
  app.add_option("--jobs", options.jobs, "Files at once")->check(CLI::Range(1, 256));
  app.add_option("--most-refusals", options.most_refusals, "Of files not made to break");
  app.add_option("--least-share", options.least_share, "Of results within all floors");
  CLI11_PARSE(app, argc, argv);
  try {
    return Run(options);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 2;
  }
}
