// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/metrics/repeated_shots.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

namespace impactrig::fitting {
namespace {

TEST(ShotScatter, IsMeanAndStandardDeviation) {
  const ShotScatter found = shot_scatter({{1.0, 5.0}, {2.0, 5.0}, {6.0, 5.0}});
  EXPECT_DOUBLE_EQ(found.mean[0], 3.0);
  EXPECT_NEAR(found.deviation[0], std::sqrt(7.0), 1e-15);
  EXPECT_EQ(found.deviation[1], 0.0);
  // (4 - 3)^2 / (7 / 3); the sample without scatter is left out
  EXPECT_NEAR(chi2_per_sample(std::vector{4.0, 9.0}, found, 3), 3.0 / 7.0, 1e-15);
  EXPECT_THROW(shot_scatter({{1.0}}), std::invalid_argument);
  EXPECT_THROW(shot_scatter({{1.0}, {1.0, 2.0}}), std::invalid_argument);
}

// Shots with independent noise round the truth: t² of shots − 1 degrees of freedom has the mean
// (shots − 1) / (shots − 3). 20000 samples of variance 2 ν² (ν − 1) / ((ν − 2)² (ν − 4)) leave 1.5
// %.
TEST(ShotScatter, LeavesTheTruthAChi2OfStudentsLaw) {
  std::mt19937 generator(3);
  std::normal_distribution<double> normal(10.0, 2.0);
  std::vector<std::vector<double>> shots(9, std::vector<double>(20'000));
  for (auto& shot : shots)
    for (double& value : shot) value = normal(generator);
  const std::vector<double> truth(20'000, 10.0);
  EXPECT_NEAR(chi2_per_sample(truth, shot_scatter(shots), shots.size()), 8.0 / 6.0, 0.06)
      << "seed 3";
}

// White noise of a band of two standard deviations: 95.45 % inside, and as many samples as there
// are.
TEST(BandCoverage, OfWhiteNoiseIsThatOfTheNormalLaw) {
  std::mt19937 generator(5);
  std::normal_distribution<double> normal;
  std::vector<double> c(10'000), centre(c.size(), 0.0), half(c.size(), 2.0);
  for (double& value : c) value = normal(generator);
  const BandCoverage found = band_coverage(c, centre, half);
  EXPECT_NEAR(found.fraction, 0.9545, 4.0 * std::sqrt(0.9545 * 0.0455 / 1e4)) << "seed 5";
  EXPECT_NEAR(found.effective_samples, 1e4, 500.0);
  EXPECT_LT(found.low, 0.9545);
  EXPECT_GT(found.high, 0.9545);
  EXPECT_NEAR(found.high - found.low, 2.0 * 1.96 * std::sqrt(0.9545 * 0.0455 / 1e4), 1e-3);
}

// A slow wander is inside or outside for long: few samples, a wide interval.
TEST(BandCoverage, KnowsThatNeighboursAreAlike) {
  std::mt19937 generator(6);
  std::normal_distribution<double> normal;
  std::vector<double> c(10'000), centre(c.size(), 0.0), half(c.size(), 20.0);
  double state = 0.0;
  for (double& value : c) value = state = 0.99 * state + normal(generator);
  const BandCoverage found = band_coverage(c, centre, half);
  EXPECT_LT(found.effective_samples, 200.0);
  EXPECT_GT(found.high - found.low, 0.02);
}

TEST(BandCoverage, CountsAndRefuses) {
  const std::vector<double> c = {0.0, 1.0, 3.0, 5.0}, centre = {0.0, 0.0, 0.0, 5.0};
  EXPECT_EQ(band_coverage(c, centre, std::vector{1.0, 1.0, 1.0, 0.0}).fraction, 0.75);
  // a share of 0, of few effective samples: the interval's end is 0, not rounded below it
  for (int n = 1; n < 200; ++n) {
    const auto size = static_cast<std::size_t>(n);
    const std::vector<double> none(size, 0.0), one(size, 1.0), tiny(size, 1e-3);
    const BandCoverage outside = band_coverage(one, none, tiny);
    EXPECT_GE(outside.low, 0.0) << n;
    EXPECT_LE(band_coverage(none, none, tiny).high, 1.0) << n;
  }
  EXPECT_THROW(band_coverage(c, centre, std::vector{1.0, 1.0, 1.0, -1.0}), std::invalid_argument);
  EXPECT_THROW(band_coverage(c, centre, std::vector{1.0}), std::invalid_argument);
}

}  // namespace
}  // namespace impactrig::fitting
