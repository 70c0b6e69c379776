#pragma once

#include <cstdint>
#include <vector>

#include "core/base/interrupt.h"
#include "core/sampling/mesh/edge_flips.h"
#include "core/sampling/relax/coverage.h"
#include "core/sampling/relax/defects.h"
#include "core/sampling/relax/geometry_phase.h"
#include "core/surface/projection.h"
#include "core/surface/surface.h"

namespace ccst::internal {

/// Takes the sample of each defect out of the sample mesh and puts it where it is wanted: onto an
/// uncovered place or into one of the triangles of largest capacity. The count stays exact. Samples
/// whose removal would change the topology stay. When there are more uncovered places than defects,
/// the samples with the least room go too. Ends early, every sample either moved or not, when
/// `interrupt` is requested.
/// @param geometry  whose samples and mesh they are. @param flips  made by its PackedSamples.
/// @return how many moved.
std::int64_t Relocate(const std::vector<Defect>& defects,
                      const std::vector<UncoveredPlace>& uncovered, const Surface& surface,
                      Projection* projection, GeometryPhase* geometry, EdgeFlips* flips,
                      Interrupt* interrupt);

}  // namespace ccst::internal
