#pragma once

#include <cstdint>
#include <vector>

#include "core/base/interrupt.h"
#include "core/density/density.h"
#include "core/parallel/parallel.h"
#include "core/sampling/mesh/sample_mesh.h"
#include "core/sampling/mesh/samples.h"
#include "core/sampling/start/plan.h"
#include "core/surface/surface.h"

namespace ccst::internal {

/// What counts as a defect that moves and flips do not mend.
struct DefectLimits {
  double least_facing = 0.0;      ///< A triangle below this cosine is turned over.
  double least_separation = 0.6;  ///< Of samples on one side, over the spacing.
  bool all_near = false;  ///< Separation is asked of all samples up to two edges apart, else of the
                          ///< two opposite an edge.
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
/// @param interrupt  when requested, the list is unfinished. Cost O(n + scope).
std::vector<Defect> FindDefects(const Surface& surface, const Density& density, const Plan& plan,
                                const SampleMesh& mesh, const Samples& samples,
                                const DefectLimits& limits, const DefectLimits& grave,
                                const std::vector<std::uint8_t>& scope, const Parallel& parallel,
                                Interrupt* interrupt);

/// Orders by sample and keeps one of each, the grave one if there is.
void KeepOneEach(std::vector<Defect>* defects);

/// Sum of the areas of the triangles around `v`, twice. Cost O(valence), as below.
double RingArea(const SampleMesh& mesh, const Samples& samples, std::int32_t v);

/// Cosine of the smallest angle of triangle (a, b, c).
double SmallestAngleCosine(const Samples& samples, std::int32_t a, std::int32_t b, std::int32_t c);

}  // namespace ccst::internal
