#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "absl/status/statusor.h"
#include "core/base/interrupt.h"
#include "core/sampling/mesh/sample_mesh.h"

namespace ccst::internal {

/// Removes the vertices from `keep` on by collapsing each into a neighbour, keeping the topology.
/// Rounds over sets of vertices with disjoint rings, so that no part is thinned out long before
/// another; in each, a vertex goes where the resulting triangles have the best shape and face the
/// surface. Vertices that cannot go well wait for a later round with a lower demand.
/// @param position, normal  per vertex. @param mesh  live triangles over all of them.
/// @return the vertices that could not be removed; none unless some component has hardly as many
///         samples as its topology needs. @errors CANCELLED when `interrupt` was requested.
absl::StatusOr<std::vector<std::int32_t>> RemoveVertices(
    std::int32_t keep, const std::vector<Eigen::Vector3d>& position,
    const std::vector<Eigen::Vector3d>& normal, Interrupt* interrupt, SampleMesh* mesh);

}  // namespace ccst::internal
