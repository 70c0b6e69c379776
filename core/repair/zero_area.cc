#include "core/repair/zero_area.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <deque>
#include <unordered_set>

#include <Eigen/Core>

#include "core/mesh/faces.h"

namespace ccst::repair {
namespace {

/// Numbers of edges that a caller chose must not all fall into one bucket.
struct EdgeHash {
  std::size_t operator()(std::uint64_t key) const {
    key = (key ^ (key >> 30)) * 0xbf58476d1ce4e5b9U;
    key = (key ^ (key >> 27)) * 0x94d049bb133111ebU;
    return static_cast<std::size_t>(key ^ (key >> 31));
  }
};

class ZeroAreaRemoval {
 public:
  ZeroAreaRemoval(const Geometry& geometry, const std::vector<std::int32_t>& positions_of,
                  LinkedFaces* linked, Interrupt* interrupt)
      : geometry_(geometry),
        positions_of_(positions_of),
        linked_(*linked),
        interrupt_(*interrupt),
        empty_(linked->faces.size(), 0) {}

  ZeroAreaReport Run() {
    for (std::int32_t f = 0; f < linked_.count(); ++f) {
      if (interrupt_.RequestedAt(f)) return report_;
      empty_[f] = geometry_.HasNoArea(Places(linked_.faces[f]));
      if (empty_[f]) work_.push_back(f);
    }
    if (work_.empty()) return report_;
    dropped_.assign(linked_.faces.size(), 0);
    DropEmptyPieces();
    CollectEdges();
    while (!work_.empty()) {
      if (interrupt_.RequestedAfter(1)) return report_;
      const std::int32_t f = work_.front();
      work_.pop_front();
      if (empty_[f] && !dropped_[f]) Remove(f);
    }
    Compact();
    return report_;
  }

 private:
  Eigen::Vector3i Places(const Eigen::Vector3i& face) const {
    return {positions_of_[face[0]], positions_of_[face[1]], positions_of_[face[2]]};
  }
  static std::uint64_t EdgeKey(std::int32_t a, std::int32_t b) {
    return static_cast<std::uint64_t>(std::min(a, b)) << 32 |
           static_cast<std::uint32_t>(std::max(a, b));
  }

  void DropEmptyPieces() {
    std::vector<std::uint8_t> seen(linked_.faces.size(), 0);
    std::vector<std::int32_t> piece;
    const std::vector<std::int32_t> seeds(work_.begin(), work_.end());
    for (const std::int32_t seed : seeds) {
      if (seen[seed]) continue;
      seen[seed] = 1;
      piece.assign(1, seed);
      bool all_empty = true;
      for (std::size_t i = 0; i < piece.size(); ++i) {
        for (std::int32_t s = 3 * piece[i]; s < 3 * piece[i] + 3; ++s) {
          const std::int32_t g = linked_.links[s] < 0 ? -1 : linked_.links[s] / 3;
          if (g < 0 || seen[g]) continue;
          if (!empty_[g]) {
            all_empty = false;
            continue;
          }
          seen[g] = 1;
          piece.push_back(g);
        }
      }
      if (!all_empty) continue;
      for (const std::int32_t f : piece) Drop(f);
    }
  }

  /// What the rules below need to look up: which edges exist and which vertices are boundary.
  void CollectEdges() {
    boundary_.assign(positions_of_.size(), 0);
    edges_.reserve(3 * linked_.faces.size() / 2);
    for (std::int32_t s = 0; s < 3 * linked_.count(); ++s) {
      if (interrupt_.RequestedAt(s)) return;
      if (dropped_[s / 3]) continue;
      if (linked_.links[s] < s) edges_.insert(EdgeKey(linked_.Origin(s), linked_.Target(s)));
      if (linked_.links[s] >= 0) continue;
      boundary_[linked_.Origin(s)] = 1;
      boundary_[linked_.Target(s)] = 1;
    }
  }

  void Drop(std::int32_t f) {
    dropped_[f] = 1;
    ++report_.removed;
    for (std::int32_t s = 3 * f; s < 3 * f + 3; ++s) {
      if (linked_.links[s] < 0) {
        edges_.erase(EdgeKey(linked_.Origin(s), linked_.Target(s)));
        continue;
      }
      work_.push_back(linked_.links[s] / 3);
      linked_.Unlink(s);
    }
  }

  void Remove(std::int32_t f) {
    int free_sides = 0;
    for (std::int32_t s = 3 * f; s < 3 * f + 3; ++s) free_sides += linked_.links[s] < 0;
    if (free_sides >= 2) return Drop(f);
    const Eigen::Vector3i places = Places(linked_.faces[f]);
    const std::int32_t side = 3 * f + geometry_.LongestSide(places);
    const std::int32_t apex = linked_.Apex(side);
    if (free_sides == 1) {
      if (linked_.links[side] >= 0 || boundary_[apex]) return;
      boundary_[apex] = 1;
      return Drop(f);
    }
    if (IsNeedle(places)) return;
    SplitNeighbour(side);
  }

  bool IsNeedle(const Eigen::Vector3i& t) const {
    const double shortest =
        std::min({geometry_.Edge(t[0], t[1]).norm(), geometry_.Edge(t[1], t[2]).norm(),
                  geometry_.Edge(t[2], t[0]).norm()});
    return shortest <= 2.0 * geometry_.Rounding(t);
  }

  /// (a, b, c) with c on the side ab of (b, a, d): they become (b, c, d) and (c, a, d).
  void SplitNeighbour(std::int32_t side) {
    const std::int32_t across = linked_.links[side];
    const std::int32_t f = side / 3;
    const std::int32_t g = across / 3;
    const std::int32_t a = linked_.Origin(side);
    const std::int32_t b = linked_.Target(side);
    const std::int32_t c = linked_.Apex(side);
    const std::int32_t d = linked_.Apex(across);
    if (empty_[g] || c == d || edges_.contains(EdgeKey(c, d))) return;
    const Eigen::Vector3i one(b, c, d);
    const Eigen::Vector3i two(c, a, d);
    if (geometry_.HasNoArea(Places(one)) || geometry_.HasNoArea(Places(two))) return;

    const std::int32_t beyond_bc = linked_.links[NextHalfEdge(side)];
    const std::int32_t beyond_ca = linked_.links[PreviousHalfEdge(side)];
    const std::int32_t beyond_ad = linked_.links[NextHalfEdge(across)];
    const std::int32_t beyond_db = linked_.links[PreviousHalfEdge(across)];
    edges_.erase(EdgeKey(a, b));
    edges_.insert(EdgeKey(c, d));
    linked_.faces[f] = one;
    linked_.faces[g] = two;
    linked_.source[f] = linked_.source[g];
    const std::array<std::int8_t, 3> corner = linked_.source_corner[g];
    const std::int8_t at_d = corner[(across % 3 + 2) % 3];
    linked_.source_corner[f] = {corner[across % 3], -1, at_d};
    linked_.source_corner[g] = {-1, corner[(across % 3 + 1) % 3], at_d};
    linked_.Link(3 * f + 1, 3 * g + 2);
    Attach(3 * f, beyond_bc);
    Attach(3 * f + 2, beyond_db);
    Attach(3 * g, beyond_ca);
    Attach(3 * g + 1, beyond_ad);
    empty_[f] = 0;
    ++report_.removed;
    ++report_.splits;
  }

  void Attach(std::int32_t slot, std::int32_t other) {
    linked_.links[slot] = other;
    if (other < 0) return;
    linked_.links[other] = slot;
    if (empty_[other / 3]) work_.push_back(other / 3);
  }

  void Compact() {
    std::int32_t kept = 0;
    for (std::int32_t f = 0; f < linked_.count(); ++f) {
      if (dropped_[f]) continue;
      linked_.faces[kept] = linked_.faces[f];
      linked_.source[kept] = linked_.source[f];
      linked_.source_corner[kept] = linked_.source_corner[f];
      ++kept;
    }
    linked_.faces.resize(kept);
    linked_.source.resize(kept);
    linked_.source_corner.resize(kept);
    linked_.links.clear();  // Nobody needs them any more.
  }

  const Geometry& geometry_;
  const std::vector<std::int32_t>& positions_of_;
  LinkedFaces& linked_;
  Interrupt& interrupt_;
  std::vector<std::uint8_t> empty_;
  std::vector<std::uint8_t> dropped_;
  std::vector<std::uint8_t> boundary_;
  std::unordered_set<std::uint64_t, EdgeHash> edges_;
  std::deque<std::int32_t> work_;
  ZeroAreaReport report_;
};

}  // namespace

ZeroAreaReport RemoveZeroArea(const Geometry& geometry,
                              const std::vector<std::int32_t>& positions_of, LinkedFaces* linked,
                              Interrupt* interrupt) {
  return ZeroAreaRemoval(geometry, positions_of, linked, interrupt).Run();
}

}  // namespace ccst::repair
