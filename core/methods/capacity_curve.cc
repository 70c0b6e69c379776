#include "core/methods/capacity_curve.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/spatial/spatial_order.h"

namespace ccst {

CapacityCurve::CapacityCurve(const Surface& surface, const Density& density, Interrupt* interrupt)
    : surface_(surface),
      density_(density),
      component_begins_(surface.component_areas().size() + 1, 0.0) {
  std::vector<Eigen::Vector3d> centers(surface.face_count());
  std::vector<std::int64_t> next(component_begins_.size() + 1, 0);
  for (std::int32_t f = 0; f < surface.face_count(); ++f) {
    const Eigen::Vector3i& face = surface.faces()[f];
    centers[f] = (surface.positions()[face[0]] + surface.positions()[face[1]] +
                  surface.positions()[face[2]]) /
                 3.0;
    ++next[surface.face_components()[f] + 1];
  }
  const std::vector<std::int32_t> order = HilbertOrder(centers, interrupt);
  if (interrupt->Requested()) return;
  for (std::size_t c = 1; c < next.size(); ++c) next[c] += next[c - 1];
  faces_.resize(surface.face_count());
  for (const std::int32_t f : order) faces_[next[surface.face_components()[f]]++] = f;
  std::erase_if(faces_, [&](std::int32_t f) { return !(density.face_capacities()[f] > 0.0); });
  ends_.reserve(faces_.size());
  std::size_t begun = 0;
  double end = 0.0;
  for (const std::int32_t f : faces_) {
    while (begun <= static_cast<std::size_t>(surface.face_components()[f])) {
      component_begins_[begun++] = end;
    }
    end += density.face_capacities()[f];
    ends_.push_back(end);
  }
  while (begun < component_begins_.size()) component_begins_[begun++] = end;
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
