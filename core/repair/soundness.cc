#include "core/repair/soundness.h"

#include <algorithm>
#include <cstddef>
#include <span>

#include "core/mesh/edges.h"
#include "core/repair/weld.h"

namespace ccst::repair {
namespace {

bool HasSoundFaces(const TriangleMesh& mesh, const Geometry& geometry, Interrupt* interrupt) {
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    if (interrupt->RequestedAt(static_cast<std::int64_t>(f))) return false;
    const Eigen::Vector3i& t = mesh.faces[f];
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0] || geometry.HasNoArea(t)) return false;
  }
  return true;
}

/// Across every slot the one with which it is linked, -1 at a boundary; empty when some edge is
/// not sound.
std::vector<std::int32_t> LinkSlots(const TriangleMesh& mesh, Interrupt* interrupt) {
  std::vector<std::int32_t> links(3 * mesh.faces.size(), -1);
  std::int64_t edges = 0;
  bool sound = true;
  ForEachEdge(mesh.faces, static_cast<std::int64_t>(mesh.positions.size()),
              [&](std::span<const std::int32_t> slots) {
                sound = slots.size() <= 2 && !interrupt->RequestedAt(edges++);
                if (!sound || slots.size() == 1) return sound;
                const std::int32_t origin = mesh.faces[slots[0] / 3][slots[0] % 3];
                sound = origin != mesh.faces[slots[1] / 3][slots[1] % 3];
                links[slots[0]] = slots[1];
                links[slots[1]] = slots[0];
                return sound;
              });
  if (!sound) links.clear();
  return links;
}

/// Whether two faces have the same three vertices; edges are sound already, so they share all
/// three.
bool HasDuplicates(const std::vector<std::int32_t>& links) {
  for (std::size_t s = 0; s < links.size(); s += 3) {
    if (links[s] >= 0 && links[s + 1] >= 0 && links[s] / 3 == links[s + 1] / 3) return true;
  }
  return false;
}

/// Whether turning around each vertex from one of its faces, both ways, passes all of them.
bool HasSoundFans(const TriangleMesh& mesh, const std::vector<std::int32_t>& links) {
  const auto previous = [](std::int32_t s) { return s % 3 == 0 ? s + 2 : s - 1; };
  std::vector<std::int32_t> unseen(mesh.positions.size(), 0);
  std::vector<std::int32_t> leave(mesh.positions.size(), -1);
  const auto slots = static_cast<std::int32_t>(links.size());
  for (std::int32_t s = 0; s < slots; ++s) {
    const std::int32_t v = mesh.faces[s / 3][s % 3];
    ++unseen[v];
    if (leave[v] < 0 || links[s] < 0) leave[v] = s;
  }
  for (std::size_t v = 0; v < leave.size(); ++v) {
    std::int32_t s = leave[v];
    do {
      --unseen[v];
      s = links[previous(s)];
    } while (s >= 0 && s != leave[v] && unseen[v] > 0);
    if (unseen[v] != 0) return false;
  }
  return true;
}

}  // namespace

bool IsSound(const TriangleMesh& mesh, const std::vector<std::uint8_t>& used,
             const Geometry& geometry, Interrupt* interrupt) {
  if (std::find(used.begin(), used.end(), 0) != used.end()) return false;
  if (!HasSoundFaces(mesh, geometry, interrupt)) return false;
  if (!AllDiffer(mesh.positions, interrupt)) return false;
  const std::vector<std::int32_t> links = LinkSlots(mesh, interrupt);
  return !links.empty() && !HasDuplicates(links) && HasSoundFans(mesh, links);
}

}  // namespace ccst::repair
