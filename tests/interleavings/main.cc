// Clients of chance side by side on a service; says what is not as it was promised.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "core/io/draco_mesh.h"
#include "server/store/store.h"
#include "tests/interleavings/local_service.h"
#include "tests/interleavings/remote_service.h"
#include "tests/interleavings/rounds.h"
#include "tests/support/shapes.h"

namespace ccst::interleavings {
namespace {

struct Flags {
  std::string on = "store";
  std::string server;
  std::vector<std::string> server_flags;
  std::string folder = {};
  double seconds = 20.0;
  int clients = 6;
  int calls = 60;
  std::uint64_t seed = 1;
};

v1::SamplingOptions Options(std::int64_t count, std::uint64_t seed, v1::SamplingMethod method) {
  v1::SamplingOptions options;
  options.set_sample_count(count);
  options.set_seed(seed);
  options.set_method(method);
  return options;
}

// Small ones: the more often they run, the more they meet. The meshes must differ in their faces:
// the digest of samples is of faces and barycentrics, so that equal ones of two sizes would share
// it and yet be two blobs.
void Fill(bool real, Workload& workload) {
  for (int i = 0; i < 2; ++i) {
    workload.meshes.push_back(real ? *EncodeDraco(shapes::Icosphere(1 + i))
                                   : "mesh " + std::to_string(i));
  }
  // Real alternations take time, which calls cannot meet in; those of the bench are reports alone.
  const auto quick = real ? v1::SAMPLING_METHOD_WHITE_NOISE : v1::SAMPLING_METHOD_CCST;
  for (std::uint64_t seed = 0; seed < 2; ++seed) {
    workload.options.push_back(Options(200, seed, quick));
  }
  workload.options.push_back(Options(60, 0, v1::SAMPLING_METHOD_CCST));
}

absl::StatusOr<std::unique_ptr<Service>> Start(const Flags& flags, const Workload& workload) {
  if (flags.on == "store") {
    return LocalService::Start(
        [&flags] { return server::OpenEmbeddedStore(flags.folder + "/data"); }, flags.seed);
  }
  return RemoteService::Start(flags.server, flags.folder, workload.owners, flags.server_flags);
}

int Run(const Flags& flags) {
  Workload workload;
  Fill(flags.on == "server", workload);
  auto service = Start(flags, workload);
  if (!service.ok()) {
    std::printf("FAIL  %s\n", std::string(service.status().message()).c_str());
    return EXIT_FAILURE;
  }
  const auto begin = std::chrono::steady_clock::now();
  RoundReport sum;
  int rounds = 0;
  std::chrono::duration<double> elapsed(0.0);
  while (elapsed.count() < flags.seconds && sum.faults.empty()) {
    const std::uint64_t seed = flags.seed + static_cast<std::uint64_t>(rounds++);
    RoundReport round =
        RunRound(**service, workload,
                 {.clients = flags.clients, .calls_a_client = flags.calls, .seed = seed});
    sum.calls += round.calls;
    sum.jobs += round.jobs;
    sum.faults = std::move(round.faults);
    for (const std::string& fault : sum.faults) {
      std::printf("FAIL  round with --seed %llu: %s\n", static_cast<unsigned long long>(seed),
                  fault.c_str());
    }
    elapsed = std::chrono::steady_clock::now() - begin;
  }
  std::printf("%s  %d rounds of %d clients in %.1f s: %d calls, %d jobs\n",
              sum.faults.empty() ? "ok  " : "FAIL", rounds, flags.clients, elapsed.count(),
              sum.calls, sum.jobs);
  return sum.faults.empty() ? EXIT_SUCCESS : EXIT_FAILURE;
}

// In memory where the system has such a place: synchronizing a disk takes most of the time.
std::string MakeFolder() {
  const std::string memory = "/dev/shm";
  std::string name =
      (std::filesystem::is_directory(memory) ? memory
                                             : std::filesystem::temp_directory_path().string()) +
      "/ccst-interleavings-XXXXXX";
  return mkdtemp(name.data()) == nullptr ? "" : name;
}

}  // namespace
}  // namespace ccst::interleavings

int main(int argc, char** argv) {
  ccst::interleavings::Flags flags;
  CLI::App app(
      "Clients of chance side by side on a service, and whether all holds that it promised.");
  app.add_option("--on", flags.on, "the rooms below the calls, or a server process")
      ->check(CLI::IsMember({"store", "server"}));
  app.add_option("--server", flags.server, "path of ccst-server");
  app.add_option("--server-flag", flags.server_flags, "a further flag of the server, as --a=b");
  app.add_option("--seconds", flags.seconds, "rounds begin for so long");
  app.add_option("--clients", flags.clients, "clients side by side");
  app.add_option("--calls", flags.calls, "calls of a client in a round");
  app.add_option("--seed", flags.seed, "of the first round; each further one has the next");
  CLI11_PARSE(app, argc, argv);
  flags.folder = ccst::interleavings::MakeFolder();
  if (flags.folder.empty()) return EXIT_FAILURE;
  const int code = ccst::interleavings::Run(flags);
  std::filesystem::remove_all(flags.folder);
  return code;
}
