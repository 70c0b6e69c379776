#include <cmath>
#include <numbers>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stb/stb_image.h>

#include "client/render/camera.h"
#include "client/render/picture.h"
#include "client/render/rasterizer.h"
#include "tests/support/shapes.h"

namespace ccst {
namespace {

bool IsWhite(const RgbImage& image, int x, int y) {
  const std::uint8_t* p = image.Pixel(x, y);
  return p[0] == 255 && p[1] == 255 && p[2] == 255;
}

bool IsDark(const RgbImage& image, int x, int y) {
  const std::uint8_t* p = image.Pixel(x, y);
  return p[0] < 90 && p[1] < 90 && p[2] < 130;
}

template <typename Predicate>
int CountPixels(const RgbImage& image, int first, int last, Predicate predicate) {
  int count = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = first; x < last; ++x) count += predicate(image, x, y) ? 1 : 0;
  }
  return count;
}

// One sample on each vertex, the mesh's own triangles over them.
SampleSet VertexSamples(const TriangleMesh& mesh) {
  SampleSet samples;
  samples.positions = mesh.positions;
  samples.triangles = mesh.faces;
  for (const Eigen::Vector3d& p : mesh.positions) samples.normals.push_back(p.normalized());
  return samples;
}

SampleSet OneSample(const Eigen::Vector3d& position, const Eigen::Vector3d& normal) {
  SampleSet samples;
  samples.positions = {position};
  samples.normals = {normal};
  return samples;
}

TEST(Camera, FramesEveryPointWithAMargin) {
  const std::vector<TriangleMesh> meshes = {
      shapes::Cube(),
      shapes::Torus(1.0, 0.3, 40, 20),
      shapes::PlaneGrid(1.0, 1.0, 4, 4),
      shapes::Cylinder(0.01, 5.0, 12, 4),
      shapes::Moved(shapes::Cube(), Eigen::Vector3d(1e7, -2e7, 3e7), 1e-3),
      shapes::Moved(shapes::Cube(), Eigen::Vector3d::Zero(), 1e30)};
  for (const TriangleMesh& mesh : meshes) {
    const Camera camera = Camera::Framing(mesh.positions, 300, 200);
    Eigen::Vector2d low(1e9, 1e9);
    Eigen::Vector2d high(-1e9, -1e9);
    for (const Eigen::Vector3d& p : mesh.positions) {
      const Eigen::Vector3d view = camera.ToView(p);
      EXPECT_GT(camera.Depth(view), 0.0);
      low = low.cwiseMin(camera.ToPixel(view));
      high = high.cwiseMax(camera.ToPixel(view));
    }
    EXPECT_GT(low.minCoeff(), 5.0);
    EXPECT_LT(high.x(), 295.0);
    EXPECT_LT(high.y(), 195.0);
    // And no smaller than need be: it touches the margin in one direction.
    EXPECT_GT(std::max((high - low).x() / 300.0, (high - low).y() / 200.0), 0.8);
  }
}

TEST(Camera, UnprojectsWhatItProjects) {
  const Camera camera = Camera::Framing(shapes::Cube().positions, 200, 200);
  const Eigen::Vector3d view = camera.ToView({0.3, -0.7, 0.9});
  EXPECT_LT((camera.Unproject(camera.ToPixel(view), camera.Depth(view)) - view).norm(), 1e-12);
}

TEST(Camera, ShowsYUpwards) {
  const Camera camera = Camera::Framing(shapes::Cube().positions, 200, 200);
  EXPECT_LT(camera.ToPixel(camera.ToView({0, 1, 0})).y(),
            camera.ToPixel(camera.ToView({0, -1, 0})).y());
}

TEST(Camera, LooksOntoFlatObjects) {
  // Flat in z: seen from the side of +z, and large.
  const TriangleMesh mesh = shapes::PlaneGrid(1.0, 1.0, 2, 2);
  const Camera camera = Camera::Framing(mesh.positions, 200, 200);
  EXPECT_GT(camera.RotateToView({0, 0, 1}).z(), 0.5);
}

TEST(Rasterizer, SphereCoversTheAreaOfItsSilhouette) {
  const TriangleMesh mesh = shapes::Icosphere(5);
  const int size = 400;
  const Camera camera = Camera::Framing(mesh.positions, size, size);
  std::vector<Eigen::Vector3d> view;
  for (const Eigen::Vector3d& p : mesh.positions) view.push_back(camera.ToView(p));
  const VisibilityBuffer buffer = Rasterize(view, mesh.faces, camera, size, size);
  double covered = 0.0;
  for (const std::int32_t f : buffer.triangle) covered += f >= 0 ? 1.0 : 0.0;
  // A sphere of radius r at distance d is seen under the sine r / d.
  const double sine = 0.5 / camera.Depth(Eigen::Vector3d::Zero());
  const double pixels = camera.PixelsPerUnit(1.0) * sine / std::sqrt(1.0 - sine * sine);
  EXPECT_NEAR(covered / (std::numbers::pi * pixels * pixels), 1.0, 0.01);
}

TEST(Rasterizer, NearerTrianglesHideFartherOnes) {
  const std::vector<Eigen::Vector3d> corners = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
  const Camera camera = Camera::Framing(corners, 64, 64);
  std::vector<Eigen::Vector3d> view;
  for (const double z : {-0.2, 0.2}) {
    for (const Eigen::Vector3d& c : corners) {
      view.push_back(camera.ToView(c) + Eigen::Vector3d(0, 0, z));
    }
  }
  const std::vector<Eigen::Vector3i> near_last = {{0, 1, 2}, {3, 4, 5}};
  const std::vector<Eigen::Vector3i> near_first = {{3, 4, 5}, {0, 1, 2}};
  const std::size_t middle = 32 * 64 + 32;
  EXPECT_EQ(Rasterize(view, near_last, camera, 64, 64).triangle[middle], 1);
  EXPECT_EQ(Rasterize(view, near_first, camera, 64, 64).triangle[middle], 0);
}

TEST(Picture, HasTwoPanelsOnWhite) {
  const TriangleMesh mesh = shapes::Icosphere(3);
  const auto image = RenderPicture(mesh, VertexSamples(mesh), {.width = 400, .height = 200});
  ASSERT_TRUE(image.ok()) << image.status();
  EXPECT_EQ(image->width, 400);
  EXPECT_EQ(image->height, 200);
  for (const auto& [x, y] : {std::pair(0, 0), {199, 0}, {200, 199}, {399, 199}}) {
    EXPECT_TRUE(IsWhite(*image, x, y));
  }
  EXPECT_FALSE(IsWhite(*image, 100, 100));
  EXPECT_FALSE(IsWhite(*image, 300, 100));
  // Both show the same shape: as many pixels, up to dots and lines on the rim.
  const auto seen = [](const RgbImage& i, int x, int y) { return !IsWhite(i, x, y); };
  const int left = CountPixels(*image, 0, 200, seen);
  const int right = CountPixels(*image, 200, 400, seen);
  EXPECT_NEAR(left, right, 0.02 * left);
}

TEST(Picture, DotsOfTheFarSideAreHidden) {
  const TriangleMesh mesh = shapes::Icosphere(4);
  const Camera camera = Camera::Framing(mesh.positions, 200, 200);
  // The direction of the viewer in mesh space.
  Eigen::Vector3d to_eye = Eigen::Vector3d::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    to_eye[axis] = camera.RotateToView(Eigen::Vector3d::Unit(axis)).z();
  }
  const auto dark = [&](const Eigen::Vector3d& p) {
    const auto image = RenderPicture(mesh, OneSample(p, p), {.width = 400, .height = 200});
    return image.ok() ? CountPixels(*image, 0, 200, IsDark) : -1;
  };
  EXPECT_GT(dark(to_eye), 100);
  EXPECT_EQ(dark(-to_eye), 0);
}

TEST(Picture, DotsStayOnTheirSideOfAThinSheet) {
  // Two sheets closer than a dot is wide; the sample lies on the lower, which faces down.
  TriangleMesh mesh = shapes::PlaneGrid(1.0, 1.0, 4, 4);
  const auto count = static_cast<int>(mesh.positions.size());
  const std::vector<Eigen::Vector3i> faces = mesh.faces;
  for (int i = 0; i < count; ++i) {
    mesh.positions.push_back(mesh.positions[i] - Eigen::Vector3d(0, 0, 1e-3));
  }
  for (const Eigen::Vector3i& f : faces) {
    mesh.faces.emplace_back(f[0] + count, f[2] + count, f[1] + count);
  }
  const auto image =
      RenderPicture(mesh, OneSample({0.5, 0.5, -1e-3}, {0, 0, -1}), {.width = 400, .height = 200});
  ASSERT_TRUE(image.ok());
  EXPECT_EQ(CountPixels(*image, 0, 200, IsDark), 0);
}

TEST(Picture, IsTheSameEveryTime) {
  const TriangleMesh mesh = shapes::Torus(1.0, 0.35, 24, 12);
  const SampleSet samples = VertexSamples(mesh);
  const PictureOptions options = {.width = 200, .height = 100};
  EXPECT_EQ(RenderPicture(mesh, samples, options)->rgb, RenderPicture(mesh, samples, options)->rgb);
}

TEST(Picture, TakesExtremeScales) {
  for (const double scale : {1e-200, 1e-12, 1e30, 1e150}) {
    const TriangleMesh mesh = shapes::Moved(shapes::Icosphere(2), Eigen::Vector3d::Zero(), scale);
    const auto image = RenderPicture(mesh, VertexSamples(mesh), {.width = 80, .height = 40});
    ASSERT_TRUE(image.ok()) << image.status();
    EXPECT_FALSE(IsWhite(*image, 20, 20)) << scale;
  }
}

TEST(Picture, RefusesWhatItCannotDraw) {
  const TriangleMesh mesh = shapes::Cube();
  const SampleSet samples = VertexSamples(mesh);
  EXPECT_FALSE(RenderPicture(mesh, samples, {.width = 0}).ok());
  EXPECT_FALSE(RenderPicture(mesh, samples, {.supersampling = 99}).ok());
  EXPECT_FALSE(RenderPicture({}, samples).ok());
  TriangleMesh out_of_range = mesh;
  out_of_range.faces[3][1] = 99;
  EXPECT_FALSE(RenderPicture(out_of_range, samples).ok());
  TriangleMesh not_finite = mesh;
  not_finite.positions[2].y() = std::nan("");
  EXPECT_FALSE(RenderPicture(not_finite, samples).ok());
}

TEST(Png, HoldsThePixels) {
  RgbImage image;
  image.width = 3;
  image.height = 2;
  for (int i = 0; i < 18; ++i) image.rgb.push_back(static_cast<std::uint8_t>(14 * i));
  const auto bytes = EncodePng(image);
  ASSERT_TRUE(bytes.ok());
  int width = 0;
  int height = 0;
  int channels = 0;
  stbi_uc* pixels =
      stbi_load_from_memory(reinterpret_cast<const stbi_uc*>(bytes->data()),
                            static_cast<int>(bytes->size()), &width, &height, &channels, 3);
  ASSERT_NE(pixels, nullptr);
  EXPECT_EQ(width, 3);
  EXPECT_EQ(height, 2);
  EXPECT_EQ(std::vector<std::uint8_t>(pixels, pixels + 18), image.rgb);
  stbi_image_free(pixels);
}

}  // namespace
}  // namespace ccst
