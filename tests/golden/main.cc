// Records the digests of the golden requests:
//   build/release/bin/ccst_golden tests/golden/digests.txt
// Refuses when samples have changed and kAlgorithmRevision has not.

#include <cstdio>
#include <fstream>
#include <sstream>

#include "core/sampling/algorithm_revision.h"
#include "tests/golden/digest_file.h"
#include "tests/golden/requests.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s DIGEST_FILE\n", argv[0]);
    return 2;
  }
  ccst::golden::DigestFile now;
  now.revision = ccst::kAlgorithmRevision;
  for (const ccst::golden::Request& request : ccst::golden::Requests()) {
    now.digests[request.name] = ccst::golden::DigestOf(request);
  }
  if (std::ifstream in(argv[1]); in) {
    std::stringstream text;
    text << in.rdbuf();
    const auto recorded = ccst::golden::ParseDigestFile(text.str());
    const std::string problem =
        recorded.ok() ? FindSilentChange(*recorded, now) : std::string(recorded.status().message());
    if (!problem.empty()) {
      std::fprintf(stderr, "%s: %s\n", argv[1], problem.c_str());
      return 1;
    }
  }
  std::ofstream out(argv[1]);
  out << FormatDigestFile(now) << std::flush;
  if (!out) {
    std::fprintf(stderr, "%s cannot be written\n", argv[1]);
    return 1;
  }
  std::printf("%zu digests of revision %d\n", now.digests.size(), now.revision);
  return 0;
}
