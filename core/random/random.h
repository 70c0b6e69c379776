#pragma once

#include <cstdint>

namespace ccst {

/// Counter-based random numbers: the value at (seed, stream, index) is a pure function, so draws
/// do not depend on the order or the thread in which they are made. The standard library's
/// distributions differ between implementations; these do not.
/// Source: the finaliser of SplitMix64 (Steele, Lea, Flood, OOPSLA 2014) over a Weyl sequence.
class CounterRandom {
 public:
  constexpr CounterRandom(std::uint64_t seed, std::uint64_t stream)
      : key_(Mix(seed + 0x9e3779b97f4a7c15u) ^ Mix(stream * 0xd1342543de82ef95u + 1)) {}

  /// 64 uniform bits.
  constexpr std::uint64_t Bits(std::uint64_t index) const {
    return Mix(key_ + (index + 1) * 0x9e3779b97f4a7c15u);
  }

  /// Uniform in [0, 1), a multiple of 2^-53.
  constexpr double Uniform(std::uint64_t index) const {
    return static_cast<double>(Bits(index) >> 11) * 0x1.0p-53;
  }

 private:
  static constexpr std::uint64_t Mix(std::uint64_t x) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
  }

  std::uint64_t key_;
};

}  // namespace ccst
