#include "core/methods/capacity_curve.h"
#include "core/methods/methods.h"
#include "core/random/random.h"

namespace ccst {
namespace {

constexpr std::uint64_t kStream = 0x7768697465;  // "white"

}  // namespace

absl::StatusOr<std::vector<SurfacePoint>> DrawWhiteNoise(const Surface& surface,
                                                         const Density& density, std::int64_t count,
                                                         std::uint64_t seed,
                                                         const MethodControl& control) {
  const CapacityCurve curve(surface, density);
  const CounterRandom random(seed, kStream);
  std::vector<SurfacePoint> points(count);
  for (std::int64_t i = 0; i < count; ++i) {
    if (control.interrupt->RequestedAt(i)) {
      return absl::CancelledError("stopped while white noise was drawn");
    }
    points[i] = curve.At(random.Uniform(i) * curve.length());
  }
  return points;
}

}  // namespace ccst
