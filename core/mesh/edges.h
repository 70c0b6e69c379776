#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace ccst {

/// Calls visit(std::span<const std::int32_t> slots) for every undirected edge of `faces`. Slot
/// 3 f + k is the side of face f from corner k to corner k + 1. Slots ascend; edges come by
/// smaller, then larger vertex. Ends early when visit returns false.
/// @param faces  indices in [0, vertex_count), the three of a face different.
/// Cost O(F log F) whatever the degrees, 24 bytes a slot.
template <typename Visit>
void ForEachEdge(const std::vector<Eigen::Vector3i>& faces, std::int64_t vertex_count,
                 const Visit& visit) {
  std::vector<std::int32_t> start(vertex_count + 2, 0);
  for (const Eigen::Vector3i& face : faces) {
    for (int k = 0; k < 3; ++k) ++start[std::min(face[k], face[(k + 1) % 3]) + 2];
  }
  for (std::int64_t v = 2; v < vertex_count + 2; ++v) start[v] += start[v - 1];
  // Larger vertex and slot in one number, which sorts faster than looking both up.
  std::vector<std::uint64_t> keys(3 * faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const std::int32_t a = faces[f][k];
      const std::int32_t b = faces[f][(k + 1) % 3];
      keys[start[std::min(a, b) + 1]++] =
          static_cast<std::uint64_t>(std::max(a, b)) << 32 | (3 * f + k);
    }
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
      if (!visit(std::span<const std::int32_t>(group))) return;
    }
  }
}

}  // namespace ccst
