#pragma once

#include <algorithm>

namespace ccst::server {

/// Threads that decode the meshes of so many running jobs: a second one each, for decoders that
/// stopped jobs leave behind, but not beyond what decoding needs.
inline int DecodingThreads(int running_jobs) {
  constexpr int kMost = 16;
  return std::min(2 * running_jobs, kMost);
}

}  // namespace ccst::server
