// Writes the page's description of the options anew:
//   build/release/bin/ccst_option_file client/web/src/job/options.json

#include <cstdio>
#include <fstream>

#include "tests/options/option_file.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s OPTION_FILE\n", argv[0]);
    return 2;
  }
  std::ofstream out(argv[1]);
  out << ccst::OptionFileText() << std::flush;
  if (!out) {
    std::fprintf(stderr, "%s cannot be written\n", argv[1]);
    return 1;
  }
  return 0;
}
