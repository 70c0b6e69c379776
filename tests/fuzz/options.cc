// The command line of ccst: arguments are the lines of the input.
#include <string>
#include <vector>

#include "client/cli/flags.h"
#include "tests/fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::vector<std::string> arguments = {"ccst"};
  std::string argument;
  for (std::size_t i = 0; i < size; ++i) {
    if (data[i] == '\n') {
      arguments.push_back(argument);
      argument.clear();
    } else if (data[i] != '\0') {
      argument += static_cast<char>(data[i]);
    }
  }
  if (!argument.empty()) arguments.push_back(argument);
  std::vector<const char*> pointers;
  for (const std::string& a : arguments) pointers.push_back(a.c_str());
  ccst::cli::ParseCommandLine(static_cast<int>(pointers.size()), pointers.data(), nullptr);
  return 0;
}
