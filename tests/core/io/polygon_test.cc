#include "core/io/polygon.h"

#include <cmath>
#include <random>
#include <set>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "core/io/mesh_readers.h"

namespace ccst::io {
namespace {

using Polygon = std::vector<Eigen::Vector3d>;
using Triangles = std::vector<std::array<std::int32_t, 3>>;

// By the shoelace formula in the xy plane.
double SignedArea(const Polygon& polygon) {
  double twice = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector3d& a = polygon[i];
    const Eigen::Vector3d& b = polygon[(i + 1) % polygon.size()];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return twice / 2;
}

double SumOfAreas(const Polygon& polygon, const Triangles& triangles) {
  double sum = 0.0;
  for (const auto& [a, b, c] : triangles) {
    sum += (polygon[b] - polygon[a]).cross(polygon[c] - polygon[a]).norm() / 2;
  }
  return sum;
}

// In another plane, far from the origin.
Polygon Turned(const Polygon& polygon) {
  const Eigen::Affine3d turn = Eigen::Translation3d(300, -20, 7) *
                               Eigen::AngleAxisd(2.1, Eigen::Vector3d(1, -2, 0.5).normalized());
  Polygon result;
  for (const Eigen::Vector3d& corner : polygon) result.push_back(turn * corner);
  return result;
}

// Triangles of a simple polygon cover it once: as many as there must be, each in the polygon's own
// sense, and no more area together.
void ExpectCovers(const Polygon& polygon) {
  PolygonCutter cutter;
  Triangles triangles;
  for (const Polygon& placed : {polygon, Turned(polygon)}) {
    ASSERT_EQ(cutter.Cut(placed, triangles), PolygonCut::kWhole);
    EXPECT_EQ(triangles.size(), polygon.size() - 2);
    const double area = std::abs(SignedArea(polygon));
    EXPECT_NEAR(SumOfAreas(placed, triangles), area, 1e-9 * area);
    std::set<std::int32_t> used;
    for (const auto& triangle : triangles) used.insert(triangle.begin(), triangle.end());
    EXPECT_EQ(used.size(), polygon.size());
  }
  ASSERT_EQ(cutter.Cut(polygon, triangles), PolygonCut::kWhole);
  for (const auto& [a, b, c] : triangles) {
    EXPECT_GE(SignedArea({polygon[a], polygon[b], polygon[c]}) * SignedArea(polygon), 0.0);
  }
}

// A star around the origin: simple, and as concave as `random` makes it.
Polygon Star(int corners, std::mt19937& random) {
  std::uniform_real_distribution<double> radius(0.1, 1.0);
  Polygon polygon;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2 * M_PI * i / corners;
    const double r = radius(random);
    polygon.emplace_back(r * std::cos(angle), r * std::sin(angle), 0.0);
  }
  return polygon;
}

TEST(PolygonCutter, ConcavePolygonsAreCovered) {
  ExpectCovers({{0, 0, 0}, {2, 1, 0}, {0, 2, 0}, {1.5, 1, 0}});  // An arrow.
  ExpectCovers({{1, 1, 0},
                {1, 3, 0},
                {0, 3, 0},
                {0, 0, 0},
                {3, 0, 0},
                {3, 3, 0},
                {2, 3, 0},
                {2, 1, 0}});  // A U, in the other sense.
}

TEST(PolygonCutter, StarsOfEverySizeAreCovered) {
  std::mt19937 random(5);
  for (const int corners : {5, 6, 7, 10, 33, 100, 1000, 5000}) ExpectCovers(Star(corners, random));
}

TEST(PolygonCutter, CornersOnAStraightSideGetTrianglesWithArea) {
  const Polygon polygon = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {3, 1, 0}, {0, 1, 0}};
  ExpectCovers(polygon);
  PolygonCutter cutter;
  Triangles triangles;
  ASSERT_EQ(cutter.Cut(polygon, triangles), PolygonCut::kWhole);
  for (const auto& [a, b, c] : triangles) {
    EXPECT_GT(SignedArea({polygon[a], polygon[b], polygon[c]}), 0.01);
  }
}

TEST(PolygonCutter, BridgesToHolesAreFollowed) {
  // A square with a square hole, joined by a bridge that the boundary passes twice.
  ExpectCovers({{0, 0, 0},
                {4, 0, 0},
                {4, 4, 0},
                {0, 4, 0},
                {0, 0, 0},
                {1, 1, 0},
                {1, 3, 0},
                {3, 3, 0},
                {3, 1, 0},
                {1, 1, 0}});
}

TEST(PolygonCutter, FlatPolygonsBecomeDelaunay) {
  std::mt19937 random(9);
  std::uniform_real_distribution<double> step(0.5, 1.5);
  Polygon polygon;  // Convex: corners on an ellipse at odd angles.
  for (double angle = 0; angle < 2 * M_PI - 0.1; angle += 0.2 * step(random)) {
    polygon.emplace_back(3 * std::cos(angle), std::sin(angle), 0.0);
  }
  PolygonCutter cutter;
  Triangles triangles;
  ASSERT_EQ(cutter.Cut(polygon, triangles), PolygonCut::kWhole);
  for (const auto& [a, b, c] : triangles) {
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      // The determinant is positive where corner i lies within the circle around the triangle.
      Eigen::Matrix3d m;
      int row = 0;
      for (const std::int32_t corner : {a, b, c}) {
        const Eigen::Vector2d d = (polygon[corner] - polygon[i]).head<2>();
        m.row(row++) << d.x(), d.y(), d.squaredNorm();
      }
      EXPECT_LT(m.determinant(), 1e-9);
    }
  }
}

TEST(PolygonCutter, BentQuadrilateralsGetTheBetterDiagonal) {
  // A rhombus folded along its short diagonal: cut along the long one it would have slivers.
  const Polygon polygon = {{-3, 0, 1}, {0, -1, 0}, {3, 0, 1}, {0, 1, 0}};
  PolygonCutter cutter;
  Triangles triangles;
  ASSERT_EQ(cutter.Cut(polygon, triangles), PolygonCut::kWhole);
  for (const auto& triangle : triangles) {
    const std::set<std::int32_t> corners(triangle.begin(), triangle.end());
    EXPECT_TRUE(corners.contains(1) && corners.contains(3));
  }
}

TEST(PolygonCutter, RectanglesStayFans) {
  PolygonCutter cutter;
  Triangles triangles;
  ASSERT_EQ(cutter.Cut(Polygon{{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}}, triangles),
            PolygonCut::kWhole);
  EXPECT_EQ(triangles, (Triangles{{0, 1, 2}, {0, 2, 3}}));
}

TEST(PolygonCutter, SelfCrossingPolygonsAreSaidToBe) {
  PolygonCutter cutter;
  Triangles triangles;
  EXPECT_EQ(cutter.Cut(Polygon{{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}}, triangles),
            PolygonCut::kSelfCrossing);
  EXPECT_EQ(triangles.size(), 2u);
  Polygon pentagram;
  for (int i = 0; i < 5; ++i) {
    const double angle = 4 * M_PI * i / 5;
    pentagram.emplace_back(std::cos(angle), std::sin(angle), 0.0);
  }
  EXPECT_EQ(cutter.Cut(pentagram, triangles), PolygonCut::kSelfCrossing);
  EXPECT_EQ(triangles.size(), 3u);
}

TEST(PolygonCutter, PolygonsWithoutAreaAreCutAllTheSame) {
  PolygonCutter cutter;
  Triangles triangles;
  for (const Polygon& polygon : {Polygon(5, Eigen::Vector3d(1, 2, 3)),
                                 Polygon{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {5, 0, 0}, {3, 0, 0}}}) {
    cutter.Cut(polygon, triangles);
    EXPECT_EQ(triangles.size(), polygon.size() - 2);
  }
}

TEST(PolygonCutter, WorkIsBounded) {
  // A comb whose teeth all reach across: every ear's box has all corners in it.
  Polygon comb;
  constexpr int kTeeth = 60'000;
  for (int i = 0; i < kTeeth; ++i) {
    comb.emplace_back(i, 0.0, 0.0);
    comb.emplace_back(i + 0.5, 1e6, 0.0);
  }
  comb.emplace_back(kTeeth, 1e6 + 1, 0.0);
  comb.emplace_back(0, 1e6 + 1, 0.0);
  PolygonCutter cutter;
  Triangles triangles;
  const PolygonCut cut = cutter.Cut(comb, triangles);
  EXPECT_TRUE(cut == PolygonCut::kTooComplex || triangles.size() == comb.size() - 2);
}

TEST(PolygonCutter, CornersKeepTheirTextureCoordinates) {
  const auto file = ReadObj(
      "v 0 0 0\nv 2 1 0\nv 0 2 0\nv 1.5 1 0\nvt 0 0\nvt 2 1\nvt 0 2\nvt 1.5 1\n"
      "f 1/1 2/2 3/3 4/4\n",
      {});
  ASSERT_TRUE(file.ok()) << file.status();
  ASSERT_EQ(file->mesh.faces.size(), 2u);
  ASSERT_EQ(file->mesh.attributes.size(), 1u);
  for (std::size_t f = 0; f < 2; ++f) {
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d& position =
          file->mesh.positions[static_cast<std::size_t>(file->mesh.faces[f][k])];
      const float* const uv = file->mesh.attributes[0].values.data() + 2 * (3 * f + k);
      EXPECT_EQ(uv[0], static_cast<float>(position.x()));
      EXPECT_EQ(uv[1], static_cast<float>(position.y()));
    }
  }
}

}  // namespace
}  // namespace ccst::io
