#include <algorithm>
#include <cmath>

#include "core/methods/capacity_curve.h"
#include "core/methods/cloud.h"
#include "core/methods/methods.h"
#include "core/methods/sides.h"

namespace ccst {
namespace {

constexpr std::uint64_t kStream = 0x6461727473;  // "darts"

/// Darts a sample, and how many there are at least and at most.
constexpr std::int64_t kDartsPerSample = 20;
constexpr std::int64_t kMinDarts = 4096;
constexpr std::int64_t kMaxDarts = 10'000'000;

/// Where maximal sets are about, in r_max; the search starts here.
constexpr double kFirstRadius = 0.75;
constexpr int kMaxRadii = 24;
/// Points that are one unit of work of an Interrupt.
constexpr std::int64_t kPointsAUnit = 256;
/// The search ends when no more than this part of the samples, and one, would be dropped.
constexpr double kMaxExcess = 0.002;

/// The darts accepted, as indices into the cloud, in the order of the draws; unfinished when
/// `interrupt` was requested.
/// @param radius  in local spacings.
std::vector<std::int32_t> Throw(const Cloud& cloud, const Sides& sides, double radius,
                                Interrupt* interrupt) {
  std::vector<std::int32_t> accepted;
  std::vector<char> covered(cloud.positions.size(), 0);
  for (std::size_t k = 0; k < cloud.draws.size(); ++k) {
    if (interrupt->RequestedAt(static_cast<std::int64_t>(k))) break;
    const std::int32_t i = cloud.draws[k];
    if (covered[i]) continue;
    accepted.push_back(i);
    std::int64_t seen = 0;
    cloud.tree.ForEachWithin(
        cloud.positions[i], radius * cloud.spacings[i], [&](std::int32_t j, double squared) {
          ++seen;
          const double other = radius * cloud.spacings[j];
          if (!covered[j] && squared < other * other && sides.Same(cloud.faces[i], cloud.faces[j]))
            covered[j] = 1;
        });
    if (interrupt->RequestedAfter(seen / kPointsAUnit)) break;
  }
  return accepted;
}

}  // namespace

absl::StatusOr<DartSamples> ThrowDarts(const Surface& surface, const Density& density,
                                       std::int64_t count, std::uint64_t seed,
                                       const MethodControl& control) {
  const CapacityCurve curve(surface, density, control.interrupt);
  const Sides sides(surface);
  const std::int64_t size =
      std::clamp(kDartsPerSample * count, kMinDarts, std::max(kMaxDarts, 4 * count));
  Cloud cloud;
  DrawCloud(surface, density, curve, size, count, seed, kStream, control.interrupt, &cloud);

  const auto wanted = static_cast<std::size_t>(count);
  const auto excess = static_cast<std::size_t>(kMaxExcess * static_cast<double>(count)) + 1;
  // The number of darts falls with the square of the radius, a little raggedly.
  double low = 0.0;   // The largest radius known to give enough of them.
  double high = 4.0;  // The smallest known to give too few, or one that does.
  double radius = kFirstRadius;
  std::vector<std::int32_t> best;
  for (int attempt = 0; best.empty() || attempt < kMaxRadii; ++attempt) {
    std::vector<std::int32_t> accepted = Throw(cloud, sides, radius, control.interrupt);
    if (control.interrupt->Requested()) {
      return control.interrupt->Error("darts were thrown");
    }
    const std::size_t found = accepted.size();
    if (found >= wanted) {
      low = radius;
      best = std::move(accepted);
      if (found <= wanted + excess) break;
    } else {
      high = radius;
    }
    // Aims at half the excess that is accepted.
    const double aim = static_cast<double>(wanted) + 0.5 * static_cast<double>(excess);
    radius *= std::sqrt(static_cast<double>(found) / aim);
    if (!(radius > low && radius < high)) radius = 0.5 * (low + high);
  }
  DartSamples samples;
  samples.radius = low * HexagonalSpacing(surface, count);
  samples.points.reserve(wanted);
  for (std::size_t k = 0; k < wanted; ++k) {
    samples.points.push_back(curve.At(cloud.capacities[best[k]]));
  }
  return samples;
}

}  // namespace ccst
