#include "client/render/picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <future>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "client/render/camera.h"
#include "client/render/rasterizer.h"
#include "client/render/shading.h"

namespace ccst {
namespace {

const Color kSurfaceColor(0.80f, 0.78f, 0.74f);
const Color kMeshColor(0.66f, 0.76f, 0.86f);
const Color kDotColor(0.010f, 0.030f, 0.120f);
const Color kLineColor(0.015f, 0.035f, 0.090f);

// In units of the spacing of a hexagonal lattice of as many samples; then bounds in pixels.
constexpr double kDotRadius = 0.2;
constexpr double kMinDotRadius = 0.55;
constexpr double kMaxDotRadius = 9.0;
constexpr double kLineWidth = 0.07;
constexpr double kMinLineWidth = 0.45;
constexpr double kMaxLineWidth = 1.25;

absl::Status CheckRange(const char* name, int value, int low, int high) {
  if (value >= low && value <= high) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("picture ", name, " is ", value, ", want ", low, " to ", high));
}

absl::Status CheckMesh(const char* name, std::span<const Eigen::Vector3d> positions,
                       std::span<const Eigen::Vector3i> faces) {
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (!positions[i].allFinite()) {
      return absl::InvalidArgumentError(absl::StrCat(name, " position ", i, " is not finite"));
    }
  }
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (const int v : faces[f]) {
      if (v < 0 || static_cast<std::size_t>(v) >= positions.size()) {
        return absl::InvalidArgumentError(absl::StrCat(name, " face ", f, " refers to vertex ", v,
                                                       ", but there are ", positions.size()));
      }
    }
  }
  return absl::OkStatus();
}

double Area(const ViewMesh& mesh) {
  double area = 0.0;
  for (const Eigen::Vector3i& t : mesh.faces) {
    const Eigen::Vector3d& a = mesh.positions[t[0]];
    area += 0.5 * (mesh.positions[t[1]] - a).cross(mesh.positions[t[2]] - a).norm();
  }
  return area;
}

std::uint8_t ToSrgb(float linear) {
  const float c = std::clamp(linear, 0.0f, 1.0f);
  const float encoded = c <= 0.0031308f ? 12.92f * c : 1.055f * std::pow(c, 1.0f / 2.4f) - 0.055f;
  return static_cast<std::uint8_t>(std::lround(255.0f * encoded));
}

// Averages factor x factor sub-pixels in linear light into the columns from `left` on.
void Resolve(const std::vector<Color>& colors, int panel_width, int factor, int left,
             RgbImage& image) {
  const std::size_t stride = static_cast<std::size_t>(panel_width) * factor;
  const float scale = 1.0f / static_cast<float>(factor * factor);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < panel_width; ++x) {
      Color sum = Color::Zero();
      for (int v = 0; v < factor; ++v) {
        for (int u = 0; u < factor; ++u) sum += colors[(y * factor + v) * stride + x * factor + u];
      }
      std::uint8_t* out =
          image.rgb.data() + 3 * (static_cast<std::size_t>(y) * image.width + left + x);
      for (int k = 0; k < 3; ++k) out[k] = ToSrgb(scale * sum[k]);
    }
  }
}

// One panel size in sub-pixels and the view both panels share.
struct Scene {
  Camera camera;
  int width;
  int height;
  int factor;
  double spacing;      // Hexagonal spacing of the samples in view space.
  double unit_pixels;  // Sub-pixels a view unit covers in the middle of the object.
};

std::vector<Color> DrawSamples(const ViewMesh& mesh, const SampleSet& samples, const Scene& scene) {
  const VisibilityBuffer buffer =
      Rasterize(mesh.positions, mesh.faces, scene.camera, scene.width, scene.height);
  std::vector<Color> colors =
      Shade(mesh, buffer, scene.camera, {.surface = kSurfaceColor, .smooth = true});
  std::vector<Eigen::Vector3d> view;
  std::vector<Eigen::Vector3d> normals;
  view.reserve(samples.positions.size());
  normals.reserve(samples.positions.size());
  for (std::size_t i = 0; i < samples.positions.size(); ++i) {
    view.push_back(scene.camera.ToView(samples.positions[i]));
    normals.push_back(scene.camera.RotateToView(samples.normals[i]));
  }
  const double pixels = std::clamp(kDotRadius * scene.spacing * scene.unit_pixels,
                                   kMinDotRadius * scene.factor, kMaxDotRadius * scene.factor);
  PaintDots(view, normals, mesh, buffer, scene.camera,
            {.color = kDotColor, .radius = pixels / scene.unit_pixels}, colors);
  return colors;
}

std::vector<Color> DrawSampleMesh(const SampleSet& samples, const Scene& scene) {
  const ViewMesh mesh = ToViewMesh(samples.positions, samples.triangles, scene.camera);
  const VisibilityBuffer buffer =
      Rasterize(mesh.positions, mesh.faces, scene.camera, scene.width, scene.height);
  const double spacing_pixels = scene.spacing * scene.unit_pixels / scene.factor;
  return Shade(mesh, buffer, scene.camera,
               {.surface = kMeshColor,
                .smooth = true,
                .line = kLineColor,
                .line_width = scene.factor *
                              std::clamp(kLineWidth * spacing_pixels, kMinLineWidth, kMaxLineWidth),
                // Where edges crowd into a few pixels full lines would hide the shape.
                .line_opacity = std::clamp(0.25 + 0.05 * spacing_pixels, 0.3, 0.85)});
}

}  // namespace

absl::StatusOr<RgbImage> RenderPicture(const TriangleMesh& surface, const SampleSet& samples,
                                       const PictureOptions& options) {
  for (const absl::Status& status : {CheckRange("width", options.width, 16, 16384),
                                     CheckRange("height", options.height, 16, 16384),
                                     CheckRange("supersampling", options.supersampling, 1, 8),
                                     CheckMesh("surface", surface.positions, surface.faces),
                                     CheckMesh("sample", samples.positions, samples.triangles)}) {
    if (!status.ok()) return status;
  }
  if (surface.faces.empty()) return absl::InvalidArgumentError("the surface has no face to draw");
  if (samples.normals.size() != samples.positions.size()) {
    return absl::InvalidArgumentError("samples need one normal each");
  }

  const int panel = options.width / 2;
  // Only the vertices of a face are seen; isolated ones must not shrink the picture.
  std::vector<Eigen::Vector3d> used;
  used.reserve(3 * surface.faces.size());
  for (const Eigen::Vector3i& t : surface.faces) {
    for (const int v : t) used.push_back(surface.positions[v]);
  }
  Scene scene;
  scene.factor = options.supersampling;
  scene.width = panel * scene.factor;
  scene.height = options.height * scene.factor;
  scene.camera = Camera::Framing(used, scene.width, scene.height);
  used = {};
  const ViewMesh mesh = ToViewMesh(surface.positions, surface.faces, scene.camera);
  const double count = std::max<double>(1.0, static_cast<double>(samples.positions.size()));
  scene.spacing = std::sqrt(2.0 * Area(mesh) / (std::sqrt(3.0) * count));
  scene.unit_pixels = scene.camera.PixelsPerUnit(scene.camera.eye().z());

  RgbImage image;
  image.width = options.width;
  image.height = options.height;
  image.rgb.assign(static_cast<std::size_t>(3) * image.width * image.height, 255);
  try {
    auto left = std::async(std::launch::async, [&] { return DrawSamples(mesh, samples, scene); });
    const std::vector<Color> right = DrawSampleMesh(samples, scene);
    Resolve(right, panel, scene.factor, options.width - panel, image);
    Resolve(left.get(), panel, scene.factor, 0, image);
  } catch (const std::exception& error) {
    return absl::ResourceExhaustedError(absl::StrCat("the picture needs too much: ", error.what()));
  }
  return image;
}

}  // namespace ccst
