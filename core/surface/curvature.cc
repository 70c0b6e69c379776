#include "core/surface/curvature.h"

#include <cmath>

#include <Eigen/Dense>

#include "core/surface/frame.h"

namespace ccst {
namespace {

/// Rotates `x` by the smallest rotation that takes the unit vector `from` to the unit vector `to`.
Eigen::Vector3d RotateFromTo(const Eigen::Vector3d& x, const Eigen::Vector3d& from,
                             const Eigen::Vector3d& to) {
  const double cosine = from.dot(to);
  if (cosine < -0.999999) return x;
  const Eigen::Vector3d axis = from.cross(to);
  return cosine * x + axis.cross(x) + axis * (axis.dot(x) / (1.0 + cosine));
}

}  // namespace

std::vector<std::array<float, 6>> VertexShapeTensors(const std::vector<Eigen::Vector3d>& positions,
                                                     const std::vector<Eigen::Vector3i>& faces,
                                                     const std::vector<Eigen::Vector3d>& normals,
                                                     Interrupt* interrupt) {
  std::vector<std::array<double, 6>> sums(positions.size(), {0, 0, 0, 0, 0, 0});
  std::vector<double> weights(positions.size(), 0.0);
  std::int64_t counter = 0;
  for (const Eigen::Vector3i& face : faces) {
    if (interrupt->RequestedAt(counter++)) break;
    std::array<Eigen::Vector3d, 3> edge;
    for (int k = 0; k < 3; ++k) {
      edge[k] = positions[face[(k + 2) % 3]] - positions[face[(k + 1) % 3]];
    }
    Eigen::Vector3d normal = edge[0].cross(edge[1]);
    const double twice_area = normal.norm();
    const double longest = std::max({edge[0].norm(), edge[1].norm(), edge[2].norm()});
    // The normals of a sliver say nothing about the bending across it.
    if (!(twice_area > 1e-6 * longest * longest)) continue;
    normal /= twice_area;
    const Eigen::Vector3d u = edge[0].normalized();
    const Eigen::Vector3d v = normal.cross(u);
    // Least squares over the three edges: II * (edge in the plane) = difference of the normals.
    Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (int k = 0; k < 3; ++k) {
      const double eu = edge[k].dot(u);
      const double ev = edge[k].dot(v);
      const Eigen::Vector3d change = normals[face[(k + 2) % 3]] - normals[face[(k + 1) % 3]];
      const double nu = change.dot(u);
      const double nv = change.dot(v);
      matrix(0, 0) += eu * eu;
      matrix(0, 1) += eu * ev;
      matrix(1, 1) += eu * eu + ev * ev;
      matrix(1, 2) += eu * ev;
      matrix(2, 2) += ev * ev;
      right += Eigen::Vector3d(eu * nu, ev * nu + eu * nv, ev * nv);
    }
    matrix(1, 0) = matrix(0, 1);
    matrix(2, 1) = matrix(1, 2);
    const Eigen::Vector3d form = -matrix.ldlt().solve(right);
    if (!form.allFinite()) continue;
    for (int k = 0; k < 3; ++k) {
      const int vertex = face[k];
      const Eigen::Vector3d ru = RotateFromTo(u, normal, normals[vertex]);
      const Eigen::Vector3d rv = RotateFromTo(v, normal, normals[vertex]);
      const Eigen::Matrix3d tensor = form[0] * ru * ru.transpose() +
                                     form[1] * (ru * rv.transpose() + rv * ru.transpose()) +
                                     form[2] * rv * rv.transpose();
      // Corner weight: the part of the face nearest the corner (Meyer et al. 2003, approximated
      // by a third for obtuse faces).
      double weight = twice_area / 6.0;
      const Eigen::Vector3d& next = edge[(k + 2) % 3];          // corner k -> k + 1
      const Eigen::Vector3d& last = edge[(k + 1) % 3];          // corner k + 2 -> k
      const double cot_next = -last.dot(edge[k]) / twice_area;  // at corner k + 2
      const double cot_last = -next.dot(edge[k]) / twice_area;  // at corner k + 1
      if (cot_next > 0.0 && cot_last > 0.0 && next.dot(last) < 0.0) {
        weight = (next.squaredNorm() * cot_next + last.squaredNorm() * cot_last) / 8.0;
      }
      auto& sum = sums[vertex];
      sum[0] += weight * tensor(0, 0);
      sum[1] += weight * tensor(0, 1);
      sum[2] += weight * tensor(0, 2);
      sum[3] += weight * tensor(1, 1);
      sum[4] += weight * tensor(1, 2);
      sum[5] += weight * tensor(2, 2);
      weights[vertex] += weight;
    }
  }
  std::vector<std::array<float, 6>> shapes(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const double scale = weights[i] > 0.0 ? 1.0 / weights[i] : 0.0;
    for (int k = 0; k < 6; ++k) shapes[i][k] = static_cast<float>(sums[i][k] * scale);
  }
  return shapes;
}

PrincipalCurvatures Diagonalise(const Eigen::Matrix<double, 6, 1>& shape,
                                const Eigen::Vector3d& normal) {
  Eigen::Vector3d t1;
  Eigen::Vector3d t2;
  TangentFrame(normal, &t1, &t2);
  const double e = TensorProduct(shape, t1, t1);
  const double f = TensorProduct(shape, t1, t2);
  const double g = TensorProduct(shape, t2, t2);
  const double mean = 0.5 * (e + g);
  const double half = 0.5 * (e - g);
  const double spread = std::hypot(half, f);
  const double angle = 0.5 * std::atan2(f, half);
  const Eigen::Vector3d larger = std::cos(angle) * t1 + std::sin(angle) * t2;
  const Eigen::Vector3d smaller = normal.cross(larger);
  PrincipalCurvatures result{mean + spread, mean - spread, larger, smaller};
  if (std::abs(result.k1) < std::abs(result.k2)) {
    std::swap(result.k1, result.k2);
    result.direction1 = smaller;
    result.direction2 = -larger;
  }
  return result;
}

}  // namespace ccst
