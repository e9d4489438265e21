// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace impactrig::acquisition {
namespace {

constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();

datasets::Channel channel_of(std::vector<double> samples) {
  datasets::Channel channel;
  channel.raw = std::move(samples);
  return channel;
}

TEST(CompensatedSum, KeepsWhatLargeTermsWouldSwallow) {
  CompensatedSum sum;
  for (const double term : {1.0, 1e100, 1.0, -1e100}) sum.add(term);
  EXPECT_EQ(sum.value(), 2.0);
}

// The sum of n equal terms is known; a plain sum of ten million 0.1 is wrong in the tenth digit.
TEST(CompensatedSum, DoesNotDriftWithTheNumberOfTerms) {
  CompensatedSum sum;
  const int n = 10'000'000;
  for (int i = 0; i < n; ++i) sum.add(0.1);
  EXPECT_DOUBLE_EQ(sum.value(), 0.1 * n);
}

TEST(CompensatedSum, OverflowsToInfinity) {
  CompensatedSum sum;
  sum.add(1e308);
  sum.add(1e308);
  EXPECT_EQ(sum.value(), std::numeric_limits<double>::infinity());
}

TEST(Statistics, AreThoseOfTheValuesNotOfTheRawSamples) {
  datasets::Channel channel;
  channel.raw = std::vector<std::int16_t>{0, 1, -3, 2};
  channel.scale = 0.5;
  channel.offset = 1.0;  // values 1, 1.5, -0.5, 2
  const ChannelStatistics figures = statistics(channel);
  EXPECT_EQ(figures.samples, 4U);
  EXPECT_EQ(figures.invalid, 0U);
  EXPECT_EQ(figures.first, 1.0);
  EXPECT_EQ(figures.last, 2.0);
  EXPECT_EQ(figures.min, -0.5);
  EXPECT_EQ(figures.max, 2.0);
  EXPECT_EQ(figures.sum, 4.0);
  EXPECT_EQ(figures.mean, 1.0);
  EXPECT_EQ(figures.sum_of_squares, 1.0 + 2.25 + 0.25 + 4.0);
  EXPECT_EQ(figures.rms, std::sqrt(7.5 / 4.0));
}

TEST(Statistics, LeaveOutWhatIsNotFinite) {
  datasets::Channel channel =
      channel_of({nan_value, 1.0, 3.0, std::numeric_limits<double>::infinity()});
  channel.valid = {0, 1, 0, 1};  // flagged but finite samples count
  const ChannelStatistics figures = statistics(channel);
  EXPECT_TRUE(std::isnan(figures.first));
  EXPECT_TRUE(std::isinf(figures.last));
  EXPECT_EQ(figures.invalid, 3U);
  EXPECT_EQ(figures.sum, 4.0);
  EXPECT_EQ(figures.mean, 2.0);
  EXPECT_EQ(figures.max, 3.0);
}

TEST(Statistics, OfNothingAreNoNumbers) {
  for (const auto& samples : {std::vector<double>{}, std::vector<double>{nan_value}}) {
    const ChannelStatistics figures = statistics(channel_of(samples));
    EXPECT_EQ(figures.samples, samples.size());
    EXPECT_EQ(figures.invalid, samples.size());
    EXPECT_EQ(figures.sum, 0.0);
    for (const double figure : {figures.min, figures.max, figures.mean, figures.rms})
      EXPECT_TRUE(std::isnan(figure));
  }
}

TEST(Statistics, OfAComplexChannelSumBothParts) {
  datasets::Channel channel = channel_of({1.0, 2.0, 3.0});
  channel.imaginary = {-1.0, 0.5, nan_value};
  const ChannelStatistics figures = statistics(channel);
  EXPECT_EQ(figures.complex_sum, std::complex<double>(3.0, -0.5));
  EXPECT_EQ(figures.sum_abs2, 2.0 + 4.25);
  EXPECT_EQ(figures.invalid, 1U);
}

}  // namespace
}  // namespace impactrig::acquisition
