#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace ccst {

/// The sides of faces by the undirected edge they lie on. Slot 3 f + k is the side of face f from
/// corner k to corner k + 1. 24 bytes a slot.
class EdgeSlots {
 public:
  /// @param faces  indices in [0, vertex_count), the three of a face different. Cost O(F).
  EdgeSlots(const std::vector<Eigen::Vector3i>& faces, std::int64_t vertex_count)
      : start_(vertex_count + 2, 0), keys_(3 * faces.size()) {
    for (const Eigen::Vector3i& face : faces) {
      for (int k = 0; k < 3; ++k) ++start_[std::min(face[k], face[(k + 1) % 3]) + 2];
    }
    for (std::int64_t v = 2; v < vertex_count + 2; ++v) start_[v] += start_[v - 1];
    // Larger vertex and slot in one number, which sorts faster than looking both up.
    for (std::size_t f = 0; f < faces.size(); ++f) {
      for (int k = 0; k < 3; ++k) {
        const std::int32_t a = faces[f][k];
        const std::int32_t b = faces[f][(k + 1) % 3];
        keys_[start_[std::min(a, b) + 1]++] =
            static_cast<std::uint64_t>(std::max(a, b)) << 32 | (3 * f + k);
      }
    }
  }

  /// Calls visit(std::span<const std::int32_t> slots) for every edge whose smaller vertex lies in
  /// [first, end). Slots ascend; edges come by smaller, then larger vertex. Ends early when visit
  /// returns false. Several threads may visit ranges that do not overlap.
  /// Cost O(slots log slots) whatever the degrees.
  template <typename Visit>
  void ForEach(std::int64_t first, std::int64_t end, const Visit& visit) {
    std::vector<std::int32_t> group;
    for (std::int64_t v = first; v < end; ++v) {
      std::sort(keys_.begin() + start_[v], keys_.begin() + start_[v + 1]);
      for (std::int32_t i = start_[v]; i < start_[v + 1];) {
        group.clear();
        const std::uint64_t high = keys_[i] >> 32;
        for (; i < start_[v + 1] && keys_[i] >> 32 == high; ++i) {
          group.push_back(static_cast<std::int32_t>(keys_[i] & 0xffffffffu));
        }
        if (!visit(std::span<const std::int32_t>(group))) return;
      }
    }
  }

 private:
  std::vector<std::int32_t> start_;
  std::vector<std::uint64_t> keys_;
};

/// Visits all edges of `faces` in their order, see EdgeSlots.
template <typename Visit>
void ForEachEdge(const std::vector<Eigen::Vector3i>& faces, std::int64_t vertex_count,
                 const Visit& visit) {
  EdgeSlots(faces, vertex_count).ForEach(0, vertex_count, visit);
}

}  // namespace ccst
