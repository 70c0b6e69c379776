#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/base/interrupt.h"
#include "core/density/density.h"
#include "core/density/share_out.h"
#include "core/methods/capacity_curve.h"
#include "core/random/random.h"

namespace ccst {

/// Cuts each component into intervals of equal capacity along the curve, `parts` times as many as
/// its share of `count`, and calls visit(point) with a random point of each, in order. Ends early
/// when `interrupt` is requested.
template <class Visit>
void ForEachStratum(const Density& density, const CapacityCurve& curve, std::int64_t count,
                    std::int64_t parts, const CounterRandom& random, Interrupt* interrupt,
                    Visit&& visit) {
  const std::vector<std::int64_t> shares = ShareOut(count, density.component_capacities());
  std::int64_t i = 0;
  for (std::size_t c = 0; c < shares.size(); ++c) {
    const double begin = curve.ComponentBegin(static_cast<std::int32_t>(c));
    const double end = curve.ComponentBegin(static_cast<std::int32_t>(c) + 1);
    const double stratum = (end - begin) / static_cast<double>(shares[c] * parts);
    for (std::int64_t k = 0; k < shares[c] * parts; ++k, ++i) {
      if (interrupt->RequestedAt(i)) return;
      const double along = (static_cast<double>(k) + random.Uniform(i)) * stratum;
      visit(curve.At(std::min(begin + along, end)));
    }
  }
}

/// `site` moved to the point of the surface for `centroid`; as it is when that is no closer.
inline SurfacePoint MoveTo(const Surface& surface, const SurfacePoint& site,
                           const Eigen::Vector3d& centroid) {
  const SurfacePoint moved = surface.Follow(site.face, centroid);
  return (moved.position - centroid).squaredNorm() < (site.position - centroid).squaredNorm()
             ? moved
             : site;
}

}  // namespace ccst
