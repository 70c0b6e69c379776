#include "core/sampling/output/progressive_order.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>

#include "core/base/portable_math.h"
#include "core/base/sort_in_runs.h"
#include "core/random/random.h"

namespace ccst::internal {
namespace {

constexpr std::uint64_t kOrderStream = 0x6f72646572;  // "order"

/// Radius over r_max of the samples chosen, when darts find no more room.
constexpr double kDartRadius = 0.7;
/// Share of the samples that darts choose. The rest need no radius: they are far enough apart.
constexpr double kDartShare = 0.4;
/// Darts thrown for each one that is expected to be chosen.
constexpr double kDartsPerSample = 12.0;

/// From this share of all samples on, it pays to go through all first.
constexpr double kSweptShare = 0.25;
/// Darts thrown before what they hit is taken into account, and those that one thread looks at.
constexpr std::size_t kVolley = 8192;
constexpr std::int64_t kPiece = 512;
/// Units of work, for an Interrupt, of asking for samples near a dart: thin parts lie on top of
/// each other in one cell.
constexpr std::int64_t kDartWork = 32;

/// Chosen samples in the cells of a grid, found through a hash of the cell.
class Grid {
 public:
  explicit Grid(std::size_t capacity)
      : first_(std::bit_ceil(2 * capacity + 16), -1), next_(capacity, -1) {}

  void Reset(double cell) {
    scale_ = 1.0 / cell;
    std::fill(first_.begin(), first_.end(), -1);
  }

  void Insert(std::int32_t i, const Eigen::Vector3d& position) {
    const Eigen::Vector3d p = scale_ * position;
    const std::size_t slot = Slot(Floor(p[0]), Floor(p[1]), Floor(p[2]));
    next_[i] = first_[slot];
    first_[slot] = i;
  }

  /// True when `f` is for one of the samples within half a cell of `position`; it may be asked
  /// about others, and about one more than once.
  template <typename F>
  bool Any(const Eigen::Vector3d& position, F&& f) const {
    const Eigen::Vector3d p = scale_ * position;
    std::array<std::array<std::int64_t, 2>, 3> cells;
    for (int k = 0; k < 3; ++k) {
      const std::int64_t cell = Floor(p[k]);
      cells[k] = {cell, p[k] - static_cast<double>(cell) < 0.5 ? cell - 1 : cell + 1};
    }
    for (const std::int64_t x : cells[0]) {
      for (const std::int64_t y : cells[1]) {
        for (const std::int64_t z : cells[2]) {
          for (std::int32_t i = first_[Slot(x, y, z)]; i >= 0; i = next_[i]) {
            if (f(i)) return true;
          }
        }
      }
    }
    return false;
  }

 private:
  static std::int64_t Floor(double x) { return static_cast<std::int64_t>(std::floor(x)); }

  std::size_t Slot(std::int64_t x, std::int64_t y, std::int64_t z) const {
    const auto mix = static_cast<std::uint64_t>(x) * 0x9E3779B97F4A7C15U ^
                     static_cast<std::uint64_t>(y) * 0xC2B2AE3D27D4EB4FU ^
                     static_cast<std::uint64_t>(z) * 0x165667B19E3779F9U;
    return (mix ^ (mix >> 29)) & (first_.size() - 1);
  }

  double scale_ = 1.0;
  std::vector<std::int32_t> first_;  // Per slot.
  std::vector<std::int32_t> next_;   // Per sample.
};

/// A sample in the order in which they are thrown: by a random number, and equal ones by index.
using Dart = std::pair<double, std::int32_t>;

/// The samples chosen so far, and what chooses more.
class Darts {
 public:
  /// What ProgressiveOrder() gets.
  Darts(std::span<const Eigen::Vector3d> positions, std::span<const Eigen::Vector3d> normals,
        std::span<const double> scales, std::uint64_t seed, Interrupt* interrupt,
        const Parallel& parallel)
      : positions_(positions),
        normals_(normals),
        scales_(scales),
        random_(seed, kOrderStream),
        interrupt_(*interrupt),
        parallel_(parallel),
        largest_scale_(scales.empty() ? 1.0 : *std::max_element(scales.begin(), scales.end())),
        throws_(positions.size()),
        taken_(positions.size(), 0),
        grid_(positions.size()),
        fresh_(std::min(positions.size(), kVolley)) {
    for (std::size_t i = 0; i < throws_.size(); ++i) throws_[i] = DartOf(i);
    SortInRuns(throws_.begin(), throws_.end(), interrupt);
    order_.reserve(positions.size());
  }

  /// Throws the first `count` and chooses those that are not within `radius`, times the scales, of
  /// one chosen before. Unfinished when interrupted.
  void Throw(std::size_t count, double radius) {
    radius_ = radius;
    grid_.Reset(2.0 * radius * largest_scale_);
    for (const std::int32_t i : order_) grid_.Insert(i, positions_[i]);
    if (interrupt_.Requested()) return;
    if (static_cast<double>(count) >= kSweptShare * static_cast<double>(throws_.size())) {
      ThrowVolleys(WithRoom(count));
    } else {
      ThrowVolleys(std::span(throws_).first(count));
    }
  }

  /// The chosen and, unless interrupted, after them the others as they are thrown.
  std::vector<std::int32_t> Order() && {
    if (interrupt_.Requested()) return std::move(order_);
    for (const auto& [key, i] : throws_) {
      if (!taken_[i]) order_.push_back(i);
    }
    return std::move(order_);
  }

 private:
  Dart DartOf(std::size_t i) const { return {random_.Uniform(i), static_cast<std::int32_t>(i)}; }

  bool AreNear(std::int32_t i, std::int32_t j) const {
    const double scale = scales_.empty() ? 2.0 : scales_[i] + scales_[j];
    const double apart = 0.5 * radius_ * scale;
    return (positions_[i] - positions_[j]).squaredNorm() < apart * apart &&
           normals_[i].dot(normals_[j]) > 0.0;
  }

  /// True when `i` is chosen or near one that the grid knows of.
  bool IsHopeless(std::int32_t i) const {
    return taken_[i] != 0 ||
           grid_.Any(positions_[i], [&](std::int32_t j) { return AreNear(i, j); });
  }

  /// Those of the first `count` that have a chance so far. Asks in the order of the samples, in
  /// which neighbours look into the same cells.
  std::vector<Dart> WithRoom(std::size_t count) const;
  void ThrowVolleys(std::span<const Dart> darts);

  const std::span<const Eigen::Vector3d> positions_;
  const std::span<const Eigen::Vector3d> normals_;
  const std::span<const double> scales_;
  const CounterRandom random_;
  Interrupt& interrupt_;
  const Parallel& parallel_;
  const double largest_scale_;
  double radius_ = 0.0;
  std::vector<Dart> throws_;
  std::vector<std::uint8_t> taken_;
  std::vector<std::int32_t> order_;
  Grid grid_;   // The chosen.
  Grid fresh_;  // What the volley under way has added to them.
};

std::vector<Dart> Darts::WithRoom(std::size_t count) const {
  const Dart last = throws_[count - 1];
  std::vector<std::uint8_t> has_room(positions_.size(), 0);
  parallel_.ForRanges(static_cast<std::int64_t>(positions_.size()), kPiece,
                      [&, stop = interrupt_](std::int64_t first, std::int64_t end) {
                        Interrupt own = stop;
                        for (auto i = static_cast<std::size_t>(first);
                             i < static_cast<std::size_t>(end); ++i) {
                          if (own.RequestedAfter(kDartWork)) return;
                          const Dart dart = DartOf(i);
                          has_room[i] = dart <= last && !IsHopeless(dart.second) ? 1 : 0;
                        }
                      });
  std::vector<Dart> darts;
  for (const Dart& dart : std::span(throws_).first(count)) {
    if (has_room[dart.second] != 0) darts.push_back(dart);
  }
  return darts;
}

void Darts::ThrowVolleys(std::span<const Dart> darts) {
  std::vector<std::int32_t> added;
  std::vector<std::uint8_t> hopeless(kVolley);  // Per dart of a volley.
  for (std::size_t first = 0; first < darts.size(); first += kVolley) {
    // Most darts fall near what was chosen before their volley: threads find out which. The rest
    // are looked at one after the other.
    const std::size_t end = std::min(darts.size(), first + kVolley);
    parallel_.ForRanges(static_cast<std::int64_t>(end - first), kPiece,
                        [&, stop = interrupt_](std::int64_t from, std::int64_t to) {
                          Interrupt own = stop;
                          for (auto k = static_cast<std::size_t>(from);
                               k < static_cast<std::size_t>(to); ++k) {
                            if (own.RequestedAfter(kDartWork)) return;
                            hopeless[k] = IsHopeless(darts[first + k].second) ? 1 : 0;
                          }
                        });
    fresh_.Reset(2.0 * radius_ * largest_scale_);
    added.clear();
    for (std::size_t k = first; k < end; ++k) {
      if (interrupt_.RequestedAfter(kDartWork)) return;
      const std::int32_t i = darts[k].second;
      if (hopeless[k - first] != 0) continue;
      const bool crowded = fresh_.Any(positions_[i], [&](std::int32_t a) {
        return AreNear(i, added[static_cast<std::size_t>(a)]);
      });
      if (crowded) continue;
      fresh_.Insert(static_cast<std::int32_t>(added.size()), positions_[i]);
      added.push_back(i);
      taken_[i] = 1;
      order_.push_back(i);
      grid_.Insert(i, positions_[i]);
    }
  }
}

}  // namespace

std::vector<std::int32_t> ProgressiveOrder(std::span<const Eigen::Vector3d> positions,
                                           std::span<const Eigen::Vector3d> normals,
                                           std::span<const double> scales, double r_max,
                                           std::uint64_t seed, Interrupt* interrupt,
                                           const Parallel& parallel) {
  const auto n = static_cast<double>(positions.size());
  Darts darts(positions, normals, scales, seed, interrupt, parallel);
  const double chosen = kDartShare * n;
  const int levels = std::max(0, CeilLog2(std::max(1.0, chosen)));
  for (int level = levels; level >= 0 && !interrupt->Requested(); --level) {
    const double aim = chosen / std::ldexp(1.0, level);
    const double count = std::min(n, std::ceil(kDartsPerSample * aim));
    darts.Throw(static_cast<std::size_t>(count), kDartRadius * r_max * std::sqrt(n / aim));
  }
  return std::move(darts).Order();
}

}  // namespace ccst::internal
