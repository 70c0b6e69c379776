#include "core/io/numbers.h"

#include <array>
#include <clocale>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace ccst::io {
namespace {

TEST(Numbers, DoublesRoundTrip) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 100000; ++i) {
    const std::uint64_t bits = random();
    double value;
    std::memcpy(&value, &bits, sizeof(value));
    if (std::isnan(value)) continue;
    std::string text;
    AppendDouble(text, value);
    const auto back = ParseDouble(text);
    ASSERT_TRUE(back.has_value()) << text;
    ASSERT_EQ(0, std::memcmp(&value, &*back, sizeof(value))) << text;
  }
}

TEST(Numbers, SpellingsOfDoubles) {
  EXPECT_EQ(ParseDouble("+1.5"), 1.5);
  EXPECT_EQ(ParseDouble("-.5"), -0.5);
  EXPECT_EQ(ParseDouble("5."), 5.0);
  EXPECT_EQ(ParseDouble("1e3"), 1000.0);
  EXPECT_EQ(ParseDouble("1E+03"), 1000.0);
  EXPECT_TRUE(std::isnan(*ParseDouble("nan")));
  EXPECT_TRUE(std::isnan(*ParseDouble("-NaN")));
  EXPECT_EQ(ParseDouble("+inf"), std::numeric_limits<double>::infinity());
  EXPECT_EQ(ParseDouble("1e999"), std::numeric_limits<double>::infinity());
  EXPECT_EQ(ParseDouble("1e-999"), 0.0);
}

TEST(Numbers, OtherTextIsNoDouble) {
  for (const char* text : {"", "+", "-", ".", "e5", "1.5x", "1,5", "0x10", "++1", "+-1", " 1"}) {
    EXPECT_FALSE(ParseDouble(text).has_value()) << text;
  }
}

TEST(Numbers, LocaleChangesNothing) {
  const std::string before = std::setlocale(LC_ALL, nullptr);
  // Where the locale is not installed the test still holds.
  std::setlocale(LC_ALL, "de_DE.UTF-8");
  std::string text;
  AppendDouble(text, 0.25);
  EXPECT_EQ(text, "0.25");
  EXPECT_EQ(ParseDouble("0.25"), 0.25);
  std::setlocale(LC_ALL, before.c_str());
}

TEST(Numbers, Integers) {
  EXPECT_EQ(ParseInteger("-17"), -17);
  EXPECT_EQ(ParseInteger("+17"), 17);
  EXPECT_EQ(ParseInteger("9223372036854775807"), std::numeric_limits<std::int64_t>::max());
  for (const char* text : {"", "9223372036854775808", "1.0", "1e3", "x", "+", "--1"}) {
    EXPECT_FALSE(ParseInteger(text).has_value()) << text;
  }
}

TEST(Numbers, BytesInEitherOrder) {
  std::string bytes;
  AppendLittleEndian(bytes, std::uint32_t{0x01020304});
  EXPECT_EQ(bytes, std::string("\x04\x03\x02\x01"));
  EXPECT_EQ(LoadBytes<std::uint32_t>(bytes.data(), std::endian::little), 0x01020304u);
  EXPECT_EQ(LoadBytes<std::uint32_t>(bytes.data(), std::endian::big), 0x04030201u);
}

TEST(Numbers, RoundingToFloatRoundsWhereverItIsInlined) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1e7, 1e7);
  std::vector<std::array<double, 3>> values(1000);
  for (auto& vector : values) {
    for (double& value : vector) value = uniform(random);
  }
  auto rounded = values;
  for (auto& vector : rounded) {
    for (double& value : vector) value = RoundedToFloat(value);
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      // Floats have 24 bits: the 29 others of a double are zero.
      std::uint64_t bits;
      std::memcpy(&bits, &rounded[i][k], sizeof(bits));
      EXPECT_EQ(bits & ((std::uint64_t{1} << 29) - 1), 0u);
      EXPECT_LE(std::abs(rounded[i][k] - values[i][k]), 0.5);
    }
  }
}

TEST(Numbers, QuotedTextIsShortAndPrintable) {
  EXPECT_EQ(Quoted("abc"), "'abc'");
  EXPECT_EQ(Quoted(std::string_view("a\0\xff", 3)), std::string("'a") + "?" + "?'");
  EXPECT_EQ(Quoted(std::string(100, 'x')).size(), 45u);
}

}  // namespace
}  // namespace ccst::io
