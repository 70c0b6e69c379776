#include "core/surface/curvature.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <Eigen/Geometry>

#include "core/base/portable_math.h"
#include "core/surface/frame.h"

namespace ccst {
namespace {

/// Weighted tensors at a vertex: (xx, xy, xz, yy, yz, zz), then the weight.
using Sum = Eigen::Matrix<double, 7, 1>;

/// Vertices whose sums one thread divides in one go.
constexpr std::int64_t kPiece = 8192;

/// What one face says of the bending at its corners: calls add(k, sum) for each.
template <typename Add>
void AddFace(const std::array<Eigen::Vector3d, 3>& corner,
             const std::array<Eigen::Vector3d, 3>& corner_normal, const Add& add) {
  const std::array<Eigen::Vector3d, 3> edge = {corner[2] - corner[1], corner[0] - corner[2],
                                               corner[1] - corner[0]};
  Eigen::Vector3d normal = edge[0].cross(edge[1]);
  const double twice_area = normal.norm();
  const std::array<double, 3> squared = {edge[0].squaredNorm(), edge[1].squaredNorm(),
                                         edge[2].squaredNorm()};
  // The normals of a sliver say nothing about the bending across it.
  if (!(twice_area > 1e-6 * std::max({squared[0], squared[1], squared[2]}))) return;
  normal /= twice_area;
  const double length = std::sqrt(squared[0]);
  const Eigen::Vector3d u = edge[0] / length;
  const Eigen::Vector3d v = normal.cross(u);
  // Least squares over the three edges: II * (edge in the plane) = difference of the normals. The
  // first edge is (length, 0) in the plane; edges and differences add up to zero.
  const double eu = edge[1].dot(u);
  const double ev = twice_area / length;
  const Eigen::Vector3d change0 = corner_normal[2] - corner_normal[1];
  const Eigen::Vector3d change1 = corner_normal[0] - corner_normal[2];
  const double nu0 = change0.dot(u);
  const double nv0 = change0.dot(v);
  const double nu1 = change1.dot(u);
  const double nv1 = change1.dot(v);
  const double eu2 = -length - eu;
  const double nu2 = -nu0 - nu1;
  const double nv2 = -nv0 - nv1;
  // The normal equations are (a b 0; b a + c b; 0 b c) x = r; a c - b^2 is three times the square
  // of twice the area.
  const double a = squared[0] + eu * eu + eu2 * eu2;
  const double b = (eu - eu2) * ev;
  const double c = 2.0 * ev * ev;
  const double r0 = length * nu0 + eu * nu1 + eu2 * nu2;
  const double r1 = length * nv0 + eu * nv1 + eu2 * nv2 + ev * (nu1 - nu2);
  const double r2 = ev * (nv1 - nv2);
  const double ac = a * c;
  const double f1 = (r1 * ac - b * (r0 * c + r2 * a)) / ((a + c) * 3.0 * twice_area * twice_area);
  const double f0 = (r0 - b * f1) / a;
  const double f2 = (r2 - b * f1) / c;
  if (!std::isfinite(f0 + f1 + f2)) return;
  for (int k = 0; k < 3; ++k) {
    // By the smallest rotation that takes the face's normal to the corner's.
    const Eigen::Vector3d& to = corner_normal[k];
    const double cosine = normal.dot(to);
    Eigen::Vector3d ru = u;
    Eigen::Vector3d rv = v;
    if (cosine >= -0.999999) {
      const Eigen::Vector3d middle = (normal + to) / (1.0 + cosine);
      ru -= u.dot(to) * middle;
      rv -= v.dot(to) * middle;
    }
    // Corner weight: the part of the face nearest the corner (Meyer et al. 2003, approximated by a
    // third for obtuse faces).
    double weight = twice_area / 6.0;
    const int i = (k + 1) % 3;
    const int j = (k + 2) % 3;
    const double cos_j = -edge[i].dot(edge[k]);  // At corner k + 2, times the sides there.
    const double cos_i = -edge[j].dot(edge[k]);
    if (cos_j > 0.0 && cos_i > 0.0 && edge[i].dot(edge[j]) < 0.0) {
      weight = (squared[j] * cos_j + squared[i] * cos_i) / (8.0 * twice_area);
    }
    // A bending towards the normal counts as positive.
    const Eigen::Vector3d left = -weight * (f0 * ru + f1 * rv);
    const Eigen::Vector3d right = -weight * (f1 * ru + f2 * rv);
    Sum sum;
    sum[0] = ru[0] * left[0] + rv[0] * right[0];
    sum[1] = ru[0] * left[1] + rv[0] * right[1];
    sum[2] = ru[0] * left[2] + rv[0] * right[2];
    sum[3] = ru[1] * left[1] + rv[1] * right[1];
    sum[4] = ru[1] * left[2] + rv[1] * right[2];
    sum[5] = ru[2] * left[2] + rv[2] * right[2];
    sum[6] = weight;
    add(k, sum);
  }
}

}  // namespace

std::vector<std::array<float, 6>> VertexShapeTensors(const std::vector<Eigen::Vector3d>& positions,
                                                     const std::vector<Eigen::Vector3i>& faces,
                                                     const CornerSums& corners,
                                                     const std::vector<Eigen::Vector3d>& normals,
                                                     const Parallel& parallel,
                                                     Interrupt* interrupt) {
  std::vector<Sum> sums(positions.size(), Sum::Zero());
  corners.Add(
      parallel, interrupt,
      [&](std::int64_t f, const auto& add) {
        const Eigen::Vector3i& face = faces[static_cast<std::size_t>(f)];
        AddFace({positions[face[0]], positions[face[1]], positions[face[2]]},
                {normals[face[0]], normals[face[1]], normals[face[2]]}, add);
      },
      &sums);
  std::vector<std::array<float, 6>> shapes(positions.size());
  parallel.ForRanges(
      static_cast<std::int64_t>(shapes.size()), kPiece, [&](std::int64_t first, std::int64_t end) {
        for (auto i = static_cast<std::size_t>(first); i < static_cast<std::size_t>(end); ++i) {
          const double scale = sums[i][6] > 0.0 ? 1.0 / sums[i][6] : 0.0;
          for (int k = 0; k < 6; ++k) {
            shapes[i][k] = static_cast<float>(sums[i][k] * scale);
          }
        }
      });
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
  const double spread = PortableHypot(half, f);
  const double angle = 0.5 * PortableAtan2(f, half);
  const Eigen::Vector3d larger = PortableCos(angle) * t1 + PortableSin(angle) * t2;
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
