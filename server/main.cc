#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <variant>

#include "server/app/command_line.h"
#include "server/app/server.h"
#include "server/app/signals.h"
#include "server/app/transport_log.h"

namespace {

using ccst::server::Done;
using ccst::server::ParseCommandLine;
using ccst::server::Server;
using ccst::server::ServerOptions;
using ccst::server::Signals;

constexpr int kUsageError = 1;
constexpr int kCannotListen = 2;

int Run(int argc, char** argv) {
  const auto command = ParseCommandLine(argc, argv);
  if (const auto* done = std::get_if<Done>(&command)) return done->exit_code;
  const auto& options = std::get<ServerOptions>(command);
  ccst::server::LogTransportErrors(options.log_format);
  Signals signals;
  auto server = Server::Start(options, Server::RealDependencies(options));
  if (!server.ok()) {
    std::fprintf(stderr, "ccst-server: %s\n", std::string(server.status().message()).c_str());
    return absl::IsUnavailable(server.status()) ? kCannotListen : kUsageError;
  }
  std::printf("listening on %s\n", (*server)->address().c_str());
  if (!(*server)->metrics_address().empty()) {
    std::printf("metrics on %s\n", (*server)->metrics_address().c_str());
  }
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
