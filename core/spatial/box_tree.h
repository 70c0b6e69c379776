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

  /// Points that follow each other and share a box: run r holds those from kRun * r on.
  static constexpr std::size_t kRun = 8;

  std::size_t run_count() const { return levels_.empty() ? 0 : levels_.front().size(); }

  /// Calls visit(other) for every run from `run` on whose box is less than `radius` from that of
  /// `run`, itself first: what finds all pairs of near points faster than a search for each point.
  template <class Visit>
  void ForEachRunWithin(std::size_t run, double radius, Visit&& visit) const {
    const Box& box = levels_.front()[run];
    for (std::size_t b = 0; b < levels_.back().size(); ++b) {
      DescendToRuns(levels_.size() - 1, b, run, box, radius * radius, visit);
    }
  }

 private:
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

  template <class Visit>
  void DescendToRuns(std::size_t level, std::size_t box, std::size_t from, const Box& target,
                     double squared, Visit&& visit) const {
    const std::size_t shift = 3 * level;
    if (((box + 1) << shift) <= from) return;
    const Box& bounds = levels_[level][box];
    const Eigen::Vector3d apart =
        (bounds.low - target.high).cwiseMax(target.low - bounds.high).cwiseMax(0.0);
    if (!(apart.squaredNorm() < squared)) return;
    if (level == 0) {
      visit(box);
      return;
    }
    const std::size_t end = std::min((box + 1) * kRun, levels_[level - 1].size());
    for (std::size_t b = box * kRun; b < end; ++b) {
      DescendToRuns(level - 1, b, from, target, squared, visit);
    }
  }

  const std::vector<Eigen::Vector3d>* points_ = nullptr;
  std::vector<std::vector<Box>> levels_;  // Lowest first; the last holds kRun boxes at most.
};

}  // namespace ccst
