#include "core/repair/soundness.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <span>

#include "core/mesh/edges.h"
#include "core/mesh/faces.h"
#include "core/repair/weld.h"

namespace ccst::repair {
namespace {

/// Faces or vertices that one thread looks at in one go.
constexpr std::int64_t kPiece = 8192;

/// Whether is_sound(i) holds for all of [0, count).
template <typename IsSoundAt>
bool AllSound(std::int64_t count, const Parallel& parallel, Interrupt* interrupt,
              const IsSoundAt& is_sound) {
  std::atomic<bool> sound = true;
  parallel.ForRanges(count, kPiece, [&, stop = *interrupt](std::int64_t first, std::int64_t end) {
    if (!sound || Interrupt(stop).Requested()) return;
    for (std::int64_t i = first; i < end; ++i) {
      if (!is_sound(static_cast<std::int32_t>(i))) {
        sound = false;
        return;
      }
    }
  });
  return sound && !interrupt->Requested();
}

bool HasSoundFaces(const TriangleMesh& mesh, const Geometry& geometry, const Parallel& parallel,
                   Interrupt* interrupt) {
  return AllSound(static_cast<std::int64_t>(mesh.faces.size()), parallel, interrupt,
                  [&](std::int32_t f) {
                    const Eigen::Vector3i& t = mesh.faces[f];
                    return t[0] != t[1] && t[1] != t[2] && t[2] != t[0] && !geometry.HasNoArea(t);
                  });
}

/// Across every slot the one with which it is linked, -1 at a boundary; empty when some edge is
/// not sound.
std::vector<std::int32_t> LinkSlots(const TriangleMesh& mesh, const Parallel& parallel,
                                    Interrupt* interrupt) {
  std::vector<std::int32_t> links(3 * mesh.faces.size(), -1);
  const auto vertices = static_cast<std::int64_t>(mesh.positions.size());
  EdgeSlots edges(mesh.faces, vertices);
  std::atomic<bool> sound = true;
  parallel.ForRanges(
      vertices, kPiece, [&, stop = *interrupt](std::int64_t first, std::int64_t end) {
        if (!sound || Interrupt(stop).Requested()) return;
        edges.ForEach(first, end, [&](std::span<const std::int32_t> slots) {
          if (slots.size() == 1) return true;
          if (slots.size() > 2 ||
              mesh.faces[slots[0] / 3][slots[0] % 3] == mesh.faces[slots[1] / 3][slots[1] % 3]) {
            sound = false;
            return false;
          }
          links[slots[0]] = slots[1];
          links[slots[1]] = slots[0];
          return true;
        });
      });
  if (!sound || interrupt->Requested()) links.clear();
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
bool HasSoundFans(const TriangleMesh& mesh, const std::vector<std::int32_t>& links,
                  const Parallel& parallel, Interrupt* interrupt) {
  std::vector<std::int32_t> degree(mesh.positions.size(), 0);
  std::vector<std::int32_t> leave(mesh.positions.size(), -1);
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const std::int32_t v = mesh.faces[f][k];
      const auto slot = static_cast<std::int32_t>(3 * f + k);
      ++degree[v];
      if (leave[v] < 0 || links[slot] < 0) leave[v] = slot;
    }
  }
  return AllSound(static_cast<std::int64_t>(leave.size()), parallel, interrupt,
                  [&](std::int32_t v) {
                    std::int32_t unseen = degree[v];
                    std::int32_t s = leave[v];
                    do {
                      --unseen;
                      s = links[PreviousHalfEdge(s)];
                    } while (s >= 0 && s != leave[v] && unseen > 0);
                    return unseen == 0;
                  });
}

}  // namespace

bool IsSound(const TriangleMesh& mesh, const std::vector<std::uint8_t>& used,
             const Geometry& geometry, const Parallel& parallel, Interrupt* interrupt) {
  if (std::find(used.begin(), used.end(), 0) != used.end()) return false;
  if (!HasSoundFaces(mesh, geometry, parallel, interrupt)) return false;
  if (!AllDiffer(mesh.positions, parallel, interrupt)) return false;
  const std::vector<std::int32_t> links = LinkSlots(mesh, parallel, interrupt);
  return !links.empty() && !HasDuplicates(links) && HasSoundFans(mesh, links, parallel, interrupt);
}

}  // namespace ccst::repair
