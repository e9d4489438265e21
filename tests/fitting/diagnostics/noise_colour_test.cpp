// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/diagnostics/noise_colour.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/fitting/diagnostics/noise.hpp"

namespace impactrig::fitting {
namespace {

using tests::gaussian_noise;

// x_t = φ x_{t−1} + e_t: σ_e² = 1 − φ², τ = (1 + φ) / (1 − φ). From 20 000 samples φ is known to
// √((1 − φ²) / n) = 0.0057; bounds at four of that and what follows from it, dτ = 2 dφ / (1 − φ)².
TEST(NoiseColour, KnowsAFirstOrderProcess) {
  const double phi = 0.6;
  const NoiseColour found = noise_colour(gaussian_noise(20000, 3, phi));
  ASSERT_FALSE(found.coefficients.empty());
  EXPECT_NEAR(found.coefficients[0], phi, 0.03);
  EXPECT_NEAR(found.innovation, std::sqrt(1.0 - phi * phi), 0.02);
  EXPECT_NEAR(found.correlation_time, (1.0 + phi) / (1.0 - phi), 0.4);
  EXPECT_NEAR(found.kurtosis, 3.0, 0.15);
}

TEST(NoiseColour, TakesAParabolaForNoNoise) {
  std::vector<double> x = gaussian_noise(1000, 4);
  const NoiseColour plain = noise_colour(x);
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double t = static_cast<double>(i) / 1000.0;
    x[i] += 50.0 - 80.0 * t + 30.0 * t * t;
  }
  const NoiseColour bent = noise_colour(x);
  EXPECT_NEAR(bent.deviation, plain.deviation, 1e-9);
  EXPECT_NEAR(bent.correlation_time, plain.correlation_time, 1e-9);
}

TEST(NoiseColour, WhitensWhatItSawAndKeepsGaps) {
  const NoiseColour colour = noise_colour(gaussian_noise(20000, 5, 0.8));
  std::vector<double> other = gaussian_noise(20000, 6, 0.8);
  EXPECT_NEAR(autocorrelations(other, 1)[0], 0.8, 0.03);
  EXPECT_NEAR(autocorrelations(whitened(other, colour), 1)[0], 0.0, 0.04);  // 4 √(2 / n)
  const std::size_t order = colour.coefficients.size();
  other[100] = std::numeric_limits<double>::quiet_NaN();
  const std::vector<double> w = whitened(other, colour);
  EXPECT_EQ(present(w), w.size() - order - (order + 1));
  EXPECT_TRUE(std::isnan(w[100 + order]));
  EXPECT_FALSE(std::isnan(w[101 + order]));
}

TEST(NoiseColour, IsOfNothingWhereNothingMoves) {
  const NoiseColour found = noise_colour(std::vector<double>(500, 2.5));
  EXPECT_LT(found.deviation, 1e-12);
  EXPECT_EQ(found.samples, 500u);
  EXPECT_EQ(noise_colour(std::vector<double>{1.0, 2.0}).deviation, 0.0);
}

}  // namespace
}  // namespace impactrig::fitting
