#include "core/spatial/point_tree.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include <nanoflann.hpp>

namespace ccst {
namespace {

struct Adaptor {
  const std::vector<Eigen::Vector3d>& points;

  std::size_t kdtree_get_point_count() const { return points.size(); }
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

}  // namespace

struct PointTree::Index {
  explicit Index(const std::vector<Eigen::Vector3d>& points)
      : adaptor{points}, tree(3, adaptor, nanoflann::KDTreeSingleIndexAdaptorParams(16)) {}

  Adaptor adaptor;
  Tree tree;
};

PointTree::PointTree(const std::vector<Eigen::Vector3d>& points)
    : index_(std::make_unique<Index>(points)) {}
PointTree::~PointTree() = default;
PointTree::PointTree(PointTree&&) noexcept = default;
PointTree& PointTree::operator=(PointTree&&) noexcept = default;

std::vector<std::int32_t> PointTree::Nearest(const Eigen::Vector3d& query, int count) const {
  // One more than asked for, so that a tie at the end is seen and broken by index.
  const auto wanted = static_cast<std::size_t>(std::max(0, count));
  std::vector<std::uint32_t> indices(wanted + 1);
  std::vector<double> distances(wanted + 1);
  const std::size_t found =
      index_->tree.knnSearch(query.data(), wanted + 1, indices.data(), distances.data());
  std::vector<std::pair<double, std::int32_t>> order(found);
  for (std::size_t i = 0; i < found; ++i) {
    order[i] = {distances[i], static_cast<std::int32_t>(indices[i])};
  }
  std::sort(order.begin(), order.end());
  if (found > wanted && wanted > 0 && order[wanted].first == order[wanted - 1].first) {
    // Which of the points at this distance were found is the tree's choice: look at all of them.
    const double bound =
        std::nextafter(order[wanted].first, std::numeric_limits<double>::infinity());
    std::vector<std::pair<std::uint32_t, double>> all;
    index_->tree.radiusSearch(query.data(), bound, all, nanoflann::SearchParams());
    order.clear();
    for (const auto& [index, distance] : all) {
      order.emplace_back(distance, static_cast<std::int32_t>(index));
    }
    std::sort(order.begin(), order.end());
  }
  order.resize(std::min(order.size(), wanted));
  std::vector<std::int32_t> result;
  result.reserve(order.size());
  for (const auto& [distance, index] : order) result.push_back(index);
  return result;
}

}  // namespace ccst
