#pragma once

#include <cstdint>
#include <vector>

#include "core/density/density.h"
#include "core/surface/surface.h"

namespace ccst {

/// A curve through the whole surface along which capacity is the parameter: component by
/// component, in each along a Hilbert curve through the centroids of the faces, in each face along
/// Density::PointAt(). Points that follow each other are near each other; a component is an
/// interval. Holds references to the surface and the density.
class CapacityCurve {
 public:
  /// Cost O(F log F).
  CapacityCurve(const Surface& surface, const Density& density);

  /// Capacity of the surface.
  double length() const { return ends_.back(); }
  /// Where component `c` begins; for the number of components, the length.
  double ComponentBegin(std::int32_t c) const { return component_begins_[c]; }

  /// The point at `capacity` in [0, length()]; never on a face without capacity. Cost O(log F).
  SurfacePoint At(double capacity) const;

 private:
  const Surface& surface_;
  const Density& density_;
  std::vector<std::int32_t> faces_;  // Those with capacity, in the order of the curve.
  std::vector<double> ends_;         // Per entry of faces_, where it ends.
  std::vector<double> component_begins_;
};

/// r_max = sqrt(2 A / (sqrt(3) count)).
double HexagonalSpacing(const Surface& surface, std::int64_t count);

}  // namespace ccst
