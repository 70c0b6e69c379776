// The paper's Algorithm 1 step by step: passes until the energy rests, then flips, no relocation.
// Writes every pass's energies as JSON to standard output and pictures of the phases asked for.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "absl/status/status.h"
#include "client/render/picture.h"
#include "core/base/interrupt.h"
#include "core/base/status.h"
#include "core/io/mesh_file.h"
#include "core/parallel/parallel.h"
#include "core/sampling/mesh/edge_flips.h"
#include "core/sampling/relax/geometry_phase.h"
#include "core/sampling/start/initial_mesh.h"
#include "tests/paper/report.h"
#include "tests/paper/start.h"

namespace ccst::paper {
namespace {

struct Options {
  std::string mesh;
  std::int64_t count = 5000;
  std::uint64_t seed = 1;
  Points points = Points::kWhite;
  Energy energy = Energy::kTarget;
  int phases = 10;
  int max_passes = 40;
  std::string pictures;         // Prefix of their names; empty: none.
  std::vector<int> picture_at;  // Phases: 0 is the start; k the end of phase k, after flips.
  bool picture_before_flips = false;
};

/// A phase is over when a pass lowers the energy's distance from its floor by less than this.
constexpr double kRest = 0.01;

/// What both energies are of a sample mesh, whichever is minimised, in units of its own areas.
nlohmann::json MeasureEnergies(const SampleSet& set, double surface_area) {
  double sum = 0.0;
  double squares = 0.0;
  for (const Eigen::Vector3i& t : set.triangles) {
    const double area = 0.5 * (set.positions[t[1]] - set.positions[t[0]])
                                  .cross(set.positions[t[2]] - set.positions[t[0]])
                                  .norm();
    sum += area;
    squares += area * area;
  }
  const double m = static_cast<double>(set.triangles.size());
  const double target = surface_area / m;
  return {{"squared_area", squares / (m * target * target)},
          {"target", squares / (m * target * target) - 2.0 * sum / surface_area + 1.0},
          {"cv", std::sqrt(std::max(0.0, m * squares / (sum * sum) - 1.0))},
          {"area", sum / surface_area}};
}

absl::Status WritePicture(const Start& start, const SampleMesh& mesh, const std::string& path) {
  CCST_ASSIGN_OR_RETURN(const RgbImage image,
                        RenderPicture(start.mesh, MakeSampleSet(start, mesh)));
  CCST_ASSIGN_OR_RETURN(const std::string png, EncodePng(image));
  std::ofstream file(path, std::ios::binary);
  file << png;
  return file.flush() ? absl::OkStatus() : absl::InternalError("cannot write " + path);
}

absl::Status Run(const Options& options) {
  CCST_ASSIGN_OR_RETURN(const MeshFile file, ReadMeshFile(options.mesh));
  CCST_ASSIGN_OR_RETURN(Start start,
                        DrawStart(file.mesh, options.count, options.seed, options.points));
  Interrupt never;
  CCST_ASSIGN_OR_RETURN(SampleMesh mesh,
                        BuildInitialMesh(start.surface, start.plan, start.samples, &never));
  const double area = start.surface.area() * start.surface.unit() * start.surface.unit();
  const auto picture = [&](int phase, const char* moment) {
    const bool wanted = std::count(options.picture_at.begin(), options.picture_at.end(), phase);
    if (options.pictures.empty() || !wanted) return absl::OkStatus();
    return WritePicture(start, mesh, options.pictures + std::to_string(phase) + moment + ".png");
  };

  const Parallel one_thread;
  internal::GeometryPhase geometry(&start.surface, &start.density, &start.plan, options.energy,
                                   &mesh, &start.samples, &one_thread);
  geometry.stretch = 1.0;  // The minimiser as it is.
  geometry.rest = 1e-3;
  internal::EdgeFlips flips = geometry.packed().MakeFlips();
  nlohmann::json rows = nlohmann::json::array();
  const auto record = [&](int phase, int pass, std::int64_t flipped) {
    nlohmann::json row = MeasureEnergies(MakeSampleSet(start, mesh), area);
    row["phase"] = phase;
    row["pass"] = pass;
    row["flips"] = flipped;
    rows.push_back(row);
  };
  record(0, 0, 0);
  CCST_RETURN_IF_ERROR(picture(0, ""));
  for (int phase = 1; phase <= options.phases; ++phase) {
    double before = geometry.MeasureCapacities().cv;
    for (int pass = 1; pass <= options.max_passes; ++pass) {
      geometry.Pass(&never);
      record(phase, pass, 0);
      const double cv = geometry.MeasureCapacities().cv;
      if (before - cv < kRest * before) break;
      before = cv;
    }
    if (options.picture_before_flips) CCST_RETURN_IF_ERROR(picture(phase, "-moved"));
    flips.touched.clear();
    const std::int64_t flipped = flips.FlipAll();
    for (const std::int32_t v : flips.touched) geometry.Activate(v);
    record(phase, -1, flipped);
    CCST_RETURN_IF_ERROR(picture(phase, ""));
  }

  const SampleSet set = MakeSampleSet(start, mesh);
  const nlohmann::json report = {{"rows", rows},
                                 {"figures", ReportFigures(start.surface, {&set, 1})}};
  std::printf("%s\n", report.dump().c_str());
  return absl::OkStatus();
}

}  // namespace
}  // namespace ccst::paper

int main(int argc, char** argv) {
  ccst::paper::Options options;
  CLI::App app("The paper's Algorithm 1 step by step");
  app.add_option("mesh", options.mesh, "Closed surface of one piece")->required();
  app.add_option("--count", options.count, "Samples");
  app.add_option("--seed", options.seed, "Seed");
  app.add_option("--points", options.points, "Where samples start")
      ->transform(CLI::CheckedTransformer(ccst::paper::PointsByName()));
  app.add_option("--energy", options.energy, "What is minimised")
      ->transform(CLI::CheckedTransformer(std::map<std::string, ccst::Energy>{
          {"target", ccst::Energy::kTarget}, {"squared-area", ccst::Energy::kSquaredArea}}));
  app.add_option("--phases", options.phases, "Geometry phases, each ended by flips");
  app.add_option("--max-passes", options.max_passes, "Most passes in a phase");
  app.add_option("--pictures", options.pictures, "Prefix of pictures' names");
  app.add_option("--picture-at", options.picture_at, "Phases to draw")->delimiter(',');
  app.add_flag("--picture-before-flips", options.picture_before_flips, "And before their flips");
  CLI11_PARSE(app, argc, argv);
  const absl::Status status = ccst::paper::Run(options);
  if (status.ok()) return 0;
  std::fprintf(stderr, "%s\n", std::string(status.message()).c_str());
  return 2;
}
