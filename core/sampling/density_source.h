#pragma once

#include "absl/status/statusor.h"
#include "core/density/density.h"
#include "core/mesh/triangle_mesh.h"
#include "core/sampling/sampling.h"
#include "core/sampling/source_map.h"
#include "core/surface/surface.h"

namespace ccst {

/// OPTION_INVALID naming the first field of `options` that is out of its range; an image that is
/// yet to be decoded will do.
absl::Status ValidateDensity(const DensityOptions& options);

/// The density that `options` ask for on `surface`, whose faces lie on those of `mesh` as `sources`
/// says.
/// Curvatures are averaged over three rings; those beyond their 99th percentile by area are cut off
/// there: at a crease they measure the mesh instead of the shape, and contrast is counted from the
/// largest.
/// @errors INVALID_ARGUMENT DENSITY_INVALID: no such attribute or no texture coordinates (names
///         those there are), a value that is negative or not finite, zero everywhere.
/// Cost O(F), and O(pixels) for an image.
absl::StatusOr<Density> MakeDensity(const TriangleMesh& mesh, const SourceMap& sources,
                                    const Surface& surface, const DensityOptions& options);

}  // namespace ccst
