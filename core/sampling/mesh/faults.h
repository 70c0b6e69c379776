#pragma once

#include <string>

#include "core/sampling/mesh/sample_mesh.h"
#include "core/sampling/mesh/samples.h"
#include "core/surface/surface.h"

namespace ccst::internal {

// What is wrong with the data that the steps share, for assertions and tests; empty when nothing
// is. Cost O(n).

/// Twins that do not match, vertices that leave through a half-edge of another one or of none,
/// boundary vertices that do not leave through the boundary, vertices whose triangles are not one
/// fan, edges of one vertex, edges locked on one side only.
std::string FindFault(const SampleMesh& mesh);

/// Arrays of different lengths, hosts that are no faces, weights that are none, positions that are
/// not where host and weights say, normals that are no unit vectors.
std::string FindFault(const Samples& samples, const Surface& surface);

}  // namespace ccst::internal
