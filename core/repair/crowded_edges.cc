#include "core/repair/crowded_edges.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <tuple>
#include <vector>

#include <Eigen/Geometry>

#include "core/base/sort_in_runs.h"
#include "core/repair/disjoint_sets.h"

namespace ccst::repair {
namespace {

constexpr std::int32_t kReach = 8;  // Candidates on either side of the flat continuation.
constexpr std::int64_t kBladeWork = 2 * kReach;  // Units of work, for an Interrupt, of a face.

/// One face at the edge, seen along it.
struct Blade {
  std::int32_t slot = -1;
  double x = 0.0;  // Unit vector from the edge into the face; (0, 0) where the face has no area.
  double y = 0.0;
  double turn = 0.0;  // In [0, 4), grows with the angle; half a turn is exactly 2.
};

/// Diamond angle: no trigonometry, whose last bits differ between libraries.
double Turn(double x, double y) {
  const double sum = std::abs(x) + std::abs(y);
  if (!(sum > 0.0)) return 0.0;
  if (y >= 0.0) return x >= 0.0 ? y / sum : 1.0 - x / sum;
  return x < 0.0 ? 2.0 - y / sum : 3.0 + x / sum;
}

/// Unfinished when `interrupt` was requested.
std::vector<Blade> MakeBlades(const Geometry& geometry, const LinkedFaces& linked,
                              const std::int32_t* slots, std::int32_t count, Interrupt* interrupt) {
  const std::int32_t low = std::min(linked.Origin(slots[0]), linked.Target(slots[0]));
  const std::int32_t high = std::max(linked.Origin(slots[0]), linked.Target(slots[0]));
  const Eigen::Vector3d axis = geometry.Edge(low, high).stableNormalized();
  const Eigen::Vector3d x_axis = axis.unitOrthogonal();
  const Eigen::Vector3d y_axis = axis.cross(x_axis);
  std::vector<Blade> blades(count);
  for (std::int32_t i = 0; i < count; ++i) {
    if (interrupt->RequestedAfter(1)) return blades;
    Blade& blade = blades[i];
    blade.slot = slots[i];
    const Eigen::Vector3d out = geometry.Edge(low, linked.Apex(slots[i]));
    const Eigen::Vector2d across(out.dot(x_axis), out.dot(y_axis));
    const double length = across.stableNorm();
    const Eigen::Vector3i& face = linked.faces[slots[i] / 3];
    if (length <= geometry.Rounding(face) || geometry.HasNoArea(face)) continue;
    blade.x = across[0] / length;
    blade.y = across[1] / length;
    blade.turn = Turn(blade.x, blade.y);
  }
  SortInRuns(blades.begin(), blades.end(), interrupt, [](const Blade& a, const Blade& b) {
    return std::tie(a.turn, a.slot) < std::tie(b.turn, b.slot);
  });
  return blades;
}

/// Two blades that may be joined; a's slot is the smaller.
struct Candidate {
  bool bare = false;      // One of them has no area, so that its direction says nothing.
  std::int32_t bend = 0;  // Least where they continue each other; rounded, so that equals tie.
  bool concave = false;
  std::int32_t a = -1;
  std::int32_t b = -1;
  auto Key() const { return std::tie(bare, bend, concave, a, b); }
  bool operator<(const Candidate& other) const { return Key() < other.Key(); }
  bool operator==(const Candidate& other) const { return Key() == other.Key(); }
};

/// Runs the pairing over all edges; the sets join pieces that were linked.
class Pairing {
 public:
  Pairing(Orientation* orientation, LinkedFaces* linked, Interrupt* interrupt)
      : orientation_(*orientation),
        linked_(*linked),
        interrupt_(*interrupt),
        sets_(orientation->piece_count) {}

  void LinkEdge(const std::vector<Blade>& blades) {
    std::vector<Candidate> candidates = Candidates(blades);
    SortInRuns(candidates.begin(), candidates.end(), &interrupt_);
    candidates.erase(std::unique(candidates.begin(), candidates.end()), candidates.end());
    for (const bool may_turn : {false, true}) {
      for (const Candidate& c : candidates) {
        if (interrupt_.RequestedAfter(1)) return;
        if (linked_.links[c.a] >= 0 || linked_.links[c.b] >= 0) continue;
        const std::int32_t piece_a = orientation_.pieces[c.a / 3];
        const std::int32_t piece_b = orientation_.pieces[c.b / 3];
        const bool same_set = sets_.Find(piece_a).first == sets_.Find(piece_b).first;
        const bool agree = AscendsTurned(c.a) != AscendsTurned(c.b);
        if (!agree && (same_set || !may_turn)) continue;
        if (!same_set) {
          const bool opposed = Ascends(c.a) == Ascends(c.b);
          sets_.Unite(piece_a, piece_b, opposed);
        }
        linked_.Link(c.a, c.b);
      }
    }
  }

  void ApplyTurns() {
    for (std::size_t f = 0; f < orientation_.flips.size(); ++f) {
      orientation_.flips[f] ^= static_cast<std::uint8_t>(Turned(orientation_.pieces[f]));
    }
  }

 private:
  bool Turned(std::int32_t piece) { return sets_.Find(piece).second; }
  bool Ascends(std::int32_t slot) const {
    return linked_.Ascends(slot) != static_cast<bool>(orientation_.flips[slot / 3]);
  }
  bool AscendsTurned(std::int32_t slot) {
    return Ascends(slot) != Turned(orientation_.pieces[slot / 3]);
  }

  std::vector<Candidate> Candidates(const std::vector<Blade>& blades) {
    std::vector<Candidate> candidates;
    const auto count = static_cast<std::int32_t>(blades.size());
    const std::int32_t reach = std::min(2 * kReach, count);
    candidates.reserve(blades.size() * static_cast<std::size_t>(reach));
    for (std::int32_t i = 0; i < count; ++i) {
      if (interrupt_.RequestedAfter(kBladeWork)) return candidates;
      const double opposite = blades[i].turn < 2.0 ? blades[i].turn + 2.0 : blades[i].turn - 2.0;
      const auto at = std::lower_bound(blades.begin(), blades.end(), opposite,
                                       [](const Blade& b, double t) { return b.turn < t; });
      const auto middle = static_cast<std::int32_t>(at - blades.begin());
      for (std::int32_t step = 0; step < reach; ++step) {
        const std::int32_t j = (middle - reach / 2 + step + count) % count;
        if (j != i) candidates.push_back(Compare(blades[i], blades[j]));
      }
    }
    return candidates;
  }

  Candidate Compare(const Blade& one, const Blade& other) {
    const Blade& a = one.slot < other.slot ? one : other;
    const Blade& b = one.slot < other.slot ? other : one;
    Candidate c;
    c.a = a.slot;
    c.b = b.slot;
    c.bare = (a.x == 0.0 && a.y == 0.0) || (b.x == 0.0 && b.y == 0.0);
    c.bend = static_cast<std::int32_t>(std::lround((a.x * b.x + a.y * b.y) * 1e6));
    // The normal of a face that ascends is axis x out: its plane coordinates are (-y, x).
    const double side = -a.y * b.x + a.x * b.y;
    c.concave = AscendsTurned(a.slot) ? side > 0.0 : side < 0.0;
    return c;
  }

  Orientation& orientation_;
  LinkedFaces& linked_;
  Interrupt& interrupt_;
  TurnedSets sets_;
};

}  // namespace

void LinkCrowdedEdges(const Geometry& geometry, const CrowdedEdges& crowded,
                      Orientation* orientation, LinkedFaces* linked, Interrupt* interrupt) {
  if (crowded.count() == 0) return;
  Pairing pairing(orientation, linked, interrupt);
  for (std::size_t e = 0; e < crowded.count(); ++e) {
    const std::int32_t begin = crowded.start[e];
    pairing.LinkEdge(MakeBlades(geometry, *linked, crowded.slots.data() + begin,
                                crowded.start[e + 1] - begin, interrupt));
    if (interrupt->RequestedAfter(1)) return;
  }
  pairing.ApplyTurns();
}

}  // namespace ccst::repair
