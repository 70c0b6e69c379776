#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace ccst {

/// Boxes around runs of eight points, boxes around runs of eight boxes, and so on: what finds the
/// points in a ball when points that follow each other in memory are near each other in space (see
/// HilbertOrder()). Any order gives right answers; that one gives fast ones. Costs a fraction of a
/// k-d tree to build, so it suits points that move. Queries may run on several threads.
class BoxTree {
 public:
  /// Indexes `points` (N x 3), which must outlive the tree and stay as they are until the next
  /// Build(). Cost O(N); allocates only when N has grown.
  void Build(const std::vector<Eigen::Vector3d>& points);

  /// Calls visit(index, squared distance) for every point less than `radius` from `center`, in the
  /// order of the points.
  template <class Visit>
  void ForEachWithin(const Eigen::Vector3d& center, double radius, Visit&& visit) const {
    if (levels_.empty()) return;
    for (std::size_t b = 0; b < levels_.back().size(); ++b) {
      Descend(levels_.size() - 1, b, center, radius * radius, visit);
    }
  }

 private:
  static constexpr std::size_t kRun = 8;

  struct Box {
    Eigen::Vector3d low;
    Eigen::Vector3d high;
  };

  template <class Visit>
  void Descend(std::size_t level, std::size_t box, const Eigen::Vector3d& center, double squared,
               Visit&& visit) const {
    const Box& bounds = levels_[level][box];
    const Eigen::Vector3d outside =
        (bounds.low - center).cwiseMax(center - bounds.high).cwiseMax(0.0);
    if (!(outside.squaredNorm() < squared)) return;
    if (level > 0) {
      const std::size_t end = std::min((box + 1) * kRun, levels_[level - 1].size());
      for (std::size_t b = box * kRun; b < end; ++b) {
        Descend(level - 1, b, center, squared, visit);
      }
      return;
    }
    const std::size_t end = std::min((box + 1) * kRun, points_->size());
    for (std::size_t i = box * kRun; i < end; ++i) {
      const double distance = ((*points_)[i] - center).squaredNorm();
      if (distance < squared) visit(static_cast<std::int32_t>(i), distance);
    }
  }

  const std::vector<Eigen::Vector3d>* points_ = nullptr;
  std::vector<std::vector<Box>> levels_;  // Lowest first; the last holds kRun boxes at most.
};

}  // namespace ccst
