#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/limit_error.h"
#include "core/methods/capacity_curve.h"
#include "core/methods/methods.h"
#include "core/methods/sides.h"
#include "core/methods/strata.h"
#include "core/spatial/box_tree.h"

namespace ccst {
namespace {

constexpr std::uint64_t kSiteStream = 0x63637674;     // "ccvt"
constexpr std::uint64_t kPointStream = 0x6363767470;  // "ccvtp"

/// Units of work, for an Interrupt, of looking for swaps between two sites.
constexpr std::int64_t kSwapWork = 16;

/// What one point would gain by going to the other site of a pair.
struct Gain {
  double gain;
  std::int64_t entry;  // Index of the point.
  bool operator<(const Gain& other) const {
    return gain != other.gain ? gain > other.gain : entry < other.entry;
  }
};

/// Sites, each with the same number of points: site s owns points [s * parts, (s + 1) * parts);
/// to swap ownerships is to swap points.
class Balance {
 public:
  Balance(const Surface& surface, double r_max, std::int64_t parts, std::vector<SurfacePoint> sites)
      : surface_(surface),
        sides_(surface),
        parts_(parts),
        penalty_(4.0 * r_max * r_max),
        least_gain_(1e-12 * r_max * r_max),
        sites_(std::move(sites)),
        positions_(sites_.size()),
        reach_(sites_.size()),
        changed_(sites_.size(), 0) {
    for (std::size_t s = 0; s < sites_.size(); ++s) positions_[s] = sites_[s].position;
    points_.reserve(sites_.size() * parts);
  }

  /// To be called for every point before all else.
  void Add(const SurfacePoint& point) { points_.push_back({point.position, point.face}); }

  const std::vector<SurfacePoint>& sites() const { return sites_; }

  /// Sum of the costs of all points.
  double Energy() const {
    double energy = 0.0;
    for (std::size_t s = 0; s < sites_.size(); ++s) energy += CostOf(s, sites_[s]);
    return energy;
  }

  /// Swaps points between all pairs of sites that have changed since the step before and whose
  /// points may lie across each other; returns the number of swaps. Every state on the way is a
  /// whole one, so it may end anywhere when `interrupt` is requested.
  std::int64_t Swap(int step, Interrupt* interrupt) {
    tree_.Build(positions_);
    for (std::size_t s = 0; s < sites_.size(); ++s) {
      reach_[s] = 0.0;
      for (std::int64_t e = Begin(s); e < Begin(s + 1); ++e) {
        reach_[s] = std::max(reach_[s], (points_[e].position - positions_[s]).squaredNorm());
      }
      reach_[s] = std::sqrt(reach_[s]);
    }
    std::int64_t swaps = 0;
    for (std::size_t i = 0; i < sites_.size(); ++i) {
      if (interrupt->Requested()) break;
      // Balls that do not meet leave nothing to swap. A pair is seen from its larger ball.
      others_.clear();
      tree_.ForEachWithin(positions_[i], 2.0 * reach_[i], [&](std::int32_t j, double squared) {
        const auto other = static_cast<std::size_t>(j);
        const double sum = reach_[i] + reach_[j];
        const bool larger = reach_[i] != reach_[j] ? reach_[i] > reach_[j] : i < other;
        if (larger && squared < sum * sum && std::max(changed_[i], changed_[j]) >= step - 1) {
          others_.push_back(j);
        }
      });
      for (const std::int32_t j : others_) {
        if (interrupt->RequestedAfter(kSwapWork)) break;
        const std::int64_t swapped = SwapBetween(i, j);
        if (swapped > 0) changed_[i] = changed_[j] = step;
        swaps += swapped;
      }
    }
    return swaps;
  }

  /// Moves every site to the centroid of its points unless that costs more; returns the longest
  /// move. Once `interrupt` is requested the others stay.
  double Move(int step, Interrupt* interrupt) {
    double longest = 0.0;
    for (std::size_t s = 0; s < sites_.size(); ++s) {
      if (interrupt->RequestedAfter(kSwapWork)) break;
      if (changed_[s] < step - 1) continue;
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      for (std::int64_t e = Begin(s); e < Begin(s + 1); ++e) {
        sum += points_[e].position;
      }
      const SurfacePoint moved = MoveTo(surface_, sites_[s], sum / static_cast<double>(parts_));
      const double distance = (moved.position - positions_[s]).norm();
      if (!(distance > 0.0) || !(CostOf(s, moved) < CostOf(s, sites_[s]))) continue;
      longest = std::max(longest, distance);
      sites_[s] = moved;
      positions_[s] = moved.position;
      changed_[s] = step;
    }
    return longest;
  }

 private:
  struct Point {
    Eigen::Vector3d position;
    std::int32_t face;
  };

  std::int64_t Begin(std::size_t s) const { return static_cast<std::int64_t>(s) * parts_; }

  double Cost(const Point& point, const SurfacePoint& site) const {
    return (point.position - site.position).squaredNorm() +
           (sides_.Same(point.face, site.face) ? 0.0 : penalty_);
  }

  double CostOf(std::size_t s, const SurfacePoint& site) const {
    double cost = 0.0;
    for (std::int64_t e = Begin(s); e < Begin(s + 1); ++e) cost += Cost(points_[e], site);
    return cost;
  }

  /// What the points of `from` gain by going to `to`; returns the largest gain.
  double FindGains(std::size_t from, std::size_t to, std::vector<Gain>* gains) const {
    double largest = -std::numeric_limits<double>::infinity();
    gains->clear();
    for (std::int64_t e = Begin(from); e < Begin(from + 1); ++e) {
      const double gain = Cost(points_[e], sites_[from]) - Cost(points_[e], sites_[to]);
      largest = std::max(largest, gain);
      gains->push_back({gain, e});
    }
    return largest;
  }

  /// Swaps points of two sites, those that gain most first, as long as both together gain.
  std::int64_t SwapBetween(std::size_t i, std::size_t j) {
    const double most_i = FindGains(i, j, &gains_i_);
    const double most_j = FindGains(j, i, &gains_j_);
    if (!(most_i + most_j > least_gain_)) return 0;
    std::erase_if(gains_i_, [&](const Gain& g) { return !(g.gain + most_j > least_gain_); });
    std::erase_if(gains_j_, [&](const Gain& g) { return !(g.gain + most_i > least_gain_); });
    std::sort(gains_i_.begin(), gains_i_.end());
    std::sort(gains_j_.begin(), gains_j_.end());
    std::size_t k = 0;
    for (; k < std::min(gains_i_.size(), gains_j_.size()); ++k) {
      if (!(gains_i_[k].gain + gains_j_[k].gain > least_gain_)) break;
      std::swap(points_[gains_i_[k].entry], points_[gains_j_[k].entry]);
    }
    return static_cast<std::int64_t>(k);
  }

  const Surface& surface_;
  Sides sides_;
  const std::int64_t parts_;
  const double penalty_;       // Of a point on another side than its site.
  const double least_gain_;    // Less is rounding.
  std::vector<Point> points_;  // By site.
  std::vector<SurfacePoint> sites_;
  std::vector<Eigen::Vector3d> positions_;
  std::vector<double> reach_;  // Distance of a site's farthest point.
  std::vector<int> changed_;   // The last step in which a site moved or swapped.
  BoxTree tree_;
  std::vector<std::int32_t> others_;
  std::vector<Gain> gains_i_;
  std::vector<Gain> gains_j_;
};

}  // namespace

absl::StatusOr<RelaxedSamples> BalanceVoronoi(const Surface& surface, const Density& density,
                                              std::int64_t count, std::uint64_t seed,
                                              const BalanceOptions& options,
                                              const MethodControl& control) {
  if (count > kMaxBalancedCount) {
    return OverLimit({"max_sample_count", kMaxBalancedCount, count},
                     absl::StrCat("capacity-constrained Voronoi tessellation takes at most ",
                                  kMaxBalancedCount, " samples; sample_count is ", count));
  }
  const CapacityCurve curve(surface, density, control.interrupt);
  std::vector<SurfacePoint> start;
  start.reserve(count);
  ForEachStratum(density, curve, count, 1, CounterRandom(seed, kSiteStream), control.interrupt,
                 [&](const SurfacePoint& point) { start.push_back(point); });
  Interrupt* const interrupt = control.interrupt;
  if (interrupt->Requested()) return interrupt->Error("the first samples were drawn");
  const std::int64_t parts = options.points_per_sample;
  Balance balance(surface, HexagonalSpacing(surface, count), parts, std::move(start));
  ForEachStratum(density, curve, count, parts, CounterRandom(seed, kPointStream), interrupt,
                 [&](const SurfacePoint& point) { balance.Add(point); });
  RelaxedSamples result;
  if (interrupt->Requested()) {
    result.points = balance.sites();
    return result;
  }
  result.energy = balance.Energy();
  if (control.on_step) control.on_step({0, result.energy, 0.0, balance.sites()});
  while (!result.converged && result.steps < options.max_steps) {
    const int step = result.steps + 1;
    const std::int64_t swaps = balance.Swap(step, interrupt);
    if (interrupt->Requested()) break;
    const double max_move = balance.Move(step, interrupt);
    if (interrupt->Requested()) break;
    result.steps = step;
    result.energy = balance.Energy();
    result.converged = swaps == 0;
    if (control.on_step) control.on_step({step, result.energy, max_move, balance.sites()});
  }
  result.points = balance.sites();
  return result;
}

}  // namespace ccst
