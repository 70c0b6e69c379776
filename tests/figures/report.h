#pragma once

#include <cstdint>
#include <set>
#include <string>

#include "core/sampling/sampling.h"
#include "tests/figures/figures.h"

namespace ccst::figures {

/// One run of the sampler and what it is worth.
struct RunRecord {
  std::string model;  ///< Path below the mesh folder.
  std::int64_t sample_count = 0;
  std::uint64_t seed = 0;
  std::string error;  ///< Why there is no result; empty when there is one.

  Figures figures;
  std::set<std::string, std::less<>> misses;  ///< Names of the columns that miss.
  std::int64_t closed_loops = 0;
  int alternations = 0;
  std::int64_t passes = 0;
  Termination termination = Termination::kConverged;
  double wall_seconds = 0.0;  ///< Of the call as a whole.
  double cpu_seconds = 0.0;   ///< Of the calling thread: what counts on a busy machine.
  double prepare_seconds = 0.0;
  double initialise_seconds = 0.0;
  double optimise_seconds = 0.0;
  bool bits_checked = false;
  bool bits_equal = true;  ///< With two threads and a listener as with one and none.

  bool Holds() const { return error.empty() && misses.empty() && bits_equal; }
};

/// Headings of the rows, `model_width` characters for the model.
std::string FormatHeader(int model_width);

/// One aligned line; figures that miss end in `*`. Lines that say where follow it when the
/// sample mesh is not manifold or two samples are too close.
std::string FormatRow(const RunRecord& run, int model_width);

/// One JSON object, every figure under its name in `Figures`.
std::string FormatJson(const RunRecord& run);

}  // namespace ccst::figures
