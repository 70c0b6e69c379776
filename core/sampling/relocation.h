#pragma once

#include <cstdint>
#include <vector>

#include "core/sampling/edge_flips.h"
#include "core/sampling/geometry_phase.h"
#include "core/sampling/sample_mesh.h"
#include "core/sampling/samples.h"
#include "core/surface/surface.h"

namespace ccst {

/// What counts as a defect that moves and flips do not mend.
struct DefectLimits {
  double least_facing = 0.0;      ///< A triangle below this cosine is turned over.
  double least_separation = 0.6;  ///< Of samples on one side, over the local spacing.
  double least_angle = 0.0;       ///< Of a triangle [rad].
};

/// Samples that are part of a defect, at most one per defect, in index order: interior ones only.
std::vector<std::int32_t> FindDefects(const SampleMesh& mesh, const Samples& samples,
                                      const DefectLimits& limits);

/// Takes each of `crowded` out of the sample mesh and puts it into one of the triangles of
/// largest capacity, so that the count stays exact. Samples whose removal would change the
/// topology stay. @return how many moved.
std::int64_t Relocate(const std::vector<std::int32_t>& crowded, const Surface& surface,
                      GeometryPhase* geometry, EdgeFlips* flips, SampleMesh* mesh,
                      Samples* samples);

}  // namespace ccst
