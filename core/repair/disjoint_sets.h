#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace ccst::repair {

/// Sets of numbers in [0, count); the smallest member stands for its set.
class DisjointSets {
 public:
  explicit DisjointSets(std::int32_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  std::int32_t Find(std::int32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void Unite(std::int32_t a, std::int32_t b) {
    a = Find(a);
    b = Find(b);
    if (a != b) parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::int32_t> parent_;
};

/// Sets whose members are turned over, or not, against the one that stands for them.
class TurnedSets {
 public:
  explicit TurnedSets(std::int32_t count) : parent_(count), turned_(count, 0) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  /// The set of `i` and whether `i` is turned against it.
  std::pair<std::int32_t, bool> Find(std::int32_t i) {
    bool turned = false;
    while (parent_[i] != i) {
      const std::int32_t up = parent_[i];
      turned_[i] = turned_[i] != turned_[up];
      parent_[i] = parent_[up];
      turned = turned != static_cast<bool>(turned_[i]);
      i = parent_[i];
    }
    return {i, turned};
  }
  /// Joins two different sets so that `a` and `b` are turned against each other or alike.
  void Unite(std::int32_t a, std::int32_t b, bool opposed) {
    const auto [root_a, turned_a] = Find(a);
    const auto [root_b, turned_b] = Find(b);
    if (root_a == root_b) return;
    const bool turned = (turned_a != turned_b) != opposed;
    parent_[std::max(root_a, root_b)] = std::min(root_a, root_b);
    turned_[std::max(root_a, root_b)] = turned;
  }

 private:
  std::vector<std::int32_t> parent_;
  std::vector<std::uint8_t> turned_;  // Against the parent.
};

}  // namespace ccst::repair
