#pragma once

#include <cstdint>

#include "absl/status/statusor.h"
#include "core/base/interrupt.h"
#include "core/density/density.h"
#include "core/parallel/parallel.h"
#include "core/sampling/mesh/samples.h"
#include "core/sampling/start/plan.h"
#include "core/surface/surface.h"

namespace ccst::internal {

/// Draws the initial samples: boundary samples where the plan puts them, then interior ones
/// by capacity. The capacity is cut into as many equal strata as there are samples, along the faces
/// in their order, which is that of SortFaces(), and a quadtree inside each, with one sample drawn
/// in each stratum: every region gets its share from the start, and neighbours in memory are
/// neighbours in space.
/// On a component that gets points all are drawn at the same place of their strata, which keeps
/// them apart. Samples are ordered by component; within one, interior ones along the curve, then
/// boundary ones loop by loop.
/// @errors CANCELLED when `interrupt` was requested. Cost O(F + n); the same on any number of
/// threads.
absl::StatusOr<Samples> DrawInitialPoints(const Surface& surface, const Density& density,
                                          const Plan& plan, std::uint64_t seed,
                                          Interrupt* interrupt,
                                          const Parallel& parallel = Parallel());

}  // namespace ccst::internal
