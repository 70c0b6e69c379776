#include "core/analysis/geodesic_disc.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "tests/support/shapes.h"

namespace ccst::analysis {
namespace {

Surface Of(const TriangleMesh& mesh) { return *Surface::Build(mesh); }

SurfacePoint Middle(const Surface& surface, std::int32_t face) {
  const Eigen::Vector3d third = Eigen::Vector3d::Constant(1.0 / 3.0);
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  for (int k = 0; k < 3; ++k) position += surface.positions()[surface.faces()[face][k]] / 3.0;
  return {face, third, position};
}

TEST(GeodesicDisc, PlaneIsLaidFlatExactly) {
  const Surface surface = Of(shapes::PlaneGrid(1.0, 1.0, 17, 13));
  GeodesicDisc disc(surface);
  const SurfacePoint center = Middle(surface, 200);
  std::size_t faces = 0;
  for (const FlatFace& flat : disc.Unfold(center, 10.0)) {
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d offset =
          surface.positions()[surface.faces()[flat.face][k]] - center.position;
      EXPECT_NEAR((flat.corners[k] - offset.head<2>()).norm(), 0.0, 1e-12);
    }
    ++faces;
  }
  EXPECT_EQ(faces, 2u * 17u * 13u);
}

TEST(GeodesicDisc, RadiusBoundsTheFaces) {
  const Surface surface = Of(shapes::PlaneGrid(1.0, 1.0, 40, 40));
  GeodesicDisc disc(surface);
  const double radius = 0.1;
  const SurfacePoint center = Middle(surface, 1640);
  std::vector<bool> found(surface.face_count(), false);
  for (const FlatFace& flat : disc.Unfold(center, radius)) found[flat.face] = true;
  for (std::int32_t f = 0; f < surface.face_count(); ++f) {
    const double distance =
        (surface.ClosestOnFace(f, center.position).position - center.position).norm();
    if (std::abs(distance - radius) < 1e-9) continue;
    EXPECT_EQ(found[f], distance < radius) << f;
  }
}

TEST(GeodesicDisc, CylinderIsUnrolled) {
  // A prism of 60 sides: distances around it are those along the polygon.
  const Surface surface = Of(shapes::Cylinder(1.0, 4.0, 60, 20));
  GeodesicDisc disc(surface);
  const SurfacePoint center = Middle(surface, 1210);
  const double radius = 1.2 / surface.unit();
  const double side = 2.0 * std::sin(M_PI / 60.0) / surface.unit();
  const auto around = [&](const Eigen::Vector3d& p) {  // Along the polygon.
    const Eigen::Vector3d m = surface.ToMesh(p);
    const double turn = std::atan2(m.y(), m.x()) / (2.0 * M_PI / 60.0);
    const double whole = std::floor(turn + 1e-9);
    const double part = (turn - whole) * (2.0 * M_PI / 60.0);
    const double step = 2.0 * M_PI / 60.0;
    // Share of the chord at an angle: by the sines.
    const double share = std::sin(part) / (std::sin(part) + std::sin(step - part));
    return (whole + share) * side;
  };
  int corners = 0;
  for (const FlatFace& flat : disc.Unfold(center, radius)) {
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d& p = surface.positions()[surface.faces()[flat.face][k]];
      double arc = around(p) - around(center.position);
      arc -= std::round(arc / (60.0 * side)) * 60.0 * side;
      const double along = p.z() - center.position.z();
      EXPECT_NEAR(flat.corners[k].norm(), std::hypot(arc, along), 1e-9);
      ++corners;
    }
  }
  EXPECT_GT(corners, 300);
}

TEST(GeodesicDisc, GreatCirclesAreMeasuredOnASphere) {
  const Surface surface = Of(shapes::Icosphere(5));
  GeodesicDisc disc(surface);
  double worst = 0.0;
  for (std::int32_t host = 0; host < surface.face_count(); host += 997) {
    const SurfacePoint center = Middle(surface, host);
    const Eigen::Vector3d from = surface.ToMesh(center.position).normalized();
    for (const FlatFace& flat : disc.Unfold(center, 0.9 / surface.unit())) {
      for (int k = 0; k < 3; ++k) {
        const Eigen::Vector3d to =
            surface.ToMesh(surface.positions()[surface.faces()[flat.face][k]]);
        const double angle = std::atan2(from.cross(to.normalized()).norm(), from.dot(to));
        if (angle < 0.1) continue;
        worst = std::max(worst, std::abs(flat.corners[k].norm() * surface.unit() / angle - 1.0));
      }
    }
  }
  std::printf("largest relative error %.4f\n", worst);
  EXPECT_LT(worst, 0.01);
}

// Inside and outside of a torus bend ways apart and together: paths of faces that are not straight
// lay a face anywhere.
TEST(GeodesicDisc, NoFaceOfATorusIsNearerThanItsChordAndNoneIsLeftOut) {
  const Surface surface = Of(shapes::Torus(1.0, 0.45, 60, 30));
  GeodesicDisc disc(surface);
  const double radius = 1.0 / surface.unit();
  for (std::int32_t f = 0; f < surface.face_count(); f += 37) {
    const SurfacePoint center = Middle(surface, f);
    std::vector<bool> found(surface.face_count(), false);
    for (const FlatFace& flat : disc.Unfold(center, radius)) {
      found[flat.face] = true;
      if (flat.face == f) continue;
      const double chord = (Middle(surface, flat.face).position - center.position).norm();
      EXPECT_GE(flat.At(Eigen::Vector3d::Constant(1.0 / 3.0)).norm(), 0.99 * chord);
    }
    for (std::int32_t g = 0; g < surface.face_count(); ++g) {
      // Around a tube the way is at most pi / 2 times the chord.
      const double chord = (Middle(surface, g).position - center.position).norm();
      EXPECT_TRUE(found[g] || 1.6 * chord > radius) << g;
    }
  }
}

TEST(GeodesicDisc, OtherSideOfAThinPlateIsAroundTheRim) {
  // A box 1 x 1 x 0.02, each side in 50 x 50 quads: opposite points in the middle are far apart.
  TriangleMesh plate = shapes::Subdivided(
      shapes::Subdivided(shapes::Subdivided(shapes::Subdivided(shapes::Cube()))));
  for (Eigen::Vector3d& p : plate.positions) p = Eigen::Vector3d(p.x() / 2, p.y() / 2, p.z() / 100);
  const Surface surface = Of(plate);
  GeodesicDisc disc(surface);
  for (std::int32_t host = 0; host < surface.face_count(); ++host) {
    const SurfacePoint center = Middle(surface, host);
    const Eigen::Vector3d c = surface.ToMesh(center.position);
    if (c.z() < 0.0099) continue;
    const double rim = 0.5 - std::max(std::abs(c.x()), std::abs(c.y()));
    for (const FlatFace& flat : disc.Unfold(center, 0.3 / surface.unit())) {
      const Eigen::Vector3d other = surface.ToMesh(Middle(surface, flat.face).position);
      if (other.z() > -0.0099) continue;
      const double distance = flat.At(Eigen::Vector3d::Constant(1.0 / 3.0)).norm();
      const double other_rim = 0.5 - std::max(std::abs(other.x()), std::abs(other.y()));
      EXPECT_GE(distance * surface.unit(), rim + other_rim + 0.02 - 1e-9);
    }
  }
}

}  // namespace
}  // namespace ccst::analysis
