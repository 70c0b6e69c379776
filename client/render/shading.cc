#include "client/render/shading.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include <Eigen/Geometry>

namespace ccst {
namespace {

constexpr float kCreaseCosine = 0.84f;     // A corner further than 33 degrees off is a crease.
constexpr float kOcclusionRadius = 0.11f;  // In view space: about a tenth of the object.
constexpr float kOcclusionBias = 0.004f;   // Depths are flat within a pixel.
constexpr int kOcclusionTaps = 6;          // A sub-pixel.
constexpr float kOcclusionStrength = 4.75f;

std::uint32_t Hash(std::uint32_t x, std::uint32_t y) {
  std::uint32_t h = x * 0x9E3779B1u ^ (y * 0x85EBCA77u + 0x165667B1u);
  h ^= h >> 15;
  h *= 0x2C1B3C6Du;
  h ^= h >> 12;
  h *= 0x297A2D39u;
  return h ^ (h >> 15);
}

Eigen::Vector3f FaceNormal(const ViewMesh& mesh, int f) {
  const Eigen::Vector3i& t = mesh.faces[f];
  const Eigen::Vector3d& a = mesh.positions[t[0]];
  return (mesh.positions[t[1]] - a).cross(mesh.positions[t[2]] - a).normalized().cast<float>();
}

// Weights of the corners of face `f` at the point where the ray through `pixel` meets it.
Eigen::Vector3d Weights(const ViewMesh& mesh, int f, const Camera& camera,
                        const Eigen::Vector2d& pixel) {
  const Eigen::Vector3i& t = mesh.faces[f];
  const Eigen::Vector3d ray = camera.Unproject(pixel, 1.0) - camera.eye();
  const Eigen::Vector3d a = mesh.positions[t[0]] - camera.eye();
  const Eigen::Vector3d b = mesh.positions[t[1]] - camera.eye();
  const Eigen::Vector3d c = mesh.positions[t[2]] - camera.eye();
  const Eigen::Vector3d w(ray.dot(b.cross(c)), ray.dot(c.cross(a)), ray.dot(a.cross(b)));
  const double sum = w.sum();
  if (sum == 0.0) return Eigen::Vector3d::Constant(1.0 / 3.0);
  return w / sum;
}

// Normal at a seen point, turned towards the viewer.
Eigen::Vector3f NormalAt(const ViewMesh& mesh, int f, const Eigen::Vector3d& weights, bool smooth,
                         const Eigen::Vector3f& to_eye) {
  const Eigen::Vector3f flat = FaceNormal(mesh, f);
  Eigen::Vector3f normal = flat;
  if (smooth) {
    normal.setZero();
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3f& corner = mesh.normals[mesh.faces[f][k]];
      normal += static_cast<float>(weights[k]) * (corner.dot(flat) > kCreaseCosine ? corner : flat);
    }
    normal.normalize();
  }
  return flat.dot(to_eye) < 0.0f ? Eigen::Vector3f(-normal) : normal;
}

// Scalable ambient obscurance (McGuire, Mara, Luebke, HPG 2012): share of the sky over `point`
// that the depths around it leave open. The pattern turns from sub-pixel to sub-pixel, so that
// averaging them removes the noise.
float OpenSky(const VisibilityBuffer& buffer, const Camera& camera, int x, int y,
              const Eigen::Vector3d& point, const Eigen::Vector3f& normal) {
  constexpr float kGoldenCosine = -0.7373688f;  // Of the golden angle: evenly spread taps.
  constexpr float kGoldenSine = 0.6754903f;
  constexpr float kRadius2 = kOcclusionRadius * kOcclusionRadius;
  const float pixels = static_cast<float>(camera.PixelsPerUnit(camera.Depth(point)));
  const float reach = kOcclusionRadius * pixels;
  const std::uint32_t hash = Hash(x, y);
  const float turn = 2.0f * std::numbers::pi_v<float> * (hash & 0xFFFF) / 65536.0f;
  const float shift = (hash >> 16) / 65536.0f;
  Eigen::Vector2f direction(std::cos(turn), std::sin(turn));
  float sum = 0.0f;
  for (int i = 0; i < kOcclusionTaps; ++i) {
    const float distance = reach * (i + shift) / kOcclusionTaps;
    const int u = static_cast<int>(x + 0.5f + distance * direction.x());
    const int v = static_cast<int>(y + 0.5f + distance * direction.y());
    direction = {kGoldenCosine * direction.x() - kGoldenSine * direction.y(),
                 kGoldenSine * direction.x() + kGoldenCosine * direction.y()};
    if (u < 0 || v < 0 || u >= buffer.width || v >= buffer.height) continue;
    const float depth = buffer.depth[buffer.Index(u, v)];
    if (std::isinf(depth)) continue;
    const Eigen::Vector3f offset =
        (camera.Unproject({u + 0.5, v + 0.5}, depth) - point).cast<float>();
    const float d2 = offset.squaredNorm();
    const float falloff = std::max(0.0f, kRadius2 - d2) / kRadius2;
    sum += falloff * falloff * falloff * std::max(0.0f, offset.dot(normal) - kOcclusionBias) /
           (d2 + 1e-3f * kRadius2);
  }
  const float blocked = kOcclusionStrength * kOcclusionRadius * sum;
  return std::max(0.0f, 1.0f - blocked / kOcclusionTaps);
}

float Power4(float x) { return x * x * x * x; }

Color Light(const Color& surface, const Eigen::Vector3f& normal, const Eigen::Vector3f& to_eye,
            float open_sky) {
  static const Eigen::Vector3f kKey = Eigen::Vector3f(-0.45f, 0.65f, 0.62f).normalized();
  static const Eigen::Vector3f kFill = Eigen::Vector3f(0.75f, 0.1f, 0.55f).normalized();
  // Wrapped diffuse light keeps the shadow side readable.
  const float key = std::max(0.0f, (normal.dot(kKey) + 0.25f) / 1.25f);
  const float fill = std::max(0.0f, (normal.dot(kFill) + 0.4f) / 1.4f);
  const float sky = 0.5f + 0.5f * normal.y();
  const Color ambient = Color(0.30f, 0.29f, 0.28f) + sky * Color(0.13f, 0.145f, 0.17f);
  const Color direct = key * Color(0.62f, 0.60f, 0.57f) + fill * Color(0.12f, 0.13f, 0.15f);
  const float glancing = Power4(1.0f - std::clamp(normal.dot(to_eye), 0.0f, 1.0f));
  const Eigen::Vector3f half = (kKey + to_eye).normalized();
  const float gloss = 0.06f * std::pow(std::max(0.0f, normal.dot(half)), 40.0f);
  const float direct_open = 0.45f + 0.55f * open_sky;
  const Color lit = surface.cwiseProduct(ambient * open_sky + direct * direct_open);
  return (lit * (1.0f - 0.25f * glancing) + Color::Constant(gloss * direct_open)).cwiseMin(1.0f);
}

// Distance in pixels from `pixel` to the nearest edge of the drawn face `f`.
double EdgeDistance(const ViewMesh& mesh, int f, const Camera& camera,
                    const Eigen::Vector2d& pixel) {
  Eigen::Vector2d p[3];
  for (int k = 0; k < 3; ++k) p[k] = camera.ToPixel(mesh.positions[mesh.faces[f][k]]);
  double nearest = 1e300;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector2d edge = p[(k + 1) % 3] - p[k];
    const Eigen::Vector2d to = pixel - p[k];
    const double length = edge.norm();
    if (length > 0.0) {
      nearest = std::min(nearest, std::abs(edge.x() * to.y() - edge.y() * to.x()) / length);
    }
  }
  return nearest;
}

// Share of a pixel at signed distance `d` outside an edge that the inside covers.
float Coverage(double d) { return static_cast<float>(std::clamp(0.5 - d, 0.0, 1.0)); }

}  // namespace

ViewMesh ToViewMesh(std::span<const Eigen::Vector3d> positions,
                    std::span<const Eigen::Vector3i> faces, const Camera& camera) {
  ViewMesh mesh;
  mesh.faces = faces;
  mesh.positions.reserve(positions.size());
  for (const Eigen::Vector3d& p : positions) mesh.positions.push_back(camera.ToView(p));
  mesh.normals.assign(positions.size(), Eigen::Vector3f::Zero());
  for (const Eigen::Vector3i& t : faces) {
    const Eigen::Vector3d& a = mesh.positions[t[0]];
    const Eigen::Vector3f weighted =
        (mesh.positions[t[1]] - a).cross(mesh.positions[t[2]] - a).cast<float>();
    for (int k = 0; k < 3; ++k) mesh.normals[t[k]] += weighted;
  }
  for (Eigen::Vector3f& n : mesh.normals) n.normalize();
  return mesh;
}

std::vector<Color> Shade(const ViewMesh& mesh, const VisibilityBuffer& buffer, const Camera& camera,
                         const ShadingStyle& style) {
  std::vector<Color> colors(buffer.triangle.size(), Color::Ones());
  for (int y = 0; y < buffer.height; ++y) {
    for (int x = 0; x < buffer.width; ++x) {
      const std::size_t i = buffer.Index(x, y);
      const int f = buffer.triangle[i];
      if (f < 0) continue;
      const Eigen::Vector2d pixel(x + 0.5, y + 0.5);
      const Eigen::Vector3d point = camera.Unproject(pixel, buffer.depth[i]);
      const Eigen::Vector3f to_eye = (camera.eye() - point).normalized().cast<float>();
      const Eigen::Vector3f normal =
          NormalAt(mesh, f, Weights(mesh, f, camera, pixel), style.smooth, to_eye);
      Color color =
          Light(style.surface, normal, to_eye, OpenSky(buffer, camera, x, y, point, normal));
      if (style.line_width > 0.0) {
        // Each of the two faces at an edge draws its half of the line.
        const double d = EdgeDistance(mesh, f, camera, pixel) - 0.5 * style.line_width;
        const float share = Coverage(d) * static_cast<float>(style.line_opacity);
        color = (1.0f - share) * color + share * style.line;
      }
      colors[i] = color;
    }
  }
  return colors;
}

void PaintDots(std::span<const Eigen::Vector3d> view, std::span<const Eigen::Vector3d> normals,
               const ViewMesh& mesh, const VisibilityBuffer& buffer, const Camera& camera,
               const DotStyle& style, std::vector<Color>& colors) {
  for (std::size_t s = 0; s < view.size(); ++s) {
    const Eigen::Vector3d& center = view[s];
    const double scale = camera.PixelsPerUnit(camera.Depth(center));
    const double reach = style.radius * scale + 1.5;
    const Eigen::Vector2d p = camera.ToPixel(center);
    if (!p.allFinite()) continue;
    const int x0 = std::max(0, static_cast<int>(std::floor(p.x() - reach)));
    const int x1 = std::min(buffer.width - 1, static_cast<int>(std::ceil(p.x() + reach)));
    const int y0 = std::max(0, static_cast<int>(std::floor(p.y() - reach)));
    const int y1 = std::min(buffer.height - 1, static_cast<int>(std::ceil(p.y() + reach)));
    const Eigen::Vector3f side = normals[s].cast<float>();
    for (int y = y0; y <= y1; ++y) {
      for (int x = x0; x <= x1; ++x) {
        const std::size_t i = buffer.Index(x, y);
        if (buffer.triangle[i] < 0) continue;
        const Eigen::Vector3d seen = camera.Unproject({x + 0.5, y + 0.5}, buffer.depth[i]);
        const double outside = ((seen - center).norm() - style.radius) * scale;
        if (outside > 0.5) continue;
        // The other sheet of a thin part may be as near, but faces the other way.
        if (FaceNormal(mesh, buffer.triangle[i]).dot(side) < 0.0f) continue;
        const float share = Coverage(outside);
        colors[i] = (1.0f - share) * colors[i] + share * style.color;
      }
    }
  }
}

}  // namespace ccst
