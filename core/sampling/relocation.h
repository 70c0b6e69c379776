#pragma once

#include <cstdint>
#include <vector>

#include "core/base/interrupt.h"
#include "core/density/density.h"
#include "core/sampling/coverage.h"
#include "core/sampling/edge_flips.h"
#include "core/sampling/geometry_phase.h"
#include "core/sampling/plan.h"
#include "core/sampling/sample_mesh.h"
#include "core/sampling/samples.h"
#include "core/surface/projection.h"
#include "core/surface/surface.h"

namespace ccst {

/// What counts as a defect that moves and flips do not mend.
struct DefectLimits {
  double least_facing = 0.0;      ///< A triangle below this cosine is turned over.
  double least_separation = 0.6;  ///< Of samples on one side, over the spacing.
  int reach = 0;  ///< Separation is asked of samples up to this many edges apart; 0: of the two
                  ///< opposite an edge only.
  double least_angle = 0.0;  ///< Of a triangle [rad].
  /// Of an interior vertex's valence from the one its total angle asks for, 3 / pi times the angle:
  /// 6 where the surface is flat, fewer at a tip.
  double most_excess = 1000.0;
};

/// A sample that is part of a defect.
struct Defect {
  std::int32_t sample = -1;
  bool grave = false;  ///< Beyond the grave limits too.
};

/// Samples that are part of a defect, in index order, one for each: interior ones only.
/// Two samples are on one side when the normals of their hosts are less than 90 degrees apart;
/// samples far apart along the mesh are not compared, for close sheets are no defect.
/// @param limits, grave  what counts; `grave` is nowhere stricter than `limits`.
/// @param scope  per sample: non-zero where to look.
/// @param interrupt  when requested, the list is unfinished. Cost O(n + scope reach^2).
std::vector<Defect> FindDefects(const Surface& surface, const Density& density, const Plan& plan,
                                const SampleMesh& mesh, const Samples& samples,
                                const DefectLimits& limits, const DefectLimits& grave,
                                const std::vector<std::uint8_t>& scope, Interrupt* interrupt);

/// Takes the sample of each defect out of the sample mesh and puts it where it is wanted: onto an
/// uncovered place or into one of the triangles of largest capacity. The count stays exact. Samples
/// whose removal would change the topology stay. When there are more uncovered places than defects,
/// the samples with the least room go too. Ends early, every sample either moved or not, when
/// `interrupt` is requested. @return how many moved.
std::int64_t Relocate(const std::vector<Defect>& defects,
                      const std::vector<UncoveredPlace>& uncovered, const Surface& surface,
                      Projection* projection, GeometryPhase* geometry, EdgeFlips* flips,
                      Interrupt* interrupt, SampleMesh* mesh, Samples* samples);

}  // namespace ccst
