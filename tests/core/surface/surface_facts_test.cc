#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/quality/mesh_topology.h"
#include "core/surface/surface.h"
#include "tests/support/shapes.h"

namespace ccst {
namespace {

struct Case {
  std::string name;
  TriangleMesh mesh;
  std::vector<std::int64_t> eulers;
  std::size_t loops = 0;
};

std::vector<Case> Cases() {
  const std::vector<TriangleMesh> three = {shapes::Torus(1, 0.3, 12, 8),
                                           shapes::Moved(shapes::Tetrahedron(), {5, 0, 0}),
                                           shapes::Moved(shapes::SingleTriangle(), {-5, 0, 0})};
  return {{"tetrahedron", shapes::Tetrahedron(), {2}},
          {"sphere", shapes::Icosphere(2), {2}},
          {"torus", shapes::Torus(1, 0.3, 12, 8), {0}},
          {"double torus", shapes::PlateWithHoles(2, 1), {-2}},
          {"triple torus", shapes::PlateWithHoles(3, 1), {-4}},
          {"triangle", shapes::SingleTriangle(), {1}, 1},
          {"plane", shapes::PlaneGrid(2, 1, 5, 4), {1}, 1},
          {"cylinder", shapes::Cylinder(1, 2, 12, 5), {0}, 2},
          {"three components", shapes::DisjointUnion(three), {0, 2, 1}, 1}};
}

TEST(Surface, EulerComponentsAndLoopsAreThoseOfTheShape) {
  for (const Case& c : Cases()) {
    SCOPED_TRACE(c.name);
    const absl::StatusOr<Surface> surface = Surface::Build(c.mesh);
    ASSERT_TRUE(surface.ok()) << surface.status();
    EXPECT_EQ(surface->component_eulers(), c.eulers);
    EXPECT_EQ(surface->component_areas().size(), c.eulers.size());
    EXPECT_EQ(surface->boundary_loops().size(), c.loops);
    const quality::MeshTopology topology =
        quality::MeasureTopology(static_cast<std::int64_t>(c.mesh.positions.size()), c.mesh.faces);
    std::int64_t euler = 0;
    for (const std::int64_t part : surface->component_eulers()) euler += part;
    EXPECT_EQ(euler, topology.euler);
    EXPECT_EQ(c.eulers.size(), static_cast<std::size_t>(topology.components));
  }
}

TEST(Surface, TwinsAndOutgoingAreConsistent) {
  for (const Case& c : Cases()) {
    SCOPED_TRACE(c.name);
    const Surface surface = *Surface::Build(c.mesh);
    for (std::int32_t h = 0; h < 3 * surface.face_count(); ++h) {
      const std::int32_t g = surface.twins()[h];
      if (g < 0) continue;
      EXPECT_EQ(surface.twins()[g], h);
      EXPECT_EQ(surface.Origin(g), surface.Target(h));
      EXPECT_EQ(surface.Target(g), surface.Origin(h));
    }
    for (std::int32_t v = 0; v < surface.vertex_count(); ++v) {
      EXPECT_EQ(surface.Origin(surface.outgoing()[v]), v);
    }
    for (const BoundaryLoop& loop : surface.boundary_loops()) {
      double length = 0.0;
      for (std::size_t i = 0; i < loop.half_edges.size(); ++i) {
        const std::int32_t h = loop.half_edges[i];
        EXPECT_LT(surface.twins()[h], 0);
        EXPECT_EQ(surface.outgoing()[surface.Origin(h)], h);
        EXPECT_EQ(surface.Target(h),
                  surface.Origin(loop.half_edges[(i + 1) % loop.half_edges.size()]));
        EXPECT_EQ(surface.face_components()[h / 3], loop.component);
        length += (surface.positions()[surface.Target(h)] - surface.positions()[surface.Origin(h)])
                      .norm();
      }
      EXPECT_NEAR(loop.length, length, 1e-12);
    }
  }
}

TEST(Surface, AreasAndLengthsAgreeWithClosedForms) {
  const Surface plane = *Surface::Build(shapes::PlaneGrid(3, 2, 6, 4));
  const double unit = plane.unit();
  EXPECT_NEAR(plane.area() * unit * unit, 6.0, 1e-12);
  EXPECT_NEAR(plane.diagonal() * unit, std::sqrt(13.0), 1e-12);
  EXPECT_NEAR(plane.boundary_loops()[0].length * unit, 10.0, 1e-12);
  const Surface cube = *Surface::Build(shapes::Cube());
  EXPECT_NEAR(cube.area() * cube.unit() * cube.unit(), 24.0, 1e-12);
}

TEST(Surface, NormalsAreWeightedByArea) {
  // Three right triangles with legs a, b, c along the axes: area times normal is (bc, ca, ab) / 2.
  const double a = 1.0;
  const double b = 2.0;
  const double c = 5.0;
  const TriangleMesh corner = {{{0, 0, 0}, {a, 0, 0}, {0, b, 0}, {0, 0, c}},
                               {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}}};
  const Surface surface = *Surface::Build(corner);
  const Eigen::Vector3d expected = -Eigen::Vector3d(b * c, c * a, a * b).normalized();
  EXPECT_LT((surface.normals()[0] - expected).norm(), 1e-14);
}

TEST(Surface, NormalsOfSymmetricShapesAreRadial) {
  for (const TriangleMesh& mesh : {shapes::Tetrahedron(), shapes::Icosphere(0)}) {
    const Surface surface = *Surface::Build(mesh);
    for (int v = 0; v < surface.vertex_count(); ++v) {
      EXPECT_LT((surface.normals()[v] - mesh.positions[v].normalized()).norm(), 1e-14);
    }
  }
}

TEST(Surface, NormalsOfATorusConvergeAtSecondOrder) {
  std::vector<double> errors;
  for (const int around : {40, 80, 160}) {
    const int across = around / 2;
    const Surface surface = *Surface::Build(shapes::Torus(1.0, 0.35, around, across));
    double worst = 0.0;
    for (int v = 0; v < surface.vertex_count(); ++v) {
      const double u = 2.0 * std::numbers::pi * (v % around) / around;
      const double w = 2.0 * std::numbers::pi * (v / around) / across;
      const Eigen::Vector3d exact(std::cos(w) * std::cos(u), std::cos(w) * std::sin(u),
                                  std::sin(w));
      worst = std::max(worst, (surface.normals()[v] - exact).norm());
    }
    errors.push_back(worst);
  }
  EXPECT_GT(std::log2(errors[0] / errors[1]), 1.8);
  EXPECT_GT(std::log2(errors[1] / errors[2]), 1.8);
}

TEST(Surface, NormalAtInterpolatesAndStaysUnit) {
  const Surface surface = *Surface::Build(shapes::Icosphere(2));
  for (int f = 0; f < surface.face_count(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d corner = Eigen::Vector3d::Unit(k);
      EXPECT_LT((surface.NormalAt(f, corner) - surface.normals()[surface.faces()[f][k]]).norm(),
                1e-14);
    }
    const Eigen::Vector3d middle = surface.NormalAt(f, Eigen::Vector3d::Constant(1.0 / 3.0));
    EXPECT_NEAR(middle.norm(), 1.0, 1e-14);
  }
}

}  // namespace
}  // namespace ccst
