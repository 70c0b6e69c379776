// One whole job on a mesh made by code or read from a file: seconds of its phases, work and peak
// memory as one JSON object. tests/benchmark/README.md says what uses it.
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <gnu/libc-version.h>
#include <nlohmann/json.hpp>
#include <time.h>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/base/status.h"
#include "core/io/draco_mesh.h"
#include "core/io/mesh_file.h"
#include "core/sampling/run_control.h"
#include "core/sampling/sampling.h"
#include "tests/benchmark/subjects.h"

/// Called between phases and doing nothing: where callgrind puts one phase's counts apart from the
/// next one's (--dump-before). Without C++'s name mangling its name is plain.
extern "C" [[gnu::noinline]] void ccst_benchmark_mark() { asm volatile(""); }

namespace ccst::benchmarks {
namespace {

using Clock = std::chrono::steady_clock;

/// What this process has computed so far, on all threads: what other programs do to the machine
/// changes it little.
double ProcessorSeconds() {
  timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct Options {
  std::string mesh;  // A file; empty: made by code.
  std::string shape = "scan";
  std::int64_t faces = 20'000;
  bool draco = false;
  std::string write;  // Where to write the mesh for other programs.
  SamplingOptions sampling;
};

/// What /proc/self/status says of `key`, in KiB; 0 where there is no such file.
std::int64_t MemoryStatus(const std::string& key) {
  std::ifstream file("/proc/self/status");
  for (std::string line; std::getline(file, line);) {
    if (line.rfind(key + ":", 0) == 0) return std::stoll(line.substr(key.size() + 1));
  }
  return 0;
}

/// Forgets the peak that making the mesh has left; where that is not allowed it stays in.
void ResetPeakMemory() { std::ofstream("/proc/self/clear_refs") << 5; }

/// Takes the time and the peak of memory at the end of every phase.
class Stopwatch : public ProgressSink {
 public:
  void Begin() {
    ccst_benchmark_mark();
    last_ = Clock::now();
    last_processor_ = ProcessorSeconds();
  }

  void End(const std::string& phase) {
    ccst_benchmark_mark();
    const Clock::time_point now = Clock::now();
    processor[phase] = ProcessorSeconds() - last_processor_;
    processor["total"] += processor[phase];
    seconds[phase] = std::chrono::duration<double>(now - last_).count();
    seconds["total"] += seconds[phase];
    peak_kib[phase] = MemoryStatus("VmHWM");
    last_ = Clock::now();
    last_processor_ = ProcessorSeconds();
  }

  void OnPhase(Phase phase) override {
    static const std::map<Phase, std::string> kEnded = {{Phase::kPreparing, "decode"},
                                                        {Phase::kInitializing, "prepare"},
                                                        {Phase::kRelaxing, "initialise"},
                                                        {Phase::kFinalizing, "relax"}};
    End(kEnded.at(phase));
  }

  void OnAlternation(const AlternationReport& report) override {
    flips += report.flips;
    relocations += report.relocations;
  }

  std::map<std::string, double> seconds;
  std::map<std::string, double> processor;       // Seconds too, of all threads together.
  std::map<std::string, std::int64_t> peak_kib;  // So far, at the end of the phase.
  std::int64_t flips = 0;
  std::int64_t relocations = 0;

 private:
  Clock::time_point last_;
  double last_processor_ = 0.0;
};

/// What instruction counts depend on besides the code.
nlohmann::json About() {
#ifdef __OPTIMIZE__
  constexpr bool kOptimised = true;
#else
  constexpr bool kOptimised = false;
#endif
  return {{"compiler", __VERSION__}, {"optimised", kOptimised}, {"libc", gnu_get_libc_version()}};
}

absl::StatusOr<TriangleMesh> Input(const Options& options) {
  if (options.mesh.empty()) return MakeSubject(options.shape, options.faces);
  CCST_ASSIGN_OR_RETURN(MeshFile file, ReadMeshFile(options.mesh));
  return std::move(file.mesh);
}

absl::Status Run(const Options& options) {
  CCST_ASSIGN_OR_RETURN(TriangleMesh mesh, Input(options));
  if (!options.write.empty()) return WriteMeshFile(mesh, options.write);
  std::string bytes;
  if (options.draco) {
    CCST_ASSIGN_OR_RETURN(bytes, EncodeDraco(mesh));
    mesh = {};
  }
  ResetPeakMemory();
  const std::int64_t before = MemoryStatus("VmRSS");

  Stopwatch watch;
  RunControl run;
  run.progress = &watch;
  watch.Begin();
  if (options.draco) {
    CCST_ASSIGN_OR_RETURN(mesh, DecodeDraco(bytes));
  }
  CCST_ASSIGN_OR_RETURN(const SamplingResult result, SampleSurface(mesh, options.sampling, run));
  watch.End("finalize");

  const nlohmann::json report = {{"build", About()},
                                 {"faces", mesh.faces.size()},
                                 {"count", options.sampling.sample_count},
                                 {"threads", options.sampling.thread_count},
                                 {"seed", options.sampling.seed},
                                 {"seconds", watch.seconds},
                                 {"processor", watch.processor},
                                 {"before_kib", before},
                                 {"peak_kib", watch.peak_kib},
                                 {"alternations", result.alternations},
                                 {"passes", result.passes},
                                 {"flips", watch.flips},
                                 {"relocations", watch.relocations},
                                 {"capacity_cv", result.capacity_cv},
                                 {"radius", result.relative_radius}};
  std::printf("%s\n", report.dump().c_str());
  return absl::OkStatus();
}

int Main(int argc, char** argv) {
  Options options;
  options.sampling.sample_count = 10'000;
  CLI::App app("Runs one sampling job and prints what it took as JSON");
  app.add_option("--mesh", options.mesh, "a file; otherwise the mesh is made by code");
  app.add_option("--shape", options.shape, "torus, scan (default), saddle or soup");
  app.add_option("--faces", options.faces, "about how many faces it has")
      ->check(CLI::Range(32, 100'000'000));
  app.add_option("--count", options.sampling.sample_count, "samples");
  app.add_option("--seed", options.sampling.seed, "seed");
  app.add_option("--threads", options.sampling.thread_count, "threads");
  const std::map<std::string, DensitySource> densities = {{"uniform", DensitySource::kUniform},
                                                          {"curvature", DensitySource::kCurvature}};
  app.add_option("--density", options.sampling.density.source, "uniform or curvature")
      ->transform(CLI::CheckedTransformer(densities));
  app.add_flag("--draco", options.draco, "start from a Draco stream of the mesh");
  app.add_option("--write", options.write, "write the mesh to this file and do no more");
  CLI11_PARSE(app, argc, argv);
  const absl::Status status = Run(options);
  if (status.ok()) return 0;
  std::fprintf(stderr, "ccst_benchmark_job: %s\n", std::string(status.message()).c_str());
  return 2;
}

}  // namespace
}  // namespace ccst::benchmarks

int main(int argc, char** argv) { return ccst::benchmarks::Main(argc, argv); }
