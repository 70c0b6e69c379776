#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <string_view>

#include "tests/figures/figures.h"

namespace ccst::figures {

/// What a result on a clean surface must reach; shares in [0, 1], lengths over the diagonal.
struct Floors {
  double max_distance = 1e-6;
  double capacity_cv = 0.05;
  double radius_same_side = 0.62;
  double min_angle = 25.0;  ///< [degree]
  double below_30 = 0.0015;
  double valence_5_7 = 0.995;
  double hausdorff = 0.015;  ///< Infinite where none is stated.
};

/// The floors for `sample_count` samples of `surface`: closed or open, smooth or creased. The
/// Hausdorff distance has one at 4000 samples only.
Floors FloorsFor(const ReferenceSurface& surface, std::int64_t sample_count);

/// Names of the figures (as in the columns of the report) that miss what must hold.
/// @param closed_loops  as the sampler states it.
std::set<std::string, std::less<>> FindMisses(const Figures& figures,
                                              const ReferenceSurface& surface,
                                              std::int64_t sample_count, std::int64_t closed_loops);

}  // namespace ccst::figures
