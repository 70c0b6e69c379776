#pragma once

#include <array>
#include <cstdint>

namespace ccst {

/// The 16 bits of `x`, each three places from the next.
inline std::uint64_t SpreadBits(std::uint64_t x) {
  x = (x | x << 16) & 0x0000ff0000ffu;
  x = (x | x << 8) & 0x00f00f00f00fu;
  x = (x | x << 4) & 0x0c30c30c30c3u;
  return (x | x << 2) & 0x249249249249u;
}

/// Position of a cell along the three-dimensional Hilbert curve of order 16.
/// @param cell  coordinates, each in [0, 2^16).
/// @return      index in [0, 2^48); neighbours on the curve are neighbours in space.
/// Source: Skilling, "Programming the Hilbert curve", AIP Conf. Proc. 707, 2004; without branches,
/// of which no processor could foretell one.
inline std::uint64_t HilbertIndex(std::array<std::uint32_t, 3> cell) {
  constexpr int kBits = 16;
  for (int bit = kBits - 1; bit > 0; --bit) {
    const std::uint32_t low = (1u << bit) - 1;
    const auto if_set = [&](std::uint32_t axis) { return 0u - ((axis >> bit) & 1u); };
    cell[0] ^= low & if_set(cell[0]);
    for (int k = 1; k < 3; ++k) {
      const std::uint32_t set = if_set(cell[k]);
      const std::uint32_t swap = (cell[0] ^ cell[k]) & low & ~set;
      cell[0] ^= swap | (low & set);
      cell[k] ^= swap;
    }
  }
  cell[1] ^= cell[0];
  cell[2] ^= cell[1];
  // Every bit turns those below it.
  std::uint32_t fix = cell[2] >> 1;
  for (int shift = 1; shift < kBits; shift *= 2) fix ^= fix >> shift;
  return SpreadBits(cell[0] ^ fix) << 2 | SpreadBits(cell[1] ^ fix) << 1 |
         SpreadBits(cell[2] ^ fix);
}

}  // namespace ccst
