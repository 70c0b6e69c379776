#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "client/render/camera.h"
#include "client/render/rasterizer.h"

namespace ccst {

/// A mesh in the camera's view space.
struct ViewMesh {
  std::vector<Eigen::Vector3d> positions;  ///< V x 3.
  std::vector<Eigen::Vector3f> normals;    ///< V x 3 unit, area weighted; zero where undefined.
  std::span<const Eigen::Vector3i> faces;  ///< F x 3.
};

/// Moves a mesh to view space and gives its vertices normals. Cost O(V + F).
ViewMesh ToViewMesh(std::span<const Eigen::Vector3d> positions,
                    std::span<const Eigen::Vector3i> faces, const Camera& camera);

/// Colour in linear light, each channel in [0, 1].
using Color = Eigen::Vector3f;

/// What a panel shows besides its surface.
struct ShadingStyle {
  Color surface = Color::Constant(0.7f);  ///< Reflectance.
  bool smooth = true;                     ///< Interpolate normals (creases stay sharp).
  Color line = Color::Zero();             ///< Colour of the edges.
  double line_width = 0.0;                ///< [pixel]; 0 draws no edges.
  double line_opacity = 1.0;              ///< In [0, 1].
};

/// height x width colours of what `buffer` sees: lit from above left, with ambient occlusion from
/// the depths around each pixel; white where nothing is seen. Cost O(pixels).
std::vector<Color> Shade(const ViewMesh& mesh, const VisibilityBuffer& buffer, const Camera& camera,
                         const ShadingStyle& style);

/// Round dots that lie on what `buffer` sees.
struct DotStyle {
  Color color = Color::Zero();
  double radius = 0.0;  ///< In view space.
};

/// Paints over `colors` every seen point within `style.radius` of a sample on the same side of the
/// surface. @param view, normals  n x 3 in view space. Cost O(n + painted pixels).
void PaintDots(std::span<const Eigen::Vector3d> view, std::span<const Eigen::Vector3d> normals,
               const ViewMesh& mesh, const VisibilityBuffer& buffer, const Camera& camera,
               const DotStyle& style, std::vector<Color>& colors);

}  // namespace ccst
