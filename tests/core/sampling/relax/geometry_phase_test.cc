#include "core/sampling/relax/geometry_phase.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "core/base/interrupt.h"
#include "core/parallel/parallel.h"
#include "core/quality/capacity.h"
#include "core/quality/sample_mesh_quality.h"
#include "core/sampling/mesh/faults.h"
#include "core/surface/frame.h"
#include "tests/core/sampling/sampling_test_util.h"
#include "tests/support/shapes.h"

namespace ccst::internal {
namespace {

using sampling_test::MakeStart;
using sampling_test::Start;
using sampling_test::Triangles;

// The energy of the triangles at `v` if it were at `position`, from its definition.
double RingEnergy(const Start& start, std::int32_t v, const Eigen::Vector3d& position,
                  Energy energy) {
  double sum = 0.0;
  start.mesh.ForEachOutgoing(v, [&](std::int32_t h) {
    const std::vector<Eigen::Vector3d> corners = {position,
                                                  start.samples.position[start.mesh.Target(h)],
                                                  start.samples.position[start.mesh.Apex(h)]};
    const std::vector<Eigen::Vector3i> triangle = {{0, 1, 2}};
    const double c = quality::TotalArea(corners, triangle) / start.plan.components[0].target;
    sum += energy == Energy::kTarget ? (c - 1.0) * (c - 1.0) : c * c;
  });
  return sum;
}

// A sample that is interior and whose neighbours are.
std::vector<std::int32_t> InnerSamples(const Start& start, int count) {
  std::vector<std::int32_t> found;
  for (std::int32_t v = 0; v < start.samples.count() && static_cast<int>(found.size()) < count;
       v += 7) {
    bool inner = start.samples.kind[v] == SampleMesh::Kind::kInterior;
    start.mesh.ForEachOutgoing(v, [&](std::int32_t h) {
      inner = inner && start.samples.kind[start.mesh.Target(h)] == SampleMesh::Kind::kInterior;
    });
    if (inner) found.push_back(v);
  }
  return found;
}

double RingSpacing(const Start& start, std::int32_t v) {
  double nearest = 1e9;
  start.mesh.ForEachOutgoing(v, [&](std::int32_t h) {
    nearest = std::min(
        nearest, (start.samples.position[start.mesh.Target(h)] - start.samples.position[v]).norm());
  });
  return nearest;
}

// Relaxes a little, so that rings are as they are in a run, then lets `v` alone move.
Start OneFree(const TriangleMesh& mesh, std::int64_t count, std::int32_t* v, int which) {
  Interrupt never;
  Start start = *MakeStart(mesh, count, 3);
  GeometryPhase settle(&start.surface, &start.density, &start.plan, Energy::kTarget, &start.mesh,
                       &start.samples, &sampling_test::kOneThread);
  for (int pass = 0; pass < 2; ++pass) settle.Pass(&never);
  *v = InnerSamples(start, which + 1).back();
  for (std::int32_t u = 0; u < start.samples.count(); ++u) {
    if (u != *v) start.samples.kind[u] = SampleMesh::Kind::kFixed;
  }
  return start;
}

// One Newton step on sum c^2, its derivatives taken by finite differences along the osculating
// torus of the exact surface, against the move the phase makes.
void ExpectNewtonStep(const TriangleMesh& mesh, std::int64_t count, double k1, double k2,
                      double tolerance) {
  Interrupt never;
  int compared = 0;
  for (int which = 0; which < 12; ++which) {
    std::int32_t v = -1;
    Start start = OneFree(mesh, count, &v, which);
    const Eigen::Vector3d s = start.samples.position[v];
    const Eigen::Vector3d n = start.samples.normal[v];
    // The frame of the shapes used here: `around` the z axis, and across.
    const Eigen::Vector3d center = start.surface.ToMesh(s);
    Eigen::Vector3d t1(-center.y(), center.x(), 0.0);
    t1 = (t1 - n * n.dot(t1)).normalized();
    const Eigen::Vector3d t2 = n.cross(t1);
    double around = k1;
    if (k2 != 0.0) {  // Torus: along `around` the curvature varies.
      const Eigen::Vector3d out = Eigen::Vector3d(center.x(), center.y(), 0.0).normalized();
      around = -n.dot(out) / std::hypot(center.x(), center.y());
    }
    const double unit = start.surface.unit();
    const auto at = [&](double u, double w) {
      return RingEnergy(start, v,
                        s + u * t1 + w * t2 + 0.5 * unit * (around * u * u + k2 * w * w) * n,
                        Energy::kSquaredArea);
    };
    const double spacing = RingSpacing(start, v);
    const double e = 1e-3 * spacing;
    Eigen::Vector2d gradient((at(e, 0) - at(-e, 0)) / (2 * e), (at(0, e) - at(0, -e)) / (2 * e));
    Eigen::Matrix2d hessian;
    hessian(0, 0) = (at(e, 0) - 2 * at(0, 0) + at(-e, 0)) / (e * e);
    hessian(1, 1) = (at(0, e) - 2 * at(0, 0) + at(0, -e)) / (e * e);
    hessian(0, 1) = hessian(1, 0) = (at(e, e) - at(e, -e) - at(-e, e) + at(-e, -e)) / (4 * e * e);
    const Eigen::Vector2d expected = -hessian.inverse() * gradient;
    // Longer steps are cut short; shorter ones stay on a face, which is flat.
    if (expected.norm() > 0.3 * spacing || expected.norm() < 0.01 * spacing) continue;
    GeometryPhase geometry(&start.surface, &start.density, &start.plan, Energy::kSquaredArea,
                           &start.mesh, &start.samples, &sampling_test::kOneThread);
    geometry.stretch = 1.0;
    geometry.rest = 1e-9;
    geometry.Pass(&never);
    const Eigen::Vector3d moved = start.samples.position[v] - s;
    EXPECT_NEAR(moved.dot(t1), expected[0], tolerance * expected.norm()) << "sample " << v;
    EXPECT_NEAR(moved.dot(t2), expected[1], tolerance * expected.norm()) << "sample " << v;
    ++compared;
  }
  EXPECT_GE(compared, 4);
}

TEST(GeometryPhase, NewtonStepAgreesWithFiniteDifferencesOnAPlane) {
  // The energy is a quadratic there and the step exact but for single precision.
  ExpectNewtonStep(shapes::PlaneGrid(1, 1, 10, 10), 400, 0.0, 0.0, 1e-5);
}

TEST(GeometryPhase, NewtonStepAgreesWithFiniteDifferencesOnACylinder) {
  ExpectNewtonStep(shapes::Cylinder(1, 2, 200, 20), 300, -1.0, 0.0, 0.03);
}

TEST(GeometryPhase, NewtonStepAgreesWithFiniteDifferencesOnATorus) {
  ExpectNewtonStep(shapes::Torus(1, 0.35, 160, 64), 500, 0.0, -1.0 / 0.35, 0.05);
}

// Where a single free sample comes to rest no point around has less energy.
void ExpectMinimum(const TriangleMesh& mesh, std::int64_t count, Energy energy, double slack) {
  Interrupt never;
  for (int which = 0; which < 6; ++which) {
    std::int32_t v = -1;
    Start start = OneFree(mesh, count, &v, which);
    const double before = RingEnergy(start, v, start.samples.position[v], energy);
    GeometryPhase geometry(&start.surface, &start.density, &start.plan, energy, &start.mesh,
                           &start.samples, &sampling_test::kOneThread);
    geometry.rest = 1e-7;
    for (int pass = 0; pass < 60; ++pass) geometry.Pass(&never);
    const Eigen::Vector3d s = start.samples.position[v];
    const double found = RingEnergy(start, v, s, energy);
    EXPECT_LE(found, before);
    Eigen::Vector3d t1;
    Eigen::Vector3d t2;
    TangentFrame(start.samples.normal[v], &t1, &t2);
    const double spacing = RingSpacing(start, v);
    double least = found;
    for (const double cell : {0.02, 0.002}) {
      for (int i = -10; i <= 10; ++i) {
        for (int j = -10; j <= 10; ++j) {
          const SurfacePoint point =
              start.surface.Follow(start.samples.face[v], s + cell * spacing * (i * t1 + j * t2));
          least = std::min(least, RingEnergy(start, v, point.position, energy));
        }
      }
    }
    EXPECT_GE(least, found - slack * std::max(found, before - found)) << "sample " << v;
  }
}

TEST(GeometryPhase, FreeSampleRestsAtTheMinimumOnAPlane) {
  ExpectMinimum(shapes::PlaneGrid(1, 1, 10, 10), 400, Energy::kTarget, 1e-5);
  ExpectMinimum(shapes::PlaneGrid(1, 1, 10, 10), 400, Energy::kSquaredArea, 1e-5);
}

TEST(GeometryPhase, FreeSampleRestsAtTheMinimumOnATorus) {
  ExpectMinimum(shapes::Torus(1, 0.35, 160, 64), 500, Energy::kTarget, 0.01);
  ExpectMinimum(shapes::Torus(1, 0.35, 160, 64), 500, Energy::kSquaredArea, 0.01);
}

struct Named {
  std::string name;
  TriangleMesh mesh;
};

std::vector<Named> Surfaces() {
  return {{"sphere", shapes::Icosphere(3)},
          {"torus", shapes::Torus(1, 0.35, 60, 24)},
          {"creased plate", shapes::PlateWithHoles(2, 1)},
          {"cube", shapes::Cube()},
          {"pointed arms", sampling_test::Jack(4)},
          {"plane", shapes::PlaneGrid(1, 1, 10, 10)},
          {"saddle", shapes::Saddle(20)},
          {"cap", shapes::SphereWithHole(0.8, 20, 30)}};
}

TEST(GeometryPhase, EnergyNeverRises) {
  Interrupt never;
  for (const Named& shape : Surfaces()) {
    for (const Energy energy : {Energy::kTarget, Energy::kSquaredArea}) {
      for (std::uint64_t seed = 0; seed < 2; ++seed) {
        SCOPED_TRACE(shape.name);
        Start start = *MakeStart(shape.mesh, 500, seed);
        GeometryPhase geometry(&start.surface, &start.density, &start.plan, energy, &start.mesh,
                               &start.samples, &sampling_test::kOneThread);
        double last = geometry.MeasureCapacities().energy;
        const double first = last;
        for (int pass = 0; pass < 25; ++pass) {
          geometry.Pass(&never);
          const double now = geometry.MeasureCapacities().energy;
          EXPECT_LE(now, last * (1.0 + 1e-12));
          last = now;
        }
        EXPECT_LT(last, first);
      }
    }
  }
}

TEST(GeometryPhase, BlocksSideBySideVisitEverySample) {
  Interrupt never;
  Start start = *MakeStart(shapes::Torus(1, 0.35, 60, 24), 40000, 1);
  const std::vector<Eigen::Vector3d> before = start.samples.position;
  const Parallel parallel(2);
  GeometryPhase geometry(&start.surface, &start.density, &start.plan, Energy::kTarget, &start.mesh,
                         &start.samples, &parallel);
  double last = geometry.MeasureCapacities().energy;
  for (int pass = 0; pass < 5; ++pass) {
    EXPECT_GT(geometry.Pass(&never), 0.0);
    const double now = geometry.MeasureCapacities().energy;
    EXPECT_LE(now, last * (1.0 + 1e-12));
    last = now;
  }
  // Of white noise next to none is where it should be.
  std::int64_t moved = 0;
  for (std::size_t i = 0; i < before.size(); ++i) moved += before[i] != start.samples.position[i];
  EXPECT_GT(moved, 39800);
}

// Above the number of samples from which there are blocks.
TEST(GeometryPhase, AlternationsFlipWhatTheirPassesSpoil) {
  Interrupt never;
  Start start = *MakeStart(shapes::Torus(1, 0.35, 60, 24), 40000, 1);
  const Parallel parallel(2);
  GeometryPhase geometry(&start.surface, &start.density, &start.plan, Energy::kTarget, &start.mesh,
                         &start.samples, &parallel);
  double last = geometry.MeasureCapacities().cv;
  for (int alternation = 0; alternation < 4; ++alternation) {
    geometry.ClearMoved();
    const GeometryPhase::Change change = geometry.Alternate(3, &never);
    EXPECT_GT(change.flips, 100);
    EXPECT_GT(change.largest_move, 0.0);
    const double now = geometry.MeasureCapacities().cv;
    EXPECT_LT(now, last);
    last = now;
  }
  EXPECT_EQ(FindFault(start.mesh), "");
  // What moves left for the next alternation apart, all is Delaunay.
  EdgeFlips flips(&start.mesh, &start.samples.position, &start.samples.normal);
  EXPECT_LT(flips.FlipAll(), 400) << "of 120,000 edges";
}

TEST(GeometryPhase, PassesTurnNoTriangleOver) {
  Interrupt never;
  for (const Named& shape : Surfaces()) {
    SCOPED_TRACE(shape.name);
    Start start = *MakeStart(shape.mesh, 500, 1);
    const std::vector<Eigen::Vector3i> triangles = Triangles(start.mesh);
    const std::int64_t before =
        quality::CountTurnedOver(start.samples.position, start.samples.normal, triangles);
    GeometryPhase geometry(&start.surface, &start.density, &start.plan, Energy::kTarget,
                           &start.mesh, &start.samples, &sampling_test::kOneThread);
    for (int pass = 0; pass < 20; ++pass) geometry.Pass(&never);
    EXPECT_LE(quality::CountTurnedOver(start.samples.position, start.samples.normal, triangles),
              before);
  }
}

TEST(GeometryPhase, SamplesStayOnTheSurfaceAndOnTheirLoops) {
  Interrupt never;
  for (const Named& shape : Surfaces()) {
    SCOPED_TRACE(shape.name);
    Start start = *MakeStart(shape.mesh, 400, 1);
    const Samples before = start.samples;
    GeometryPhase geometry(&start.surface, &start.density, &start.plan, Energy::kTarget,
                           &start.mesh, &start.samples, &sampling_test::kOneThread);
    for (int pass = 0; pass < 10; ++pass) geometry.Pass(&never);
    const Samples& now = start.samples;
    for (std::int32_t v = 0; v < now.count(); ++v) {
      Eigen::Vector3d position = Eigen::Vector3d::Zero();
      for (int k = 0; k < 3; ++k) {
        position +=
            now.weights[v][k] * start.surface.positions()[start.surface.faces()[now.face[v]][k]];
      }
      EXPECT_LT((position - now.position[v]).norm(), 1e-14);
      EXPECT_EQ(now.component[v], start.surface.face_components()[now.face[v]]);
      if (now.kind[v] == SampleMesh::Kind::kFixed) {
        EXPECT_EQ(now.position[v], before.position[v]);
      }
      if (now.kind[v] != SampleMesh::Kind::kInterior) {
        EXPECT_EQ(now.loop[v], before.loop[v]);
        const SurfacePoint on_loop =
            PointOnLoop(start.surface, start.plan, now.loop[v], now.arc[v]);
        EXPECT_LT((on_loop.position - now.position[v]).norm(), 1e-14);
      }
    }
  }
}

// However small the triangles beside them are before the rest has settled.
TEST(GeometryPhase, BoundarySamplesKeepApartWhileTheRestSettles) {
  Interrupt never;
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    Start start = *MakeStart(shapes::SphereWithHole(0.8, 40, 60), 3000, seed);
    const auto nearest = [&] {
      double least = 1e9;
      for (std::size_t h = 0; h < start.mesh.origin.size(); ++h) {
        if (start.mesh.origin[h] < 0 || start.mesh.twin[h] >= 0) continue;
        const auto half_edge = static_cast<std::int32_t>(h);
        least = std::min(least, (start.samples.position[start.mesh.origin[h]] -
                                 start.samples.position[start.mesh.Target(half_edge)])
                                    .norm());
      }
      return least / start.plan.spacing;
    };
    GeometryPhase geometry(&start.surface, &start.density, &start.plan, Energy::kTarget,
                           &start.mesh, &start.samples, &sampling_test::kOneThread);
    for (int alternation = 0; alternation < 6; ++alternation) {
      geometry.Alternate(3, &never);
      EXPECT_GT(nearest(), 0.75) << "seed " << seed << " alternation " << alternation;
    }
  }
}

TEST(GeometryPhase, SpreadAgreesWithTheQualityRoom) {
  const Start made = *MakeStart(shapes::Icosphere(3), 700, 2);
  Start start = made;
  const GeometryPhase geometry(&start.surface, &start.density, &start.plan, Energy::kTarget,
                               &start.mesh, &start.samples, &sampling_test::kOneThread);
  const quality::CapacityFigures figures =
      quality::MeasureCapacities(start.samples.position, Triangles(start.mesh));
  EXPECT_NEAR(geometry.MeasureCapacities().cv, figures.cv, 1e-9);
  EXPECT_NEAR(geometry.EstimateCapacities().cv, figures.cv, 6e-8 * figures.cv);
  double sum = 0.0;
  for (std::int32_t t = 0; t < start.mesh.triangle_count(); ++t)
    sum += geometry.Capacity(TriangleIndex(t));
  EXPECT_NEAR(sum * start.plan.components[0].target, figures.total, 1e-9);
}

TEST(GeometryPhase, OnlyActiveSamplesMove) {
  Interrupt never;
  Start start = *MakeStart(shapes::Icosphere(3), 500, 2);
  GeometryPhase geometry(&start.surface, &start.density, &start.plan, Energy::kTarget, &start.mesh,
                         &start.samples, &sampling_test::kOneThread);
  geometry.DeactivateAll();
  const std::vector<Eigen::Vector3d> before = start.samples.position;
  EXPECT_EQ(geometry.Pass(&never), 0.0);
  EXPECT_EQ(start.samples.position, before);
  geometry.ClearMoved();
  geometry.Activate(17);
  EXPECT_GT(geometry.Pass(&never), 0.0);
  std::vector<bool> allowed(500, false);
  allowed[17] = true;
  start.mesh.ForEachOutgoing(17, [&](std::int32_t h) { allowed[start.mesh.Target(h)] = true; });
  for (int v = 0; v < 500; ++v) {
    if (!allowed[v]) {
      EXPECT_EQ(start.samples.position[v], before[v]);
      EXPECT_EQ(geometry.moved()[v], 0);
    }
  }
}

TEST(GeometryPhase, ManyPassesAndNoFlipsComeToRest) {
  Interrupt never;
  Start start = *MakeStart(shapes::Icosphere(3), 300, 2);
  GeometryPhase geometry(&start.surface, &start.density, &start.plan, Energy::kTarget, &start.mesh,
                         &start.samples, &sampling_test::kOneThread);
  int passes = 0;
  while (passes < 2000 && geometry.Pass(&never) > 0.0) ++passes;
  EXPECT_LT(passes, 2000);
}

}  // namespace
}  // namespace ccst::internal
