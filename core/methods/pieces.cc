#include "core/methods/pieces.h"

#include <cmath>
#include <utility>

#include <Eigen/Geometry>

namespace ccst {
namespace {

/// Longest edge of a piece in spacings, and the area in squared spacings under which a piece is
/// left as it is, however long.
constexpr double kLongestEdge = 1.2;
constexpr double kNegligibleArea = 1.0 / 4.0;

using Corners = std::array<Eigen::Vector3d, 3>;

/// Position of the point of a face with the given weights.
Eigen::Vector3d PositionOf(const Surface& surface, std::int32_t face,
                           const Eigen::Vector3d& weights) {
  const Eigen::Vector3i& corner = surface.faces()[face];
  return weights[0] * surface.positions()[corner[0]] + weights[1] * surface.positions()[corner[1]] +
         weights[2] * surface.positions()[corner[2]];
}

/// Calls take(face, barycentric corners, positions) for every piece, until `interrupt` is
/// requested.
template <typename Take>
void ForEachPiece(const Surface& surface, const Density& density, double r_max,
                  Interrupt* interrupt, const Take& take) {
  std::vector<std::pair<Corners, double>> stack;  // Barycentric corners, area.
  std::int64_t steps = 0;
  for (std::int32_t f = 0; f < surface.face_count(); ++f) {
    if (!(surface.face_areas()[f] > 0.0)) continue;
    stack.push_back({{Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ()},
                     surface.face_areas()[f]});
    while (!stack.empty()) {
      if (interrupt->RequestedAt(steps++)) return;
      const auto [corners, area] = stack.back();
      stack.pop_back();
      Corners positions;
      for (int k = 0; k < 3; ++k) positions[k] = PositionOf(surface, f, corners[k]);
      int longest = 0;
      double squared = 0.0;
      for (int k = 0; k < 3; ++k) {
        const double edge = (positions[(k + 1) % 3] - positions[k]).squaredNorm();
        if (edge > squared) {
          squared = edge;
          longest = k;
        }
      }
      const Eigen::Vector3d center = (corners[0] + corners[1] + corners[2]) / 3.0;
      const double spacing2 = r_max * r_max / density.At(f, center, area);
      if (squared > kLongestEdge * kLongestEdge * spacing2 && area > kNegligibleArea * spacing2) {
        const Eigen::Vector3d& a = corners[longest];
        const Eigen::Vector3d& b = corners[(longest + 1) % 3];
        const Eigen::Vector3d& c = corners[(longest + 2) % 3];
        const Eigen::Vector3d middle = 0.5 * (a + b);
        stack.push_back({{middle, b, c}, 0.5 * area});
        stack.push_back({{a, middle, c}, 0.5 * area});
        continue;
      }
      take(f, corners, positions, area);
    }
  }
}

}  // namespace

std::vector<Piece> CutPieces(const Surface& surface, const Density& density, double r_max,
                             Interrupt* interrupt) {
  // Counted first: a list that grows takes three times its memory in between.
  std::size_t count = 0;
  ForEachPiece(surface, density, r_max, interrupt,
               [&count](std::int32_t, const Corners&, const Corners&, double) { ++count; });
  std::vector<Piece> pieces;
  if (interrupt->Requested()) return pieces;
  pieces.reserve(count);
  ForEachPiece(
      surface, density, r_max, interrupt,
      [&](std::int32_t face, const Corners& corners, const Corners& positions, double area) {
        Piece piece;
        piece.face = face;
        for (int k = 0; k < 3; ++k) {
          const double rho = density.At(face, corners[k], area);
          piece.corners[k] << positions[k].cast<float>(), static_cast<float>(rho * rho);
        }
        pieces.push_back(piece);
      });
  return pieces;
}

PieceClipper::Moments PieceClipper::Integrate(const Piece& piece,
                                              const std::vector<Eigen::Vector3d>& sites,
                                              std::size_t k) {
  polygon_.clear();
  for (const Eigen::Vector4f& corner : piece.corners) polygon_.push_back(corner.cast<double>());
  for (std::size_t other = 0; other < sites.size(); ++other) {
    if (other == k) continue;
    const Eigen::Vector3d away = sites[other] - sites[k];
    if (away.isZero(0.0) && k < other) continue;
    const double middle = 0.5 * away.dot(sites[other] + sites[k]);
    // Positive where the other site is nearer.
    const auto beyond = [&](const Eigen::Vector4d& v) {
      return away.isZero(0.0) ? 1.0 : away.dot(v.head<3>()) - middle;
    };
    clipped_.clear();
    for (std::size_t i = 0; i < polygon_.size(); ++i) {
      const Eigen::Vector4d& from = polygon_[i];
      const Eigen::Vector4d& to = polygon_[i + 1 < polygon_.size() ? i + 1 : 0];
      const double at_from = beyond(from);
      const double at_to = beyond(to);
      if (at_from <= 0.0) clipped_.push_back(from);
      if ((at_from < 0.0 && at_to > 0.0) || (at_from > 0.0 && at_to < 0.0)) {
        clipped_.push_back(from + at_from / (at_from - at_to) * (to - from));
      }
    }
    polygon_.swap(clipped_);
    if (polygon_.size() < 3) return {};
  }
  Moments moments;
  for (std::size_t i = 2; i < polygon_.size(); ++i) {
    const Eigen::Vector4d& a = polygon_[0];
    const Eigen::Vector4d& b = polygon_[i - 1];
    const Eigen::Vector4d& c = polygon_[i];
    const double area = 0.5 * (b - a).head<3>().cross((c - a).head<3>()).norm();
    const auto add = [&](const Eigen::Vector4d& node, double share) {
      const double weight = share * area * node[3];
      moments.first += weight * Eigen::Vector4d(node[0], node[1], node[2], 1.0);
      moments.second += weight * (node.head<3>() - sites[k]).squaredNorm();
    };
    const Eigen::Vector4d sum = a + b + c;
    add(sum / 3.0, -27.0 / 48.0);
    add(0.2 * sum + 0.4 * a, 25.0 / 48.0);
    add(0.2 * sum + 0.4 * b, 25.0 / 48.0);
    add(0.2 * sum + 0.4 * c, 25.0 / 48.0);
  }
  return moments;
}

}  // namespace ccst
