#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/portable_math.h"
#include "core/methods/capacity_curve.h"
#include "core/methods/cloud.h"
#include "core/methods/methods.h"
#include "core/methods/sides.h"

namespace ccst {
namespace {

constexpr std::uint64_t kStream = 0x656c696d;  // "elim"

/// Yuksel's parameters; alpha = 8 is in Weight().
constexpr std::int64_t kPointsPerSample = 5;
constexpr double kBeta = 0.65;
constexpr double kGamma = 1.5;

/// A neighbour and what it adds to a point's weight.
struct Neighbor {
  std::int32_t index;
  float weight;
};

/// (1 - d)^8 with d = distance over spacing (2 r_max in Yuksel's terms), limited from below.
/// @param squared  d^2 in [0, 1).
float Weight(double squared, double limit) {
  const double w = 1.0 - std::max(std::sqrt(squared), limit);
  const double w2 = w * w;
  const double w4 = w2 * w2;
  return static_cast<float>(w4 * w4);
}

/// Points looked at that are one unit of work of an Interrupt.
constexpr std::int64_t kPointsAUnit = 64;

/// The neighbours of the points of a cloud. They are kept, unless they are too many: where thin
/// parts of a surface lie on top of each other, every point may be a neighbour of every other.
class Neighborhoods {
 public:
  /// Unfinished when `interrupt` was requested.
  Neighborhoods(const Cloud& cloud, const Sides& sides, double limit, Interrupt* interrupt)
      : cloud_(cloud), sides_(sides), limit_(limit), interrupt_(*interrupt) {
    // A disk of radius r_max holds 2 pi / sqrt(3) samples, and some more for luck.
    constexpr std::size_t kExpected = 19 * kPointsPerSample / 5;
    const std::size_t expected = kExpected * cloud.positions.size();
    neighbors_.reserve(expected);
    ends_.reserve(cloud.positions.size());
    for (std::int32_t i = 0; i < size(); ++i) {
      if (interrupt_.RequestedAt(i)) return;
      Search(i, [&](const Neighbor& neighbor) { neighbors_.push_back(neighbor); });
      ends_.push_back(static_cast<std::int64_t>(neighbors_.size()));
      if (neighbors_.size() <= 2 * expected) continue;
      neighbors_ = {};
      ends_ = {};
      return;
    }
  }

  std::int32_t size() const { return static_cast<std::int32_t>(cloud_.positions.size()); }

  /// Calls f(neighbor) for those of point `i`, always in the same order. Ends early when the
  /// interrupt was requested.
  template <typename F>
  void ForEach(std::int32_t i, const F& f) {
    if (ends_.empty()) return Search(i, f);
    for (std::int64_t k = i == 0 ? 0 : ends_[i - 1]; k < ends_[i]; ++k) f(neighbors_[k]);
  }

 private:
  template <typename F>
  void Search(std::int32_t i, const F& f) {
    const double spacing = cloud_.spacings[i];
    std::int64_t seen = 0;
    cloud_.tree.ForEachWithin(cloud_.positions[i], spacing, [&](std::int32_t j, double squared) {
      ++seen;
      const double smaller = std::min<double>(spacing, cloud_.spacings[j]);
      const double relative = squared / (smaller * smaller);
      if (j == i || !(relative < 1.0) || !sides_.Same(cloud_.faces[i], cloud_.faces[j])) return;
      f(Neighbor{j, Weight(relative, limit_)});
    });
    interrupt_.RequestedAfter(1 + seen / kPointsAUnit);
  }

  const Cloud& cloud_;
  const Sides& sides_;
  const double limit_;
  Interrupt& interrupt_;
  std::vector<Neighbor> neighbors_;  // One point's after the other's: those of i end at ends_[i].
  std::vector<std::int64_t> ends_;   // Empty when they are not kept.
};

/// Points by weight, the largest first, of equal ones that of the largest index, when weights only
/// fall. A point lies in the bucket of a weight that it once had; when the bucket's turn comes,
/// points that have fallen since go to lower ones, and only the others are sorted, by a heap. That
/// is the order of one heap of all points, without its cache misses.
class FallingQueue {
 public:
  /// @param weights  not owned; may only fall while the queue is used.
  explicit FallingQueue(const std::vector<double>& weights)
      : weights_(weights), heads_(kBuckets, -1), next_(weights.size(), -1), bucket_(kBuckets) {
    double largest = 1e-30;
    for (const double weight : weights) largest = std::max(largest, weight);
    scale_ = (kBuckets - 1) / largest;
    for (std::size_t i = 0; i < weights.size(); ++i) Insert(static_cast<std::int32_t>(i));
  }

  /// Takes out the first point. The queue is not empty. Cost O(1) amortised for few equal weights.
  std::int32_t Pop() {
    while (true) {
      while (heap_.empty()) OpenNext();
      std::pop_heap(heap_.begin(), heap_.end());
      const auto [weight, i] = heap_.back();
      heap_.pop_back();
      if (weights_[i] == weight) return i;
      Insert(i);
    }
  }

 private:
  static constexpr int kBuckets = 1 << 16;

  int BucketOf(std::int32_t i) const {
    return std::clamp(static_cast<int>(weights_[i] * scale_), 0, kBuckets - 1);
  }

  void Insert(std::int32_t i) {
    const int bucket = BucketOf(i);
    if (bucket < bucket_) {
      next_[i] = heads_[bucket];
      heads_[bucket] = i;
    } else {
      heap_.emplace_back(weights_[i], i);
      std::push_heap(heap_.begin(), heap_.end());
    }
  }

  /// Inserts the points of the next lower bucket, with what weights they have now.
  void OpenNext() {
    --bucket_;
    for (std::int32_t i = std::exchange(heads_[bucket_], -1); i >= 0;) {
      const std::int32_t following = next_[i];
      Insert(i);
      i = following;
    }
  }

  const std::vector<double>& weights_;
  std::vector<std::int32_t> heads_;  // Per bucket: its first point, -1 when empty.
  std::vector<std::int32_t> next_;   // Per point: the next one of its bucket.
  std::vector<std::pair<double, std::int32_t>> heap_;  // Points of the open bucket.
  int bucket_;                                         // The open one; higher ones are empty.
  double scale_ = 0.0;                                 // Buckets a unit of weight.
};

/// Removes the point of the largest weight until `count` are left; returns which are. Unfinished
/// when `interrupt` was requested.
std::vector<char> Eliminate(Neighborhoods* all, std::int64_t count, Interrupt* interrupt) {
  const std::int32_t size = all->size();
  std::vector<double> weights(size, 0.0);
  for (std::int32_t i = 0; i < size; ++i) {
    if (interrupt->RequestedAt(i)) return {};
    all->ForEach(i, [&](const Neighbor& neighbor) { weights[i] += neighbor.weight; });
  }
  FallingQueue queue(weights);
  std::vector<char> alive(size, 1);
  for (std::int64_t left = size; left > count; --left) {
    if (interrupt->RequestedAt(left)) break;
    const std::int32_t i = queue.Pop();
    alive[i] = 0;
    all->ForEach(i, [&](const Neighbor& neighbor) { weights[neighbor.index] -= neighbor.weight; });
  }
  return alive;
}

}  // namespace

absl::StatusOr<std::vector<SurfacePoint>> EliminateSamples(const Surface& surface,
                                                           const Density& density,
                                                           std::int64_t count, std::uint64_t seed,
                                                           const MethodControl& control) {
  const CapacityCurve curve(surface, density, control.interrupt);
  const Sides sides(surface);
  Cloud cloud;
  DrawCloud(surface, density, curve, kPointsPerSample * count, count, seed, kStream,
            control.interrupt, &cloud);
  const double limit = kBeta * (1.0 - PortablePow(1.0 / kPointsPerSample, kGamma));
  Neighborhoods neighborhoods(cloud, sides, limit, control.interrupt);
  std::vector<char> alive;
  if (!control.interrupt->Requested()) {
    alive = Eliminate(&neighborhoods, count, control.interrupt);
  }
  if (control.interrupt->Requested()) {
    return control.interrupt->Error("samples were eliminated");
  }
  std::vector<SurfacePoint> points;
  points.reserve(count);
  for (std::size_t i = 0; i < alive.size(); ++i) {
    if (alive[i]) points.push_back(curve.At(cloud.capacities[i]));
  }
  return points;
}

}  // namespace ccst
