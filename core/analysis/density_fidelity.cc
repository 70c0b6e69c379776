#include "core/analysis/density_fidelity.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/analysis/face_parts.h"
#include "core/spatial/hilbert.h"

namespace ccst::analysis {
namespace {

// Parts a patch is made of, at least: what bounds the difference in capacity.
constexpr double kPartsOfPatch = 64.0;

}  // namespace

double MeasureDensityFidelity(const Surface& surface, const Density& density,
                              std::span<const SurfacePoint> samples, int patches) {
  if (samples.empty()) return 0.0;
  const FaceParts parts(surface, density, kPartsOfPatch * patches);
  std::vector<std::pair<std::uint64_t, std::int64_t>> order;
  order.reserve(static_cast<std::size_t>(parts.size()));
  double total = 0.0;
  for (std::int32_t face = 0; face < surface.face_count(); ++face) {
    const Eigen::Vector3i& corners = surface.faces()[static_cast<std::size_t>(face)];
    for (std::int64_t k = parts.first(face); k < parts.first(face + 1); ++k) {
      const Eigen::Vector3d weights = parts.Centroid(face, k);
      Eigen::Vector3d place = Eigen::Vector3d::Constant(0.5);
      for (int i = 0; i < 3; ++i) place += weights[i] * surface.positions()[corners[i]];
      const auto cell = [&](int axis) {
        return static_cast<std::uint32_t>(std::clamp(place[axis], 0.0, 1.0) * 65535.0);
      };
      order.emplace_back(HilbertIndex({cell(0), cell(1), cell(2)}), k);
      total += parts.Capacity(k);
    }
  }
  std::sort(order.begin(), order.end());
  std::vector<int> patch(order.size());
  std::vector<double> share(static_cast<std::size_t>(patches), 0.0);
  double passed = 0.0;
  for (const auto& [key, k] : order) {
    const double capacity = parts.Capacity(k);
    const double middle = (passed + 0.5 * capacity) / total;
    const int at = std::min(patches - 1, static_cast<int>(middle * patches));
    patch[static_cast<std::size_t>(k)] = at;
    share[static_cast<std::size_t>(at)] += capacity / total;
    passed += capacity;
  }
  std::vector<double> found(share.size(), 0.0);
  for (const SurfacePoint& sample : samples) {
    const int at = patch[static_cast<std::size_t>(parts.Find(sample))];
    found[static_cast<std::size_t>(at)] += 1.0 / static_cast<double>(samples.size());
  }
  double squares = 0.0;
  double counted = 0.0;
  for (std::size_t i = 0; i < share.size(); ++i) {
    if (!(share[i] > 0.0)) continue;
    squares += (found[i] / share[i] - 1.0) * (found[i] / share[i] - 1.0);
    counted += 1.0;
  }
  return std::sqrt(squares / counted);
}

}  // namespace ccst::analysis
