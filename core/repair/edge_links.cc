#include "core/repair/edge_links.h"

#include <algorithm>
#include <array>
#include <span>
#include <tuple>
#include <utility>

#include "core/mesh/edges.h"

namespace ccst::repair {
namespace {

constexpr double kSliver = 1e-7;

/// Keeps the faces that are not `dropped`; links are no longer right then.
void Compact(const std::vector<std::uint8_t>& dropped, LinkedFaces* linked) {
  std::int32_t kept = 0;
  for (std::int32_t f = 0; f < linked->count(); ++f) {
    if (dropped[f]) continue;
    linked->faces[kept] = linked->faces[f];
    linked->source[kept] = linked->source[f];
    linked->source_corner[kept] = linked->source_corner[f];
    ++kept;
  }
  linked->faces.resize(kept);
  linked->source.resize(kept);
  linked->source_corner.resize(kept);
}

}  // namespace

std::int64_t DropDuplicates(LinkedFaces* linked, std::int64_t vertex_count, Interrupt* interrupt) {
  // Faces by their smallest vertex, then sorted within.
  std::vector<std::int32_t> start(vertex_count + 1, 0);
  for (const Eigen::Vector3i& face : linked->faces) ++start[face.minCoeff() + 1];
  for (std::int64_t v = 0; v < vertex_count; ++v) start[v + 1] += start[v];
  struct Key {
    std::int32_t middle, high, face;
    bool operator<(const Key& other) const {
      return std::tie(middle, high, face) < std::tie(other.middle, other.high, other.face);
    }
  };
  std::vector<Key> keys(linked->faces.size());
  std::vector<std::int32_t> fill(start.begin(), start.end() - 1);
  for (std::int32_t f = 0; f < linked->count(); ++f) {
    if (interrupt->RequestedAt(f)) return 0;
    Eigen::Vector3i face = linked->faces[f];
    std::sort(face.data(), face.data() + 3);
    keys[fill[face[0]]++] = {face[1], face[2], f};
  }
  std::vector<std::uint8_t> dropped(linked->faces.size(), 0);
  std::int64_t count = 0;
  for (std::int64_t v = 0; v < vertex_count; ++v) {
    if (interrupt->RequestedAfter(1 + start[v + 1] - start[v])) return 0;
    std::sort(keys.begin() + start[v], keys.begin() + start[v + 1]);
    for (std::int32_t i = start[v] + 1; i < start[v + 1]; ++i) {
      if (keys[i].middle != keys[i - 1].middle || keys[i].high != keys[i - 1].high) continue;
      dropped[keys[i].face] = 1;
      ++count;
    }
  }
  if (count > 0) Compact(dropped, linked);
  return count;
}

std::int64_t DropHangingSlivers(const Geometry& geometry, LinkedFaces* linked,
                                std::int64_t vertex_count, Interrupt* interrupt) {
  std::vector<std::uint8_t> free_sides(linked->faces.size(), 0);
  CrowdedEdges crowded;
  ForEachEdge(linked->faces, vertex_count, [&](std::span<const std::int32_t> slots) {
    if (interrupt->RequestedAfter(1)) return false;
    if (slots.size() == 1) ++free_sides[slots[0] / 3];
    if (slots.size() <= 2) return true;
    crowded.slots.insert(crowded.slots.end(), slots.begin(), slots.end());
    crowded.start.push_back(static_cast<std::int32_t>(crowded.slots.size()));
    return true;
  });
  std::vector<std::uint8_t> dropped(linked->faces.size(), 0);
  std::int64_t count = 0;
  for (std::size_t e = 0; e < crowded.count(); ++e) {
    std::int32_t left = crowded.start[e + 1] - crowded.start[e];
    for (std::int32_t i = crowded.start[e]; i < crowded.start[e + 1] && left > 2; ++i) {
      const std::int32_t f = crowded.slots[i] / 3;
      const Eigen::Vector3i& face = linked->faces[f];
      if (free_sides[f] != 2 || !geometry.IsFlat(face, geometry.FloatRounding(face), kSliver))
        continue;
      dropped[f] = 1;
      ++count;
      --left;
    }
  }
  if (count > 0) Compact(dropped, linked);
  return count;
}

CrowdedEdges LinkPlainEdges(const std::vector<Eigen::Vector3i>& input_faces,
                            const std::vector<std::int32_t>& leaders, LinkedFaces* linked,
                            Interrupt* interrupt) {
  linked->links.assign(3 * linked->faces.size(), -1);
  CrowdedEdges crowded;
  // The input's own two vertices of a slot, and the slot.
  std::vector<std::array<std::int32_t, 3>> named;
  ForEachEdge(linked->faces, static_cast<std::int64_t>(leaders.size()),
              [&](std::span<const std::int32_t> slots) {
                if (interrupt->RequestedAfter(static_cast<std::int64_t>(slots.size())))
                  return false;
                if (slots.size() == 2) linked->Link(slots[0], slots[1]);
                if (slots.size() <= 2) return true;
                crowded.any = true;
                named.clear();
                for (const std::int32_t s : slots) {
                  const Eigen::Vector3i& face = input_faces[linked->source[s / 3]];
                  const auto [low, high] = std::minmax(face[s % 3], face[(s % 3 + 1) % 3]);
                  named.push_back({low, high, s});
                }
                std::sort(named.begin(), named.end());
                const std::size_t begin = crowded.slots.size();
                for (std::size_t i = 0; i < named.size();) {
                  std::size_t end = i + 1;
                  while (end < named.size() && named[end][0] == named[i][0] &&
                         named[end][1] == named[i][1]) {
                    ++end;
                  }
                  if (end - i == 2) {
                    linked->Link(named[i][2], named[i + 1][2]);
                  } else {
                    for (std::size_t j = i; j < end; ++j) crowded.slots.push_back(named[j][2]);
                  }
                  i = end;
                }
                if (crowded.slots.size() - begin < 2) {
                  crowded.slots.resize(begin);
                } else {
                  std::sort(crowded.slots.begin() + begin, crowded.slots.end());
                  crowded.start.push_back(static_cast<std::int32_t>(crowded.slots.size()));
                }
                return true;
              });
  return crowded;
}

}  // namespace ccst::repair
