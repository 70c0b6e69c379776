#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/base/interrupt.h"
#include "core/density/density.h"
#include "core/surface/surface.h"

namespace ccst {

/// A triangle of a finer cut of the surface. The weight is linear over it.
struct Piece {
  std::array<Eigen::Vector4f, 3> corners;  ///< Position and weight.
  std::int32_t face = -1;                  ///< Of the surface.
};

/// Halves the faces across their longest edges until those are at most 1.2 of the spacing
/// r_max / sqrt(rho) there, or the area is negligible; the weights are rho^2. At most
/// F + 28 n pieces for n samples, some 4 n when faces are large and well shaped. Faces without
/// area are left out. Unfinished when `interrupt` was requested.
std::vector<Piece> CutPieces(const Surface& surface, const Density& density, double r_max,
                             Interrupt* interrupt);

/// Parts of a piece that are nearest to one of several sites, and integrals over them.
class PieceClipper {
 public:
  /// Integrals over a part: weight times (position, 1), and weight times squared distance.
  struct Moments {
    Eigen::Vector4d first = Eigen::Vector4d::Zero();
    double second = 0.0;
  };

  /// Over the part of `piece` that is nearer to site `k` than to the others; where two are at the
  /// same place, the first has it all. Distances of `second` are from site k. Exact.
  /// Source: clipping by half-spaces, Sutherland and Hodgman, CACM 17(1), 1974; quadrature of
  /// degree 3, Strang and Fix 1973.
  Moments Integrate(const Piece& piece, const std::vector<Eigen::Vector3d>& sites, std::size_t k);

 private:
  std::vector<Eigen::Vector4d> polygon_;
  std::vector<Eigen::Vector4d> clipped_;
};

}  // namespace ccst
