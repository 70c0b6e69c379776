#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/base/interrupt.h"
#include "core/parallel/parallel.h"
#include "core/sampling/mesh/sample_mesh.h"

namespace ccst::internal {

/// Removes most of the vertices from `keep` on as RemoveVertices() does, block by block on several
/// threads and several times as fast: those that lie inside a block, off boundaries and locked
/// edges, and leave well-shaped triangles; flips edges inside the blocks towards Delaunay as it
/// goes. The rest is for RemoveVertices(). The same on any number of threads.
/// @param block  per vertex: the number >= 0 of its block. Few edges between blocks are best.
/// @param position, normal  per vertex. @param mesh  live triangles over all of them.
/// @param interrupt  when requested, less is removed. Cost O(vertices removed).
void ThinBlocks(std::int32_t keep, const std::vector<std::int32_t>& block,
                const std::vector<Eigen::Vector3d>& position,
                const std::vector<Eigen::Vector3d>& normal, const Parallel& parallel,
                Interrupt* interrupt, SampleMesh* mesh);

}  // namespace ccst::internal
