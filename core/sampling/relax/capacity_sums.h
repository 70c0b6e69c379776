#pragma once

#include <cstdint>

#include "core/sampling/relax/ring.h"

namespace ccst::internal {

/// What the capacities of sample triangles follow from; nothing is owned.
struct CapacitySources {
  const RingPlace* places = nullptr;         ///< Of the samples.
  const std::int32_t* origins = nullptr;     ///< Three of each triangle.
  const std::int32_t* components = nullptr;  ///< Of the samples.
  const double* scales = nullptr;            ///< 1 / C*, of the components.
  const float* densities = nullptr;          ///< Of the triangles; null: 1.
};

/// Sums over triangles, of how far their capacities are from the target.
struct CapacitySums {
  double apart = 0.0;   ///< Of c - 1, c = C / C*.
  double square = 0.0;  ///< Of (c - 1)^2.
};

/// The sums of triangles [first, end), eight at a time in single precision relative to each; gives
/// the same bits in all registers.
CapacitySums SumCapacities(const CapacitySources& sources, Registers registers, std::int32_t first,
                           std::int32_t end);

}  // namespace ccst::internal
