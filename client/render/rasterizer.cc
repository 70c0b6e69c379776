#include "client/render/rasterizer.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ccst {
namespace {

double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

}  // namespace

VisibilityBuffer Rasterize(std::span<const Eigen::Vector3d> view,
                           std::span<const Eigen::Vector3i> faces, const Camera& camera, int width,
                           int height) {
  VisibilityBuffer buffer;
  buffer.width = width;
  buffer.height = height;
  const std::size_t size = static_cast<std::size_t>(width) * height;
  buffer.triangle.assign(size, -1);
  buffer.depth.assign(size, std::numeric_limits<float>::infinity());

  for (std::size_t f = 0; f < faces.size(); ++f) {
    Eigen::Vector2d p[3];
    double inverse_depth[3];
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d& v = view[faces[f][k]];
      p[k] = camera.ToPixel(v);
      inverse_depth[k] = 1.0 / camera.Depth(v);
    }
    const double area = Cross(p[1] - p[0], p[2] - p[0]);
    if (area == 0.0 || !std::isfinite(area)) continue;
    const auto [x_low, x_high] = std::minmax({p[0].x(), p[1].x(), p[2].x()});
    const auto [y_low, y_high] = std::minmax({p[0].y(), p[1].y(), p[2].y()});
    const int x0 = std::max(0, static_cast<int>(std::ceil(x_low - 0.5)));
    const int x1 = std::min(width - 1, static_cast<int>(std::floor(x_high - 0.5)));
    const int y0 = std::max(0, static_cast<int>(std::ceil(y_low - 0.5)));
    const int y1 = std::min(height - 1, static_cast<int>(std::floor(y_high - 0.5)));
    for (int y = y0; y <= y1; ++y) {
      for (int x = x0; x <= x1; ++x) {
        const Eigen::Vector2d middle(x + 0.5, y + 0.5);
        const double w0 = Cross(p[1] - middle, p[2] - middle) / area;
        const double w1 = Cross(p[2] - middle, p[0] - middle) / area;
        const double w2 = 1.0 - w0 - w1;
        if (w0 < 0.0 || w1 < 0.0 || w2 < 0.0) continue;
        // Inverse depth is what is linear over the picture under perspective.
        const float depth = static_cast<float>(
            1.0 / (w0 * inverse_depth[0] + w1 * inverse_depth[1] + w2 * inverse_depth[2]));
        const std::size_t i = buffer.Index(x, y);
        if (depth < buffer.depth[i]) {
          buffer.depth[i] = depth;
          buffer.triangle[i] = static_cast<std::int32_t>(f);
        }
      }
    }
  }
  return buffer;
}

}  // namespace ccst
