// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/metrics/residuals.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace impactrig::fitting {
namespace {

// m − c = 1 everywhere but for a 3: of the peak 4 that is 1/4, 1/4, 3/4, 1/4.
TEST(ResidualAnalysis, IsOfMeasuredLessComputedInPartsOfThePeak) {
  const std::vector<double> m = {0.0, -4.0, 2.0, 1.0}, c = {-1.0, -5.0, -1.0, 0.0};
  const ResidualAnalysis found = residual_analysis({m, c});
  EXPECT_DOUBLE_EQ(found.mean, 0.375);
  EXPECT_DOUBLE_EQ(found.deviation, 0.25);
  EXPECT_DOUBLE_EQ(found.t, 3.0);
  // deviations -1, -1, 3, -1 eighths: (1 - 3 - 3) / 12
  EXPECT_NEAR(found.lag1, -5.0 / 12.0, 1e-15);
}

TEST(RootMeanSquareError, NamesItsDivisor) {
  const std::vector<double> m = {0.0, -4.0, 2.0, 0.0}, c = {1.0, -3.0, 3.0, 1.0};
  const RootMeanSquareError found = root_mean_square_error({m, c});
  EXPECT_DOUBLE_EQ(found.rmse, 1.0);
  EXPECT_DOUBLE_EQ(found.of_peak, 1.0 / 4.0);
  EXPECT_DOUBLE_EQ(found.of_range, 1.0 / 6.0);
  EXPECT_DOUBLE_EQ(found.of_rms, 1.0 / std::sqrt(5.0));
}

TEST(Correlation, IsBlindToScaleAndOffset) {
  const std::vector<double> m = {1.0, 5.0, -2.0, 3.0},
                            c = {1e3 + 2.0, 1e3 + 10.0, 1e3 - 4.0, 1e3 + 6.0};
  EXPECT_NEAR(correlation({m, c}), 1.0, 1e-15);
  EXPECT_LT(r_squared({m, c}), -1e4);
}

// x_i = φ x_{i−1} + noise has τ = (1 + φ) / (1 − φ). 2e5 samples: τ within some 5 %.
TEST(EffectiveSamples, AreThoseOfAnAutoregressiveProcess) {
  std::mt19937 generator(7);
  std::normal_distribution<double> normal;
  for (const double phi : {0.0, 0.5, 0.9, 0.99}) {
    std::vector<double> x(200'000);
    double state = 0.0;
    for (double& value : x) value = state = phi * state + normal(generator);
    const double tau = static_cast<double>(x.size()) / effective_samples(x);
    EXPECT_NEAR(tau / ((1.0 + phi) / (1.0 - phi)), 1.0, 0.1) << phi << ", seed 7";
  }
}

// A walk of a million samples would take 10^11 products; means of neighbours tell as much.
TEST(EffectiveSamples, OfALongSmoothRecordAreFew) {
  std::vector<double> x(1'000'000);
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = static_cast<double>(i);
  EXPECT_LT(effective_samples(x), 10.0);
  EXPECT_GE(effective_samples(x), 1.0);
}

TEST(EffectiveSamples, OfAConstantAreNotDefined) {
  EXPECT_TRUE(std::isnan(effective_samples(std::vector<double>(5, 2.0))));
  EXPECT_TRUE(std::isnan(effective_samples({})));
}

}  // namespace
}  // namespace impactrig::fitting
