// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/low_pass.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>
#include <variant>

#include "datasets/zero_phase_low_pass.hpp"
#include "tests/acquisition/scene.hpp"

namespace impactrig::acquisition {

namespace {

using datasets::LowPass;
using datasets::zero_phase_low_pass;
using namespace tests;

constexpr double pi = std::numbers::pi;

/// Amplitude and phase of a sinusoid within the middle third of a record.
std::complex<double> part_at(const std::vector<double>& y, double frequency, double interval) {
  // Whole periods, so that the sum is exact.
  const auto period = static_cast<std::size_t>(std::lround(1.0 / (frequency * interval)));
  const std::size_t first = y.size() / 3;
  const std::size_t n = y.size() / 3 / period * period;
  std::complex<double> sum = 0.0;
  for (std::size_t i = first; i < first + n; ++i)
    sum += y[i] * std::polar(1.0, -2.0 * pi * frequency * interval * static_cast<double>(i));
  return 2.0 * sum / static_cast<double>(n);
}

class ZeroPhaseLowPass : public testing::TestWithParam<int> {};

// The gain of both passes, 1/(1 + (w/w1)^2n), and no phase, at every frequency and order.
TEST_P(ZeroPhaseLowPass, HasTheButterworthGainAndNoPhase) {
  const int order = GetParam();
  const double h = 1e-6;
  for (const double cutoff : {2e3, 1e4, 1e5, 4e5}) {
    const double w1 = std::tan(pi * cutoff * h) / std::pow(std::numbers::sqrt2 - 1.0, 0.5 / order);
    for (const double frequency : {1e3, 1e4, 5e4, 1e5, 2e5, 2.5e5}) {
      std::vector<double> y(60000);
      for (std::size_t i = 0; i < y.size(); ++i)
        y[i] = 3.0 + std::cos(2.0 * pi * frequency * h * static_cast<double>(i));
      const auto out = zero_phase_low_pass(y, h, {cutoff, order});
      const double expected =
          1.0 / (1.0 + std::pow(std::tan(pi * frequency * h) / w1, 2.0 * order));
      const std::complex<double> part = part_at(out, frequency, h);
      EXPECT_NEAR(part.real(), expected, 1e-7) << cutoff << " " << frequency;
      EXPECT_NEAR(part.imag(), 0.0, 1e-7) << cutoff << " " << frequency;
    }
    // 3 dB at the cutoff by definition.
    const double gain = 1.0 / (1.0 + std::pow(std::tan(pi * cutoff * h) / w1, 2.0 * order));
    EXPECT_NEAR(gain, std::numbers::sqrt2 / 2.0, 1e-12);
  }
}

INSTANTIATE_TEST_SUITE_P(Orders, ZeroPhaseLowPass, testing::Values(1, 2, 3, 4, 5, 8));

// The reflected record goes on as a line does, so nothing happens at its ends.
TEST(LowPass, LeavesAStraightLineAlone) {
  std::vector<double> y(3000);
  for (std::size_t i = 0; i < y.size(); ++i) y[i] = 7.0 - 2e-3 * static_cast<double>(i);
  for (const int order : {1, 2, 4, 7})
    for (const double cutoff : {20e3, 450e3, 499.9e3}) {
      const auto out = zero_phase_low_pass(y, 1e-6, {cutoff, order});
      for (std::size_t i = 0; i < y.size(); ++i)
        ASSERT_NEAR(out[i], y[i], 1e-8) << order << " " << cutoff << " " << i;
    }
}

// Backwards in time is the same filter.
TEST(LowPass, CommutesWithTimeReversal) {
  std::vector<double> y(5000);
  add_noise(y, 1.0, 3);
  auto forwards = zero_phase_low_pass(y, 1e-6, {50e3, 3});
  std::ranges::reverse(y);
  auto backwards = zero_phase_low_pass(y, 1e-6, {50e3, 3});
  std::ranges::reverse(backwards);
  // Within the record's inner part; its ends prolong it each in their own way.
  for (std::size_t i = 500; i < 4500; ++i) ASSERT_NEAR(forwards[i], backwards[i], 1e-10);
}

// tan(pi f h) = 3e-5: the direct forms of a filter lose most of their digits there.
TEST(LowPass, IsAccurateFarBelowTheSampleRate) {
  const double h = 1e-6, frequency = 10.0;
  std::vector<double> y(3'000'000);
  for (std::size_t i = 0; i < y.size(); ++i)
    y[i] = 1.0 + std::cos(2.0 * pi * frequency * h * static_cast<double>(i));
  const auto out = zero_phase_low_pass(y, h, {frequency, 8});
  EXPECT_NEAR(part_at(out, frequency, h).real(), std::numbers::sqrt2 / 2.0, 1e-6);
  const std::vector<double> constant(1'000'000, 5.0);
  for (const double value : zero_phase_low_pass(constant, h, {1.0, 4}))
    ASSERT_NEAR(value, 5.0, 1e-9);
}

TEST(LowPass, OfAChannelBridgesInvalidSamplesAndKeepsTheirMarks) {
  const Sampling at{.start = 0.0, .interval = 1e-6, .samples = 400};
  auto velocity = velocity_of(at, std::vector<double>(400, 0.4));
  std::get<std::vector<double>>(velocity.raw)[100] = 1e6;
  velocity.valid.assign(400, 1);
  velocity.valid[100] = 0;
  const LowPassed result = low_pass(velocity, {50e3, 4});
  EXPECT_NEAR(velocity.value(100), 0.4, 1e-12);
  EXPECT_EQ(velocity.valid[100], 0);
  EXPECT_EQ(velocity.valid[99], 1);
  EXPECT_EQ(result.edit.what, "low-pass, zero phase");
  EXPECT_EQ(result.edit.parameters.at("cutoff"), "50000 Hz");
}

TEST(LowPass, SaysWhatThePulseLost) {
  const Sampling at;
  auto force = force_of(at, sampled(at, [](double t) { return half_sine(t, 1500.0, 200e-6); }));
  auto copy = force;
  EXPECT_LT(low_pass(force, {100e3, 4}).lost, 1e-3);
  const LowPassed result = low_pass(copy, {5e3, 4});
  double highest = 0.0;
  for (const double value : copy.values()) highest = std::max(highest, value);
  EXPECT_NEAR(result.lost, 1.0 - highest / 1500.0, 1e-4);
  EXPECT_GT(result.lost, 0.01);
}

// One reflection is too short for the filter's memory: 200 samples at a cutoff of 1 to 10 periods
// of the record. A ramp to 1e6 times the noise of an ordinary record shows the least push.
TEST(LowPass, LeavesAStraightLineAloneInAShortRecord) {
  for (const std::size_t n : {3U, 4U, 20U, 200U})
    for (const int order : {1, 2, 4, 8})
      for (const double periods : {1.0, 1.3, 3.0, 10.0}) {
        const double h = 1e-6, cutoff = periods / (static_cast<double>(n) * h);
        if (!(cutoff * h < 0.5)) continue;
        std::vector<double> y(n);
        for (std::size_t i = 0; i < n; ++i) y[i] = 5.0 + 0.3 * static_cast<double>(i);
        const auto out = zero_phase_low_pass(y, h, {cutoff, order});
        for (std::size_t i = 0; i < n; ++i)
          ASSERT_NEAR(out[i], y[i], 1e-8) << n << " " << order << " " << periods;
      }
}

// Between its ends a record of half periods of a sine goes on as that sine, however often it is
// reflected, so it keeps its shape and takes the gain of its frequency.
TEST(LowPass, OfAShortRecordIsThatOfItsReflections) {
  const std::size_t n = 201;
  const double h = 1e-6;
  for (const int order : {1, 4, 8})
    for (const double half_periods : {1.0, 3.0, 4.0, 9.0}) {
      const double frequency = 0.5 * half_periods / (h * static_cast<double>(n - 1));
      const double cutoff = 1.2 / (h * static_cast<double>(n));
      const double w1 =
          std::tan(pi * cutoff * h) / std::pow(std::numbers::sqrt2 - 1.0, 0.5 / order);
      const double gain = 1.0 / (1.0 + std::pow(std::tan(pi * frequency * h) / w1, 2.0 * order));
      std::vector<double> y(n);
      for (std::size_t i = 0; i < n; ++i)
        y[i] = std::sin(2.0 * pi * frequency * h * static_cast<double>(i));
      const auto out = zero_phase_low_pass(y, h, {cutoff, order});
      for (std::size_t i = 0; i < n; ++i)
        ASSERT_NEAR(out[i], gain * y[i], 1e-8) << order << " " << half_periods << " " << i;
    }
}

TEST(LowPass, MarksWhatWasNotFinite) {
  const Sampling at{.start = 0.0, .interval = 1e-6, .samples = 400};
  auto velocity = velocity_of(at, std::vector<double>(400, 0.4));
  std::get<std::vector<double>>(velocity.raw)[100] = NAN;
  low_pass(velocity, {50e3, 4});
  ASSERT_EQ(velocity.valid.size(), 400U);
  EXPECT_EQ(velocity.valid[100], 0);
  EXPECT_EQ(std::ranges::count(velocity.valid, 0), 1);
  EXPECT_NEAR(velocity.value(100), 0.4, 1e-12);
}

TEST(LowPass, RefusesARecordShorterThanAPeriod) {
  const Sampling at{.start = 0.0, .interval = 1e-6, .samples = 4000};
  auto velocity = velocity_of(at, std::vector<double>(4000, 0.4));
  EXPECT_NO_THROW(low_pass(velocity, {250.0, 4}));
  EXPECT_THAT(
      [&] {
        low_pass(velocity, {200.0, 4});
      },
      testing::ThrowsMessage<std::invalid_argument>(
          "a low-pass at 200 Hz has less than one period in the 0.004 s of channel 'Velocity'; "
          "filter at 250 Hz or more, or take a straight line off (step = \"drift\")"));
  EXPECT_THAT(
      [&] {
        low_pass(velocity, {-5.0, 4});
      },
      testing::ThrowsMessage<std::invalid_argument>("a low-pass at -5 Hz is not above 0 Hz"));
}

TEST(LowPass, RefusesWhatIsNoFilter) {
  const std::vector<double> y(10, 1.0);
  EXPECT_THROW(zero_phase_low_pass(y, 1e-6, {500e3, 4}), std::invalid_argument);
  // a memory of 1e10 samples: it took minutes
  EXPECT_THROW(zero_phase_low_pass(y, 1e-6, {500e3 * (1.0 - 1e-9), 4}), std::invalid_argument);
  EXPECT_THROW(zero_phase_low_pass(y, 1e-6, {0.0, 4}), std::invalid_argument);
  EXPECT_THROW(zero_phase_low_pass(y, 1e-6, {1e3, 0}), std::invalid_argument);
  EXPECT_THROW(zero_phase_low_pass(y, 1e-6, {1e3, 9}), std::invalid_argument);
  EXPECT_TRUE(zero_phase_low_pass({}, 1e-6, {1e3, 4}).empty());
}

}  // namespace

}  // namespace impactrig::acquisition
