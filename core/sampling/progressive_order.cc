#include "core/sampling/progressive_order.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>

#include "core/random/random.h"

namespace ccst {
namespace {

constexpr std::uint64_t kOrderStream = 0x6f72646572;  // "order"

/// Radius over r_max of the samples accepted, when darts find no more room.
constexpr double kDartRadius = 0.7;
/// Share of the samples that darts choose. The rest need no radius: they are far enough apart.
constexpr double kDartShare = 0.4;
/// Darts thrown for each one that is expected to be accepted.
constexpr double kDartsPerSample = 12.0;

/// Darts thrown before what they hit is taken into account, and those that one thread looks at.
constexpr std::size_t kVolley = 8192;
constexpr std::int64_t kPiece = 512;

/// Accepted samples in the cells of a grid, found through a hash of the cell.
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

/// Sorts; unfinished when `interrupt` was requested, which is looked at between runs.
void SortInRuns(std::vector<std::pair<double, std::int32_t>>* keys, Interrupt* interrupt) {
  constexpr std::ptrdiff_t kRun = std::ptrdiff_t{1} << 17;
  const auto size = static_cast<std::ptrdiff_t>(keys->size());
  const auto at = [&](std::ptrdiff_t i) { return keys->begin() + std::min(i, size); };
  for (std::ptrdiff_t i = 0; i < size && !interrupt->Requested(); i += kRun) {
    std::sort(at(i), at(i + kRun));
  }
  for (std::ptrdiff_t run = kRun; run < size; run *= 2) {
    for (std::ptrdiff_t i = 0; i < size && !interrupt->Requested(); i += 2 * run) {
      std::inplace_merge(at(i), at(i + run), at(i + 2 * run));
    }
  }
}

}  // namespace

std::vector<std::int32_t> ProgressiveOrder(std::span<const Eigen::Vector3d> positions,
                                           std::span<const Eigen::Vector3d> normals,
                                           std::span<const double> scales, double r_max,
                                           std::uint64_t seed, Interrupt* interrupt,
                                           const Parallel& parallel) {
  const std::size_t n = positions.size();
  const CounterRandom random(seed, kOrderStream);
  std::vector<std::pair<double, std::int32_t>> keys(n);
  for (std::size_t i = 0; i < n; ++i) {
    keys[i] = {random.Uniform(i), static_cast<std::int32_t>(i)};
  }
  SortInRuns(&keys, interrupt);

  const double largest_scale =
      scales.empty() ? 1.0 : *std::max_element(scales.begin(), scales.end());
  const auto scale = [&](std::int32_t i) { return scales.empty() ? 1.0 : scales[i]; };
  std::vector<std::int32_t> order;
  order.reserve(n);
  std::vector<std::uint8_t> taken(n, 0);
  Grid grid(n);
  Grid fresh(std::min(n, kVolley));  // What the volley under way has added.
  std::vector<std::int32_t> added;
  std::vector<std::uint8_t> hopeless(kVolley);  // Per dart of a volley.
  const double chosen = kDartShare * static_cast<double>(n);
  const int levels = std::max(0, static_cast<int>(std::ceil(std::log2(std::max(1.0, chosen)))));
  for (int level = levels; level >= 0; --level) {
    const double aim = chosen / std::exp2(level);
    const double radius = kDartRadius * r_max * std::sqrt(static_cast<double>(n) / aim);
    grid.Reset(2.0 * radius * largest_scale);
    if (interrupt->Requested()) return order;
    for (const std::int32_t i : order) grid.Insert(i, positions[i]);
    const auto darts = std::min(n, static_cast<std::size_t>(std::ceil(kDartsPerSample * aim)));
    const auto is_near = [&](std::int32_t i, std::int32_t j) {
      const double apart = 0.5 * radius * (scale(i) + scale(j));
      return (positions[i] - positions[j]).squaredNorm() < apart * apart &&
             normals[i].dot(normals[j]) > 0.0;
    };
    for (std::size_t first = 0; first < darts; first += kVolley) {
      // Most darts fall near what was accepted before their volley: threads find out which. The
      // rest are looked at one after the other.
      const std::size_t end = std::min(darts, first + kVolley);
      parallel.ForRanges(
          static_cast<std::int64_t>(end - first), kPiece,
          [&, stop = *interrupt](std::int64_t from, std::int64_t to) {
            if (Interrupt(stop).Requested()) return;
            for (auto k = static_cast<std::size_t>(from); k < static_cast<std::size_t>(to); ++k) {
              const std::int32_t i = keys[first + k].second;
              hopeless[k] = taken[i] != 0 || grid.Any(positions[i],
                                                      [&](std::int32_t j) { return is_near(i, j); })
                                ? 1
                                : 0;
            }
          });
      fresh.Reset(2.0 * radius * largest_scale);
      added.clear();
      for (std::size_t k = first; k < end; ++k) {
        if (interrupt->RequestedAt(static_cast<std::int64_t>(k))) return order;
        const std::int32_t i = keys[k].second;
        if (hopeless[k - first] != 0) continue;
        const bool crowded = fresh.Any(positions[i], [&](std::int32_t a) {
          return is_near(i, added[static_cast<std::size_t>(a)]);
        });
        if (crowded) continue;
        fresh.Insert(static_cast<std::int32_t>(added.size()), positions[i]);
        added.push_back(i);
        taken[i] = 1;
        order.push_back(i);
        grid.Insert(i, positions[i]);
      }
    }
  }
  for (const auto& [key, i] : keys) {
    if (!taken[i]) order.push_back(i);
  }
  return order;
}

}  // namespace ccst
