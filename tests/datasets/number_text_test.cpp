// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/number_text.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace impactrig::datasets {
namespace {

TEST(NumberText, HasNoExponentWhereASentenceNeedsNone) {
  EXPECT_EQ(figures(1499.0, 2), "1500");
  EXPECT_EQ(figures(-1234.0, 3), "-1230");
  EXPECT_EQ(figures(99.7, 2), "100");
  EXPECT_EQ(figures(999400.0, 3), "999000");
  EXPECT_EQ(figures(999700.0, 3), "1e+06");
  EXPECT_EQ(figures(12.34, 3), "12.3");
  EXPECT_EQ(figures(0.0, 2), "0");
  EXPECT_EQ(figures(1.23e-4, 2), "0.00012");
  EXPECT_EQ(figures(1.23e-7, 2), "1.2e-07");
  EXPECT_EQ(figures(5e-324, 2), "4.9e-324");
  EXPECT_EQ(figures(INFINITY, 2), "inf");
  EXPECT_EQ(figures(NAN, 2), "nan");
}

TEST(NumberText, GivesPercent) {
  EXPECT_EQ(percent(0.999), "100 %");
  EXPECT_EQ(percent(1.0), "100 %");
  EXPECT_EQ(percent(0.123), "12 %");
  EXPECT_EQ(percent(0.00344), "0.34 %");
  EXPECT_EQ(percent(37.7), "3800 %");
}

}  // namespace
}  // namespace impactrig::datasets
