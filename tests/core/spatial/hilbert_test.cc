#include "core/spatial/hilbert.h"

#include <array>
#include <cstdint>
#include <cstdlib>
#include <map>

#include <gtest/gtest.h>

namespace ccst {
namespace {

using Cell = std::array<std::uint32_t, 3>;

// The curve through the 16 x 16 x 16 blocks in the given corner of the grid, by index.
std::map<std::uint64_t, Cell> CurveThrough(const Cell& first, std::uint32_t step) {
  std::map<std::uint64_t, Cell> curve;
  for (std::uint32_t x = 0; x < 16; ++x) {
    for (std::uint32_t y = 0; y < 16; ++y) {
      for (std::uint32_t z = 0; z < 16; ++z) {
        const Cell cell = {first[0] + x * step, first[1] + y * step, first[2] + z * step};
        curve[HilbertIndex(cell)] = cell;
      }
    }
  }
  return curve;
}

std::uint32_t Distance(const Cell& a, const Cell& b) {
  std::uint32_t sum = 0;
  for (int k = 0; k < 3; ++k) sum += a[k] > b[k] ? a[k] - b[k] : b[k] - a[k];
  return sum;
}

TEST(HilbertIndex, IsABijectionOnABlockOfCells) {
  // A block of 2^4 cells a side, aligned to its size, is one unbroken piece of the curve.
  for (const Cell& first : {Cell{0, 0, 0}, Cell{16, 32, 48}, Cell{65520, 65520, 65520}}) {
    const auto curve = CurveThrough(first, 1);
    ASSERT_EQ(curve.size(), 4096u);
    EXPECT_EQ(curve.rbegin()->first - curve.begin()->first, 4095u);
    EXPECT_EQ(curve.begin()->first % 4096u, 0u);
  }
}

TEST(HilbertIndex, ConsecutiveIndicesAreFaceNeighbours) {
  for (const Cell& first : {Cell{0, 0, 0}, Cell{4080, 160, 65520}}) {
    const auto curve = CurveThrough(first, 1);
    for (auto here = curve.begin(), next = std::next(here); next != curve.end(); ++here, ++next) {
      ASSERT_EQ(Distance(here->second, next->second), 1u) << here->first;
    }
  }
}

TEST(HilbertIndex, CoarseCellsFollowTheCurveToo) {
  // The same property for the curve of order 4, whose cells are 4096 wide.
  const auto curve = CurveThrough({0, 0, 0}, 4096);
  ASSERT_EQ(curve.size(), 4096u);
  std::uint64_t expected = 0;
  const Cell* last = nullptr;
  for (const auto& [index, cell] : curve) {
    EXPECT_EQ(index >> 36, expected++);
    if (last != nullptr) {
      ASSERT_EQ(Distance(*last, cell), 4096u);
    }
    last = &cell;
  }
}

TEST(HilbertIndex, StaysBelowTwoToThe48) {
  for (std::uint32_t x : {0u, 65535u}) {
    for (std::uint32_t y : {0u, 65535u}) {
      for (std::uint32_t z : {0u, 65535u}) {
        EXPECT_LT(HilbertIndex({x, y, z}), std::uint64_t{1} << 48);
      }
    }
  }
}

}  // namespace
}  // namespace ccst
