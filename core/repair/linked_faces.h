#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace ccst::repair {

/// Faces and how they hang together. Slot 3 f + k is the edge of face f from corner k to k + 1.
struct LinkedFaces {
  std::vector<Eigen::Vector3i> faces;  ///< F x 3 vertices, all different in a face.
  std::vector<std::int32_t> source;    ///< F: face of the input.
  std::vector<std::int32_t> links;     ///< 3 F: the slot across the edge, -1 at a boundary.

  std::int32_t count() const { return static_cast<std::int32_t>(faces.size()); }
  std::int32_t Origin(std::int32_t slot) const { return faces[slot / 3][slot % 3]; }
  std::int32_t Target(std::int32_t slot) const { return faces[slot / 3][(slot % 3 + 1) % 3]; }
  std::int32_t Apex(std::int32_t slot) const { return faces[slot / 3][(slot % 3 + 2) % 3]; }
  /// Whether the slot runs from the smaller vertex to the larger.
  bool Ascends(std::int32_t slot) const { return Origin(slot) < Target(slot); }

  void Link(std::int32_t a, std::int32_t b) {
    links[a] = b;
    links[b] = a;
  }
  void Unlink(std::int32_t slot) {
    if (links[slot] < 0) return;
    links[links[slot]] = -1;
    links[slot] = -1;
  }
};

/// Calls visit(std::span<const std::int32_t> slots) for every undirected edge, slots ascending;
/// edges by smaller, then larger vertex. Vertices lie in [0, vertex_count).
/// Cost O(F log F) whatever the degrees.
template <typename Visit>
void ForEachEdge(const LinkedFaces& linked, std::int64_t vertex_count, const Visit& visit) {
  const std::int32_t slots = 3 * linked.count();
  std::vector<std::int32_t> start(vertex_count + 1, 0);
  for (std::int32_t s = 0; s < slots; ++s) {
    ++start[std::min(linked.Origin(s), linked.Target(s)) + 1];
  }
  for (std::int64_t v = 0; v < vertex_count; ++v) start[v + 1] += start[v];
  // Larger vertex and slot in one number, which sorts faster than looking both up.
  std::vector<std::uint64_t> keys(slots);
  std::vector<std::int32_t> fill(start.begin(), start.end() - 1);
  for (std::int32_t s = 0; s < slots; ++s) {
    const std::int32_t low = std::min(linked.Origin(s), linked.Target(s));
    const std::int32_t high = std::max(linked.Origin(s), linked.Target(s));
    keys[fill[low]++] = static_cast<std::uint64_t>(high) << 32 | static_cast<std::uint32_t>(s);
  }
  std::vector<std::int32_t> group;
  for (std::int64_t v = 0; v < vertex_count; ++v) {
    std::sort(keys.begin() + start[v], keys.begin() + start[v + 1]);
    for (std::int32_t i = start[v]; i < start[v + 1];) {
      group.clear();
      const std::uint64_t high = keys[i] >> 32;
      for (; i < start[v + 1] && keys[i] >> 32 == high; ++i) {
        group.push_back(static_cast<std::int32_t>(keys[i] & 0xffffffffu));
      }
      visit(std::span<const std::int32_t>(group));
    }
  }
}

}  // namespace ccst::repair
