// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/background.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "tests/acquisition/scene.hpp"

namespace impactrig::acquisition {

namespace {

using namespace tests;

std::vector<double> normal_noise(std::size_t n, double sigma, std::uint64_t seed) {
  std::vector<double> values(n, 0.0);
  add_noise(values, sigma, seed);
  return values;
}

TEST(RobustSpread, IsTheStandardDeviationOfNormalNoise) {
  const Spread spread = robust_spread(normal_noise(1'000'000, 3.0, 1));
  EXPECT_NEAR(spread.sigma, 3.0, 0.02);
  EXPECT_NEAR(spread.centre, 0.0, 0.02);
}

TEST(RobustSpread, IsNotMovedByAPulse) {
  std::vector<double> values = normal_noise(10'000, 3.0, 1);
  for (std::size_t i = 4000; i < 4500; ++i) values[i] += 1e6;
  EXPECT_NEAR(robust_spread(values).sigma, 3.0, 0.3);
}

TEST(Median, IsTheMiddleOrTheMeanOfTheTwoMiddles) {
  EXPECT_EQ(median({3.0, 1.0, 2.0}), 2.0);
  EXPECT_EQ(median({4.0, 1.0, 3.0, 2.0}), 2.5);
  EXPECT_EQ(median({5.0}), 5.0);
}

TEST(StepNoise, SeesWhiteNoiseOnly) {
  std::vector<double> values = normal_noise(100'000, 3.0, 1);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double x = static_cast<double>(i);
    values[i] += 1000.0 * std::sin(1e-3 * x) + 0.1 * x;
  }
  EXPECT_NEAR(step_noise(values), 3.0, 0.05);
}

TEST(CorrelationTime, IsThatOfAFirstOrderRecursion) {
  for (const double r : {0.0, 0.5, 0.9}) {
    Noise noise(3);
    double state = 0.0;
    std::vector<double> values(200'000);
    for (double& value : values) value = state = r * state + noise();
    EXPECT_NEAR(correlation_time(values), (1.0 + r) / (1.0 - r), 0.05 * (1.0 + r) / (1.0 - r));
  }
}

TEST(CorrelationTime, IsAtLeastOne) {
  EXPECT_EQ(correlation_time(std::vector<double>{1.0, -1.0, 1.0, -1.0, 1.0, -1.0}), 1.0);
  EXPECT_EQ(correlation_time(std::vector<double>(10, 0.0)), 1.0);
}

TEST(QuantumOf, FindsTheGrid) {
  std::vector<double> values = normal_noise(5000, 1.0, 1);
  EXPECT_EQ(quantum_of(values), 0.0);
  for (const double step : {0.0123, 1.0, 7.0 / 3.0}) {
    std::vector<double> rounded = values;
    for (double& value : rounded) value = 0.1 + step * std::round(10.0 * value);
    EXPECT_NEAR(quantum_of(rounded), step, 1e-9 * step);
  }
}

// A rail of the amplifier, a zero that a recorder puts in, the straight line over a lost sample.
TEST(QuantumOf, OverlooksFewValuesBesideTheGrid) {
  for (const double step : {0.0123, 1.0, 7.0 / 3.0})
    for (const double beside : {0.5, 1.0 / 3.0, 0.04, 0.07}) {
      SCOPED_TRACE(testing::Message() << step << " " << beside);
      std::vector<double> values = normal_noise(5000, 10.0, 1);
      for (double& value : values) value = 0.1 + step * std::round(3.0 * value);
      for (const std::size_t i : {0U, 777U, 4999U}) values[i] += beside * step;
      EXPECT_NEAR(quantum_of(values), step, 1e-4 * step);
    }
}

TEST(QuantumOf, DoesNotCountSamplesThatAreNotValid) {
  std::vector<double> values = normal_noise(5000, 1.0, 1);
  for (double& value : values) value = std::round(3.0 * value);
  std::vector<std::uint8_t> valid(values.size(), 1);
  for (std::size_t i = 0; i < values.size(); i += 50) {
    values[i] += 0.3 * std::sin(static_cast<double>(i));
    valid[i] = 0;
  }
  EXPECT_NEAR(quantum_of(values, valid), 1.0, 1e-9);
  EXPECT_EQ(quantum_of(values), 0.0);
}

// Most samples on one value of the digitiser, but for rounding: no median absolute deviation.
TEST(FitQuiet, OfSamplesThatRoundingDividesIsThatOfAll) {
  std::vector<double> values = normal_noise(5000, 0.5, 1);
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = 4.8828125 + std::round(values[i]) + (i % 3 == 0 ? 9e-16 : 0.0);
  // 0.5 in steps of 1: sqrt(0.5^2 + 1/12) but for the tails
  EXPECT_NEAR(fit_quiet(values, 0, values.size(), 1, 0.0).sigma, 0.577, 0.03);
}

TEST(QuantumOf, IsNotMisledByRepeatedZeros) {
  std::vector<double> values(5000, 0.0);
  for (std::size_t i = 0; i < 200; ++i)
    values[2000 + i] = std::sin(0.0157 * static_cast<double>(i));
  EXPECT_EQ(quantum_of(values), 0.0);
}

// A transform of all would take 32 bytes a sample and more.
TEST(CorrelationTime, OfManySamplesIsThatOfTheirMiddle) {
  const std::size_t enough = std::size_t{1} << 20;
  std::vector<double> values = normal_noise(enough, 1.0, 5);
  for (std::size_t i = 1; i < enough; ++i) values[i] += 0.99 * values[i - 1];
  const double time = correlation_time(values);
  EXPECT_NEAR(time, 199.0, 20.0);
  values.insert(values.begin(), 1000, 50.0);
  values.insert(values.end(), 1000, -50.0);
  EXPECT_EQ(correlation_time(values), time);
}

TEST(FitQuiet, RecoversAParabolaInNoise) {
  std::vector<double> values = normal_noise(1000, 0.5, 2);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double x = static_cast<double>(i);
    values[i] += 3.0 + 0.02 * x - 1e-5 * x * x;
  }
  const QuietFit fit = fit_quiet(values, 100, 900, 2, 0.0);
  EXPECT_NEAR(fit.sigma, 0.5, 0.05);
  EXPECT_NEAR(fit.at(500.0), 3.0 + 10.0 - 2.5, 0.1);
  EXPECT_NEAR(fit.at(899.0), 3.0 + 17.98 - 8.082, 0.2);
}

TEST(FitQuiet, ReportsTheNoiseOfACoarseDigitiser) {
  std::vector<double> values = normal_noise(2000, 0.3, 2);
  for (double& value : values) value = std::round(value);  // 90 % of the samples are 0
  const QuietFit fit = fit_quiet(values, 0, values.size(), 1, 1.0);
  double power = 0.0;
  for (const double value : values) power += value * value;
  EXPECT_NEAR(fit.sigma, std::sqrt(power / 2000.0), 0.01 * fit.sigma);
}

TEST(FastPart, LeavesNothingOfHumAndMostOfAPulse) {
  for (const double length : {0.3e-3, 4e-3, 10e-3, 20e-3}) {
    const Sampling at{.start = 0.0, .interval = length / 2000.0, .samples = 2000};
    const double pi = std::numbers::pi;
    double worst = 0.0;
    for (double phase = 0.0; phase < 2.0 * pi; phase += 0.3) {
      const auto hum = sampled(at, [&](double t) {
        return std::sin(100.0 * pi * t + phase) + 0.3 * std::sin(300.0 * pi * t + 2.0 * phase);
      });
      worst = std::max(worst, fast_part(hum, at.interval).highest);
    }
    EXPECT_LT(worst, 0.01) << length;
    const auto pulse = sampled(at, [&](double t) { return half_sine(t - 1e-4, 1.0, 100e-6); });
    if (length > 1e-3) {
      EXPECT_GT(fast_part(pulse, at.interval).highest, 0.5) << length;
    }
  }
}

TEST(NoiseGate, LetsNoisePassLessThanOnceInTenThousandRecords) {
  for (const double n : {1e3, 1e4, 1e5, 1e7, 1e9}) {
    const double gate = noise_gate(static_cast<std::size_t>(n));
    EXPECT_GE(gate, 6.0);
    EXPECT_LT(n * std::erfc(gate / std::numbers::sqrt2), 1e-4) << n;
  }
}

}  // namespace

}  // namespace impactrig::acquisition
