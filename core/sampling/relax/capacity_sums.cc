#include "core/sampling/relax/capacity_sums.h"

#include <algorithm>

#include "core/sampling/relax/lanes.h"

namespace ccst::internal {
namespace {

/// Triangles summed in single precision before their sum is added in double.
constexpr std::int32_t kRun = 256;

CCST_INLINE double Total(const Lanes& a) {
  double total = 0.0;
  for (int k = 0; k < kLanes; ++k) total += static_cast<double>(a[k]);
  return total;
}

/// c - 1 of triangles `first` to `first` + 7, 0 from `end` on.
CCST_INLINE Lanes Apart(const CapacitySources& sources, std::int32_t first, std::int32_t end) {
  Row p[kLanes];
  Row q[kLanes];
  Lanes factor;  // c over |cross product|.
  Choice live;
  for (int k = 0; k < kLanes; ++k) {
    const std::int32_t t = std::min(first + k, end - 1);
    const std::int32_t* corner = sources.origins + 3 * static_cast<std::ptrdiff_t>(t);
    const auto base = LoadAs<LongRow>(&sources.places[corner[0]]);
    p[k] = __builtin_convertvector(LoadAs<LongRow>(&sources.places[corner[1]]) - base, Row);
    q[k] = __builtin_convertvector(LoadAs<LongRow>(&sources.places[corner[2]]) - base, Row);
    factor[k] = static_cast<float>(0.5 * sources.scales[sources.components[corner[0]]]);
    if (sources.densities != nullptr) factor[k] *= sources.densities[t];
    live[k] = -static_cast<int>(first + k < end);
  }
  const Lanes3 cross = Cross(Transposed(p), Transposed(q));
  return Masked(live, factor * Sqrt(Dot(cross, cross)) - 1.0F);
}

CCST_INLINE CapacitySums SumIn(const CapacitySources& sources, std::int32_t first,
                               std::int32_t end) {
  CapacitySums sums;
  for (std::int32_t run = first; run < end; run += kRun) {
    Lanes apart = {};
    Lanes square = {};
    for (std::int32_t t = run; t < std::min(run + kRun, end); t += kLanes) {
      const Lanes one = Apart(sources, t, end);
      apart += one;
      square += one * one;
    }
    sums.apart += Total(apart);
    sums.square += Total(square);
  }
  return sums;
}

CCST_AVX2 CapacitySums SumWide(const CapacitySources& sources, std::int32_t first,
                               std::int32_t end) {
  return SumIn(sources, first, end);
}

}  // namespace

CapacitySums SumCapacities(const CapacitySources& sources, Registers registers, std::int32_t first,
                           std::int32_t end) {
  if (registers == Registers::kAvx2) return SumWide(sources, first, end);
  return SumIn(sources, first, end);
}

}  // namespace ccst::internal
