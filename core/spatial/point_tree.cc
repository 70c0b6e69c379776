#include "core/spatial/point_tree.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include <nanoflann.hpp>

namespace ccst {
namespace {

/// Points of one k-d tree, at most.
constexpr std::int64_t kRun = 50'000;

/// A run of points, as nanoflann wants to see it.
struct Adaptor {
  const Eigen::Vector3d* points;
  std::size_t count;

  std::size_t kdtree_get_point_count() const { return count; }
  double kdtree_get_pt(std::size_t i, std::size_t axis) const {
    return points[i][static_cast<Eigen::Index>(axis)];
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

using Tree = nanoflann::KDTreeSingleIndexAdaptor<
    nanoflann::L2_Simple_Adaptor<double, Adaptor, double, std::uint32_t>, Adaptor, 3,
    std::uint32_t>;

/// The best found so far, over the trees of all runs; equal distances are told apart by index,
/// whatever the order in which they come.
class NearestSet {
 public:
  using DistanceType = double;

  explicit NearestSet(std::size_t wanted) : wanted_(wanted) { best_.reserve(wanted + 1); }

  /// Indices of the points to come count from `first`.
  void SetFirst(std::int32_t first) { first_ = first; }

  // What nanoflann asks of a result set.
  bool full() const { return best_.size() == wanted_; }
  double worstDist() const { return worst_; }
  bool addPoint(double distance, std::uint32_t index) {
    const std::pair<double, std::int32_t> found{distance,
                                                first_ + static_cast<std::int32_t>(index)};
    if (full()) {
      if (!(found < best_.back())) return true;
      best_.pop_back();
    }
    best_.insert(std::upper_bound(best_.begin(), best_.end(), found), found);
    // Trees pass over what is as far as the worst, but for rounding; an equal may go before it.
    if (full()) worst_ = std::nextafter(best_.back().first * (1.0 + 1e-12), kInfinity);
    return true;
  }

  std::vector<std::int32_t> Indices() const {
    std::vector<std::int32_t> indices;
    indices.reserve(best_.size());
    for (const auto& [distance, index] : best_) indices.push_back(index);
    return indices;
  }

 private:
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();

  std::size_t wanted_;
  std::int32_t first_ = 0;
  double worst_ = kInfinity;
  std::vector<std::pair<double, std::int32_t>> best_;  // Squared distances; nearest first.
};

}  // namespace

struct PointTree::Run {
  Run(const Eigen::Vector3d* points, std::int32_t first_point, std::size_t count)
      : first(first_point),
        adaptor{points + first_point, count},
        tree(3, adaptor, nanoflann::KDTreeSingleIndexAdaptorParams(16)) {}

  double SquaredDistance(const Eigen::Vector3d& query) const {
    double sum = 0.0;
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const auto& side = tree.root_bbox[static_cast<std::size_t>(axis)];
      const double outside = std::max({side.low - query[axis], query[axis] - side.high, 0.0});
      sum += outside * outside;
    }
    return sum;
  }

  std::int32_t first;
  Adaptor adaptor;
  Tree tree;
};

PointTree::PointTree(const std::vector<Eigen::Vector3d>& points, const Parallel& parallel)
    : runs_((points.size() + kRun - 1) / kRun) {
  parallel.ForRanges(
      static_cast<std::int64_t>(points.size()), kRun, [&](std::int64_t first, std::int64_t end) {
        runs_[static_cast<std::size_t>(first / kRun)] = std::make_unique<Run>(
            points.data(), static_cast<std::int32_t>(first), static_cast<std::size_t>(end - first));
      });
}
PointTree::~PointTree() = default;
PointTree::PointTree(PointTree&&) noexcept = default;
PointTree& PointTree::operator=(PointTree&&) noexcept = default;

std::vector<std::int32_t> PointTree::Nearest(const Eigen::Vector3d& query, int count) const {
  if (count <= 0 || runs_.empty()) return {};
  const std::size_t points = static_cast<std::size_t>(runs_.back()->first) +
                             runs_.back()->adaptor.kdtree_get_point_count();
  NearestSet nearest(std::min(points, static_cast<std::size_t>(count)));
  const auto search = [&](const Run& run) {
    nearest.SetFirst(run.first);
    run.tree.findNeighbors(nearest, query.data(), nanoflann::SearchParams());
  };
  // The nearest run first: it holds most of the answer, and most of the others need no search.
  std::size_t start = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t r = 0; r < runs_.size(); ++r) {
    const double distance = runs_[r]->SquaredDistance(query);
    if (distance >= least) continue;
    least = distance;
    start = r;
  }
  search(*runs_[start]);
  for (std::size_t r = 0; r < runs_.size(); ++r) {
    if (r == start || runs_[r]->SquaredDistance(query) >= nearest.worstDist()) continue;
    search(*runs_[r]);
  }
  return nearest.Indices();
}

}  // namespace ccst
