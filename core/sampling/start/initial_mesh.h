#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/interrupt.h"
#include "core/parallel/parallel.h"
#include "core/sampling/mesh/sample_mesh.h"
#include "core/sampling/mesh/samples.h"
#include "core/sampling/start/plan.h"
#include "core/surface/surface.h"

namespace ccst::internal {

/// Triangulates the initial samples with the topology of the surface by construction: inserts
/// them into the surface's own faces, then removes the surface's vertices by collapses that pass
/// the link condition, best-shaped first, flipping towards Delaunay as it goes. Loops the plan
/// closes are filled by a fan first. Components that get points stay without triangles.
/// @param failed  filled with the components where vertices remain that cannot be removed, which
///                stay without triangles too; null: that is an error.
/// @return a mesh over samples.count() vertices, triangles in the spatial order of the samples.
/// @errors INVALID_ARGUMENT COUNT_TOO_SMALL when such vertices remain and `failed` is null;
///         CANCELLED when `interrupt` was requested.
/// Cost O(F + n) expected. Source: core/docs/algorithm.md; the paper uses the Crust algorithm
/// (section 3.2), which needs a dense sample.
absl::StatusOr<SampleMesh> BuildInitialMesh(const Surface& surface, const Plan& plan,
                                            const Samples& samples, Interrupt* interrupt,
                                            std::vector<std::int32_t>* failed = nullptr,
                                            const Parallel& parallel = Parallel());

}  // namespace ccst::internal
