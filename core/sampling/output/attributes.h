#pragma once

#include <vector>

#include "core/mesh/triangle_mesh.h"
#include "core/sampling/result.h"

namespace ccst::internal {

/// The attributes of `mesh` at the samples, n x K each: linear over the host face, with the weights
/// u, v and 1 - u - v of its corners, computed in doubles and rounded to floats; labels are those
/// of the corner with the largest weight, the first of equals. Names, kinds and ids are those of
/// the mesh. Hosts of `samples` must be faces of `mesh`, whose attributes must pass
/// CheckAttributes(). Cost O(n) for each component.
std::vector<Attribute> InterpolateAttributes(const TriangleMesh& mesh, const SampleSet& samples);

}  // namespace ccst::internal
