// Samples a surface several times with one method and measures the sets together, as JSON.
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "absl/status/status.h"
#include "core/base/interrupt.h"
#include "core/base/status.h"
#include "core/io/mesh_file.h"
#include "core/repair/repair.h"
#include "core/sampling/sampling.h"
#include "tests/paper/report.h"

namespace ccst::paper {
namespace {

struct Options {
  std::string mesh;
  SamplingOptions sampling;
  int sets = 8;
};

absl::Status Run(Options options) {
  CCST_ASSIGN_OR_RETURN(const MeshFile file, ReadMeshFile(options.mesh));
  Interrupt never;
  CCST_ASSIGN_OR_RETURN(const RepairedMesh repaired, Repair(file.mesh, {}, &never));
  CCST_ASSIGN_OR_RETURN(const Surface surface, Surface::Build(repaired.mesh));
  options.sampling.max_iterations = DefaultMaxIterations(options.sampling.method);
  std::vector<SampleSet> sets;
  for (int set = 1; set <= options.sets; ++set) {
    options.sampling.seed = static_cast<std::uint64_t>(set);
    CCST_ASSIGN_OR_RETURN(SamplingResult result, SampleSurface(file.mesh, options.sampling));
    sets.push_back(std::move(result.samples));
  }
  std::printf("%s\n", ReportFigures(surface, sets).dump().c_str());
  return absl::OkStatus();
}

}  // namespace
}  // namespace ccst::paper

int main(int argc, char** argv) {
  using ccst::SamplingMethod;
  ccst::paper::Options options;
  options.sampling.sample_count = 1700;
  CLI::App app("Differential domain analysis of sets of samples with seeds 1, 2, ...");
  app.add_option("mesh", options.mesh, "Surface to sample")->required();
  app.add_option("--count", options.sampling.sample_count, "Samples of a set");
  app.add_option("--sets", options.sets, "How many sets")->check(CLI::Range(1, 100));
  app.add_option("--method", options.sampling.method, "How they are made")
      ->transform(CLI::CheckedTransformer(
          std::map<std::string, SamplingMethod>{{"ccst", SamplingMethod::kCcst},
                                                {"white", SamplingMethod::kWhiteNoise},
                                                {"poisson", SamplingMethod::kPoissonDisk},
                                                {"lloyd", SamplingMethod::kLloyd}}));
  CLI11_PARSE(app, argc, argv);
  const absl::Status status = ccst::paper::Run(options);
  if (status.ok()) return 0;
  std::fprintf(stderr, "%s\n", std::string(status.message()).c_str());
  return 2;
}
