#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <string_view>
#include <variant>

#include "core/base/printable_text.h"
#include "server/app/command_line.h"
#include "server/app/library_log.h"
#include "server/app/server.h"
#include "server/app/signals.h"
#include "server/app/standard_streams.h"
#include "server/app/system.h"
#include "server/app/thread_limits.h"
#include "server/net/descriptor_limit.h"

namespace {

using ccst::server::CheckThreads;
using ccst::server::Done;
using ccst::server::FinishLog;
using ccst::server::ParseCommandLine;
using ccst::server::Server;
using ccst::server::ServerOptions;
using ccst::server::ShareHeaps;
using ccst::server::Signals;
using ccst::server::ThreadsOf;

constexpr int kUsageError = 1;
constexpr int kCannotListen = 2;

int Fail(const absl::Status& status) {
  FinishLog();
  const std::string_view message(status.message().data(), status.message().size());
  std::fprintf(stderr, "ccst-server: %s\n", ccst::PrintableText(message).c_str());
  return absl::IsUnavailable(status) ? kCannotListen : kUsageError;
}

int Run(int argc, char** argv) {
  const auto command = ParseCommandLine(argc, argv);
  if (const auto* done = std::get_if<Done>(&command)) return done->exit_code;
  const auto& options = std::get<ServerOptions>(command);
  ShareHeaps();
  if (const absl::Status status = CheckThreads(ThreadsOf(options)); !status.ok()) {
    return Fail(status);
  }
  ccst::server::LogLibraryErrors(options.log_format);
  ccst::server::RaiseDescriptorLimit();
  Signals signals;
  auto server = Server::Start(options, Server::RealDependencies(options));
  if (!server.ok()) return Fail(server.status());
  std::printf("listening on %s\n", (*server)->address().c_str());
  if (!(*server)->metrics_address().empty()) {
    std::printf("metrics on %s\n", (*server)->metrics_address().c_str());
  }
  std::fflush(stdout);
  signals.Wait();
  (*server)->Drain();
  *server = nullptr;
  FinishLog();
  return EXIT_SUCCESS;
}

}  // namespace

int main(int argc, char** argv) {
  ccst::server::SecureStandardStreams(argv);
  try {
    return Run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "ccst-server: %s\n", ccst::PrintableText(error.what()).c_str());
    return EXIT_FAILURE;
  }
}
