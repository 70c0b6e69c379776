#include "core/base/portable_math.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

#include "core/base/assert.h"

namespace ccst {
namespace {

// A constant as the nearest double and what is left of it.
struct Constant {
  double high;
  double low;
};

constexpr Constant kHalfPi = {0x1.921fb54442d18p+0, 0x1.1a62633145c07p-54};
constexpr Constant kLn2 = {0x1.62e42fefa39efp-1, 0x1.abc9e3b39803fp-56};
constexpr Constant kLog2E = {0x1.71547652b82fep+0, 0x1.777d0ffda0d24p-56};
constexpr double kSqrtHalf = 0x1.6a09e667f3bcdp-1;

// atan(k / 8).
constexpr std::array<Constant, 9> kArcs = {{{0.0, 0.0},
                                            {0x1.fd5ba9aac2f6ep-4, -0x1.cd37686760c17p-59},
                                            {0x1.f5b75f92c80ddp-3, 0x1.8ab6e3cf7afbdp-57},
                                            {0x1.6f61941e4def1p-2, -0x1.c63aae6f6e918p-56},
                                            {0x1.dac670561bb4fp-2, 0x1.a2b7f222f65e2p-56},
                                            {0x1.1e00babdefeb4p-1, -0x1.928df287a668fp-58},
                                            {0x1.4978fa3269ee1p-1, 0x1.2419a87f2a458p-56},
                                            {0x1.700a7c5784634p-1, -0x1.8c34d25aadef6p-56},
                                            {0x1.921fb54442d18p-1, 0x1.1a62633145c07p-55}}};

// c[0] + c[1] x + c[2] x^2 + ...
template <std::size_t kSize>
double Polynomial(const std::array<double, kSize>& c, double x) {
  double sum = c[kSize - 1];
  for (std::size_t i = kSize - 1; i-- > 0;) sum = sum * x + c[i];
  return sum;
}

// For t in [0, 1]: atan(t) = atan(c) + atan((t - c) / (1 + t c)) with c = k / 8 next to t.
double Arc(double t) {
  constexpr std::array<double, 8> kSeries = {-1.0 / 3,  1.0 / 5,  -1.0 / 7,  1.0 / 9,
                                             -1.0 / 11, 1.0 / 13, -1.0 / 15, 1.0 / 17};
  const auto k = static_cast<std::size_t>(std::floor(t * 8.0 + 0.5));
  const double c = static_cast<double>(k) / 8.0;
  const double r = (t - c) / (1.0 + t * c);
  const double square = r * r;
  const double rest = r + r * square * Polynomial(kSeries, square);
  return kArcs[k].high + (kArcs[k].low + rest);
}

// An angle less its multiple of pi / 2, in about [-pi / 4, pi / 4], and the multiple modulo 4.
std::pair<double, int> Reduce(double angle) {
  // pi / 2 in pieces whose multiples are exact for angles up to kExact.
  constexpr double kFirst = 0x1.921fb544p+0;
  constexpr double kSecond = 0x1.0b4611a6p-34;
  constexpr double kThird = 0x1.3198a2e037073p-69;
  constexpr double kExact = 1e5;
  if (std::abs(angle) > kExact) angle = std::remainder(angle, 4.0 * kHalfPi.high);
  const double multiple = std::floor(angle / kHalfPi.high + 0.5);
  const double rest = ((angle - multiple * kFirst) - multiple * kSecond) - multiple * kThird;
  return {rest, static_cast<int>(static_cast<std::int64_t>(multiple) & 3)};
}

double SineSeries(double x) {
  constexpr std::array<double, 8> kSeries = {-1.0 / 6,
                                             1.0 / 120,
                                             -1.0 / 5040,
                                             1.0 / 362880,
                                             -1.0 / 39916800,
                                             1.0 / 6227020800.0,
                                             -1.0 / 1307674368000.0,
                                             1.0 / 355687428096000.0};
  const double square = x * x;
  return x + x * square * Polynomial(kSeries, square);
}

double CosineSeries(double x) {
  constexpr std::array<double, 8> kSeries = {1.0 / 24,
                                             -1.0 / 720,
                                             1.0 / 40320,
                                             -1.0 / 3628800,
                                             1.0 / 479001600.0,
                                             -1.0 / 87178291200.0,
                                             1.0 / 20922789888000.0,
                                             -1.0 / 6402373705728000.0};
  const double square = x * x;
  return 1.0 - (0.5 * square - square * square * Polynomial(kSeries, square));
}

// The sine `turns` quarters of a turn on.
double SineAt(double angle, int turns) {
  if (!std::isfinite(angle)) return std::numeric_limits<double>::quiet_NaN();
  const auto [rest, quarter] = Reduce(angle);
  const int place = (quarter + turns) & 3;
  const double value = place % 2 == 0 ? SineSeries(rest) : CosineSeries(rest);
  return place < 2 ? value : -value;
}

}  // namespace

double PortableAtan2(double y, double x) {
  if (std::isnan(x) || std::isnan(y)) return std::numeric_limits<double>::quiet_NaN();
  const double across = std::abs(x);
  const double up = std::abs(y);
  double angle = 0.0;  // In the first quadrant.
  if (up > across) {
    angle = kHalfPi.high - (Arc(std::isinf(up) ? 0.0 : across / up) - kHalfPi.low);
  } else if (across > 0.0) {
    angle = Arc(up == across ? 1.0 : up / across);
  }
  if (std::signbit(x)) angle = 2.0 * kHalfPi.high - (angle - 2.0 * kHalfPi.low);
  return std::copysign(angle, y);
}

double PortableSin(double angle) { return SineAt(angle, 0); }

double PortableCos(double angle) { return SineAt(angle, 1); }

double PortableExp2(double x) {
  constexpr std::array<double, 13> kSeries = {1.0 / 2,
                                              1.0 / 6,
                                              1.0 / 24,
                                              1.0 / 120,
                                              1.0 / 720,
                                              1.0 / 5040,
                                              1.0 / 40320,
                                              1.0 / 362880,
                                              1.0 / 3628800,
                                              1.0 / 39916800,
                                              1.0 / 479001600,
                                              1.0 / 6227020800.0,
                                              1.0 / 87178291200.0};
  if (std::isnan(x)) return x;
  if (x > 1024.0) return std::numeric_limits<double>::infinity();
  if (x < -1075.0) return 0.0;
  const double whole = std::floor(x + 0.5);
  const double part = x - whole;
  const double t = part * kLn2.high + part * kLn2.low;
  return std::ldexp(1.0 + (t + t * t * Polynomial(kSeries, t)), static_cast<int>(whole));
}

double PortableLog2(double x) {
  constexpr std::array<double, 11> kSeries = {2.0 / 3,  2.0 / 5,  2.0 / 7,  2.0 / 9,
                                              2.0 / 11, 2.0 / 13, 2.0 / 15, 2.0 / 17,
                                              2.0 / 19, 2.0 / 21, 2.0 / 23};
  if (std::isinf(x)) return x;
  int exponent = 0;
  double mantissa = std::frexp(x, &exponent);
  if (mantissa < kSqrtHalf) {
    mantissa *= 2.0;
    --exponent;
  }
  // ln(m) = 2 atanh((m - 1) / (m + 1)).
  const double off = mantissa - 1.0;
  const double s = off / (2.0 + off);
  const double square = s * s;
  const double log = 2.0 * s + s * square * Polynomial(kSeries, square);
  return exponent + (log * kLog2E.high + log * kLog2E.low);
}

double PortablePow(double x, double y) {
  CCST_ASSERT(!(x < 0.0));
  if (y == 0.0) return 1.0;
  if (y == 1.0) return x;
  if (y == 2.0) return x * x;
  if (y == 0.5) return std::sqrt(x);
  if (x == 0.0) return y > 0.0 ? 0.0 : std::numeric_limits<double>::infinity();
  if (std::isnan(x)) return x;
  return PortableExp2(y * PortableLog2(x));
}

double PortableHypot(double x, double y) {
  const double longer = std::max(std::abs(x), std::abs(y));
  const double shorter = std::min(std::abs(x), std::abs(y));
  if (longer == 0.0 || std::isinf(longer)) return longer;
  const double ratio = shorter / longer;
  return longer * std::sqrt(1.0 + ratio * ratio);
}

int CeilLog2(double x) {
  CCST_ASSERT(x > 0.0 && std::isfinite(x));
  int exponent = 0;
  return std::frexp(x, &exponent) == 0.5 ? exponent - 1 : exponent;
}

}  // namespace ccst
