#include "core/methods/capacity_curve.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <tuple>

#include "core/spatial/hilbert.h"

namespace ccst {
namespace {

std::uint64_t KeyOf(const Surface& surface, std::int32_t f) {
  const Eigen::Vector3i& face = surface.faces()[f];
  const Eigen::Vector3d center =
      (surface.positions()[face[0]] + surface.positions()[face[1]] + surface.positions()[face[2]]) /
      3.0;
  std::array<std::uint32_t, 3> cell;
  for (int k = 0; k < 3; ++k) {
    cell[k] = static_cast<std::uint32_t>(std::clamp((center[k] + 0.5) * 65535.0, 0.0, 65535.0));
  }
  return HilbertIndex(cell);
}

}  // namespace

CapacityCurve::CapacityCurve(const Surface& surface, const Density& density)
    : surface_(surface), density_(density) {
  std::vector<std::tuple<std::int32_t, std::uint64_t, std::int32_t>> order;
  order.reserve(surface.face_count());
  for (std::int32_t f = 0; f < surface.face_count(); ++f) {
    if (!(density.face_capacities()[f] > 0.0)) continue;
    order.emplace_back(surface.face_components()[f], KeyOf(surface, f), f);
  }
  std::sort(order.begin(), order.end());
  faces_.reserve(order.size());
  ends_.reserve(order.size());
  component_begins_.reserve(surface.component_areas().size() + 1);
  double end = 0.0;
  for (const auto& [component, key, face] : order) {
    while (component_begins_.size() <= static_cast<std::size_t>(component)) {
      component_begins_.push_back(end);
    }
    end += density.face_capacities()[face];
    faces_.push_back(face);
    ends_.push_back(end);
  }
  component_begins_.resize(surface.component_areas().size() + 1, end);
}

SurfacePoint CapacityCurve::At(double capacity) const {
  const auto at = std::min(std::upper_bound(ends_.begin(), ends_.end(), capacity), ends_.end() - 1);
  SurfacePoint point;
  point.face = faces_[at - ends_.begin()];
  const double begin = at == ends_.begin() ? 0.0 : *(at - 1);
  const double share = *at > begin ? (capacity - begin) / (*at - begin) : 0.5;
  point.weights = density_.PointAt(point.face, std::clamp(share, 0.0, 1.0 - 0x1.0p-53));
  const Eigen::Vector3i& face = surface_.faces()[point.face];
  for (int k = 0; k < 3; ++k) point.position += point.weights[k] * surface_.positions()[face[k]];
  return point;
}

double HexagonalSpacing(const Surface& surface, std::int64_t count) {
  return std::sqrt(2.0 * surface.area() / (std::numbers::sqrt3 * static_cast<double>(count)));
}

}  // namespace ccst
