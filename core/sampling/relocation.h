#pragma once

#include <cstdint>
#include <vector>

#include "core/sampling/edge_flips.h"
#include "core/sampling/geometry_phase.h"
#include "core/sampling/plan.h"
#include "core/sampling/sample_mesh.h"
#include "core/sampling/samples.h"
#include "core/surface/surface.h"

namespace ccst {

/// What counts as a defect that moves and flips do not mend.
struct DefectLimits {
  double least_facing = 0.0;      ///< A triangle below this cosine is turned over.
  double least_separation = 0.6;  ///< Of samples on one side, over the spacing.
  int reach = 0;  ///< Separation is asked of samples up to this many edges apart; 0: of the two
                  ///< opposite an edge only.
  double least_angle = 0.0;       ///< Of a triangle [rad].
  /// Of an interior vertex's valence from the one its total angle asks for, 3 / pi times the angle:
  /// 6 where the surface is flat, fewer at a tip.
  double most_excess = 1000.0;
};

/// Samples that are part of a defect, at most one per defect, in index order: interior ones only.
/// Two samples are on one side when the normals of their hosts are less than 90 degrees apart;
/// samples far apart along the mesh are not compared, for close sheets are no defect.
/// Cost O(n reach^2).
std::vector<std::int32_t> FindDefects(const Surface& surface, const Plan& plan,
                                      const SampleMesh& mesh, const Samples& samples,
                                      const DefectLimits& limits);

/// Takes each of `crowded` out of the sample mesh and puts it into one of the triangles of
/// largest capacity, so that the count stays exact. Samples whose removal would change the
/// topology stay. @return how many moved.
std::int64_t Relocate(const std::vector<std::int32_t>& crowded, const Surface& surface,
                      GeometryPhase* geometry, EdgeFlips* flips, SampleMesh* mesh,
                      Samples* samples);

}  // namespace ccst
