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
  const CapacityCurve curve(surface, density, control.interrupt);
  const CounterRandom random(seed, kStream);
  std::vector<SurfacePoint> points;
  points.reserve(count);
  for (std::int64_t i = 0; i < count; ++i) {
    if (control.interrupt->RequestedAt(i)) {
      return control.interrupt->Error("white noise was drawn");
    }
    points.push_back(curve.At(random.Uniform(i) * curve.length()));
  }
  return points;
}

}  // namespace ccst
