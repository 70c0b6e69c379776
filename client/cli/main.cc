#include <cstdio>
#include <cstdlib>
#include <exception>
#include <variant>

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

}  // namespace

int main(int argc, char** argv) {
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
