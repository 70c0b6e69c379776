#include <algorithm>
#include <cmath>
#include <utility>

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

/// The neighbours of every point of the cloud one after the other: those of i end at ends[i].
struct Neighborhoods {
  std::vector<Neighbor> neighbors;
  std::vector<std::int64_t> ends;
};

Neighborhoods FindNeighbors(const Cloud& cloud, const Sides& sides, double limit,
                            Interrupt* interrupt) {
  // A disk of radius r_max holds 2 pi / sqrt(3) samples, and some more for luck.
  constexpr std::size_t kExpected = 19 * kPointsPerSample / 5;
  Neighborhoods found;
  found.neighbors.reserve(kExpected * cloud.positions.size());
  found.ends.reserve(cloud.positions.size());
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(cloud.positions.size()); ++i) {
    if (interrupt->RequestedAt(i)) break;
    const double spacing = cloud.spacings[i];
    cloud.tree.ForEachWithin(cloud.positions[i], spacing, [&](std::int32_t j, double squared) {
      const double smaller = std::min<double>(spacing, cloud.spacings[j]);
      const double relative = squared / (smaller * smaller);
      if (j == i || !(relative < 1.0) || !sides.Same(cloud.faces[i], cloud.faces[j])) return;
      found.neighbors.push_back({j, Weight(relative, limit)});
    });
    found.ends.push_back(static_cast<std::int64_t>(found.neighbors.size()));
  }
  return found;
}

/// Removes the point of the largest weight, the last of equal ones, until `count` are left.
/// Weights only fall, so an entry of the heap is an upper bound: it is brought up to date when it
/// comes to the top instead of at every change.
std::vector<char> Eliminate(const Neighborhoods& all, std::int64_t count, Interrupt* interrupt) {
  const std::size_t size = all.ends.size();
  const auto begin_of = [&](std::int32_t i) { return i == 0 ? 0 : all.ends[i - 1]; };
  std::vector<double> weights(size, 0.0);
  std::vector<std::pair<double, std::int32_t>> heap(size);
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(size); ++i) {
    for (std::int64_t k = begin_of(i); k < all.ends[i]; ++k) weights[i] += all.neighbors[k].weight;
    heap[i] = {weights[i], i};
  }
  std::make_heap(heap.begin(), heap.end());
  std::vector<char> alive(size, 1);
  for (std::int64_t step = 0; static_cast<std::int64_t>(heap.size()) > count; ++step) {
    if (interrupt->RequestedAt(step)) break;
    std::pop_heap(heap.begin(), heap.end());
    auto& [weight, i] = heap.back();
    if (weights[i] < weight) {
      weight = weights[i];
      std::push_heap(heap.begin(), heap.end());
      continue;
    }
    alive[i] = 0;
    for (std::int64_t k = begin_of(i); k < all.ends[i]; ++k) {
      weights[all.neighbors[k].index] -= all.neighbors[k].weight;
    }
    heap.pop_back();
  }
  return alive;
}

}  // namespace

absl::StatusOr<std::vector<SurfacePoint>> EliminateSamples(const Surface& surface,
                                                           const Density& density,
                                                           std::int64_t count, std::uint64_t seed,
                                                           const MethodControl& control) {
  const CapacityCurve curve(surface, density);
  const Sides sides(surface);
  Cloud cloud;
  DrawCloud(surface, density, curve, kPointsPerSample * count, count, seed, kStream,
            control.interrupt, &cloud);
  const double limit = kBeta * (1.0 - std::pow(1.0 / kPointsPerSample, kGamma));
  const Neighborhoods neighborhoods = FindNeighbors(cloud, sides, limit, control.interrupt);
  const std::vector<char> alive = Eliminate(neighborhoods, count, control.interrupt);
  if (control.interrupt->Requested()) {
    return absl::CancelledError("stopped while samples were eliminated");
  }
  std::vector<SurfacePoint> points;
  points.reserve(count);
  for (std::size_t i = 0; i < alive.size(); ++i) {
    if (alive[i]) points.push_back(curve.At(cloud.capacities[i]));
  }
  return points;
}

}  // namespace ccst
