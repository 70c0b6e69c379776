#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <map>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "core/base/version.h"
#include "server/app/server.h"
#include "server/app/server_options.h"
#include "server/app/signals.h"

namespace {

using ccst::server::LogFormat;
using ccst::server::Server;
using ccst::server::ServerOptions;
using ccst::server::Signals;

constexpr int kUsageError = 1;
constexpr int kCannotListen = 2;

// Adds `--name`, also read from CCST_NAME.
template <typename T>
CLI::Option* AddFlag(CLI::App& app, const std::string& name, T& value, const std::string& help) {
  std::string variable = "CCST_" + name;
  for (char& c : variable) {
    c = c == '-' ? '_' : static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  }
  return app.add_option("--" + name, value, help)->envname(variable)->capture_default_str();
}

void AddFlags(CLI::App& app, ServerOptions& options) {
  AddFlag(app, "listen", options.listen, "HOST:PORT to listen on; port 0 picks a free one");
  AddFlag(app, "threads", options.threads_per_job, "Threads a job computes on");
  AddFlag(app, "max-running-jobs", options.runner.max_running_jobs,
          "Jobs that compute at once; by default running x threads is the number of cores");
  AddFlag(app, "max-queued-jobs", options.runner.max_queued_jobs, "Jobs that may wait");
  AddFlag(app, "max-queued-mesh-bytes", options.runner.max_queued_bytes,
          "Bytes of encoded meshes that may wait");
  AddFlag(app, "drain-timeout", options.drain_timeout_seconds,
          "Seconds that jobs may go on after SIGTERM");
  AddFlag(app, "log-format", options.log_format, "text or json, on standard error")
      ->transform(CLI::CheckedTransformer(
          std::map<std::string, LogFormat>{{"text", LogFormat::kText}, {"json", LogFormat::kJson}}))
      ->default_str("text");
  AddFlag(app, "max-inline-mesh-bytes", options.request_limits.max_inline_mesh_bytes,
          "Bytes of an encoded mesh in a request");
  AddFlag(app, "max-texture-bytes", options.request_limits.max_texture_bytes,
          "Bytes of an encoded image in a request");
  AddFlag(app, "max-sample-count", options.request_limits.max_sample_count, "Samples of a job");
  AddFlag(app, "max-vertex-count", options.mesh_limits.max_vertices, "Vertices of a mesh");
  AddFlag(app, "max-face-count", options.mesh_limits.max_faces, "Triangles of a mesh");
  AddFlag(app, "max-iterations", options.request_limits.max_iterations, "Alternations of a job");
  AddFlag(app, "max-job-duration", options.request_limits.max_job_seconds,
          "Seconds that a job may compute");
}

int Run(int argc, char** argv) {
  ServerOptions options;
  CLI::App app(
      "Puts blue-noise samples on triangle meshes, over gRPC (ccst.v1).\n"
      "Every flag can also come from the environment, as CCST_<FLAG>.",
      "ccst-server");
  app.set_version_flag("--version", "ccst-server " + std::string(ccst::ProjectVersion()) + " (" +
                                        std::string(ccst::SourceRevision()) + ")");
  AddFlags(app, options);
  CLI::Option* running = app.get_option("--max-running-jobs");
  running->default_str("cores / threads");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? EXIT_SUCCESS : kUsageError;
  }
  if (running->count() == 0) {
    options.runner.max_running_jobs = ccst::server::DefaultMaxRunningJobs(options.threads_per_job);
  }
  if (const absl::Status status = options.Validate(); !status.ok()) {
    std::fprintf(stderr, "ccst-server: %s\n", std::string(status.message()).c_str());
    return kUsageError;
  }
  Signals signals;
  auto server = Server::Start(options, Server::RealDependencies(options));
  if (!server.ok()) {
    std::fprintf(stderr, "ccst-server: %s\n", std::string(server.status().message()).c_str());
    return kCannotListen;
  }
  std::printf("listening on %s\n", (*server)->address().c_str());
  std::fflush(stdout);
  signals.Wait();
  (*server)->Drain();
  return EXIT_SUCCESS;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return Run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "ccst-server: %s\n", error.what());
    return EXIT_FAILURE;
  }
}
