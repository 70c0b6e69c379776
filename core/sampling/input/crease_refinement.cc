#include "core/sampling/input/crease_refinement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <tuple>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "core/base/portable_math.h"
#include "core/mesh/faces.h"

namespace ccst::internal {
namespace {

constexpr double kSharpTurn = 40.0 * std::numbers::pi / 180.0;
/// At edges that turn by more, as a tetrahedron's, rounded normals do better: with true ones
/// triangles turned over at its corners.
constexpr double kSharpestTurn = 100.0 * std::numbers::pi / 180.0;

/// The faces while they are split. Half-edge 3 f + k goes from corner k of face f to the next.
class Bisection {
 public:
  Bisection(const Surface& surface, double longest, RepairedMesh* repaired, Interrupt* interrupt)
      : interrupt_(*interrupt),
        squared_limit_(longest * longest * surface.unit() * surface.unit()),
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
      if (interrupt_.RequestedAt(h)) return false;
      if (twins_[h] < h || !IsSharp(h)) continue;
      sharp_[h] = sharp_[twins_[h]] = 1;
      at_crease_[Origin(h)] = at_crease_[Target(h)] = 1;
      any = true;
    }
    if (!any) return false;
    for (std::int32_t f = 0; f < static_cast<std::int32_t>(faces_.size()); ++f) {
      if (interrupt_.RequestedAt(f)) return false;
      if (IsLarge(f)) pending_.push_back(f);
    }
    return !pending_.empty();
  }

  /// Every face on the way to a terminal edge is split before the one it starts from, so the ways
  /// of all faces take O(new faces) steps.
  void Run(std::int64_t most_new) {
    const std::size_t most =
        std::min(faces_.size() + static_cast<std::size_t>(most_new), kMostFaces);
    for (std::size_t i = 0; i < pending_.size() && faces_.size() < most; ++i) {
      way_.clear();
      while (IsLarge(pending_[i]) && faces_.size() < most) {
        if (interrupt_.RequestedAfter(1)) return;
        FindTerminalEdge(pending_[i]);
        if (interrupt_.Requested()) return;
        Split(way_.back());
        way_.pop_back();
      }
    }
  }

 private:
  std::int32_t Origin(std::int32_t h) const { return faces_[h / 3][h % 3]; }
  std::int32_t Target(std::int32_t h) const { return Origin(NextHalfEdge(h)); }

  bool IsSharp(std::int32_t h) const {
    const Eigen::Vector3d a = FaceCross(positions_, faces_[h / 3]);
    const Eigen::Vector3d b = FaceCross(positions_, faces_[twins_[h] / 3]);
    const double scale = std::sqrt(a.squaredNorm() * b.squaredNorm());
    return a.dot(b) < PortableCos(kSharpTurn) * scale &&
           a.dot(b) > PortableCos(kSharpestTurn) * scale;
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

  /// Extends the way that leads from face `f` over longest sides to the longest side of both its
  /// faces. A split at its end leaves the faces before as they are, and with them what is left of
  /// the way.
  void FindTerminalEdge(std::int32_t f) {
    if (way_.empty()) way_.push_back(LongestSide(f));
    while (twins_[way_.back()] >= 0 && !interrupt_.RequestedAfter(1)) {
      const std::int32_t further = LongestSide(twins_[way_.back()] / 3);
      if (further == twins_[way_.back()]) break;
      way_.push_back(further);
    }
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
    const std::int32_t next = NextHalfEdge(h);
    faces_.emplace_back(middle, faces_[face][next % 3], faces_[face][PreviousHalfEdge(h) % 3]);
    faces_[face][next % 3] = middle;
    repaired_.source_face.push_back(repaired_.source_face[face]);
    const std::array<std::int8_t, 3>& corner = repaired_.source_corner[face];
    repaired_.source_corner.push_back({-1, corner[next % 3], corner[PreviousHalfEdge(h) % 3]});
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

  /// So that numbers of half-edges fit 32 bits.
  static constexpr std::size_t kMostFaces = 700'000'000;

  Interrupt& interrupt_;
  const double squared_limit_;
  RepairedMesh& repaired_;
  std::vector<Eigen::Vector3d>& positions_;
  std::vector<Eigen::Vector3i>& faces_;
  std::vector<std::int32_t> twins_;
  std::vector<std::uint8_t> sharp_;      // Per half-edge.
  std::vector<std::uint8_t> at_crease_;  // Per vertex: an end of a sharp edge.
  std::vector<std::int32_t> pending_;    // Faces to look at.
  std::vector<std::int32_t> way_;        // Half-edges, each the longest side of its face.
};

}  // namespace

bool RefineCreases(const Surface& surface, double longest, std::int64_t most_new,
                   RepairedMesh* repaired, Interrupt* interrupt) {
  Interrupt never;
  if (interrupt == nullptr) interrupt = &never;
  Bisection bisection(surface, longest, repaired, interrupt);
  if (!bisection.FindLargeFaces()) return false;
  bisection.Run(most_new);
  return true;
}

}  // namespace ccst::internal
