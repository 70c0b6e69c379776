#include "core/mesh/faces.h"

#include <cstdint>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "core/surface/frame.h"
#include "core/surface/surface.h"
#include "tests/support/shapes.h"

namespace ccst {
namespace {

TEST(HalfEdges, NextAndPreviousGoAroundOneFace) {
  for (std::int32_t h = 0; h < 9; ++h) {
    EXPECT_EQ(NextHalfEdge(h), h / 3 * 3 + (h % 3 + 1) % 3);
    EXPECT_EQ(PreviousHalfEdge(h), h / 3 * 3 + (h % 3 + 2) % 3);
  }
}

TEST(FaceCross, IsTheNormalTwiceTheAreaLong) {
  const std::vector<Eigen::Vector3d> positions = {{1, 1, 5}, {4, 1, 5}, {1, 3, 5}};
  EXPECT_EQ(FaceCross(positions, {0, 1, 2}), Eigen::Vector3d(0, 0, 6));
  EXPECT_EQ(FaceCross(positions, {0, 2, 1}), Eigen::Vector3d(0, 0, -6));
}

TEST(FaceCross, OfASurfaceAgreesWithItsAreas) {
  const Surface surface = *Surface::Build(shapes::Torus(1.0, 0.4, 30, 15));
  for (std::int32_t f = 0; f < surface.face_count(); ++f) {
    EXPECT_EQ(0.5 * surface.FaceCross(f).norm(), surface.face_areas()[f]);
  }
}

TEST(AngleBetween, IsThatOfTheDirections) {
  const Eigen::Vector3d x(2, 0, 0);
  EXPECT_EQ(AngleBetween(x, {5, 0, 0}), 0.0);
  EXPECT_NEAR(AngleBetween(x, {0, 0, 0.1}), std::numbers::pi / 2.0, 1e-15);
  EXPECT_NEAR(AngleBetween(x, {-1, 1, 0}), 0.75 * std::numbers::pi, 1e-15);
  EXPECT_NEAR(AngleBetween(x, {-1, 0, 0}), std::numbers::pi, 1e-15);
}

}  // namespace
}  // namespace ccst
