#include "core/density/density.h"

#include <cmath>
#include <limits>
#include <numeric>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/status.h"
#include "core/random/random.h"
#include "tests/support/shapes.h"

namespace ccst {
namespace {

// Index of the small triangle that holds the point: barycentric coordinates in units of 1 / 2^level
// rounded down name a lattice triangle, pointing up or down.
std::pair<std::pair<int, int>, bool> CellOf(const Eigen::Vector3d& weights, int level) {
  const double size = std::ldexp(1.0, level);
  const int i = static_cast<int>(weights[0] * size);
  const int j = static_cast<int>(weights[1] * size);
  const double rest = weights[0] * size - i + weights[1] * size - j;
  return {{i, j}, rest > 1.0};
}

TEST(UniformDensity, CurveVisitsEveryCellOnceAndPreservesArea) {
  const Density density = Density::Uniform(*Surface::Build(shapes::SingleTriangle()));
  for (int level = 1; level <= 6; ++level) {
    const int cells = 1 << (2 * level);
    std::set<std::pair<std::pair<int, int>, bool>> seen;
    for (int c = 0; c < cells; ++c) {
      // All points of one interval of the curve lie in one cell.
      const auto cell = CellOf(density.PointAt(0, (c + 0.5) / cells), level);
      EXPECT_EQ(CellOf(density.PointAt(0, (c + 0.1) / cells), level), cell);
      EXPECT_EQ(CellOf(density.PointAt(0, (c + 0.9) / cells), level), cell);
      seen.insert(cell);
    }
    EXPECT_EQ(seen.size(), static_cast<std::size_t>(cells));
  }
}

TEST(UniformDensity, CurveStaysInsideTheTriangle) {
  const Density density = Density::Uniform(*Surface::Build(shapes::SingleTriangle()));
  const CounterRandom random(1, 1);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3d w = density.PointAt(0, i == 0   ? 0.0
                                                 : i == 1 ? 1.0 - 0x1.0p-53
                                                          : random.Uniform(i));
    EXPECT_GE(w.minCoeff(), 0.0);
    EXPECT_NEAR(w.sum(), 1.0, 1e-12);
  }
}

// One value a corner, by a function of the corner's position.
template <typename F>
std::vector<double> Corners(const TriangleMesh& mesh, F&& value) {
  std::vector<double> corners;
  for (const Eigen::Vector3i& face : mesh.faces) {
    for (int k = 0; k < 3; ++k) corners.push_back(value(mesh.positions[face[k]]));
  }
  return corners;
}

double Total(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

// Share of the capacity of `face` on the near side of each point of its curve, by many points.
double ShareBelow(const Density& density, std::int32_t face, int corner, double weight) {
  constexpr int kPoints = 20000;
  int below = 0;
  for (int i = 0; i < kPoints; ++i) {
    below += density.PointAt(face, (i + 0.5) / kPoints)[corner] < weight;
  }
  return static_cast<double>(below) / kPoints;
}

TEST(LinearDensity, HasMeanOne) {
  const TriangleMesh mesh = shapes::Icosphere(2, 3.0);
  const Surface surface = *Surface::Build(mesh);
  const Density density = *Density::Linear(
      surface, Corners(mesh, [](const Eigen::Vector3d& p) { return std::exp(p.z()); }), 1e4);
  EXPECT_NEAR(Total(density.face_capacities()), surface.area(), 1e-12);
  EXPECT_NEAR(Total(density.component_capacities()), surface.area(), 1e-12);
}

TEST(LinearDensity, KeepsTheRatiosOfItsValues) {
  const Surface surface = *Surface::Build(shapes::SingleTriangle());
  const Density density = *Density::Linear(surface, {2.0, 4.0, 10.0}, 100.0);
  const double first = density.At(0, {1, 0, 0});
  EXPECT_NEAR(density.At(0, {0, 1, 0}), 2.0 * first, 1e-12);
  EXPECT_NEAR(density.At(0, {0, 0, 1}), 5.0 * first, 1e-12);
  EXPECT_NEAR(density.At(0, {0.5, 0, 0.5}), 3.0 * first, 1e-12);
}

TEST(LinearDensity, RaisesTinyValuesByContrast) {
  const Surface surface = *Surface::Build(shapes::SingleTriangle());
  const Density density = *Density::Linear(surface, {0.0, 1e-300, 8.0}, 50.0);
  EXPECT_NEAR(density.At(0, {0, 0, 1}), 50.0 * density.At(0, {1, 0, 0}), 1e-9);
  EXPECT_EQ(density.At(0, {1, 0, 0}), density.At(0, {0, 1, 0}));
}

TEST(LinearDensity, CurvePreservesCapacity) {
  const Surface surface = *Surface::Build(shapes::SingleTriangle());
  const Density density = *Density::Linear(surface, {0.0, 0.0, 1.0}, 1e6);
  // rho = w: the share of the capacity where w < h is 3 h^2 - 2 h^3.
  for (const double h : {0.1, 0.25, 0.5, 0.75, 0.9}) {
    EXPECT_NEAR(ShareBelow(density, 0, 2, h), h * h * (3.0 - 2.0 * h), 2e-3) << h;
  }
}

TEST(LinearDensity, RefusesWhatIsNoDensity) {
  const Surface surface = *Surface::Build(shapes::SingleTriangle());
  for (const double wrong : {-1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    const absl::Status status = Density::Linear(surface, {1.0, wrong, 1.0}, 100.0).status();
    EXPECT_EQ(GetErrorReason(status), ErrorReason::kDensityInvalid);
    EXPECT_NE(status.message().find("corner 1 of face 0"), std::string::npos) << status.message();
  }
  EXPECT_EQ(GetErrorReason(Density::Linear(surface, {0, 0, 0}, 100.0).status()),
            ErrorReason::kDensityInvalid);
  EXPECT_EQ(GetErrorReason(Density::Linear(surface, {1, 1, 1}, 1.0).status()),
            ErrorReason::kOptionInvalid);
}

// The unit square of two faces with its own plane coordinates as texture coordinates.
struct Square {
  TriangleMesh mesh = shapes::PlaneGrid(1, 1, 1, 1);
  Surface surface = *Surface::Build(mesh);
  std::vector<Eigen::Vector2d> coordinates;

  Square() {
    for (const Eigen::Vector3i& face : mesh.faces) {
      for (int k = 0; k < 3; ++k) coordinates.push_back(mesh.positions[face[k]].head<2>());
    }
  }
  Density Of(const Image& image) const {
    return *Density::Textured(surface, coordinates, image, 1e4);
  }
};

template <typename F>
Image Draw(std::int32_t width, std::int32_t height, F&& value) {
  Image image{width, height, {}};
  for (std::int32_t y = 0; y < height; ++y) {
    for (std::int32_t x = 0; x < width; ++x) {
      image.values.push_back(static_cast<float>(value(x, y)));
    }
  }
  return image;
}

TEST(TexturedDensity, IntegratesOverAFaceInsteadOfLookingAtItsCorners) {
  const Square square;
  // Zero at every corner of the square, one in a strip across the middle that covers 1/4.
  const Density density =
      square.Of(Draw(256, 256, [](int, int y) { return y >= 96 && y < 160 ? 1.0 : 0.0; }));
  double inside = 0.0;
  constexpr int kPoints = 4000;
  for (int f = 0; f < 2; ++f) {
    for (int i = 0; i < kPoints; ++i) {
      const Eigen::Vector3d w = density.PointAt(f, (i + 0.5) / kPoints);
      double y = 0.0;
      for (int k = 0; k < 3; ++k) y += w[k] * square.coordinates[3 * f + k].y();
      inside += std::abs(y - 0.5) < 0.13;
    }
  }
  EXPECT_GT(inside / (2 * kPoints), 0.98);
  EXPECT_NEAR(density.face_capacities()[0], density.face_capacities()[1], 0.01);
}

TEST(TexturedDensity, UpIsTheFirstRow) {
  const Square square;
  const Density density = square.Of(Draw(8, 8, [](int, int y) { return y < 4 ? 1.0 : 0.1; }));
  for (int f = 0; f < 2; ++f) {
    for (int k = 0; k < 3; ++k) {
      Eigen::Vector3d inner = Eigen::Vector3d::Constant(0.1);
      inner[k] = 0.8;
      double y = 0.0;
      for (int j = 0; j < 3; ++j) y += inner[j] * square.coordinates[3 * f + j].y();
      if (y > 0.7) {
        EXPECT_GT(density.At(f, inner), 1.5);
      }
      if (y < 0.3) {
        EXPECT_LT(density.At(f, inner), 0.3);
      }
    }
  }
}

TEST(TexturedDensity, AveragesOverTheFootprint) {
  const Square square;
  const Density density =
      square.Of(Draw(256, 256, [](int x, int y) { return (x + y) % 2 == 0 ? 1.0 : 0.0; }));
  const CounterRandom random(3, 1);
  for (int i = 0; i < 50; ++i) {
    const double a = random.Uniform(2 * i);
    const double b = (1.0 - a) * random.Uniform(2 * i + 1);
    // A footprint of 64 pixels; the mean density is 1 by definition.
    EXPECT_NEAR(density.At(0, {a, b, 1.0 - a - b}, 64.0 / 65536.0 * square.surface.area()), 1.0,
                0.02);
  }
}

TEST(TexturedDensity, RefusesCoordinatesThatAreNotFinite) {
  Square square;
  square.coordinates[4].x() = std::nan("");
  const absl::Status status = Density::Textured(square.surface, square.coordinates,
                                                Draw(2, 2, [](int, int) { return 1; }), 100.0)
                                  .status();
  EXPECT_EQ(GetErrorReason(status), ErrorReason::kDensityInvalid);
  EXPECT_NE(status.message().find("corner 1 of face 1"), std::string::npos) << status.message();
}

}  // namespace
}  // namespace ccst
