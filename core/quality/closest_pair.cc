#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <tuple>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "core/quality/distances.h"
#include "core/spatial/box_tree.h"
#include "core/spatial/spatial_order.h"

namespace ccst::quality {
namespace {

// Runs of samples whose neighbours one thread looks for in one go.
constexpr std::int64_t kPiece = 512;
// Units of work, for an Interrupt, of looking around a run.
constexpr std::int64_t kRunWork = 64;
// Positions this many mean spacings apart, or fewer, are near.
constexpr double kNear = 8.0;
// So few need no order of their own.
constexpr std::size_t kFew = 64;

// The positions in an order in which neighbours are near each other: their own, as far as they are,
// then strays, which are near neither the one before nor the one after, along a curve. In boxes
// among the others strays would be found by every search.
std::vector<std::int32_t> OrderInSpace(std::span<const Eigen::Vector3d> positions,
                                       Interrupt* interrupt, const Parallel& parallel) {
  std::vector<std::int32_t> order;
  if (positions.empty()) return order;
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& p : positions) box.extend(p);
  const double extent = box.sizes().maxCoeff();
  const double near = kNear * extent / std::sqrt(static_cast<double>(positions.size()));
  const double scale = extent > 0.0 ? 1.0 / extent : 0.0;
  order.reserve(positions.size());
  std::vector<std::int32_t> strays;
  std::vector<Eigen::Vector3d> places;  // Of strays, within half a unit of the origin.
  bool is_near = false;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const bool was_near = is_near;
    is_near =
        i + 1 < positions.size() && (positions[i + 1] - positions[i]).squaredNorm() <= near * near;
    if (was_near || is_near) {
      order.push_back(static_cast<std::int32_t>(i));
    } else {
      strays.push_back(static_cast<std::int32_t>(i));
      places.emplace_back((positions[i] - box.center()) * scale);
    }
  }
  if (strays.size() <= kFew) {
    order.insert(order.end(), strays.begin(), strays.end());
    return order;
  }
  for (const std::int32_t k : HilbertOrder(places, interrupt, parallel)) {
    order.push_back(strays[static_cast<std::size_t>(k)]);
  }
  return order;
}

// The closest pair so far; distances are divided by the mean of the two ends' scales.
struct Closest {
  double squared = std::numeric_limits<double>::infinity();
  std::int32_t first = -1;
  std::int32_t second = -1;

  void Keep(double distance, std::int32_t a, std::int32_t b) {
    const std::int32_t low = std::min(a, b);
    const std::int32_t high = std::max(a, b);
    if (std::tie(distance, low, high) < std::tie(squared, first, second) || first < 0) {
      squared = distance;
      first = low;
      second = high;
    }
  }
};

class PairSearch {
 public:
  PairSearch(std::span<const Eigen::Vector3d> positions, std::span<const Eigen::Vector3d> normals,
             std::span<const double> scales, std::vector<std::int32_t> order)
      : normals_(normals), scales_(scales), order_(std::move(order)) {
    sorted_.reserve(positions.size());
    for (const std::int32_t i : order_) sorted_.push_back(positions[static_cast<std::size_t>(i)]);
    if (!scales.empty()) largest_scale_ = *std::max_element(scales.begin(), scales.end());
    tree_.Build(sorted_);
  }

  std::int64_t run_count() const { return static_cast<std::int64_t>(tree_.run_count()); }

  // Of pairs that follow each other: the closest of them is hardly farther apart than that of all.
  Closest OfNeighbours() const {
    Closest closest;
    for (std::size_t k = 1; k < sorted_.size(); ++k) {
      Look(k, k - 1, (sorted_[k] - sorted_[k - 1]).squaredNorm(), &closest);
    }
    return closest;
  }

  // Of all pairs whose first in this order lies in one of the runs [from, end).
  void Find(std::int64_t from, std::int64_t end, Closest* closest) const {
    for (auto run = static_cast<std::size_t>(from); run < static_cast<std::size_t>(end); ++run) {
      // A little more, so that equal distances are found too.
      const double radius = std::sqrt(closest->squared) * largest_scale_ * (1.0 + 1e-12) + 1e-150;
      tree_.ForEachRunWithin(run, radius, [&](std::size_t other) {
        const double limit = radius * radius;
        const std::size_t last = std::min((run + 1) * BoxTree::kRun, sorted_.size());
        const std::size_t end_of_other = std::min((other + 1) * BoxTree::kRun, sorted_.size());
        for (std::size_t k = run * BoxTree::kRun; k < last; ++k) {
          for (std::size_t j = std::max(k + 1, other * BoxTree::kRun); j < end_of_other; ++j) {
            const double squared = (sorted_[k] - sorted_[j]).squaredNorm();
            if (squared < limit) Look(k, j, squared, closest);
          }
        }
      });
    }
  }

 private:
  void Look(std::size_t a, std::size_t b, double squared, Closest* closest) const {
    const std::int32_t i = order_[a];
    const std::int32_t j = order_[b];
    if (!normals_.empty() && !(normals_[i].dot(normals_[j]) > 0.0)) return;
    if (!scales_.empty()) {
      const double mean = 0.5 * (scales_[i] + scales_[j]);
      squared /= mean * mean;
    }
    closest->Keep(squared, i, j);
  }

  std::span<const Eigen::Vector3d> normals_;
  std::span<const double> scales_;
  const std::vector<std::int32_t> order_;
  std::vector<Eigen::Vector3d> sorted_;
  double largest_scale_ = 1.0;
  BoxTree tree_;
};

}  // namespace

SamplePair FindClosestSameSide(std::span<const Eigen::Vector3d> positions,
                               std::span<const Eigen::Vector3d> normals,
                               std::span<const double> scales, Interrupt* interrupt,
                               const Parallel& parallel) {
  Interrupt never;
  if (interrupt == nullptr) interrupt = &never;
  std::vector<std::int32_t> order = OrderInSpace(positions, interrupt, parallel);
  if (interrupt->Requested()) return {};
  const PairSearch search(positions, normals, scales, std::move(order));
  const Closest start = search.OfNeighbours();
  std::vector<Closest> found((search.run_count() + kPiece - 1) / kPiece, start);
  parallel.ForRanges(search.run_count(), kPiece,
                     [&, stop = *interrupt](std::int64_t from, std::int64_t end) {
                       Interrupt own = stop;
                       for (std::int64_t run = from; run < end; ++run) {
                         if (own.RequestedAfter(kRunWork)) return;
                         search.Find(run, run + 1, &found[static_cast<std::size_t>(from / kPiece)]);
                       }
                     });
  Closest closest = start;
  for (const Closest& other : found) {
    if (other.first >= 0) closest.Keep(other.squared, other.first, other.second);
  }
  if (closest.first < 0) return {};
  return {closest.first, closest.second, std::sqrt(closest.squared)};
}

}  // namespace ccst::quality
