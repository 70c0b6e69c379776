#include "core/quality/distances.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <nanoflann.hpp>

#include "core/base/assert.h"

namespace ccst::quality {
namespace {

// Samples whose neighbours one thread looks for in one go.
constexpr std::int64_t kPiece = 1024;
// Units of work, for an Interrupt, of a search.
constexpr std::int64_t kSearchWork = 16;

// nanoflann's view of the positions.
struct PointCloud {
  std::span<const Eigen::Vector3d> points;
  std::size_t kdtree_get_point_count() const { return points.size(); }
  double kdtree_get_pt(std::size_t i, std::size_t dim) const {
    return points[i][static_cast<Eigen::Index>(dim)];
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, PointCloud>,
                                                 PointCloud, 3, std::int32_t>;

// What decides which point is nearest.
struct Metric {
  std::span<const Eigen::Vector3d> normals;  // Empty: every point is on the same side.
  std::span<const double> scales;            // Empty: 1.
  double largest_scale = 1.0;

  // Square of what distances between two points are divided by.
  double Divisor(std::int32_t a, double scale) const {
    if (scales.empty()) return 1.0;
    const double mean = 0.5 * (scales[a] + scale);
    return mean * mean;
  }
};

// Keeps the nearest point that is not `self` and, if normals are given, on its side.
// Equal distances go to the smaller index.
class NearestOther {
 public:
  using DistanceType = double;
  using IndexType = std::int32_t;

  NearestOther(std::int32_t self, const Metric& metric, double bound)
      : self_(self),
        metric_(&metric),
        reach_(self < 0 ? 0.0 : metric.Divisor(self, metric.largest_scale)),
        squared_(bound) {}

  std::size_t size() const { return index_ < 0 ? 0 : 1; }
  bool full() const { return true; }
  double worstDist() const { return squared_ * reach_; }
  bool addPoint(double squared, std::int32_t index) {
    if (index == self_) return true;
    if (!metric_->scales.empty()) squared /= metric_->Divisor(self_, metric_->scales[index]);
    if (squared > squared_) return true;
    if (squared == squared_ && index_ >= 0 && index > index_) return true;
    const auto& normals = metric_->normals;
    if (!normals.empty() && !(normals[self_].dot(normals[index]) > 0.0)) return true;
    squared_ = squared;
    index_ = index;
    return true;
  }

  std::int32_t index() const { return index_; }
  double squared() const { return squared_; }

 private:
  std::int32_t self_;
  const Metric* metric_;
  double reach_;    // Square of the largest divisor there may be.
  double squared_;  // Of the distance, divided.
  std::int32_t index_ = -1;
};

// The translations under which a point of the box has to be looked up.
std::vector<Eigen::Vector3d> Images(const Eigen::Vector3d& box) {
  std::vector<Eigen::Vector3d> images = {Eigen::Vector3d::Zero()};
  for (int axis = 0; axis < 3; ++axis) {
    if (!(box[axis] > 0.0)) continue;
    const std::size_t count = images.size();
    for (std::size_t i = 0; i < count; ++i) {
      for (const double sign : {-1.0, 1.0}) {
        images.emplace_back(images[i] + sign * box[axis] * Eigen::Vector3d::Unit(axis));
      }
    }
  }
  return images;
}

NearestOther FindNearest(const Tree& tree, const Eigen::Vector3d& point,
                         std::span<const Eigen::Vector3d> images, NearestOther nearest) {
  for (const Eigen::Vector3d& image : images) {
    const Eigen::Vector3d query = point + image;
    tree.findNeighbors(nearest, query.data(), nanoflann::SearchParams());
  }
  return nearest;
}

void KeepCloser(std::int32_t self, const NearestOther& nearest, SamplePair& pair) {
  if (nearest.index() < 0) return;
  const double distance = std::sqrt(nearest.squared());
  if (pair.first >= 0 && distance >= pair.distance) return;
  pair = {std::min(self, nearest.index()), std::max(self, nearest.index()), distance};
}

// The closest pair among images too; what is found bounds every further search.
SamplePair ClosestPair(const Tree& tree, std::span<const Eigen::Vector3d> positions,
                       std::span<const Eigen::Vector3d> images, const Metric& metric) {
  SamplePair pair;
  double bound = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const auto self = static_cast<std::int32_t>(i);
    const NearestOther nearest =
        FindNearest(tree, positions[i], images, NearestOther(self, metric, bound));
    bound = std::min(bound, nearest.squared());
    KeepCloser(self, nearest, pair);
  }
  return pair;
}

}  // namespace

double HexagonalSpacing(double area, std::int64_t count) {
  CCST_ASSERT(count > 0);
  return std::sqrt(2.0 * area / (std::sqrt(3.0) * static_cast<double>(count)));
}

DistanceFigures MeasureDistances(std::span<const Eigen::Vector3d> positions,
                                 std::span<const Eigen::Vector3d> normals, double area,
                                 const Eigen::Vector3d& periodic_box,
                                 std::span<const double> scales, const Parallel& parallel,
                                 Interrupt* interrupt) {
  Interrupt never;
  if (interrupt == nullptr) interrupt = &never;
  DistanceFigures figures;
  if (positions.empty()) return figures;
  const auto count = static_cast<std::int32_t>(positions.size());
  figures.r_max = HexagonalSpacing(area, count);
  if (count < 2) return figures;

  const PointCloud cloud{positions};
  const Tree tree(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(8));
  const std::vector<Eigen::Vector3d> images = Images(periodic_box);
  Metric all{{}, scales};
  if (!scales.empty()) all.largest_scale = *std::max_element(scales.begin(), scales.end());
  Metric same = all;
  same.normals = normals;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  std::vector<NearestOther> nearest(positions.size(), NearestOther(-1, all, kInfinity));
  parallel.ForRanges(count, kPiece, [&, stop = *interrupt](std::int64_t first, std::int64_t end) {
    Interrupt own = stop;
    for (auto i = static_cast<std::int32_t>(first); i < static_cast<std::int32_t>(end); ++i) {
      if (own.RequestedAfter(kSearchWork)) return;
      nearest[i] = FindNearest(tree, positions[i], images, NearestOther(i, all, kInfinity));
    }
  });
  if (interrupt->Requested()) return figures;
  double sum = 0.0;
  for (std::int32_t i = 0; i < count; ++i) {
    figures.nearest.push_back(std::sqrt(nearest[i].squared()) / figures.r_max);
    sum += std::sqrt(nearest[i].squared());
    KeepCloser(i, nearest[i], figures.closest);
  }
  if (normals.empty()) {
    figures.closest_same_side = figures.closest;
  } else if (images.size() == 1) {
    figures.closest_same_side =
        FindClosestSameSide(positions, normals, scales, interrupt, parallel);
  } else {
    figures.closest_same_side = ClosestPair(tree, positions, images, same);
  }
  figures.relative_radius = figures.closest.distance / figures.r_max;
  figures.relative_radius_same_side = figures.closest_same_side.distance / figures.r_max;
  figures.mean_nearest_distance = sum / count / figures.r_max;
  return figures;
}

}  // namespace ccst::quality
