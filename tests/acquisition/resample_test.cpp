// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/resample.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "tests/acquisition/scene.hpp"

namespace impactrig::acquisition {

namespace {

using namespace tests;

constexpr double pi = std::numbers::pi;
constexpr Sampling at{.start = -2e-3, .interval = 1e-6, .samples = 8000};

/// Largest error within the inner part, away from what the ends prolong.
double inner_error(const datasets::Channel& channel, const std::function<double(double)>& truth,
                   double margin) {
  double largest = 0.0;
  for (std::size_t i = 0; i < channel.size(); ++i) {
    const double t = channel.clock.time(i);
    if (t < at.start + margin || t > at.time(at.samples - 1) - margin) continue;
    largest = std::max(largest, std::abs(channel.value(i) - truth(t)));
  }
  return largest;
}

TEST(Resample, KeepsWhatIsBelowBothNyquistFrequencies) {
  for (const double rate : {5e6, 1.2345e6, 999e3, 400e3, 102.4e3})
    for (const double part : {0.05, 0.4, 0.8}) {
      const double frequency = part * 0.5 * std::min(1e6, rate);
      const auto wave = [&](double t) { return 2.0 + std::sin(2.0 * pi * frequency * t + 0.3); };
      auto force = force_of(at, sampled(at, wave));
      resample(force, {rate});
      EXPECT_NEAR(force.clock.interval, 1.0 / rate, 1e-18);
      EXPECT_EQ(force.clock.start, at.start);
      EXPECT_LT(inner_error(force, wave, 40.0 / std::min(1e6, rate)), 2e-4) << rate << " " << part;
    }
}

TEST(Resample, TakesOffWhatAnotherRateCannotHold) {
  for (const double rate : {400e3, 102.4e3}) {
    const double frequency = 0.52 * rate;  // just above the new Nyquist frequency
    auto force =
        force_of(at, sampled(at, [&](double t) { return std::sin(2.0 * pi * frequency * t); }));
    resample(force, {rate});
    EXPECT_LT(inner_error(
                  force, [](double) { return 0.0; }, 40.0 / rate),
              5e-4)
        << rate;
  }
}

TEST(Resample, LeavesALineAndACountAlone) {
  auto force = force_of(at, sampled(at, [](double t) { return 3.0 - 1e3 * t; }));
  resample(force, {250e3});
  ASSERT_EQ(force.size(), 2000U);
  for (std::size_t i = 0; i < force.size(); ++i)
    ASSERT_NEAR(force.value(i), 3.0 - 1e3 * force.clock.time(i), 1e-6);
  const auto before = force.values();
  resample(force, {250e3});
  EXPECT_EQ(force.values(), before);
}

TEST(Resample, MarksWhatComesFromInvalidSamples) {
  auto velocity = velocity_of(at, std::vector<double>(at.samples, 0.4));
  velocity.valid.assign(at.samples, 1);
  velocity.valid[1000] = 0;
  resample(velocity, {500e3});
  EXPECT_EQ(velocity.valid[500], 0);
  EXPECT_EQ(velocity.valid[498], 1);
  EXPECT_EQ(velocity.valid[502], 1);
}

TEST(Resample, JoinsUnevenTimes) {
  const auto wave = [](double t) { return std::sin(2.0 * pi * 2e3 * t); };
  Noise noise(11);
  datasets::Channel force = force_of(at, {});
  std::vector<double> times, values;
  for (std::size_t i = 0; i < at.samples; ++i) {
    times.push_back(at.time(i) + 0.3e-6 * (2.0 * noise.uniform() - 1.0));
    values.push_back(wave(times.back()));
  }
  force.clock = {times.front(), at.interval, times};
  force.raw = values;
  const auto edit = resample(force, {1e6}).edit;
  EXPECT_TRUE(force.clock.uniform());
  EXPECT_EQ(edit.parameters.at("from"), "uneven times, joined by modified Akima cubics");
  EXPECT_NEAR(force.clock.time(force.size() - 1), times.back(), 1.5e-6);
  // Modified Akima cubics are of second order at worst: (w h)² = 1.6e-4.
  EXPECT_LT(inner_error(force, wave, 40e-6), 1.6e-4);
}

/// A signal at 1 MHz less what `lost` takes out of it.
datasets::Channel without(const std::function<bool(std::size_t)>& lost) {
  datasets::Channel force = force_of(at, {});
  std::vector<double> times, values;
  for (std::size_t i = 0; i < at.samples; ++i) {
    if (lost(i)) continue;
    times.push_back(at.time(i));
    values.push_back(std::sin(2.0 * pi * 2e3 * at.time(i)));
  }
  force.clock = {times.front(), 1e-6, times};
  force.raw = values;
  return force;
}

std::vector<std::size_t> invalid_samples(const datasets::Channel& channel) {
  std::vector<std::size_t> invalid;
  for (std::size_t i = 0; i < channel.size(); ++i)
    if (!channel.is_valid(i)) invalid.push_back(i);
  return invalid;
}

// Nobody recorded what is drawn over a gap.
TEST(Resample, MarksWhatFallsIntoGaps) {
  auto force = without([](std::size_t i) { return (i > 2000 && i <= 2050) || i == 4001; });
  const auto result = resample(force, {1e6});
  ASSERT_EQ(force.size(), at.samples);
  std::vector<std::size_t> lost;
  for (std::size_t i = 2001; i <= 2050; ++i) lost.push_back(i);  // a single one is no gap
  EXPECT_EQ(invalid_samples(force), lost);
  EXPECT_EQ(result.gaps, 1U);
  EXPECT_EQ(result.in_gaps, 50U);
  EXPECT_NEAR(result.longest_gap, 51e-6, 1e-12);
  EXPECT_TRUE(result.edit.parameters.contains("gaps"));
}

// At half the rate each new sample stands for its neighbours too.
TEST(Resample, MarksTheNeighboursOfAGapAtALowerRate) {
  auto force = without([](std::size_t i) { return i > 2000 && i <= 2010; });
  resample(force, {500e3});
  EXPECT_EQ(invalid_samples(force), (std::vector<std::size_t>{1000, 1001, 1002, 1003, 1004, 1005}));
}

TEST(Resample, TakesAnotherRateForNoGap) {
  auto force = without([](std::size_t i) { return (i < 3000 || i > 6000) && i % 10 != 0; });
  EXPECT_EQ(resample(force, {1e6}).gaps, 0U);
  EXPECT_TRUE(force.valid.empty());
}

TEST(Resample, MarksWhatIsNotANumber) {
  auto velocity = velocity_of(at, std::vector<double>(at.samples, 0.4));
  std::get<std::vector<double>>(velocity.raw)[1000] = NAN;
  resample(velocity, {500e3});
  EXPECT_EQ(invalid_samples(velocity), std::vector<std::size_t>{500});
}

// What is not sound at the beginning is no sample, and shifts none.
TEST(Resample, OfUnevenTimesBeginsAtTheFirstSoundOne) {
  datasets::Channel force = force_of(at, {});
  std::vector<double> times, values;
  for (std::size_t i = 0; i < at.samples; ++i) {
    times.push_back(at.time(i) + (i % 2 == 0 ? 0.2e-6 : 0.0));
    values.push_back(i < 500 ? NAN : times.back());
  }
  force.clock = {times.front(), at.interval, times};
  force.raw = values;
  resample(force, {1e6});
  EXPECT_EQ(force.clock.start, times[500]);
  for (std::size_t i = 100; i < force.size() - 100; ++i)
    ASSERT_NEAR(force.value(i), force.clock.time(i), 1e-9);
}

// Fewer samples than the kernel reaches to either side: the record is reflected more than once.
TEST(Resample, LeavesALineAloneInAShortRecord) {
  for (const std::size_t n : {17U, 30U, 60U, 200U})
    for (const double rate : {1e6 / 0.98, 3e6, 16.5e6 / static_cast<double>(n)}) {
      const Sampling short_one{.start = 0.0, .interval = 1e-6, .samples = n};
      auto force = force_of(short_one, sampled(short_one, [](double t) { return 3.0 + 1e6 * t; }));
      resample(force, {rate});
      for (std::size_t i = 0; i < force.size(); ++i)
        ASSERT_NEAR(force.value(i), 3.0 + 1e6 * force.clock.time(i), 1e-3) << n << " " << rate;
    }
}

// A sample that is not sound stands for nothing up to its neighbours, also where the step of an
// uneven clock is not stated.
TEST(Resample, MarksUpToTheNeighboursInUnevenTimes) {
  datasets::Channel force = force_of(at, {});
  std::vector<double> times;
  for (std::size_t i = 0; i < 100; ++i) times.push_back(1e-3 * static_cast<double>(i + i % 2));
  for (std::size_t i = 1; i < 100; i += 2) times[i] -= 0.6e-3;
  force.raw = std::vector<double>(100, 1.0);
  force.clock = {times.front(), 0.0, times};
  force.valid.assign(100, 1);
  force.valid[50] = 0;
  resample(force, {100e3});
  for (std::size_t i = 0; i < force.size(); ++i) {
    const double t = force.clock.time(i);
    const bool bridged = t > times[49] + 1e-8 && t < times[51] - 1e-8;
    ASSERT_EQ(force.is_valid(i), !bridged) << t;
  }
}

TEST(Resample, RefusesSenselessRates) {
  auto force = force_of(at, std::vector<double>(at.samples, 0.0));
  EXPECT_THROW(resample(force, {0.0}), std::invalid_argument);
  EXPECT_THROW(resample(force, {-1.0}), std::invalid_argument);
  EXPECT_THROW(resample(force, {INFINITY}), std::invalid_argument);
  EXPECT_THROW(resample(force, {1e15}), std::invalid_argument);
  EXPECT_THROW(resample(force, {1e-3}), std::invalid_argument);
  EXPECT_THROW(resample(force, {100e9}), std::invalid_argument);
  auto back = force;
  back.clock.times = std::vector<double>(at.samples, 1.0);
  EXPECT_THROW(resample(back, {1e6}), std::invalid_argument);
}

}  // namespace

}  // namespace impactrig::acquisition
