#include "tests/figures/report.h"

#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace ccst::figures {
namespace {

struct Cell {
  std::string_view heading;
  int width;
  std::string text;
};

char TerminationLetter(Termination termination) {
  switch (termination) {
    case Termination::kConverged:
      return 'c';
    case Termination::kIterationLimit:
      return 'i';
    case Termination::kTimeLimit:
      return 't';
    case Termination::kStopped:
      return 's';
  }
  return '?';
}

std::vector<Cell> Cells(const RunRecord& run) {
  const Figures& f = run.figures;
  const auto number = [](double value, int digits) {
    return absl::StrFormat("%.*f", digits, value);
  };
  const double samples = static_cast<double>(run.sample_count);
  return {
      {"n", 7, absl::StrCat(run.sample_count)},
      {"seed", 5, absl::StrCat(run.seed)},
      {"ms", 7, number(run.wall_seconds * 1e3, 0)},
      {"cv", 8, number(f.capacity_cv, 4)},
      {"radius", 8, number(f.radius_same_side, 3)},
      {"nearest", 8, number(f.mean_nearest, 3)},
      {"minAngle", 9, number(f.min_angle, 2)},
      {"<30%", 8, number(100.0 * f.below_30, 3)},
      {">90%", 8, number(100.0 * f.above_90, 3)},
      {"valence", 8, number(100.0 * f.valence_5_7, 2)},
      {"hausdorff", 10, number(100.0 * f.hausdorff, 3)},
      {"rms", 7, number(100.0 * f.rms, 3)},
      {"turned", 7, absl::StrCat(f.turned_over)},
      {"manifold", 9, f.defect.empty() ? "yes" : "no"},
      {"euler", 6, absl::StrCat(f.euler)},
      {"loops", 6, absl::StrCat(f.boundary_loops)},
      {"closed", 7, absl::StrCat(run.closed_loops)},
      {"comp", 5, absl::StrCat(f.components)},
      {"maxdist", 9, absl::StrFormat("%.1e", f.max_distance)},
      {"host", 9, absl::StrFormat("%.1e", f.max_host_error)},
      {"alt", 5, absl::StrFormat("%d%c", run.alternations, TerminationLetter(run.termination))},
      {"passes", 7, absl::StrCat(run.passes)},
      {"prep", 6, number(run.prepare_seconds * 1e3, 0)},
      {"init", 6, number(run.initialise_seconds * 1e3, 0)},
      {"opt", 7, number(run.optimise_seconds * 1e3, 0)},
      {"us/n", 7, number(run.wall_seconds * 1e6 / samples, 1)},
      {"cpu/n", 7, number(run.cpu_seconds * 1e6 / samples, 1)},
      {"bits", 5,
       !run.bits_checked ? "-"
       : run.bits_equal  ? "same"
                         : "DIFF"},
  };
}

}  // namespace

std::string FormatHeader(int model_width) {
  std::string line = absl::StrFormat("%-*s", model_width, "model");
  for (const Cell& cell : Cells(RunRecord{})) {
    absl::StrAppendFormat(&line, " %*s ", cell.width, std::string(cell.heading));
  }
  return line;
}

std::string FormatRow(const RunRecord& run, int model_width) {
  std::string line = absl::StrFormat("%-*s", model_width, run.model);
  if (!run.error.empty()) {
    absl::StrAppendFormat(&line, " %7d  %5d  * %s", run.sample_count, run.seed, run.error);
    return line;
  }
  for (const Cell& cell : Cells(run)) {
    absl::StrAppendFormat(&line, " %*s%c", cell.width, cell.text,
                          run.misses.count(cell.heading) > 0 ? '*' : ' ');
  }
  if (!run.figures.defect.empty())
    absl::StrAppend(&line, "\n    not manifold: ", run.figures.defect);
  if (run.misses.count("radius") > 0)
    absl::StrAppend(&line, "\n    too close: ", run.figures.closest_pair);
  return line;
}

std::string FormatJson(const RunRecord& run) {
  const Figures& f = run.figures;
  nlohmann::json json = {{"model", run.model},
                         {"count", run.sample_count},
                         {"seed", run.seed},
                         {"holds", run.Holds()},
                         {"misses", run.misses}};
  if (!run.error.empty()) {
    json["error"] = run.error;
    return json.dump();
  }
  json["samples"] = f.samples;
  json["max_distance"] = f.max_distance;
  json["max_host_error"] = f.max_host_error;
  json["capacity_cv"] = f.capacity_cv;
  json["radius"] = f.radius;
  json["radius_same_side"] = f.radius_same_side;
  json["mean_nearest"] = f.mean_nearest;
  json["min_angle"] = f.min_angle;
  json["mean_angle"] = f.mean_angle;
  json["below_30"] = f.below_30;
  json["above_90"] = f.above_90;
  json["valence_5_7"] = f.valence_5_7;
  json["hausdorff"] = f.hausdorff;
  json["rms"] = f.rms;
  json["turned_over"] = f.turned_over;
  json["euler"] = f.euler;
  json["components"] = f.components;
  json["boundary_loops"] = f.boundary_loops;
  json["closed_loops"] = run.closed_loops;
  json["defect"] = f.defect;
  json["closest_pair"] = f.closest_pair;
  json["alternations"] = run.alternations;
  json["passes"] = run.passes;
  json["seconds"] = {{"wall", run.wall_seconds},
                     {"cpu", run.cpu_seconds},
                     {"prepare", run.prepare_seconds},
                     {"initialise", run.initialise_seconds},
                     {"optimise", run.optimise_seconds}};
  if (run.bits_checked) json["bits_equal"] = run.bits_equal;
  return json.dump();
}

}  // namespace ccst::figures
