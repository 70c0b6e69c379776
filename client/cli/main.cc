#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <thread>
#include <variant>

#include <malloc.h>

#include "client/cli/commands.h"
#include "client/cli/exit_code.h"
#include "client/cli/flags.h"
#include "client/cli/transport_log.h"
#include "core/base/printable_text.h"

namespace {

int Start(const ccst::cli::Done& done) { return done.exit_code; }

template <typename Command>
int Start(const Command& command) {
  return ccst::cli::Run(command);
}

// Tells glibc how many heaps threads may have: as many as it would find itself. It looks when the
// ninth is made, below /sys, and where that is missing, errno is another one afterwards, which gRPC
// 1.51 reads too late after connect(): a call fails that would not have.
void FixNumberOfHeaps() {
  constexpr int kHeapsPerProcessor = 8;
  mallopt(M_ARENA_MAX,
          kHeapsPerProcessor * static_cast<int>(std::max(1U, std::thread::hardware_concurrency())));
}

}  // namespace

int main(int argc, char** argv) {
  FixNumberOfHeaps();
  ccst::cli::EscapeTransportErrors();
  try {
    const ccst::cli::Command command =
        ccst::cli::ParseCommandLine(argc, argv, std::getenv("CCST_SERVER"));
    return std::visit([](const auto& chosen) -> int { return Start(chosen); }, command);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "ccst: %s\n", ccst::PrintableText(error.what()).c_str());
    return ccst::cli::kFailed;
  }
}
