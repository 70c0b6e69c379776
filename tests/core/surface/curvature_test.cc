// Curvature against closed forms, at the vertices and in terms of the normal curvature along the
// two principal directions. What is asserted of the order of convergence is what is documented.

#include "core/surface/curvature.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "core/random/random.h"
#include "core/surface/frame.h"
#include "core/surface/surface.h"
#include "tests/support/shapes.h"

namespace ccst {
namespace {

constexpr double kPi = std::numbers::pi;

// Principal curvatures with outward normals as k1, k2 and directions, at a point of the surface.
using ClosedForm = std::function<PrincipalCurvatures(const Eigen::Vector3d&)>;

// Errors of the shape operator at vertices off the boundary rows, over the largest curvature: the
// matrix of the operator in the exact principal frame against diag(k1, k2).
struct Errors {
  double worst = 0.0;
  double rms = 0.0;
};

Errors MeasureErrors(const TriangleMesh& mesh, const ClosedForm& exact) {
  const Surface surface = *Surface::Build(mesh);
  std::vector<bool> near_boundary(surface.vertex_count(), false);
  for (int ring = 0; ring < 2; ++ring) {
    std::vector<bool> more = near_boundary;
    for (int h = 0; h < 3 * surface.face_count(); ++h) {
      if (surface.twins()[h] >= 0 && !near_boundary[surface.Origin(h)]) continue;
      for (int k = 0; k < 3; ++k) more[surface.faces()[h / 3][k]] = true;
    }
    near_boundary = more;
  }
  double worst = 0.0;
  double squares = 0.0;
  double largest = 0.0;
  int count = 0;
  for (int v = 0; v < surface.vertex_count(); ++v) {
    if (near_boundary[v]) continue;
    const int h = surface.outgoing()[v];
    const Eigen::Matrix<double, 6, 1> shape =
        surface.ShapeAt(h / 3, Eigen::Vector3d::Unit(h % 3)) / surface.unit();
    const PrincipalCurvatures k = exact(surface.ToMesh(surface.positions()[v]));
    const double e11 = TensorProduct(shape, k.direction1, k.direction1) - k.k1;
    const double e12 = TensorProduct(shape, k.direction1, k.direction2);
    const double e22 = TensorProduct(shape, k.direction2, k.direction2) - k.k2;
    worst = std::max({worst, std::abs(e11), std::abs(e12), std::abs(e22)});
    squares += e11 * e11 + 2.0 * e12 * e12 + e22 * e22;
    ++count;
    largest = std::max({largest, std::abs(k.k1), std::abs(k.k2)});
  }
  return {worst / largest, std::sqrt(squares / count) / largest};
}

PrincipalCurvatures OfSphere(const Eigen::Vector3d& p) {
  Eigen::Vector3d t1;
  Eigen::Vector3d t2;
  TangentFrame(p.normalized(), &t1, &t2);
  return {-1.0 / 3.0, -1.0 / 3.0, t1, t2};
}

PrincipalCurvatures OfCylinder(const Eigen::Vector3d& p) {
  return {-0.5, 0.0, Eigen::Vector3d(-p.y(), p.x(), 0).normalized(), Eigen::Vector3d::UnitZ()};
}

PrincipalCurvatures OfTorus(const Eigen::Vector3d& p) {
  const Eigen::Vector3d out = Eigen::Vector3d(p.x(), p.y(), 0).normalized();
  const Eigen::Vector3d normal = (p - out).normalized();
  const Eigen::Vector3d around(-out.y(), out.x(), 0);
  return {-1.0 / 0.35, -normal.dot(out) / std::hypot(p.x(), p.y()), around.cross(normal), around};
}

PrincipalCurvatures OfSaddle(const Eigen::Vector3d& p) {
  // z = x^2 - y^2 as a graph; eigenvectors of I^-1 II.
  const double zx = 2.0 * p.x();
  const double zy = -2.0 * p.y();
  const double w = std::sqrt(1.0 + zx * zx + zy * zy);
  Eigen::Matrix2d first;
  first << 1.0 + zx * zx, zx * zy, zx * zy, 1.0 + zy * zy;
  Eigen::Matrix2d second;
  second << 2.0 / w, 0.0, 0.0, -2.0 / w;
  const Eigen::Matrix2d shape = first.inverse() * second;
  const double mean = 0.5 * shape.trace();
  const double root = std::sqrt(mean * mean - shape.determinant());
  PrincipalCurvatures k;
  k.k1 = mean + root;
  k.k2 = mean - root;
  const auto direction = [&](double value) {
    const Eigen::Matrix2d m = shape - value * Eigen::Matrix2d::Identity();
    Eigen::Vector2d d =
        std::abs(m(0, 0)) + std::abs(m(0, 1)) > std::abs(m(1, 0)) + std::abs(m(1, 1))
            ? Eigen::Vector2d(-m(0, 1), m(0, 0))
            : Eigen::Vector2d(-m(1, 1), m(1, 0));
    return Eigen::Vector3d(d.x(), d.y(), zx * d.x() + zy * d.y()).normalized();
  };
  k.direction1 = direction(k.k1);
  k.direction2 = direction(k.k2);
  return k;
}

// Errors on a mesh and two refinements by two; prints and returns the orders of the last one.
Errors LastOrders(const char* name, const std::vector<TriangleMesh>& meshes,
                  const ClosedForm& exact, const Errors& bound) {
  std::vector<Errors> errors;
  for (const TriangleMesh& mesh : meshes) errors.push_back(MeasureErrors(mesh, exact));
  const Errors& coarse = errors[errors.size() - 2];
  const Errors& fine = errors.back();
  EXPECT_LT(fine.worst, bound.worst);
  EXPECT_LT(fine.rms, bound.rms);
  const Errors orders = {std::log2(coarse.worst / fine.worst), std::log2(coarse.rms / fine.rms)};
  std::printf("%s: relative error %.1e at worst, %.1e rms; order %.2f at worst, %.2f rms\n", name,
              fine.worst, fine.rms, orders.worst, orders.rms);
  return orders;
}

// A torus whose vertices are moved over the surface by up to a fifth of a cell.
TriangleMesh IrregularTorus(int around) {
  const int across = around / 2;
  TriangleMesh mesh = shapes::Torus(1.0, 0.35, around, across);
  const CounterRandom random(4, 4);
  for (int v = 0; v < static_cast<int>(mesh.positions.size()); ++v) {
    const double u = 2.0 * kPi * (v % around + 0.4 * (random.Uniform(2 * v) - 0.5)) / around;
    const double w = 2.0 * kPi * (v / around + 0.4 * (random.Uniform(2 * v + 1) - 0.5)) / across;
    const double ring = 1.0 + 0.35 * std::cos(w);
    mesh.positions[v] = {ring * std::cos(u), ring * std::sin(u), 0.35 * std::sin(w)};
  }
  return mesh;
}

TEST(Curvature, TorusConverges) {
  const Errors order = LastOrders("torus",
                                  {shapes::Torus(1, 0.35, 40, 20), shapes::Torus(1, 0.35, 80, 40),
                                   shapes::Torus(1, 0.35, 160, 80)},
                                  OfTorus, {0.01, 0.01});
  EXPECT_GT(order.worst, 1.0);
  EXPECT_GT(order.rms, 1.0);
}

TEST(Curvature, SaddleConverges) {
  const Errors order =
      LastOrders("saddle", {shapes::Saddle(16), shapes::Saddle(32), shapes::Saddle(64)}, OfSaddle,
                 {0.01, 0.01});
  EXPECT_GT(order.worst, 1.0);
  EXPECT_GT(order.rms, 1.0);
}

TEST(Curvature, SphereConvergesOnAverage) {
  const Errors order = LastOrders(
      "sphere", {shapes::Icosphere(2, 3.0), shapes::Icosphere(3, 3.0), shapes::Icosphere(4, 3.0)},
      OfSphere, {0.1, 0.05});
  EXPECT_GT(order.rms, 0.3);
}

TEST(Curvature, CylinderIsExactUpToItsPolygon) {
  const Errors error = MeasureErrors(shapes::Cylinder(2, 4, 128, 40), OfCylinder);
  EXPECT_LT(error.worst, 1e-6);
}

TEST(Curvature, IrregularTorusStaysNearTheClosedForm) {
  // Vertices that no rule places: area-weighted normals are first order there, so the curvature
  // that is derived from their differences keeps an error however fine the mesh.
  const Errors coarse = MeasureErrors(IrregularTorus(60), OfTorus);
  const Errors fine = MeasureErrors(IrregularTorus(240), OfTorus);
  std::printf("irregular torus: rms %.3f and %.3f, worst %.3f and %.3f\n", coarse.rms, fine.rms,
              coarse.worst, fine.worst);
  EXPECT_LT(fine.rms, 0.1);
  EXPECT_LT(fine.worst, 0.5);
}

TEST(Curvature, PlaneHasNone) {
  const Surface plane = *Surface::Build(shapes::PlaneGrid(2, 1, 10, 5));
  for (int f = 0; f < plane.face_count(); ++f) {
    EXPECT_LT(plane.ShapeAt(f, Eigen::Vector3d::Constant(1.0 / 3.0)).norm(), 1e-12);
  }
}

TEST(Curvature, SliversDoNotSpoilIt) {
  // A ring of needles at each pole.
  const Surface surface = *Surface::Build(shapes::UvSphere(40, 400));
  for (int f = 0; f < surface.face_count(); ++f) {
    const Eigen::Matrix<double, 6, 1> shape =
        surface.ShapeAt(f, Eigen::Vector3d::Constant(1.0 / 3.0)) / surface.unit();
    ASSERT_TRUE(shape.allFinite());
    EXPECT_LT(shape.norm(), 4.0);
  }
}

TEST(Curvature, DiagonaliseFindsKnownDirections) {
  for (double angle = 0.0; angle < kPi; angle += 0.1) {
    const Eigen::Vector3d normal = Eigen::Vector3d(0.3, -0.5, 0.8).normalized();
    Eigen::Vector3d t1;
    Eigen::Vector3d t2;
    TangentFrame(normal, &t1, &t2);
    const Eigen::Vector3d d1 = std::cos(angle) * t1 + std::sin(angle) * t2;
    const Eigen::Vector3d d2 = normal.cross(d1);
    const Eigen::Matrix3d m = -3.0 * d1 * d1.transpose() + 2.0 * d2 * d2.transpose();
    Eigen::Matrix<double, 6, 1> shape;
    shape << m(0, 0), m(0, 1), m(0, 2), m(1, 1), m(1, 2), m(2, 2);
    const PrincipalCurvatures k = Diagonalise(shape, normal);
    EXPECT_NEAR(k.k1, -3.0, 1e-12);
    EXPECT_NEAR(k.k2, 2.0, 1e-12);
    EXPECT_NEAR(std::abs(k.direction1.dot(d1)), 1.0, 1e-12);
    EXPECT_NEAR(std::abs(k.direction2.dot(d2)), 1.0, 1e-12);
  }
}

// A gently bent sheet has the same shape operator everywhere. Angles of principal directions would
// jump by pi somewhere between its vertices; the interpolated tensor must not show it.
TEST(Curvature, ConstantTensorFieldStaysConstantBetweenVertices) {
  const double bend = 1e-3;
  for (const double angle : {0.0, 0.3, 0.7853981633974483, 1.2, 1.5707963267948966, 2.5}) {
    TriangleMesh mesh = shapes::Moved(shapes::PlaneGrid(2.0, 2.0, 20, 20), {-1.0, -1.0, 0.0});
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    for (Eigen::Vector3d& p : mesh.positions) {
      const double a = c * p.x() + s * p.y();
      const double b = -s * p.x() + c * p.y();
      p.z() = bend * (a * a - b * b);
    }
    const Surface surface = *Surface::Build(mesh);
    const CounterRandom random(1, 2);
    const Eigen::Vector3d d1(c, s, 0);
    const Eigen::Vector3d d2(-s, c, 0);
    for (int i = 0; i < 2000; ++i) {
      const int f = static_cast<int>(random.Bits(3 * i) % surface.face_count());
      const double u = random.Uniform(3 * i + 1);
      const double v = random.Uniform(3 * i + 2) * (1.0 - u);
      const Eigen::Vector3d weights(u, v, 1.0 - u - v);
      Eigen::Vector3d place = Eigen::Vector3d::Zero();
      for (int k = 0; k < 3; ++k) {
        place += weights[k] * mesh.positions[surface.faces()[f][k]];
      }
      if (std::max(std::abs(place.x()), std::abs(place.y())) > 0.75) continue;
      const Eigen::Matrix<double, 6, 1> shape = surface.ShapeAt(f, weights) / surface.unit();
      EXPECT_NEAR(TensorProduct(shape, d1, d1), 2.0 * bend, 0.01 * bend);
      EXPECT_NEAR(TensorProduct(shape, d2, d2), -2.0 * bend, 0.01 * bend);
      EXPECT_NEAR(TensorProduct(shape, d1, d2), 0.0, 0.01 * bend);
    }
  }
}

TEST(TangentFrame, IsRightHandedAndOrthonormalEverywhere) {
  const CounterRandom random(8, 8);
  std::vector<Eigen::Vector3d> directions = {
      {0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {0, -1, 0}, {1, 0, -0.0}};
  for (int i = 0; i < 1000; ++i) {
    const double z = 2.0 * random.Uniform(2 * i) - 1.0;
    const double a = 2.0 * kPi * random.Uniform(2 * i + 1);
    const double r = std::sqrt(1.0 - z * z);
    directions.emplace_back(r * std::cos(a), r * std::sin(a), z);
  }
  for (const Eigen::Vector3d& n : directions) {
    Eigen::Vector3d t1;
    Eigen::Vector3d t2;
    TangentFrame(n, &t1, &t2);
    EXPECT_LT((t1.cross(t2) - n).norm(), 1e-12);
    EXPECT_NEAR(t1.norm(), 1.0, 1e-12);
    EXPECT_NEAR(t1.dot(t2), 0.0, 1e-12);
  }
}

}  // namespace
}  // namespace ccst
