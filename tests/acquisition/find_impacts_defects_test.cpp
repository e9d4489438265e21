// SPDX-License-Identifier: BSD-3-Clause
// Recordings with one planted defect each, and sound ones that look like it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "acquisition/conditioning/condition.hpp"
#include "tests/acquisition/scene.hpp"

namespace impactrig::acquisition {

namespace {

using datasets::Impact;
using datasets::ImpactFlag;
using namespace tests;

constexpr double duration = 200e-6;  // [s]

double pulse(double t) {
  return half_sine(t, 1500.0, duration);
}

/// From 0.44 m/s to -0.22 m/s within the pulse, and a ringing of 40 kHz behind it.
double bounce(double t) {
  const double part = std::clamp(t / duration, 0.0, 1.0);
  const double ringing = t > 0.0 ? 0.04 * std::sin(2.0 * std::numbers::pi * 40e3 * t) *
                                       std::min(1.0, t / duration) * std::exp(-t / 2e-3)
                                 : 0.0;
  return 0.44 - 0.33 * (1.0 - std::cos(std::numbers::pi * part)) - ringing;
}

// An amplifier that stays at its limit for most of the record: its median is the limit.
// Before touch there is less than the way to the limit takes.
TEST(FindImpacts, FindsTheRiseToARailBehindAShortRest) {
  const Sampling at{.start = -40e-6, .interval = 1e-6, .samples = 3000};
  auto force = sampled(at, [](double t) { return t < 100e-6 ? pulse(t) : 1500.0; });
  add_noise(force, 2.0, 5);
  for (double& value : force) value = std::min(value, 1450.0);
  const auto impacts = find_impacts(record_of({force_of(at, force)}));
  ASSERT_EQ(impacts.size(), 1u);
  EXPECT_NEAR(impacts[0].start, 0.0, 3e-6);
  EXPECT_TRUE(impacts[0].has(ImpactFlag::clipped));
  EXPECT_FALSE(impacts[0].has(ImpactFlag::inverted));
}

TEST(FindImpacts, FindsTheRiseToARailThatIsNotLeft) {
  for (const std::size_t samples : {2400U, 4000U, 20000U})
    for (const double sign : {1.0, -1.0})
      for (const double step : {0.0, 1.0}) {
        const Sampling at{.start = -1e-3, .interval = 1e-6, .samples = samples};
        std::vector<double> force =
            sampled(at, [&](double t) { return t < 60e-6 ? pulse(t) : 1200.0; });
        add_noise(force, 2.0, 5);
        if (step > 0.0) round_to(force, step);
        for (double& value : force) value = sign * std::min(value, 1150.0);
        const auto impacts = find_impacts(record_of({force_of(at, force)}));
        SCOPED_TRACE(testing::Message() << samples << " samples, " << sign << ", step " << step);
        ASSERT_EQ(impacts.size(), 1u);
        EXPECT_NEAR(impacts[0].start, 0.0, 3e-6);
        EXPECT_NEAR(impacts[0].peak, sign * 1150.0, 2.0);
        EXPECT_TRUE(impacts[0].has(ImpactFlag::clipped));
        EXPECT_TRUE(impacts[0].has(ImpactFlag::truncated_tail));
        EXPECT_EQ(impacts[0].has(ImpactFlag::inverted), sign < 0.0);
      }
}

// The same with noise behind the limit, and a limit that is left again after most of the record.
TEST(FindImpacts, FindsTheRiseToARailInNoise) {
  for (const double noise : {0.3, 2.0, 10.0})
    for (const double sign : {1.0, -1.0})
      for (const double leaves : {3.5e-3, 1.0}) {
        const Sampling at{.start = -1e-3, .interval = 1e-6, .samples = 5000};
        std::vector<double> force = sampled(at, [&](double t) {
          return t > leaves ? 0.0 : sign * (t < 60e-6 ? std::min(pulse(t), 1150.0) : 1150.0);
        });
        add_noise(force, noise, 5);
        const auto impacts = find_impacts(record_of({force_of(at, force)}));
        SCOPED_TRACE(testing::Message() << noise << " N, " << sign << ", left at " << leaves);
        ASSERT_EQ(impacts.size(), 1u);
        EXPECT_NEAR(impacts[0].start, 0.0, 3e-6);
        EXPECT_NEAR(impacts[0].peak, sign * 1150.0, 5.0 * noise);
        EXPECT_EQ(impacts[0].has(ImpactFlag::truncated_tail), leaves > at.time(4999));
        EXPECT_EQ(impacts[0].has(ImpactFlag::inverted), sign < 0.0);
        EXPECT_FALSE(impacts[0].has(ImpactFlag::missed_start));
        EXPECT_TRUE(impacts[0].has(ImpactFlag::clipped));
      }
}

// A straight drift of a tenth of the peak and more over the record.
TEST(FindImpacts, FindsAContactOnASlope) {
  const Sampling at{.start = -1e-3, .interval = 1e-6, .samples = 6000};
  for (const double drift : {-150.0, -120.0, -100.0, -80.0, 80.0, 100.0, 130.0})
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      auto force = sampled(at, [&](double t) { return pulse(t) + drift * t / 6e-3; });
      add_noise(force, 2.0, seed);
      const auto impacts = find_impacts(record_of({force_of(at, force)}));
      SCOPED_TRACE(testing::Message() << drift << " N, seed " << seed);
      ASSERT_EQ(impacts.size(), 1u);
      EXPECT_NEAR(impacts[0].start, 0.0, 3e-6);
      EXPECT_NEAR(impacts[0].peak, 1500.0, 12.0);
    }
}

// Contacts over 65 % of the record: its median is not what the force rests at. 20 records.
TEST(FindImpacts, KnowsTheLevelWhereContactsFillMostOfTheRecord) {
  const Sampling at{.start = -0.8e-3, .interval = 1e-6, .samples = 5600};
  const auto clean = sampled(at, [](double t) {
    return half_sine(t, 2600.0, 0.4e-3) + half_sine(t, 400.0, 2.0e-3) +
           half_sine(t - 2.8e-3, 500.0, 1.7e-3);
  });
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    auto force = clean;
    add_noise(force, 2.0, seed);
    const auto impacts = find_impacts(record_of({force_of(at, force)}));
    ASSERT_EQ(impacts.size(), 1u) << seed;
    // the first part is at its crest where the second one has 400 sin(0.1 pi)
    EXPECT_NEAR(impacts[0].peak, 2600.0 + 124.0, 5.0 * 2.0) << seed;
    EXPECT_NEAR(impacts[0].impulse, 2.0 * (2600.0 * 0.4e-3 + 400.0 * 2e-3) / std::numbers::pi, 0.01)
        << seed;
    EXPECT_NEAR(impacts[0].start, 0.0, 5e-6) << seed;
    EXPECT_TRUE(impacts[0].has(ImpactFlag::double_hit)) << seed;
  }
}

// The foot of a pulse takes 100 samples to rise through the noise of 5 %. 60 records.
TEST(FindImpacts, FollowsASlowFootThroughTheNoise) {
  const Sampling at{.start = -0.7e-3, .interval = 0.5e-6, .samples = 4000};
  const auto clean = sampled(at, [](double t) { return sine_squared(t, 1500.0, 400e-6); });
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    auto force = clean;
    add_noise(force, 75.0, seed);
    const auto impacts = find_impacts(record_of({force_of(at, force)}));
    ASSERT_EQ(impacts.size(), 1u) << seed;
    EXPECT_NEAR(impacts[0].impulse, 1500.0 * 200e-6, 0.1 * 1500.0 * 200e-6) << seed;
    EXPECT_FALSE(impacts[0].has(ImpactFlag::undersampled)) << seed;
  }
}

// An amplifier's limit between two values of a digitiser of 8 bits, whose top toggles.
TEST(ClippedFlag, FiresOnARailBetweenTwoStepsOfADigitiser) {
  const Sampling at;
  const double step = 2.0 * 2250.0 / 256.0;
  for (const double rail : {62.3, 62.4, 62.6}) {
    auto force = sampled(at, [&](double t) { return std::min(pulse(t), rail * step); });
    add_noise(force, 0.2 * step, 7);
    round_to(force, step);
    const auto impacts = find_impacts(record_of({force_of(at, force)}));
    ASSERT_EQ(impacts.size(), 1u);
    EXPECT_TRUE(impacts[0].has(ImpactFlag::clipped)) << rail;
  }
}

// Noise of 1.2 digitiser steps makes three equal samples at a crest by chance. 400 records.
TEST(ClippedFlag, IsSilentOnEqualSamplesByChance) {
  const Sampling at;
  const auto clean = sampled(at, pulse);
  int clipped = 0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    auto force = clean;
    add_noise(force, 0.6, seed);
    round_to(force, 0.5);
    clipped += find_impacts(record_of({force_of(at, force)})).at(0).has(ImpactFlag::clipped);
  }
  EXPECT_LE(clipped, 1);
}

// A narrow crest beyond the range of 12 bits: few samples lie on it, as few as noise makes equal by
// chance. 80 records.
TEST(ClippedFlag, FiresOnFewSamplesAtTheEndOfARange) {
  const Sampling at;
  constexpr double step = 1.0, top = 2047.0 * step;
  for (const double part : {0.65, 0.75})  // 5 and 4 samples
    for (const double noise : {0.6, 0.9, 1.5, 2.0})
      for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        auto force = sampled(at, [&](double t) { return sine_squared(t, top / part, 13e-6); });
        add_noise(force, noise * step, seed);
        round_to(force, step);
        for (double& value : force) value = std::min(value, top);
        const auto impacts = find_impacts(record_of({force_of(at, force)}));
        ASSERT_EQ(impacts.size(), 1u);
        EXPECT_TRUE(impacts[0].has(ImpactFlag::clipped)) << part << " " << noise << " " << seed;
      }
}

// The same within its range, where two samples at most are alike. 200 records.
TEST(ClippedFlag, IsSilentOnNarrowCrestsInNoise) {
  const Sampling at;
  for (const double width : {9e-6, 13e-6, 25e-6, 60e-6})
    for (std::uint64_t seed = 1; seed <= 50; ++seed) {
      auto force = sampled(at, [&](double t) { return sine_squared(t, 2000.0, width); });
      add_noise(force, 0.9, seed);
      round_to(force, 1.0);
      const auto impacts = find_impacts(record_of({force_of(at, force)}));
      ASSERT_EQ(impacts.size(), 1u);
      EXPECT_FALSE(impacts[0].has(ImpactFlag::clipped)) << width << " " << seed;
    }
}

// A digitiser's limit just under the crest, noise before it: hardly two samples on end are at it.
TEST(ClippedFlag, FiresOnACrestThatIsCutWithItsNoise) {
  const Sampling at;
  for (const double part : {0.95, 0.98, 0.99})
    for (const double noise : {3.0, 8.0, 15.0})
      for (const double step : {0.0, 0.1, 1.0}) {
        int clipped = 0;
        for (std::uint64_t seed = 1; seed <= 10; ++seed) {
          auto force = sampled(at, pulse);
          add_noise(force, noise, seed);
          if (step > 0.0) round_to(force, step);
          for (double& value : force) value = std::min(value, 1500.0 * part);
          clipped += find_impacts(record_of({force_of(at, force)})).at(0).has(ImpactFlag::clipped);
        }
        EXPECT_GE(clipped, 10) << part << " " << noise << " " << step;
      }
}

// The same without a limit, noise of 0.8 to 20 steps. 500 records.
TEST(ClippedFlag, IsSilentOnCrestsInNoise) {
  const Sampling at;
  const auto clean = sampled(at, pulse);
  int clipped = 0;
  for (const double steps : {0.8, 1.0, 1.5, 3.0, 20.0})
    for (std::uint64_t seed = 1; seed <= 100; ++seed) {
      auto force = clean;
      add_noise(force, steps, seed);
      round_to(force, 1.0);
      clipped += find_impacts(record_of({force_of(at, force)})).at(0).has(ImpactFlag::clipped);
    }
  EXPECT_EQ(clipped, 0);
}

// A laser that holds what it saw last and then shows zero to the record's end: no motion. With no
// noise before it may be one.
TEST(FindImpacts, LeavesOutALaserThatIsDead) {
  const Sampling at;
  for (const double noise : {0.0, 1e-3})
    for (const double step : {0.0, 2e-4}) {
      auto velocity = sampled(at, bounce);
      add_noise(velocity, noise, 6);
      if (step > 0.0) round_to(velocity, step);
      std::fill(velocity.begin() + 1120, velocity.begin() + 1160, velocity[1120]);
      std::fill(velocity.begin() + 1160, velocity.end(), 0.0);
      auto force = sampled(at, pulse);
      add_noise(force, 1.0, 7);
      const auto impacts =
          find_impacts(record_of({force_of(at, force), velocity_of(at, velocity)}));
      SCOPED_TRACE(testing::Message() << "noise " << noise << ", step " << step);
      ASSERT_EQ(impacts.size(), 1u);
      const auto& shown = *impacts[0].velocity;
      const long lost = std::ranges::count(shown.valid, 0);
      const auto expected =
          std::lround((shown.time(shown.values.size() - 1) - 120e-6) / at.interval);
      EXPECT_EQ(impacts[0].has(ImpactFlag::dropout), noise > 0.0);
      EXPECT_NEAR(static_cast<double>(lost), noise > 0.0 ? static_cast<double>(expected) : 0.0,
                  2.0);
      EXPECT_NEAR(impacts[0].approach_velocity, 0.44, 1e-3);
    }
}

// A bar that sticks, by a simulation: smooth, and then at rest.
TEST(FindImpacts, TakesNoBarAtRestForADeadLaser) {
  const Sampling at;
  auto force = sampled(at, pulse);
  add_noise(force, 1.0, 7);
  const auto velocity = sampled(at, [](double t) {
    return t < 1e-3 ? 0.44 * std::cos(0.5 * std::numbers::pi * std::max(t, -1.0) / 1e-3) : 0.0;
  });
  const auto impacts = find_impacts(record_of({force_of(at, force), velocity_of(at, velocity)}));
  ASSERT_EQ(impacts.size(), 1u);
  EXPECT_FALSE(impacts[0].has(ImpactFlag::dropout));
}

Impact impact_with(const Sampling& at, std::vector<double> velocity) {
  const auto impacts = find_impacts(
      record_of({force_of(at, sampled(at, pulse)), velocity_of(at, std::move(velocity))}));
  EXPECT_EQ(impacts.size(), 1u);
  return impacts.empty() ? Impact{} : impacts[0];
}

// A rail without a stated range: noise of 2e-4 before the converter, none on the rail.
TEST(ClippedFlag, FiresOnAVelocityAtItsRailBesideRinging) {
  const Sampling at;
  for (const double rail : {0.25, 0.35, 0.42})
    for (const double step : {0.0, 4e-5}) {
      auto velocity = sampled(at, bounce);
      add_noise(velocity, 1e-4, 11);
      if (step > 0.0) round_to(velocity, step);
      for (double& v : velocity) v = std::clamp(v, -rail, rail);
      EXPECT_TRUE(impact_with(at, velocity).has(ImpactFlag::clipped)) << rail << " " << step;
    }
}

// A decoder beyond its range goes on at the other end of it. A sound reversal takes the contact,
// and a lost laser shows zero.
TEST(ClippedFlag, FiresOnAVelocityThatWrapsRound) {
  const Sampling at;
  for (const double noise : {1e-4, 1e-3})
    for (const double range : {0.25, 0.36, 0.42, 0.6}) {
      auto velocity = sampled(at, bounce);
      add_noise(velocity, noise, 19);
      for (double& v : velocity) v -= 2.0 * range * std::round(v / (2.0 * range));
      EXPECT_EQ(impact_with(at, velocity).has(ImpactFlag::clipped), range < 0.44)
          << range << " " << noise;
    }
  auto lost = sampled(at, bounce);
  add_noise(lost, 1e-4, 20);
  for (std::size_t i = 600; i < 700; ++i) lost[i] = 0.0;
  EXPECT_FALSE(impact_with(at, lost).has(ImpactFlag::clipped));
}

// A constant approach speed of a coarse digitiser is none, nor is that of few samples a period.
TEST(ClippedFlag, IsSilentOnAConstantApproachBesideRinging) {
  for (const double interval : {0.4e-6, 1e-6, 4e-6}) {
    const Sampling at{
        .start = -1e-3, .interval = interval, .samples = static_cast<std::size_t>(4e-3 / interval)};
    for (const double step : {2e-4, 1e-3, 4e-3})
      for (const double noise : {0.0, 0.1, 0.3}) {
        auto velocity = sampled(at, bounce);
        add_noise(velocity, noise * step, 13);
        round_to(velocity, step);
        EXPECT_FALSE(impact_with(at, velocity).has(ImpactFlag::clipped))
            << interval << " " << step << " " << noise;
      }
  }
}

// --- swapped ------------------------------------------------------------------------------------

TEST(SwappedFlag, SaysThatForceAndVelocityAreExchanged) {
  const Sampling at;
  for (const double sign : {1.0, -1.0})
    for (const double noise : {1e-4, 5e-3}) {
      auto force = sampled(at, pulse), velocity = sampled(at, bounce);
      add_noise(force, 1500.0 * noise, 21);
      add_noise(velocity, 0.44 * noise, 22);
      for (double& v : velocity) v *= sign;
      const auto impacts =
          find_impacts(record_of({force_of(at, velocity), velocity_of(at, force)}));
      ASSERT_FALSE(impacts.empty());
      EXPECT_EQ(impacts[0].flags, std::vector{ImpactFlag::swapped}) << sign << " " << noise;
    }
}

// A velocity without 0 Hz begins at zero, a bar at rest that is struck too; a charge amplifier has
// an offset; polarity may be turned over.
TEST(SwappedFlag, IsSilentOnOtherMistakes) {
  const Sampling at;
  const auto flagged = [&](double offset, double level, double sign) {
    const auto impacts = find_impacts(
        record_of({force_of(at, sampled(at, [&](double t) { return sign * pulse(t) + offset; })),
                   velocity_of(at, sampled(at, [&](double t) { return bounce(t) - level; }))}));
    EXPECT_EQ(impacts.size(), 1u);
    return !impacts.empty() && impacts[0].has(ImpactFlag::swapped);
  };
  for (const double offset : {0.0, 400.0, -1000.0})
    for (const double level : {0.0, 0.44, 0.88})
      for (const double sign : {1.0, -1.0})
        EXPECT_FALSE(flagged(offset, level, sign)) << offset << " " << level << " " << sign;
}

}  // namespace

}  // namespace impactrig::acquisition
