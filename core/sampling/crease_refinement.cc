#include "core/sampling/crease_refinement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <tuple>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

namespace ccst {
namespace {

constexpr double kSharpTurn = 40.0 * std::numbers::pi / 180.0;
/// At edges that turn by more, as a tetrahedron's, rounded normals do better: with true ones
/// triangles turned over at its corners.
constexpr double kSharpestTurn = 100.0 * std::numbers::pi / 180.0;

std::int32_t Next(std::int32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
std::int32_t Previous(std::int32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }

/// The faces while they are split. Half-edge 3 f + k goes from corner k of face f to the next.
class Bisection {
 public:
  Bisection(const Surface& surface, double longest, RepairedMesh* repaired)
      : squared_limit_(longest * longest * surface.unit() * surface.unit()),
        repaired_(*repaired),
        positions_(repaired->mesh.positions),
        faces_(repaired->mesh.faces),
        twins_(surface.twins()) {}

  /// Finds sharp edges. @return true when a face at one of them is too large.
  bool FindLargeFaces() {
    sharp_.assign(twins_.size(), 0);
    at_crease_.assign(positions_.size(), 0);
    bool any = false;
    for (std::int32_t h = 0; h < static_cast<std::int32_t>(twins_.size()); ++h) {
      if (twins_[h] < h || !IsSharp(h)) continue;
      sharp_[h] = sharp_[twins_[h]] = 1;
      at_crease_[Origin(h)] = at_crease_[Target(h)] = 1;
      any = true;
    }
    if (!any) return false;
    for (std::int32_t f = 0; f < static_cast<std::int32_t>(faces_.size()); ++f) {
      if (IsLarge(f)) pending_.push_back(f);
    }
    return !pending_.empty();
  }

  void Run(std::int64_t most_new) {
    const std::size_t most = faces_.size() + static_cast<std::size_t>(most_new);
    for (std::size_t i = 0; i < pending_.size() && faces_.size() < most; ++i) {
      while (IsLarge(pending_[i]) && faces_.size() < most) Split(TerminalEdge(pending_[i]));
    }
  }

 private:
  std::int32_t Origin(std::int32_t h) const { return faces_[h / 3][h % 3]; }
  std::int32_t Target(std::int32_t h) const { return Origin(Next(h)); }

  Eigen::Vector3d Cross(std::int32_t f) const {
    const Eigen::Vector3d& a = positions_[faces_[f][0]];
    return (positions_[faces_[f][1]] - a).cross(positions_[faces_[f][2]] - a);
  }

  bool IsSharp(std::int32_t h) const {
    const Eigen::Vector3d a = Cross(h / 3);
    const Eigen::Vector3d b = Cross(twins_[h] / 3);
    const double scale = std::sqrt(a.squaredNorm() * b.squaredNorm());
    return a.dot(b) < std::cos(kSharpTurn) * scale && a.dot(b) > std::cos(kSharpestTurn) * scale;
  }

  /// Total order of the edges, so that the way to the longest ends.
  std::tuple<double, std::int32_t, std::int32_t> Rank(std::int32_t h) const {
    const auto [low, high] = std::minmax({Origin(h), Target(h)});
    return {(positions_[Origin(h)] - positions_[Target(h)]).squaredNorm(), low, high};
  }

  std::int32_t LongestSide(std::int32_t f) const {
    std::int32_t longest = 3 * f;
    for (std::int32_t h = 3 * f + 1; h < 3 * f + 3; ++h) {
      if (Rank(h) > Rank(longest)) longest = h;
    }
    return longest;
  }

  bool IsLarge(std::int32_t f) const {
    const Eigen::Vector3i& corner = faces_[f];
    if (!at_crease_[corner[0]] && !at_crease_[corner[1]] && !at_crease_[corner[2]]) return false;
    return std::get<0>(Rank(LongestSide(f))) > squared_limit_;
  }

  /// The longest side of both its faces that is reached from face `f` over longest sides.
  std::int32_t TerminalEdge(std::int32_t f) const {
    std::int32_t h = LongestSide(f);
    while (twins_[h] >= 0) {
      const std::int32_t further = LongestSide(twins_[h] / 3);
      if (further == twins_[h]) break;
      h = further;
    }
    return h;
  }

  void Link(std::int32_t a, std::int32_t b, bool sharp) {
    twins_[a] = b;
    sharp_[a] = sharp;
    if (b < 0) return;
    twins_[b] = a;
    sharp_[b] = sharp;
  }

  /// Gives the half of the face of `h` beyond vertex `middle` of that side to a new face, whose
  /// half-edge 3 f goes from `middle` to the target of `h`. @return 3 f.
  std::int32_t Halve(std::int32_t h, std::int32_t middle) {
    const auto fresh = static_cast<std::int32_t>(faces_.size());
    const std::int32_t face = h / 3;
    const std::int32_t next = Next(h);
    faces_.emplace_back(middle, faces_[face][next % 3], faces_[face][Previous(h) % 3]);
    faces_[face][next % 3] = middle;
    repaired_.source_face.push_back(repaired_.source_face[face]);
    const std::array<std::int8_t, 3>& corner = repaired_.source_corner[face];
    repaired_.source_corner.push_back({-1, corner[next % 3], corner[Previous(h) % 3]});
    repaired_.source_corner[face][next % 3] = -1;
    twins_.resize(twins_.size() + 3, -1);
    sharp_.resize(twins_.size(), 0);
    Link(3 * fresh + 1, twins_[next], sharp_[next] != 0);
    Link(3 * fresh + 2, next, false);
    pending_.push_back(fresh);
    return 3 * fresh;
  }

  void Split(std::int32_t h) {
    const std::int32_t g = twins_[h];
    const bool sharp = sharp_[h] != 0;
    const auto middle = static_cast<std::int32_t>(positions_.size());
    positions_.push_back(0.5 * positions_[Origin(h)] + 0.5 * positions_[Target(h)]);
    at_crease_.push_back(sharp);
    const std::int32_t beyond = Halve(h, middle);
    if (g < 0) return;
    const std::int32_t before = Halve(g, middle);
    Link(h, before, sharp);
    Link(g, beyond, sharp);
  }

  const double squared_limit_;
  RepairedMesh& repaired_;
  std::vector<Eigen::Vector3d>& positions_;
  std::vector<Eigen::Vector3i>& faces_;
  std::vector<std::int32_t> twins_;
  std::vector<std::uint8_t> sharp_;      // Per half-edge.
  std::vector<std::uint8_t> at_crease_;  // Per vertex: an end of a sharp edge.
  std::vector<std::int32_t> pending_;    // Faces to look at.
};

}  // namespace

bool RefineCreases(const Surface& surface, double longest, std::int64_t most_new,
                   RepairedMesh* repaired) {
  Bisection bisection(surface, longest, repaired);
  if (!bisection.FindLargeFaces()) return false;
  bisection.Run(most_new);
  return true;
}

}  // namespace ccst
