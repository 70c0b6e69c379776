#pragma once

#include "absl/status/statusor.h"
#include "core/base/interrupt.h"
#include "core/density/density.h"
#include "core/mesh/triangle_mesh.h"
#include "core/sampling/input/source_map.h"
#include "core/sampling/options.h"
#include "core/surface/surface.h"

namespace ccst::internal {

/// The density that `options` ask for on `surface`, whose faces lie on those of `mesh` as `sources`
/// says.
/// Curvatures are averaged over three rings; those beyond their 99th percentile by area are cut off
/// there: at a crease they measure the mesh instead of the shape, and contrast is counted from the
/// largest.
/// @param interrupt  may be null.
/// @errors INVALID_ARGUMENT DENSITY_INVALID: no such attribute or no texture coordinates (names
///         those there are), a value that is negative or not finite, zero everywhere; those of
///         Interrupt::Error().
/// Cost O(F), and O(pixels) for an image.
absl::StatusOr<Density> MakeDensity(const TriangleMesh& mesh, const SourceMap& sources,
                                    const Surface& surface, const DensityOptions& options,
                                    Interrupt* interrupt = nullptr);

}  // namespace ccst::internal
