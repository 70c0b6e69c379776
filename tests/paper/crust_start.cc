// How often the paper's start, Crust over white noise, gives a sample mesh of the surface's
// topology, and what it converges to beside the start by construction. One JSON object a run.
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "absl/status/status.h"
#include "core/base/interrupt.h"
#include "core/base/status.h"
#include "core/io/mesh_file.h"
#include "core/sampling/mesh/edge_flips.h"
#include "core/sampling/relax/relaxation.h"
#include "core/sampling/start/initial_mesh.h"
#include "tests/paper/report.h"
#include "tests/paper/start.h"

namespace ccst::paper {
namespace {

struct Options {
  std::vector<std::string> meshes;
  std::vector<std::int64_t> counts = {1700};
  std::vector<std::uint64_t> seeds = {1, 2, 3};
  Points points = Points::kWhite;
  double normal_filter = 50.0;  // [degree]
  bool converge = false;
};

nlohmann::json Converge(Start start, SampleMesh mesh) {
  Interrupt never;
  SamplingOptions options;
  options.sample_count = start.samples.count();
  internal::Relaxation relaxation(&start.surface, &start.density, &start.plan, options, {}, &never,
                                  Interrupt::Clock::duration::zero(), &mesh, &start.samples);
  const internal::RelaxationReport report = *relaxation.Run();  // Never interrupted.
  const SampleSet set = MakeSampleSet(start, mesh);
  nlohmann::json row = ReportFigures(start.surface, {&set, 1});
  row.erase("radial_mean");  // Of one set each: too long to print.
  row.erase("anisotropy");
  row["alternations"] = report.alternations;
  return row;
}

nlohmann::json Describe(const CrustOutcome& outcome) {
  const quality::MeshTopology& t = outcome.topology;
  return {{"usable", outcome.usable},         {"triangles", outcome.triangles.size()},
          {"unused", t.unused_vertices},      {"holes", t.boundary_loops.size()},
          {"crowded_edges", t.crowded_edges}, {"split_vertices", t.split_vertices},
          {"components", t.components},       {"euler", t.euler},
          {"seconds", outcome.seconds}};
}

absl::Status Run(const Options& options, const std::string& path, std::int64_t count,
                 std::uint64_t seed) {
  CCST_ASSIGN_OR_RETURN(const MeshFile file, ReadMeshFile(path));
  CCST_ASSIGN_OR_RETURN(const Start start, DrawStart(file.mesh, count, seed, options.points));
  nlohmann::json row = {{"mesh", path},
                        {"count", count},
                        {"seed", seed},
                        {"euler", start.surface.component_eulers()[0]}};
  CrustOptions crust_options = {.normal_filter = options.normal_filter * std::numbers::pi / 180.0};
  CCST_ASSIGN_OR_RETURN(const CrustOutcome crust, RunCrust(start, crust_options));
  row["crust"] = Describe(crust);
  if (!crust.usable) {
    crust_options.trim_holes = false;
    CCST_ASSIGN_OR_RETURN(const CrustOutcome holes, RunCrust(start, crust_options));
    row["with_holes"] = Describe(holes);
  }
  if (options.converge) {
    Interrupt never;
    CCST_ASSIGN_OR_RETURN(SampleMesh built,
                          BuildInitialMesh(start.surface, start.plan, start.samples, &never));
    row["by_construction"] = Converge(start, std::move(built));
    if (crust.usable) {
      SampleMesh mesh;
      mesh.SetTriangles(static_cast<std::int32_t>(count), crust.triangles);
      internal::EdgeFlips(&mesh, &start.samples.position, &start.samples.normal).FlipAll();
      row["by_crust"] = Converge(start, std::move(mesh));
    }
  }
  std::printf("%s\n", row.dump().c_str());
  std::fflush(stdout);
  return absl::OkStatus();
}

}  // namespace
}  // namespace ccst::paper

int main(int argc, char** argv) {
  ccst::paper::Options options;
  CLI::App app("Crust over initial samples against the start by construction");
  app.add_option("meshes", options.meshes, "Closed surfaces of one piece")->required();
  app.add_option("--counts", options.counts, "Numbers of samples")->delimiter(',');
  app.add_option("--seeds", options.seeds, "Seeds")->delimiter(',');
  app.add_option("--points", options.points, "Where samples start")
      ->transform(CLI::CheckedTransformer(ccst::paper::PointsByName()));
  app.add_option("--normal-filter", options.normal_filter, "Of Crust [degree]");
  app.add_flag("--converge", options.converge, "Relax both starts and measure what comes out");
  CLI11_PARSE(app, argc, argv);
  for (const std::string& mesh : options.meshes) {
    for (const std::int64_t count : options.counts) {
      for (const std::uint64_t seed : options.seeds) {
        const absl::Status status = ccst::paper::Run(options, mesh, count, seed);
        if (status.ok()) continue;
        std::fprintf(stderr, "%s: %s\n", mesh.c_str(), std::string(status.message()).c_str());
        return 2;
      }
    }
  }
  return 0;
}
