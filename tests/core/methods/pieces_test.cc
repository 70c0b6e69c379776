#include "core/methods/pieces.h"

#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "core/methods/capacity_curve.h"
#include "core/random/random.h"
#include "tests/core/methods/methods_test_util.h"
#include "tests/support/shapes.h"

namespace ccst {
namespace {

using methods_test::DensityOf;
using methods_test::SurfaceOf;

Piece RightTriangle() {
  Piece piece;
  piece.face = 0;
  piece.corners = {Eigen::Vector4f(0, 0, 0, 1), Eigen::Vector4f(1, 0, 0, 3),
                   Eigen::Vector4f(0, 1, 0, 2)};
  return piece;
}

double AreaOf(const Piece& piece) {
  const Eigen::Vector3d a = piece.corners[0].head<3>().cast<double>();
  return 0.5 * (piece.corners[1].head<3>().cast<double>() - a)
                   .cross(piece.corners[2].head<3>().cast<double>() - a)
                   .norm();
}

TEST(PieceClipper, MatchesQuadratureByBruteForce) {
  const Piece piece = RightTriangle();
  const std::vector<Eigen::Vector3d> sites = {
      {0.2, 0.2, 0.1}, {0.7, 0.1, 0.0}, {0.1, 0.8, -0.2}, {0.4, 0.45, 0.0}, {2.0, 2.0, 0.0}};
  std::vector<PieceClipper::Moments> expected(sites.size());
  constexpr int kCells = 1000;
  for (int x = 0; x < kCells; ++x) {
    for (int y = 0; x + y < kCells; ++y) {
      // Centroids of the small triangles that stand like the large one, and of the others.
      for (const double shift : {1.0 / 3.0, 2.0 / 3.0}) {
        if (shift > 0.5 && x + y + 1 >= kCells) continue;
        const Eigen::Vector3d place((x + shift) / kCells, (y + shift) / kCells, 0.0);
        std::size_t at = 0;
        for (std::size_t k = 1; k < sites.size(); ++k) {
          if ((sites[k] - place).squaredNorm() < (sites[at] - place).squaredNorm()) at = k;
        }
        const double weight =
            (1.0 + 2.0 * place[0] + place[1]) * 0.5 / (static_cast<double>(kCells) * kCells);
        expected[at].first += weight * Eigen::Vector4d(place[0], place[1], place[2], 1.0);
        expected[at].second += weight * (place - sites[at]).squaredNorm();
      }
    }
  }
  PieceClipper clipper;
  for (std::size_t k = 0; k < sites.size(); ++k) {
    const PieceClipper::Moments moments = clipper.Integrate(piece, sites, k);
    EXPECT_LE((moments.first - expected[k].first).norm(), 1e-4) << k;
    EXPECT_NEAR(moments.second, expected[k].second, 1e-4) << k;
  }
}

TEST(PieceClipper, PartsAddUpToTheWhole) {
  const Piece piece = RightTriangle();
  const CounterRandom random(1, 1);
  PieceClipper clipper;
  for (int round = 0; round < 100; ++round) {
    std::vector<Eigen::Vector3d> sites;
    for (int k = 0; k < 1 + round % 8; ++k) {
      const std::uint64_t i = 100 * round + 3 * k;
      sites.emplace_back(random.Uniform(i), random.Uniform(i + 1), random.Uniform(i + 2) - 0.5);
    }
    if (round % 3 == 0) sites.push_back(sites.front());
    Eigen::Vector4d sum = Eigen::Vector4d::Zero();
    for (std::size_t k = 0; k < sites.size(); ++k) sum += clipper.Integrate(piece, sites, k).first;
    // Integrals of (1 + 2 x + y) (x, y, 0, 1) over the triangle.
    EXPECT_LE((sum - Eigen::Vector4d(3.0 / 8.0, 1.0 / 3.0, 0.0, 1.0)).norm(), 1e-12) << round;
  }
}

TEST(CutPieces, CoverTheSurfaceInSmallPieces) {
  const Surface surface = SurfaceOf(shapes::Cube());
  const Density density = DensityOf(surface, [](const auto& p) { return 2.0 + p.x(); });
  Interrupt never;
  const double r_max = HexagonalSpacing(surface, 500);
  const std::vector<Piece> pieces = CutPieces(surface, density, r_max, &never);
  std::vector<double> areas(surface.face_count(), 0.0);
  for (const Piece& piece : pieces) {
    areas[piece.face] += AreaOf(piece);
    const double rho = std::sqrt(piece.corners[0][3]);
    for (int k = 0; k < 3; ++k) {
      const double edge = (piece.corners[(k + 1) % 3] - piece.corners[k]).head<3>().norm();
      EXPECT_LE(edge, 1.5 * r_max / std::sqrt(rho));
    }
  }
  for (std::int32_t f = 0; f < surface.face_count(); ++f) {
    EXPECT_NEAR(areas[f], surface.face_areas()[f], 1e-6);
  }
  EXPECT_LE(pieces.size(), 28u * 500u);
}

TEST(CutPieces, NeedlesStayFew) {
  TriangleMesh mesh = shapes::SingleTriangle();
  for (Eigen::Vector3d& p : mesh.positions) p[1] *= 1e-6;
  const Surface needle = SurfaceOf(mesh);
  Interrupt never;
  const auto pieces =
      CutPieces(needle, Density::Uniform(needle), HexagonalSpacing(needle, 100), &never);
  EXPECT_LE(pieces.size(), 1u + 28u * 100u);
}

}  // namespace
}  // namespace ccst
