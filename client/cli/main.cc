#include <cstdio>
#include <cstdlib>
#include <exception>
#include <variant>

#include "client/cli/commands.h"
#include "client/cli/exit_code.h"
#include "client/cli/flags.h"

int main(int argc, char** argv) {
  try {
    const ccst::cli::Command command =
        ccst::cli::ParseCommandLine(argc, argv, std::getenv("CCST_SERVER"));
    if (const auto* sample = std::get_if<ccst::cli::SampleCommand>(&command))
      return ccst::cli::RunSample(*sample);
    if (const auto* info = std::get_if<ccst::cli::InfoCommand>(&command))
      return ccst::cli::RunInfo(*info);
    return std::get<ccst::cli::Done>(command).exit_code;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "ccst: %s\n", error.what());
    return ccst::cli::kFailed;
  }
}
