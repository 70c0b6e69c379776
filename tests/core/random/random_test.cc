#include "core/random/random.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <set>
#include <vector>

#include <gtest/gtest.h>

namespace ccst {
namespace {

constexpr int kDraws = 1 << 16;

// Chi-square of counts that should be equal.
double ChiSquare(const std::vector<int>& counts) {
  double total = 0.0;
  for (const int count : counts) total += count;
  const double expected = total / static_cast<double>(counts.size());
  double sum = 0.0;
  for (const int count : counts) sum += (count - expected) * (count - expected) / expected;
  return sum;
}

// Five standard deviations of the chi-square distribution about its mean.
void ExpectPlausible(double chi_square, int freedom) {
  const double width = 5.0 * std::sqrt(2.0 * freedom);
  EXPECT_NEAR(chi_square, freedom, width);
}

TEST(CounterRandom, UniformFillsEqualBins) {
  constexpr int kBins = 256;
  for (const std::uint64_t seed : {0u, 1u, 2u, 12345u}) {
    const CounterRandom random(seed, 7);
    std::vector<int> counts(kBins, 0);
    for (int i = 0; i < kDraws; ++i) {
      const double x = random.Uniform(i);
      ASSERT_GE(x, 0.0);
      ASSERT_LT(x, 1.0);
      ++counts[static_cast<int>(x * kBins)];
    }
    ExpectPlausible(ChiSquare(counts), kBins - 1);
  }
}

TEST(CounterRandom, EveryBitIsSetHalfTheTime) {
  const CounterRandom random(3, 1);
  std::vector<int> ones(64, 0);
  for (int i = 0; i < kDraws; ++i) {
    const std::uint64_t bits = random.Bits(i);
    for (int bit = 0; bit < 64; ++bit) ones[bit] += static_cast<int>((bits >> bit) & 1u);
  }
  for (const int count : ones) EXPECT_NEAR(count, kDraws / 2, 5 * std::sqrt(kDraws) / 2);
}

// Pairs (x, y) drawn in several ways fill a 16 x 16 grid evenly: consecutive draws, equal indices
// of neighbouring streams, equal indices of neighbouring seeds.
TEST(CounterRandom, NeighbouringDrawsStreamsAndSeedsAreIndependent) {
  constexpr int kSide = 16;
  const CounterRandom base(5, 11);
  const CounterRandom next_stream(5, 12);
  const CounterRandom next_seed(6, 11);
  const CounterRandom swapped(11, 5);
  std::vector<std::vector<int>> counts(4, std::vector<int>(kSide * kSide, 0));
  const auto cell = [](double x, double y) {
    return static_cast<int>(x * kSide) * kSide + static_cast<int>(y * kSide);
  };
  for (int i = 0; i < kDraws; ++i) {
    const double x = base.Uniform(i);
    ++counts[0][cell(x, base.Uniform(i + 1))];
    ++counts[1][cell(x, next_stream.Uniform(i))];
    ++counts[2][cell(x, next_seed.Uniform(i))];
    ++counts[3][cell(x, swapped.Uniform(i))];
  }
  for (const std::vector<int>& grid : counts) ExpectPlausible(ChiSquare(grid), kSide * kSide - 1);
}

TEST(CounterRandom, OneBitOfTheCounterTurnsHalfTheBits) {
  const CounterRandom random(0, 0);
  double turned = 0.0;
  constexpr int kTrials = 4096;
  for (int i = 0; i < kTrials; ++i) {
    const std::uint64_t flipped = static_cast<std::uint64_t>(i) ^ (1u << (i % 20));
    turned += std::popcount(random.Bits(i) ^ random.Bits(flipped));
  }
  EXPECT_NEAR(turned / kTrials, 32.0, 5 * 4.0 / std::sqrt(kTrials));
}

TEST(CounterRandom, StreamsDoNotShareValues) {
  std::set<std::uint64_t> seen;
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    for (std::uint64_t stream = 0; stream < 8; ++stream) {
      for (std::uint64_t i = 0; i < 64; ++i) seen.insert(CounterRandom(seed, stream).Bits(i));
    }
  }
  EXPECT_EQ(seen.size(), 8u * 8u * 64u);
}

TEST(CounterRandom, DrawsDoNotDependOnTheirOrder) {
  const CounterRandom forward(9, 9);
  const CounterRandom backward(9, 9);
  std::vector<std::uint64_t> bits;
  for (int i = 0; i < 100; ++i) bits.push_back(forward.Bits(i));
  for (int i = 99; i >= 0; --i) EXPECT_EQ(backward.Bits(i), bits[i]);
}

TEST(CounterRandom, ExtremeArgumentsAreFine) {
  constexpr std::uint64_t kLargest = ~std::uint64_t{0};
  EXPECT_NE(CounterRandom(kLargest, kLargest).Bits(kLargest),
            CounterRandom(kLargest, kLargest).Bits(0));
  EXPECT_LT(CounterRandom(kLargest, 0).Uniform(kLargest), 1.0);
}

// Samples of past results depend on these bits: they must never change.
TEST(CounterRandom, BitsAreTheGoldenOnes) {
  static_assert(CounterRandom(0, 0).Bits(0) == 0x346dbc0b5711d830u);
  EXPECT_EQ(CounterRandom(0, 0).Bits(1), 0x6b182a52253dda4au);
  EXPECT_EQ(CounterRandom(1, 0).Bits(0), 0x17daf0019666393u);
  EXPECT_EQ(CounterRandom(0, 1).Bits(0), 0xd68f940882e6e04bu);
  EXPECT_EQ(CounterRandom(0x123456789abcdef0u, 0x706f696e74u).Bits(1'000'000'007u),
            0x24245325b5dfb9cbu);
  EXPECT_EQ(CounterRandom(0, 0).Uniform(0),
            static_cast<double>(0x346dbc0b5711d830u >> 11) / 9007199254740992.0);
}

}  // namespace
}  // namespace ccst
