// Samples the test meshes and holds every result against the floors.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <exception>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>

#include "core/io/mesh_file.h"
#include "tests/figures/floors.h"
#include "tests/figures/report.h"

namespace {

using ccst::figures::ReferenceSurface;
using ccst::figures::RunRecord;

const std::vector<std::string> kModels = {
    "paper/kitten_9756.off",
    "paper/eight_7402.off",
    "paper/bunny_6289.off",
    "cad/rocker-arm.obj",
    "textured/spot/spot_triangulated.obj",
    "genus/fertility_6551.off",
    "genus/genus3.off",
    "cad/fandisk.off",
    "scanned/stanford-bunny.obj",
    "open/mannequin-devil.off",
    "stress/unit_square_100x100.off",
    "stress/torus_R1_r0.35.off",
};

struct Options {
  std::string folder;
  std::vector<std::string> models = kModels;
  std::vector<std::int64_t> counts = {2000, 4000, 20000};
  std::vector<std::uint64_t> seeds = {1, 2, 3};
  int jobs = 1;
  int threads = 1;
  bool all_meshes = false;
  bool check_bits = false;
  std::string json_path;
  std::vector<std::string> known;
  std::optional<int> max_iterations;
  std::optional<double> tolerance;
};

struct Model {
  ccst::TriangleMesh mesh;
  std::unique_ptr<ReferenceSurface> surface;
  std::string error;
};

class CountingSink : public ccst::ProgressSink {
 public:
  void OnPhase(ccst::Phase) override {}
  void OnAlternation(const ccst::AlternationReport&) override {}
};

template <class T>
bool SameBits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(static_cast<const void*>(a.data()),
                                   static_cast<const void*>(b.data()), a.size() * sizeof(T)) == 0);
}

bool SameBits(const ccst::SampleSet& a, const ccst::SampleSet& b) {
  return SameBits(a.faces, b.faces) && SameBits(a.barycentrics, b.barycentrics) &&
         SameBits(a.positions, b.positions) && SameBits(a.normals, b.normals) &&
         SameBits(a.triangles, b.triangles);
}

double ThreadCpuSeconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

Model LoadModel(const std::string& path) {
  Model model;
  absl::StatusOr<ccst::MeshFile> file = ccst::ReadMeshFile(path);
  if (!file.ok()) {
    model.error = file.status().ToString();
    return model;
  }
  model.mesh = std::move(file->mesh);
  model.surface = std::make_unique<ReferenceSurface>(model.mesh);
  return model;
}

void Sample(const Model& model, const Options& options, RunRecord& run) {
  run.error = model.error;
  if (!run.error.empty()) return;
  ccst::SamplingOptions sampling;
  sampling.sample_count = run.sample_count;
  sampling.seed = run.seed;
  sampling.thread_count = options.threads;
  if (options.max_iterations) sampling.max_iterations = *options.max_iterations;
  if (options.tolerance) sampling.relative_tolerance = *options.tolerance;

  const double cpu_start = ThreadCpuSeconds();
  const auto start = std::chrono::steady_clock::now();
  const absl::StatusOr<ccst::SamplingResult> result = ccst::SampleSurface(model.mesh, sampling);
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
  run.wall_seconds = wall.count();
  run.cpu_seconds = ThreadCpuSeconds() - cpu_start;
  if (!result.ok()) {
    run.error = result.status().ToString();
    return;
  }
  run.closed_loops = result->surface.closed_loops;
  run.alternations = result->alternations;
  run.passes = result->passes;
  run.termination = result->termination;
  run.prepare_seconds = result->prepare_seconds;
  run.initialise_seconds = result->initialise_seconds;
  run.optimise_seconds = result->optimise_seconds;
  run.figures = ccst::figures::MeasureFigures(model.mesh, *model.surface, result->samples);
  run.misses =
      ccst::figures::FindMisses(run.figures, *model.surface, run.sample_count, run.closed_loops);
  if (options.check_bits) {
    CountingSink sink;
    sampling.thread_count = options.threads == 1 ? 2 : 1;
    const auto again = ccst::SampleSurface(model.mesh, sampling, {.stop = {}, .progress = &sink});
    run.bits_checked = true;
    run.bits_equal = again.ok() && SameBits(result->samples, again->samples);
  }
}

// Runs everything on `options.jobs` threads and prints the rows in the order of `runs`.
void RunAll(const Options& options, const std::map<std::string, Model>& models,
            std::vector<RunRecord>& runs, int model_width) {
  std::mutex mutex;
  std::condition_variable finished;
  std::vector<bool> done(runs.size(), false);
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    for (std::size_t i = next++; i < runs.size(); i = next++) {
      try {
        Sample(models.at(runs[i].model), options, runs[i]);
      } catch (const std::exception& e) {
        runs[i].error = std::string("exception: ") + e.what();
      }
      const std::lock_guard lock(mutex);
      done[i] = true;
      finished.notify_one();
    }
  };
  std::vector<std::jthread> workers;
  for (int job = 0; job < options.jobs; ++job) workers.emplace_back(work);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    std::unique_lock lock(mutex);
    finished.wait(lock, [&] { return done[i]; });
    lock.unlock();
    std::printf("%s\n", ccst::figures::FormatRow(runs[i], model_width).c_str());
    std::fflush(stdout);
  }
}

std::string DefaultFolder() {
  if (const char* folder = std::getenv("CCST_MESHES")) return folder;
  return CCST_SOURCE_DIR "/../shared/meshes";
}

std::vector<std::string> ListMeshes(const std::filesystem::path& folder) {
  std::vector<std::string> paths;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file() && ccst::MeshFormatFromPath(entry.path().string())) {
      paths.push_back(entry.path().lexically_relative(folder).string());
    }
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

int Figures(const Options& options) {
  if (!std::filesystem::is_directory(options.folder)) {
    std::fprintf(stderr, "no mesh folder at %s: set CCST_MESHES or --meshes\n",
                 options.folder.c_str());
    return 2;
  }
  const std::vector<std::string> names =
      options.all_meshes ? ListMeshes(options.folder) : options.models;
  std::map<std::string, Model> models;
  std::vector<RunRecord> runs;
  int model_width = 5;
  for (const std::string& name : names) {
    Model model = LoadModel(options.folder + "/" + name);
    if (options.all_meshes && (!model.error.empty() || !model.surface->topology().IsManifold())) {
      continue;  // Only manifold files were asked for.
    }
    model_width = std::max(model_width, static_cast<int>(name.size()));
    for (const std::int64_t count : options.counts) {
      for (const std::uint64_t seed : options.seeds) {
        RunRecord& run = runs.emplace_back();
        run.model = name;
        run.sample_count = count;
        run.seed = seed;
      }
    }
    models.insert_or_assign(name, std::move(model));
  }

  std::printf("%s\n", ccst::figures::FormatHeader(model_width).c_str());
  RunAll(options, models, runs, model_width);
  const auto held =
      std::count_if(runs.begin(), runs.end(), [](const RunRecord& r) { return r.Holds(); });
  // A known weakness may miss floors of shape; it must still run, and give the same bits.
  const auto excused = std::count_if(runs.begin(), runs.end(), [&](const RunRecord& r) {
    return !r.Holds() && r.error.empty() && r.bits_equal && r.figures.defect.empty() &&
           std::find(options.known.begin(), options.known.end(), r.model) != options.known.end();
  });
  std::map<std::string, int> misses;
  for (const RunRecord& run : runs) {
    for (const std::string& miss : run.misses) ++misses[miss];
    if (!run.error.empty()) ++misses["error"];
    if (!run.bits_equal) ++misses["bits"];
  }
  std::printf("runs %zu, within all floors %td", runs.size(), held);
  if (excused > 0) std::printf(", known weaknesses %td", excused);
  for (const auto& [name, count] : misses) std::printf(", %s missed %d", name.c_str(), count);
  std::printf("\n");

  if (!options.json_path.empty()) {
    std::ofstream json(options.json_path);
    for (const RunRecord& run : runs) json << ccst::figures::FormatJson(run) << "\n";
    if (!json.flush()) {
      std::fprintf(stderr, "cannot write %s\n", options.json_path.c_str());
      return 2;
    }
  }
  return held + excused == static_cast<std::ptrdiff_t>(runs.size()) && !runs.empty() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  options.folder = DefaultFolder();
  CLI::App app(
      "Samples test meshes and holds every result against the floors; lengths are over "
      "r_max (radius, nearest) or in percent of the diagonal (hausdorff, rms), times in "
      "ms. Exit code 1 when a floor is missed, 2 when nothing could be run.");
  app.add_option("--meshes", options.folder, "Folder of the models; default $CCST_MESHES");
  app.add_option("--models", options.models, "Paths below the folder")->delimiter(',');
  app.add_flag("--all-meshes", options.all_meshes, "Every manifold file below the folder");
  app.add_option("--counts", options.counts, "Numbers of samples")->delimiter(',');
  app.add_option("--seeds", options.seeds, "Seeds")->delimiter(',');
  app.add_option("--jobs", options.jobs, "Runs at once")->check(CLI::Range(1, 256));
  app.add_option("--threads", options.threads, "Threads of one run")->check(CLI::Range(1, 256));
  app.add_flag("--bits", options.check_bits,
               "Run again with another number of threads and a listener, and compare the bits");
  app.add_option("--max-iterations", options.max_iterations, "Instead of the default");
  app.add_option("--tolerance", options.tolerance, "Instead of the default");
  app.add_option("--known", options.known,
                 "Models whose missed floors are printed but do not count: known weaknesses")
      ->delimiter(',');
  app.add_option("--json", options.json_path, "Write one JSON object a run to this file");
  CLI11_PARSE(app, argc, argv);
  try {
    return Figures(options);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 2;
  }
}
