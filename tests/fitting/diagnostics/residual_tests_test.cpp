// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/diagnostics/residual_tests.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/fitting/diagnostics/noise.hpp"

namespace impactrig::fitting {
namespace {

using tests::gaussian_noise;

NoiseColour unit_noise(std::size_t samples) {
  NoiseColour noise;
  noise.deviation = noise.innovation = 1.0;
  noise.samples = samples;
  return noise;
}

// F(2, ν) has the survival function (1 + 2 F / ν)^{−ν/2}; here ν = 103 − 3, F = 5.
TEST(LevelTest, IsSnedecorsF) {
  EXPECT_NEAR(level_p_value(2.0 * 5.0, 2, unit_noise(103)), std::pow(1.1, -50.0), 1e-12);
  EXPECT_GT(level_p_value(100.0, 100, unit_noise(1000)), 0.4);
}

// Heavy tails before touch make large sums of squares common: kurtosis 9 leaves a quarter of the
// degrees of freedom.
TEST(LevelTest, ForgivesHeavyTailsSeenBefore) {
  NoiseColour heavy = unit_noise(403);
  heavy.kurtosis = 9.0;
  EXPECT_NEAR(level_p_value(8.0 * 5.0, 8, heavy), std::pow(1.1, -50.0), 1e-12);
}

// p-values of right models are uniform: 400 of them, below 0.1 with count 40 ± 6, four deviations.
TEST(WhitenessTest, HoldsItsLevelOnColouredNoise) {
  int rejected = 0;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    const std::vector<double> x = gaussian_noise(2500, 10 + seed, 0.7);
    const std::span<const double> all(x);
    const NoiseColour colour = noise_colour(all.first(1000));
    const std::vector<double> w = whitened(x, colour);
    const std::span<const double> white(w);
    if (whiteness(white.first(1000), white.subspan(1000)).p_value < 0.1) ++rejected;
  }
  EXPECT_GE(rejected, 16);
  EXPECT_LE(rejected, 64);
}

TEST(WhitenessTest, SeesAMemoryThatWasNotThereBefore) {
  // lag 1 alone: Q = 0.3² / (1/1499 + 1/999) = 54; chi-squared of 20 + 54 with 20 degrees: 4e-8
  const Whiteness found = whiteness(gaussian_noise(1000, 1), gaussian_noise(1500, 2, 0.3));
  EXPECT_LT(found.p_value, 1e-4);
  EXPECT_NEAR(found.lag1, 0.3, 0.1);  // ± 4 √((1 − φ²) / n)
  EXPECT_NEAR(found.band, 1.96 * std::sqrt(1.0 / 1000.0 + 1.0 / 1500.0), 1e-12);
}

// Stephens: A² (1 + 0.75 / n + 2.25 / n²) above 0.752 at 5 % of normal samples. 1000 of them:
// 50 ± 7, four deviations.
TEST(NormalityTest, HoldsItsLevel) {
  int rejected = 0;
  for (std::uint64_t seed = 0; seed < 1000; ++seed)
    rejected += normality(gaussian_noise(200, 5000 + seed), 0.0).p_value < 0.05 ? 1 : 0;
  EXPECT_GE(rejected, 22);
  EXPECT_LE(rejected, 78);
}

TEST(NormalityTest, SaysWhatIsNotNormal) {
  std::vector<double> x = gaussian_noise(1000, 7);
  EXPECT_EQ(normality(x, 0.0).words, "normal");
  std::vector<double> cubed = x, squared = x, sine = x;
  for (double& value : cubed) value *= value * value;
  for (double& value : squared) value = value * value;
  for (std::size_t i = 0; i < sine.size(); ++i)
    sine[i] = std::sin(2.0 * std::numbers::pi * 0.137 * static_cast<double>(i));
  EXPECT_EQ(normality(cubed, 0.0).words, "heavy-tailed");
  EXPECT_EQ(normality(squared, 0.0).words, "skewed upwards");
  for (double& value : squared) value = -value;
  EXPECT_EQ(normality(squared, 0.0).words, "skewed downwards");
  EXPECT_EQ(normality(sine, 0.0).words, "light-tailed");
}

// Steps as large as the noise: without their width the test takes them for a shape.
TEST(NormalityTest, DoesNotCallADigitiserAbnormal) {
  std::vector<double> x = gaussian_noise(3000, 8);
  for (double& value : x) value = std::round(value);
  EXPECT_LT(normality(x, 0.0).p_value, 1e-6);
  EXPECT_EQ(normality(x, 1.0).words, "normal");
}

TEST(NormalityTest, KeepsQuantilesOfANormalDistribution) {
  const Normality found = normality(gaussian_noise(20000, 9), 0.0);
  ASSERT_EQ(found.quantiles.size(), 61u);
  EXPECT_NEAR(found.quantiles[30], 0.0, 0.03);  // median ± 4 · 1.25 / √n
  const double lower_quartile = -0.6745;  // the nearest of (i + ½) / 61 is 0.2541, z = −0.6616
  EXPECT_NEAR(found.quantiles[15], -0.6616, 0.04);
  EXPECT_LT(found.quantiles[14], lower_quartile);
}

// + + − − − − + : four samples from 2; a run of 4 or more in 7 tosses comes with 0.31 (the bound
// 1 − exp(−5/16) = 0.268; the exact count is 40 of 128 = 0.3125, the difference what short series
// make).
TEST(LongestRun, FindsItAndHowRareItIs) {
  const std::vector<double> x = {1.0, 2.0, -1.0, -3.0, -1.0, -2.0, 1.0};
  const SignRun found = longest_run(x, 10.0, 0.5);
  EXPECT_EQ(found.samples, 4);
  EXPECT_DOUBLE_EQ(found.from, 11.0);
  EXPECT_DOUBLE_EQ(found.to, 12.5);
  EXPECT_NEAR(found.p_value, 1.0 - std::exp(-5.0 / 16.0), 1e-12);
}

}  // namespace
}  // namespace impactrig::fitting
