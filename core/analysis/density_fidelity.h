#pragma once

#include <span>

#include "core/density/density.h"
#include "core/surface/surface.h"

namespace ccst::analysis {

/// How far samples are from following a density: root mean square over `patches` patches of equal
/// capacity of (samples there) / (their share of all) - 1. 0 is perfect; white noise has
/// sqrt(patches / n). Patches are stretches of a Hilbert curve through the surface; those cut out
/// of one large face may differ in capacity, which is allowed for.
/// @param density  of `surface`.  @param patches  > 0.  0 without samples.
/// Cost O(F log F + n). Source: the shares per region by which Xu et al. 2012, section 4, show that
/// a density is followed.
double MeasureDensityFidelity(const Surface& surface, const Density& density,
                              std::span<const SurfacePoint> samples, int patches = 64);

}  // namespace ccst::analysis
