// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/metrics/cora.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "tests/fitting/metrics/check_signals.hpp"

namespace impactrig::fitting {
namespace {

using tests::CheckPair;
using tests::sampled;

double copy(double t) {
  return tests::pulse(t, 100.0, 0.3995, 0.2);
}

// A copy 1.25 times as high and 5 % of the window late: K = 1, F = 1.25², P on its straight line.
TEST(Cora, OfAScaledLateCopyHasAClosedForm) {
  const CheckPair signals =
      sampled(1000, 0.001, copy, [](double t) { return 1.25 * copy(t - 0.05); });
  const Cora found = cora(signals.pair());
  EXPECT_EQ(found.shift, 50);
  EXPECT_NEAR(found.progression, 1.0, 1e-12);
  EXPECT_NEAR(found.phase, (0.12 - 0.05) / 0.11, 1e-12);
  EXPECT_NEAR(found.size, 1.0 / (1.25 * 1.25), 1e-12);
  EXPECT_NEAR(found.cross_correlation, 0.5 + 0.25 * (found.phase + found.size), 1e-12);
  EXPECT_NEAR(found.rating, 0.5 * (found.corridor + found.cross_correlation), 1e-15);
}

TEST(Cora, DoesNotCountAHundredthOfTheWindow) {
  const CheckPair signals = sampled(1000, 0.001, copy, [](double t) { return copy(t + 0.01); });
  EXPECT_EQ(cora(signals.pair()).shift, -10);
  EXPECT_DOUBLE_EQ(cora(signals.pair()).phase, 1.0);
}

// K = 0.5 of m = (1, 0), c = (1/2, √3/2) leaves (3/4)^10.
TEST(Cora, ProgressionIsTheTenthPower) {
  const std::vector<double> m = {1.0, 0.0}, c = {0.5, std::sqrt(0.75)};
  EXPECT_NEAR(cora({m, c}).progression, std::pow(0.75, 10), 1e-15);
  EXPECT_NEAR(cora({m, c}).size, 1.0, 1e-15);
}

TEST(Cora, IsNotDefinedForSilence) {
  const std::vector<double> zero = {0.0, 0.0}, one = {1.0, 1.0};
  EXPECT_TRUE(std::isnan(cora({zero, one}).rating));
  const Cora silent = cora({one, zero});
  EXPECT_EQ(silent.size, 0.0);
  EXPECT_DOUBLE_EQ(silent.progression, std::pow(0.5, 10));
}

}  // namespace
}  // namespace impactrig::fitting
