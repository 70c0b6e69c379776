#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/interleavings/random_client.h"
#include "tests/interleavings/service.h"

namespace ccst::interleavings {

/// What one round does.
struct RoundOptions {
  int clients = 6;          ///< Side by side.
  int calls_a_client = 60;  ///< About so many.
  std::uint64_t seed = 1;
};

/// What came of a round.
struct RoundReport {
  int calls = 0;
  int jobs = 0;
  std::vector<std::string> faults;
};

/// Lets clients work side by side on `service`, which is empty, then asks whether all that was
/// acknowledged is there, as it was said to be, and nothing else; the same after a restart; and
/// when everything is deleted, whether nothing is left. It leaves the service empty.
RoundReport RunRound(Service& service, const Workload& workload, const RoundOptions& options);

}  // namespace ccst::interleavings
