#pragma once

#include <array>
#include <cstdint>

namespace ccst {

/// Position of a cell along the three-dimensional Hilbert curve of order 16.
/// @param cell  coordinates, each in [0, 2^16).
/// @return      index in [0, 2^48); neighbours on the curve are neighbours in space.
/// Source: Skilling, "Programming the Hilbert curve", AIP Conf. Proc. 707, 2004.
inline std::uint64_t HilbertIndex(std::array<std::uint32_t, 3> cell) {
  constexpr int kBits = 16;
  for (std::uint32_t bit = 1u << (kBits - 1); bit > 1; bit >>= 1) {
    const std::uint32_t low = bit - 1;
    for (std::uint32_t& axis : cell) {
      if (axis & bit) {
        cell[0] ^= low;
      } else {
        const std::uint32_t swap = (cell[0] ^ axis) & low;
        cell[0] ^= swap;
        axis ^= swap;
      }
    }
  }
  cell[1] ^= cell[0];
  cell[2] ^= cell[1];
  std::uint32_t fix = 0;
  for (std::uint32_t bit = 1u << (kBits - 1); bit > 1; bit >>= 1) {
    if (cell[2] & bit) fix ^= bit - 1;
  }
  for (std::uint32_t& axis : cell) axis ^= fix;
  std::uint64_t index = 0;
  for (int bit = kBits - 1; bit >= 0; --bit) {
    for (const std::uint32_t axis : cell) index = (index << 1) | ((axis >> bit) & 1u);
  }
  return index;
}

}  // namespace ccst
