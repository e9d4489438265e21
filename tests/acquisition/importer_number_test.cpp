// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/number.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdlib>
#include <random>

namespace impactrig::acquisition {
namespace {

// strtod of the C library rounds correctly: an independent method.
TEST(Number, IsTheNearestDoubleHoweverManyDigitsItHas) {
  const unsigned seed = 20240611;
  std::mt19937_64 random(seed);
  for (int i = 0; i < 20000; ++i) {
    const double value = std::bit_cast<double>(random());
    if (!std::isfinite(value)) continue;
    const int digits = static_cast<int>(random() % 20);
    for (const std::string& text :
         {fmt::format("{:.{}e}", value, digits), fmt::format("{}", value)}) {
      const double nearest = std::strtod(text.c_str(), nullptr);
      const auto read = number_in(text);
      if (std::isinf(nearest)) {
        EXPECT_FALSE(read.has_value()) << text;
      } else {
        ASSERT_TRUE(read.has_value()) << text << ", seed " << seed;
        EXPECT_EQ(std::bit_cast<std::uint64_t>(*read), std::bit_cast<std::uint64_t>(nearest))
            << text;
      }
    }
  }
}

TEST(Number, OfFewDigitsIsTheNearestDoubleToo) {
  std::mt19937_64 random(7);
  for (int i = 0; i < 20000; ++i) {
    const std::string text = fmt::format("{}.{:0{}}e{}", random() % 1000000, random() % 1000,
                                         3 + random() % 6, static_cast<int>(random() % 50) - 25);
    EXPECT_EQ(number_in(text), std::strtod(text.c_str(), nullptr)) << text;
  }
}

TEST(Number, MayBeSpelledAsInstrumentsDo) {
  EXPECT_EQ(number_in("  +1.5 \t"), 1.5);
  EXPECT_EQ(number_in(".5"), 0.5);
  EXPECT_EQ(number_in("5."), 5.0);
  EXPECT_EQ(number_in("1.5E+003"), 1500.0);
  EXPECT_EQ(number_in("1.00000000000000000D+00"), 1.0);
  EXPECT_EQ(number_in("2.5d-3"), 0.0025);
  EXPECT_EQ(number_in("1,25e2", {',', false}), 125.0);
  EXPECT_EQ(number_in("0,12345678901234567890", {',', false}), 0.12345678901234567890);
  EXPECT_EQ(number_in("1.25-100", {'.', true}), 1.25e-100);
  EXPECT_EQ(number_in("-1.25+10", {'.', true}), -1.25e10);
  EXPECT_TRUE(std::signbit(number_in("-0").value_or(1.0)));
}

TEST(Number, BelowTheSmallestIsZero) {
  EXPECT_EQ(number_in("1e-400"), 0.0);
  EXPECT_EQ(number_in("4.9e-324"), 4.9e-324);
  EXPECT_EQ(number_in("0e999999999999"), 0.0);
}

TEST(Number, IsNothingElse) {
  for (const char* text : {"", " ", "+", "-", ".", "e5", "1e", "1e+", "1.5.2", "1 2", "0x10", "nan",
                           "inf", "1,5", "1e400", "--1", "12-05", "1.5+3"})
    EXPECT_FALSE(number_in(text).has_value()) << text;
  EXPECT_FALSE(number_in("5,", {',', false}).has_value());
  EXPECT_FALSE(number_in("1.5", {',', false}).has_value());
}

TEST(DecimalDifference, LosesNothingThatIsWritten) {
  EXPECT_EQ(decimal_difference("1709290000.0000005", "1709290000.000000"), 5e-7);
  EXPECT_EQ(decimal_difference("1709290000000000100", "1709290000000000000"), 100.0);
  EXPECT_EQ(decimal_difference("1.70929e9", " +1709289999.5 "), 0.5);
  EXPECT_EQ(decimal_difference("-3,25", "4,5", {',', false}), -7.75);
  EXPECT_EQ(decimal_difference("1e3", "1e-3"), 999.999);
  EXPECT_EQ(decimal_difference("-9223372036854775807", "-9223372036854775807"), 0.0);
}

TEST(DecimalDifference, IsNoneOfWhatItCannotHold) {
  for (const char* text : {"", "x", "1.5x", "1.2.3", "99999999999999999999", "1e30", "1e-30"})
    EXPECT_FALSE(decimal_difference(text, "1")) << text;
  EXPECT_FALSE(decimal_difference("1", "1e22"));
  EXPECT_FALSE(decimal_difference("9223372036854775807", "-1"));
}

TEST(Integer, MayHaveASignAndBlanks) {
  EXPECT_EQ(integer_in("   -12 "), -12);
  EXPECT_EQ(integer_in("+7"), 7);
  for (const char* text : {"", "+", "+-7", "1.5", "99999999999999999999", "a"})
    EXPECT_FALSE(integer_in(text).has_value()) << text;
}

}  // namespace
}  // namespace impactrig::acquisition
