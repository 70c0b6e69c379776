// Against the C library in extended precision, and at the values that IEEE 754 names.
#include "core/base/portable_math.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "core/random/random.h"

namespace ccst {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kDraws = 200'000;

// Numbers of both signs and of sizes from 2^-40 to 2^40.
class Draws {
 public:
  double Sign() { return 2.0 * random_.Uniform(next_++) - 1.0; }
  double Any() {
    const double size = 40.0 * Sign();
    return std::ldexp(Sign(), static_cast<int>(size));
  }

 private:
  CounterRandom random_{1, 2};
  std::uint64_t next_ = 0;
};

// Distance of `value` to `exact` in units of the last place.
double Ulps(double value, long double exact) {
  const double size = std::abs(static_cast<double>(exact));
  const double unit = std::nextafter(size, kInfinity) - size;
  return static_cast<double>(std::abs(static_cast<long double>(value) - exact) / unit);
}

TEST(PortableAtan2, IsWithinThreeUnitsInTheLastPlace) {
  Draws draws;
  double worst = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const double y = draws.Any();
    const double x = draws.Any();
    worst = std::max(worst, Ulps(PortableAtan2(y, x), std::atan2(static_cast<long double>(y), x)));
  }
  EXPECT_LE(worst, 3.0);
}

TEST(PortableAtan2, KnowsZerosAndInfinities) {
  for (const double y : {0.0, -0.0, 1.0, -1.0, kInfinity, -kInfinity}) {
    for (const double x : {0.0, -0.0, 1.0, -1.0, kInfinity, -kInfinity}) {
      const double angle = PortableAtan2(y, x);
      EXPECT_DOUBLE_EQ(angle, std::atan2(y, x)) << y << " " << x;
      EXPECT_EQ(std::signbit(angle), std::signbit(y)) << y << " " << x;
    }
  }
  EXPECT_TRUE(std::isnan(PortableAtan2(std::nan(""), 1.0)));
}

TEST(PortableSin, IsWithinTwiceTheRounding) {
  Draws draws;
  double worst = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const double angle = draws.Sign() * (i % 2 == 0 ? 4.0 : 1e5);
    const auto exact = static_cast<long double>(angle);
    worst = std::max(worst, static_cast<double>(std::abs(PortableSin(angle) - std::sin(exact))));
    worst = std::max(worst, static_cast<double>(std::abs(PortableCos(angle) - std::cos(exact))));
  }
  EXPECT_LE(worst, 2e-16);
}

TEST(PortableSin, StaysASineFarAway) {
  for (const double angle : {1e6, -3e9, 1e300}) {
    const double sine = PortableSin(angle);
    const double cosine = PortableCos(angle);
    EXPECT_NEAR(sine * sine + cosine * cosine, 1.0, 1e-15) << angle;
  }
  EXPECT_TRUE(std::isnan(PortableSin(kInfinity)));
  EXPECT_TRUE(std::isnan(PortableCos(std::nan(""))));
}

TEST(PortableExp2, IsWithinTwoUnitsInTheLastPlace) {
  Draws draws;
  double worst = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const double x = 1000.0 * draws.Sign();
    worst = std::max(worst, Ulps(PortableExp2(x), std::exp2(static_cast<long double>(x))));
  }
  EXPECT_LE(worst, 2.0);
}

TEST(PortableExp2, PowersOfTwoAreExact) {
  for (int k = -1074; k <= 1023; ++k) EXPECT_EQ(PortableExp2(k), std::ldexp(1.0, k)) << k;
  EXPECT_EQ(PortableExp2(1025.0), kInfinity);
  EXPECT_EQ(PortableExp2(-kInfinity), 0.0);
  EXPECT_TRUE(std::isnan(PortableExp2(std::nan(""))));
}

TEST(PortableLog2, IsWithinItsBound) {
  Draws draws;
  double worst = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const double x = i % 2 == 0 ? std::abs(draws.Any()) + 1e-300 : 1.0 + 0.3 * draws.Sign();
    const long double exact = std::log2(static_cast<long double>(x));
    worst = std::max(worst, static_cast<double>(std::abs(PortableLog2(x) - exact) /
                                                std::max(1.0L, std::abs(exact))));
  }
  EXPECT_LE(worst, 4e-16);
  for (int k = -1074; k <= 1023; ++k) EXPECT_EQ(PortableLog2(std::ldexp(1.0, k)), k);
}

TEST(PortablePow, IsWithinItsBound) {
  Draws draws;
  double worst = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const double x = std::abs(draws.Any()) + 1e-300;
    const double y = 4.0 * draws.Sign();
    const long double exact = std::pow(static_cast<long double>(x), y);
    if (!(exact > 1e-300L && exact < 1e300L)) continue;
    const long double bound = 1.0L + std::abs(y * std::log2(static_cast<long double>(x)));
    worst = std::max(worst, static_cast<double>(std::abs(PortablePow(x, y) / exact - 1) / bound));
  }
  EXPECT_LE(worst, 4e-16);
}

TEST(PortablePow, EasyExponentsAreExact) {
  for (const double x : {0.0, 0.1, 1.0, 7.3, 1e200, kInfinity}) {
    EXPECT_EQ(PortablePow(x, 0.0), 1.0);
    EXPECT_EQ(PortablePow(x, 1.0), x);
    EXPECT_EQ(PortablePow(x, 2.0), x * x);
    EXPECT_EQ(PortablePow(x, 0.5), std::sqrt(x));
  }
  EXPECT_EQ(PortablePow(0.0, 0.7), 0.0);
  EXPECT_EQ(PortablePow(0.0, -0.7), kInfinity);
}

TEST(PortableHypot, IsWithinTwoUnitsInTheLastPlaceAndDoesNotOverflow) {
  Draws draws;
  double worst = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const double x = draws.Any();
    const double y = draws.Any();
    worst = std::max(worst, Ulps(PortableHypot(x, y), std::hypot(static_cast<long double>(x), y)));
  }
  EXPECT_LE(worst, 2.0);
  EXPECT_DOUBLE_EQ(PortableHypot(3e300, 4e300), 5e300);
  EXPECT_EQ(PortableHypot(0.0, -0.0), 0.0);
}

TEST(CeilLog2, IsExact) {
  for (int k = -1074; k <= 1023; ++k) {
    const double power = std::ldexp(1.0, k);
    EXPECT_EQ(CeilLog2(power), k);
    if (k < -1022) continue;
    EXPECT_EQ(CeilLog2(std::nextafter(power, kInfinity)), k + 1);
  }
}

}  // namespace
}  // namespace ccst
