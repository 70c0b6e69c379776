#pragma once

#include "absl/status/statusor.h"
#include "client/render/image.h"
#include "core/mesh/triangle_mesh.h"
#include "core/sampling/sampling.h"

namespace ccst {

/// How a picture is drawn.
struct PictureOptions {
  int width = 1600;       ///< [pixel], in [16, 16384]; two panels side by side share it.
  int height = 800;       ///< [pixel], in [16, 16384].
  int supersampling = 3;  ///< Sub-pixels along each side of a pixel, in [1, 8].
};

/// Draws samples on their surface (left) and the sample mesh with its edges (right), both from one
/// three-quarter view on white. Dots lie on the surface: what hides the surface hides them.
///
/// @param surface  positions finite, indices in range, at least one face.
/// @param samples  positions and normals on `surface`, triangles over them (may be empty).
/// @return an image of options.width x options.height.
/// @errors INVALID_ARGUMENT naming the option, index or coordinate that is out of range.
/// Cost O(F + n + pixels); about 100 bytes of memory a pixel. Equal arguments give equal bytes.
absl::StatusOr<RgbImage> RenderPicture(const TriangleMesh& surface, const SampleSet& samples,
                                       const PictureOptions& options = {});

}  // namespace ccst
