#include "core/repair/fans.h"

#include <span>
#include <utility>

#include "core/mesh/edges.h"
#include "core/mesh/faces.h"
#include "core/repair/disjoint_sets.h"

namespace ccst::repair {
namespace {

/// The fan of every corner, dense from 0 in order of first use. @return how many there are.
std::int32_t NumberFans(const LinkedFaces& linked, Interrupt* interrupt,
                        std::vector<Eigen::Vector3i>* fans) {
  const std::int32_t corners = 3 * linked.count();
  DisjointSets sets(corners);
  for (std::int32_t s = 0; s < corners; ++s) {
    if (interrupt->RequestedAt(s)) return 0;
    const std::int32_t other = linked.links[s];
    if (other < s) continue;
    const bool opposite = linked.Origin(s) != linked.Origin(other);
    sets.Unite(s, opposite ? NextHalfEdge(other) : other);
    sets.Unite(NextHalfEdge(s), opposite ? other : NextHalfEdge(other));
  }
  fans->resize(linked.faces.size());
  std::int32_t count = 0;
  for (std::int32_t s = 0; s < corners; ++s) {
    // The smallest corner stands for its set, so it is numbered before the others.
    const std::int32_t root = sets.Find(s);
    (*fans)[s / 3][s % 3] = root == s ? count++ : (*fans)[root / 3][root % 3];
  }
  return count;
}

}  // namespace

std::vector<std::int32_t> SplitFans(LinkedFaces* linked, Interrupt* interrupt) {
  std::vector<Eigen::Vector3i> fans;
  std::int32_t count = NumberFans(*linked, interrupt, &fans);
  if (count == 0 || interrupt->Requested()) return {};
  const std::vector<Eigen::Vector3i> whole = std::exchange(linked->faces, fans);
  // Two surfaces that cross at one edge may be joined crosswise there and stay joined around both
  // ends. Then one pair of vertices would stand for two edges, which an index list cannot say.
  // Undoing those links splits at least one end of each, or gives every slot its own partner, and
  // makes no other edge crowded, because fans only become smaller.
  bool undone = false;
  std::vector<std::pair<std::int32_t, std::int32_t>> meeting;  // Boundary over boundary.
  const auto look = [&](std::span<const std::int32_t> slots) {
    if (interrupt->RequestedAfter(1)) return false;
    if (slots.size() == 2 && linked->links[slots[0]] < 0) meeting.emplace_back(slots[0], slots[1]);
    if (slots.size() <= 2) return true;
    for (const std::int32_t s : slots) linked->Unlink(s);
    undone = true;
    return true;
  };
  ForEachEdge(linked->faces, count, look);
  if (undone) {
    linked->faces = whole;
    count = NumberFans(*linked, interrupt, &fans);
    if (interrupt->Requested()) return {};
    linked->faces = fans;
    meeting.clear();
    ForEachEdge(linked->faces, count, look);
  }
  if (interrupt->Requested()) return {};
  for (const auto& [one, other] : meeting) linked->Link(one, other);
  std::vector<std::int32_t> vertices(count, -1);
  for (std::size_t f = 0; f < fans.size(); ++f) {
    for (int k = 0; k < 3; ++k) vertices[fans[f][k]] = whole[f][k];
  }
  return vertices;
}

}  // namespace ccst::repair
