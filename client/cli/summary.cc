#include "client/cli/summary.h"

#include <nlohmann/json.hpp>

#include "absl/strings/str_format.h"
#include "client/cli/flags.h"
#include "client/cli/json_text.h"
#include "core/base/printable_text.h"

namespace ccst::cli {
namespace {

using Json = nlohmann::ordered_json;

const char* TerminationName(Termination termination) {
  switch (termination) {
    case Termination::kConverged:
      return "converged";
    case Termination::kIterationLimit:
      return "iteration_limit";
    case Termination::kTimeLimit:
      return "time_limit";
    case Termination::kStopped:
      return "stopped";
  }
  return "unknown";
}

const char* TerminationText(Termination termination) {
  switch (termination) {
    case Termination::kConverged:
      return "converged";
    case Termination::kIterationLimit:
      return "stopped at the iteration limit";
    case Termination::kTimeLimit:
      return "stopped at the time limit";
    case Termination::kStopped:
      return "stopped";
  }
  return "ended";
}

Json SurfaceJson(const SurfaceSummary& surface) {
  Json json;
  json["vertices"] = surface.vertices;
  json["faces"] = surface.faces;
  json["area"] = surface.area;
  json["diagonal"] = surface.diagonal;
  json["components"] = surface.components;
  json["boundary_loops"] = surface.boundary_loops;
  json["euler"] = surface.euler;
  json["untriangulated_components"] = surface.untriangulated_components;
  json["untriangulated_samples"] = surface.untriangulated_samples;
  const RepairReport& repairs = surface.repairs;
  json["repairs"] = {{"welded_vertices", repairs.welded_vertices},
                     {"isolated_vertices", repairs.isolated_vertices},
                     {"repeated_index_faces", repairs.repeated_index_faces},
                     {"duplicate_faces", repairs.duplicate_faces},
                     {"degenerate_faces", repairs.degenerate_faces},
                     {"split_faces", repairs.split_faces},
                     {"cut_edges", repairs.cut_edges},
                     {"non_orientable_cuts", repairs.non_orientable_cuts},
                     {"cut_vertices", repairs.cut_vertices},
                     {"flipped_faces", repairs.flipped_faces},
                     {"closed_loops", surface.closed_loops}};
  return json;
}

// Ends in a line break; empty where nothing was repaired.
std::string RepairsText(const RepairReport& repairs) {
  std::string text;
  const auto add = [&text](std::int64_t count, const char* what) {
    if (count == 0) return;
    absl::StrAppendFormat(&text, "%s%d %s", text.empty() ? "repaired: " : ", ", count, what);
  };
  add(repairs.welded_vertices, "vertices welded");
  add(repairs.isolated_vertices, "vertices without a face dropped");
  add(repairs.repeated_index_faces, "faces with a repeated vertex dropped");
  add(repairs.duplicate_faces, "duplicate faces dropped");
  add(repairs.degenerate_faces, "faces without area dropped or replaced");
  add(repairs.split_faces, "faces split");
  add(repairs.cut_edges, "edges of three or more faces cut");
  add(repairs.non_orientable_cuts, "edges cut to make the surface orientable");
  add(repairs.cut_vertices, "vertices split");
  add(repairs.flipped_faces, "faces turned over");
  return text.empty() ? text : text + "\n";
}

Json TextOrNull(const std::string& text) { return text.empty() ? Json(nullptr) : Json(text); }

}  // namespace

std::string SummaryJson(const FinishedRun& run) {
  const SampleOutcome& outcome = run.outcome;
  const SamplingResult& result = outcome.result;
  Json json;
  json["count"] = result.samples.positions.size();
  json["seed"] = run.options.seed;
  json["method"] = MethodName(run.options.method);
  json["converged"] = result.termination == Termination::kConverged;
  json["termination"] = TerminationName(result.termination);
  json["alternations"] = result.alternations;
  json["passes"] = result.passes;
  json["energy"] = result.energy;
  // The other methods have no triangles whose capacities could vary.
  const bool has_mesh = run.options.method == SamplingMethod::kCcst;
  json["capacity_cv"] = has_mesh ? Json(result.capacity_cv) : Json(nullptr);
  json["relative_radius"] = result.relative_radius;
  json["samples_digest"] = outcome.record.samples_sha256;
  json["surface"] = SurfaceJson(result.surface);
  json["seconds"] = {{"decode", outcome.record.decode_seconds},
                     {"prepare", result.prepare_seconds},
                     {"initialise", result.initialise_seconds},
                     {"optimise", result.optimise_seconds},
                     {"total", outcome.record.total_seconds}};
  json["job"] = TextOrNull(outcome.job_name);
  json["server"] = TextOrNull(run.server);
  return JsonText(json);
}

std::string SummaryText(const FinishedRun& run) {
  const SampleOutcome& outcome = run.outcome;
  const SamplingResult& result = outcome.result;
  const std::string where =
      run.server.empty() ? "in this process" : "by " + PrintableText(run.server);
  std::string text = RepairsText(result.surface.repairs);
  if (result.surface.untriangulated_components > 0) {
    absl::StrAppendFormat(&text,
                          "%d of %d components are too small for a triangulation; their %d "
                          "samples are spread by capacity\n",
                          result.surface.untriangulated_components, result.surface.components,
                          result.surface.untriangulated_samples);
  }
  absl::StrAppendFormat(
      &text,
      "%d samples on %d faces, %d triangles, computed %s in %.2f s\n"
      "%s after %d %s, relative radius %.3f\n",
      result.samples.positions.size(), result.surface.faces, result.samples.triangles.size(), where,
      outcome.record.total_seconds, TerminationText(result.termination), result.alternations,
      run.options.method == SamplingMethod::kCcst
          ? absl::StrFormat("alternations: capacity variation %.2f %%", 100.0 * result.capacity_cv)
          : "steps",
      result.relative_radius);
  return text;
}

}  // namespace ccst::cli
