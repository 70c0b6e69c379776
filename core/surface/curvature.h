#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/base/interrupt.h"
#include "core/parallel/parallel.h"
#include "core/surface/corner_sums.h"

namespace ccst {

/// Shape operator of every vertex as a symmetric 3 x 3 tensor (xx, xy, xz, yy, yz, zz) in the
/// vertex's tangent plane [1 / unit of positions]. Positive along directions in which the surface
/// bends towards the normal, so a sphere with outward normals has -1 / R.
/// @param positions V x 3. @param faces F x 3. @param corners  of `faces`. @param normals V x 3
/// unit. @param interrupt  when requested, the result is unfinished. Cost O(V + F). Converges at
/// first order or better on regular meshes and keeps an error of about a tenth on irregular ones
/// (measured, core/docs/algorithm.md).
/// Source: Rusinkiewicz, "Estimating curvatures and their derivatives on triangle meshes", 3DPVT
/// 2004.
std::vector<std::array<float, 6>> VertexShapeTensors(const std::vector<Eigen::Vector3d>& positions,
                                                     const std::vector<Eigen::Vector3i>& faces,
                                                     const CornerSums& corners,
                                                     const std::vector<Eigen::Vector3d>& normals,
                                                     const Parallel& parallel,
                                                     Interrupt* interrupt);

/// Principal curvatures, largest absolute value first, and their directions in the plane
/// orthogonal to `normal`.
struct PrincipalCurvatures {
  double k1 = 0.0;
  double k2 = 0.0;
  Eigen::Vector3d direction1 = Eigen::Vector3d::Zero();
  Eigen::Vector3d direction2 = Eigen::Vector3d::Zero();
};

/// Diagonalises a tensor of VertexShapeTensors() (or an interpolated one) in the plane orthogonal
/// to the unit vector `normal`.
PrincipalCurvatures Diagonalise(const Eigen::Matrix<double, 6, 1>& shape,
                                const Eigen::Vector3d& normal);

}  // namespace ccst
