// SPDX-License-Identifier: BSD-3-Clause
// What find_impacts tells of a displacement alone.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "acquisition/conditioning/condition.hpp"
#include "tests/acquisition/half_sine_contact.hpp"
#include "tests/acquisition/scene.hpp"

namespace impactrig::acquisition {

namespace {

using datasets::ImpactFlag;
using datasets::Quantity;
using namespace tests;

/// The way of a bar that comes at 0.441 m/s, is stopped by a half sine of deceleration on
/// [0, duration] and leaves with e times that: the integral of bounce().
double way(double t, double e) {
  const double speed = 0.441, change = speed * (1.0 + e);
  if (t < 0.0) return speed * t;
  const double in = std::min(t, duration);
  return speed * t - 0.5 * change * (in - duration / pi * std::sin(pi * in / duration)) -
         change * (t - in);
}

datasets::Channel displacement_of(const Sampling& at, std::vector<double> values) {
  return channel_of("Laser", Quantity::displacement, at, std::move(values));
}

std::vector<datasets::Impact> impacts_of(const Sampling& at, const std::vector<double>& values,
                                         const DetectionOptions& options = {}) {
  return find_impacts(record_of({displacement_of(at, values)}), options);
}

TEST(FindImpacts, FindsTheBounceOfADisplacement) {
  const Sampling at;
  std::vector<double> values = sampled(at, [](double t) { return way(t, 0.5); });
  add_noise(values, 0.1e-6, 5);
  const auto impacts = impacts_of(at, values);
  ASSERT_EQ(impacts.size(), 1u);
  const datasets::Impact& impact = impacts[0];
  // Force sets in as t: of s³ = 25 times the noise is left after 7 % of the contact.
  EXPECT_NEAR(impact.start, 0.0, 0.07 * duration);
  // The half sine leaves the bar way(duration, 0.5) behind the stop, which takes it half as long
  // again.
  EXPECT_NEAR(impact.end, 1.5 * duration, 0.1 * duration);
  EXPECT_NEAR(impact.approach_velocity, 0.441, 3.0 * impact.rebound->approach_error);
  EXPECT_LT(impact.rebound->approach_error, 1e-3);
  ASSERT_TRUE(impact.rebound);
  EXPECT_EQ(impact.rebound->absent, "");
  EXPECT_NEAR(impact.rebound->velocity, 0.2205, 3.0 * impact.rebound->velocity_error);
  EXPECT_NEAR(impact.rebound->restitution, 0.5, 3.0 * impact.rebound->restitution_error);
  EXPECT_LT(impact.rebound->restitution_error, 0.01);
  EXPECT_GT(impact.rebound->from, duration / 2);
  EXPECT_TRUE(impact.flags.empty());
  ASSERT_TRUE(impact.displacement);
}

// Of 200 intervals at 95 % 190 hold, 10 more or less being 3.2 standard deviations.
TEST(FindImpacts, StatesHonestIntervalsOfADisplacementsSpeeds) {
  int approach = 0, restitution = 0, found = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const double e = 0.3 + 0.003 * static_cast<double>(seed);
    const Sampling at{.start = -1e-3,
                      .interval = seed % 2 == 0 ? 1e-6 : 4e-6,
                      .samples = seed % 2 == 0 ? 3000u : 750u};
    std::vector<double> values = sampled(at, [&](double t) { return way(t, e); });
    add_noise(values, seed % 3 == 0 ? 1e-6 : 0.2e-6, seed);
    const auto impacts = impacts_of(at, values);
    if (impacts.size() != 1 || !impacts[0].rebound->absent.empty()) continue;
    ++found;
    const datasets::Rebound& rebound = *impacts[0].rebound;
    approach += std::abs(impacts[0].approach_velocity - 0.441) < 1.96 * rebound.approach_error;
    const auto [low, high] = rebound.restitution_ci95();
    restitution += low < e && e < high;
  }
  EXPECT_GE(found, 198);
  EXPECT_GE(approach, 180);
  EXPECT_GE(restitution, 180);
}

/// What a bar's vibration adds to its way: a swing of the speed by `part` of 0.441 m/s about it.
double vibration(double t, double part, double frequency, double phase) {
  const double omega = 2.0 * pi * frequency;
  return part * 0.441 / omega * (std::sin(omega * t + phase) - std::sin(phase));
}

TEST(FindImpacts, TellsTheSpeedAtTouchOfABarThatVibrates) {
  const Sampling at{.start = -2e-3, .interval = 2e-6, .samples = 2000};
  for (const double frequency : {700.0, 1500.0, 2500.0}) {
    std::vector<double> values =
        sampled(at, [&](double t) { return way(t, 0.5) + vibration(t, 0.1, frequency, 0.0); });
    add_noise(values, 0.1e-6, 5);
    const auto impacts = impacts_of(at, values);
    ASSERT_EQ(impacts.size(), 1u) << frequency;
    const double error = impacts[0].rebound->approach_error;
    EXPECT_NEAR(impacts[0].approach_velocity, 1.1 * 0.441, 3.0 * error) << frequency;
    EXPECT_LT(error, 0.03 * 0.441) << frequency;
  }
}

// A bar struck near its middle turns what it came with into vibration: its mean speed back is
// within three errors of none, but not of what it came with.
TEST(FindImpacts, FindsTheBounceOfABarThatVibratesMoreThanItComesBack) {
  const Sampling at{.start = -2e-3, .interval = 2e-6, .samples = 2000};
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Noise draw(seed);
    const double phase = 2.0 * pi * draw.uniform();
    std::vector<double> values = sampled(at, [&](double t) {
      const double since = std::max(t - duration, 0.0);  // a vibration that the contact leaves
      const double swing = std::cos(2.0 * pi * 1200.0 * since + phase) - std::cos(phase);
      return way(t, 0.1) + 0.6 * 0.441 / (2.0 * pi * 1200.0) * swing;
    });
    add_noise(values, 0.1e-6, seed);
    const auto impacts = impacts_of(at, values);
    ASSERT_EQ(impacts.size(), 1u) << seed;
    EXPECT_NEAR(impacts[0].approach_velocity, 0.441, 0.01 * 0.441);
  }
}

// Of 100 intervals at 95 % 95 hold, 7 fewer being 3.2 standard deviations.
TEST(FindImpacts, HoldsTheSpeedsOfABarThatVibrates) {
  int found = 0, approach = 0, told = 0, restitution = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    Noise draw(1000 + seed);
    const double frequency = 300.0 * std::pow(8.0, draw.uniform());
    const double part = 0.1 * draw.uniform(), phase = 2.0 * pi * draw.uniform();
    const Sampling at{.start = -2e-3, .interval = 5e-6, .samples = 800};
    const auto course = [&](double t) {
      return way(t, 0.5) + vibration(t, part, frequency, phase);
    };
    std::vector<double> values = sampled(at, course);
    add_noise(values, seed % 2 == 0 ? 1e-6 : 5e-6, seed);
    const auto impacts = impacts_of(at, values);
    if (impacts.size() != 1) continue;
    ++found;
    const double speed = 0.441 * (1.0 + part * std::cos(phase));
    const datasets::Rebound& rebound = *impacts[0].rebound;
    approach += std::abs(impacts[0].approach_velocity - speed) < 1.96 * rebound.approach_error;
    if (!rebound.absent.empty()) continue;
    ++told;
    const double mean =
        (course(rebound.from) - course(rebound.to)) / (rebound.to - rebound.from) / speed;
    const auto [low, high] = rebound.restitution_ci95();
    restitution += low < mean && mean < high;
  }
  EXPECT_GE(found, 95);
  EXPECT_GE(approach, 0.88 * found);
  EXPECT_GE(told, 90);
  EXPECT_GE(restitution, 0.88 * told);
}

TEST(FindImpacts, BridgesWhatADisplacementHasLost) {
  const Sampling at;
  std::vector<double> values = sampled(at, [](double t) { return way(t, 0.5); });
  add_noise(values, 0.1e-6, 5);
  for (double lost = 0.3 * duration; lost < 1.6 * duration; lost += 0.05 * duration) {
    datasets::Channel laser = displacement_of(at, values);
    laser.valid.assign(at.samples, 1);
    for (std::size_t i = 0; i < at.samples; ++i)
      if (at.time(i) > lost && at.time(i) < lost + 80e-6) laser.valid[i] = 0;
    const auto impacts = find_impacts(record_of({laser}), {});
    ASSERT_EQ(impacts.size(), 1u) << lost;
    EXPECT_EQ(impacts[0].flags, std::vector{ImpactFlag::dropout}) << lost;
    if (lost > 0.5 * duration && !impacts[0].rebound->absent.empty()) continue;  // in the rebound
    EXPECT_EQ(impacts[0].rebound->absent, "") << lost;
    EXPECT_NEAR(impacts[0].rebound->restitution, 0.5, 3.0 * impacts[0].rebound->restitution_error)
        << lost;
  }
}

// The extremes of 5000 normal numbers are 7.4 standard deviations apart on average.
TEST(FindImpacts, TakesNoNoiseForATurn) {
  const Sampling at{.start = -1e-3, .interval = 1e-6, .samples = 6000};
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    std::vector<double> values = sampled(at, [](double t) { return 0.441 * std::min(t, 0.0); });
    add_noise(values, 10e-6, seed);
    EXPECT_TRUE(impacts_of(at, values).empty()) << seed;
  }
}

// A touch needs a course before it: without one there is no bend, and no impact is told.
TEST(FindImpacts, TellsNoBounceWhoseStartIsMissed) {
  const Sampling whole{.interval = 10e-6, .samples = 400};
  std::vector<double> values = sampled(whole, [](double t) { return way(t, 0.5); });
  add_noise(values, 0.5e-6, 5);
  for (std::size_t cut = 90; cut < 150; ++cut) {  // 100 is touch
    const Sampling at{.start = whole.time(cut), .interval = 10e-6, .samples = 400 - cut};
    for (const datasets::Impact& impact : impacts_of(
             at, std::vector(values.begin() + static_cast<std::ptrdiff_t>(cut), values.end())))
      EXPECT_LT(std::abs(impact.approach_velocity - 0.441), 3.0 * impact.rebound->approach_error)
          << cut;
  }
}

TEST(FindImpacts, FindsTheBounceOfACoarselyDigitisedDisplacement) {
  const Sampling at{.start = -1e-3, .interval = 20e-6, .samples = 250};
  std::vector<double> values = sampled(at, [](double t) { return way(t, 0.5); });
  add_noise(values, 0.1e-6, 5);
  round_to(values, 0.736e-6);  // steady motion: hardly a value comes twice
  const auto impacts = impacts_of(at, values);
  ASSERT_EQ(impacts.size(), 1u);
  EXPECT_NEAR(impacts[0].start, 0.0, 0.25 * duration);
  EXPECT_NEAR(impacts[0].rebound->restitution, 0.5, 3.0 * impacts[0].rebound->restitution_error);
}

TEST(FindImpacts, TellsADisplacementFromTheOtherSide) {
  const Sampling at;
  std::vector<double> values = sampled(at, [](double t) { return -way(t, 0.5); });
  add_noise(values, 0.1e-6, 5);
  const auto impacts = impacts_of(at, values);
  ASSERT_EQ(impacts.size(), 1u);
  EXPECT_TRUE(impacts[0].has(ImpactFlag::inverted));
  EXPECT_NEAR(impacts[0].approach_velocity, -0.441, 2e-3);
  EXPECT_NEAR(impacts[0].rebound->velocity, -0.2205, 2e-3);
  EXPECT_NEAR(impacts[0].rebound->restitution, 0.5, 0.01);
}

TEST(FindImpacts, DoesNotDetermineAReboundThatWasNotRecorded) {
  const auto rebound_until = [](double end) {
    const Sampling at{.samples = static_cast<std::size_t>((1e-3 + end) / 1e-6)};
    std::vector<double> values = sampled(at, [](double t) { return way(t, 0.5); });
    add_noise(values, 0.1e-6, 5);
    const auto impacts = impacts_of(at, values);
    EXPECT_EQ(impacts.size(), 1u) << end;
    return impacts.empty() ? datasets::Impact{} : impacts[0];
  };
  const datasets::Impact within = rebound_until(0.8 * duration);
  EXPECT_TRUE(within.has(ImpactFlag::truncated_tail));
  ASSERT_TRUE(within.rebound);
  EXPECT_EQ(within.rebound->absent,
            "The record ends before the displacement is back at first touch; record more after "
            "the trigger.");
  const datasets::Impact behind = rebound_until(1.8 * duration);
  EXPECT_FALSE(behind.has(ImpactFlag::truncated_tail));
  ASSERT_TRUE(behind.rebound);
  EXPECT_EQ(behind.rebound->absent,
            "The record ends, or samples are lost, before it shows the rebound for as long as the "
            "contact lasts; record more after the trigger.");
}

TEST(FindImpacts, TellsWhatElseIsWrongWithADisplacement) {
  const Sampling at;
  const std::vector<double> sound = sampled(at, [](double t) { return way(t, 0.5); });
  std::vector<double> noisy = sound;
  add_noise(noisy, 8e-6, 5);
  const auto loud = impacts_of(at, noisy, {.post_trigger = 0.5e-3});  // over 0.25 mm
  ASSERT_EQ(loud.size(), 1u);
  EXPECT_TRUE(loud[0].has(ImpactFlag::noisy));

  std::vector<double> clipped = sound;
  add_noise(clipped, 0.1e-6, 5);
  for (double& value : clipped) value = std::max(value, -300e-6);  // where it goes behind the touch
  const auto railed = impacts_of(at, clipped);
  ASSERT_EQ(railed.size(), 1u);
  EXPECT_TRUE(railed[0].has(ImpactFlag::clipped));
}

TEST(FindImpacts, TellsADisplacementThatIsHeld) {
  const Sampling at;
  std::vector<double> sound = sampled(at, [](double t) { return way(t, 0.5); });
  add_noise(sound, 0.3e-6, 5);
  round_to(sound, 0.1e-6);
  EXPECT_TRUE(impacts_of(at, sound).at(0).flags.empty());

  std::vector<double> held = sound;
  std::fill(held.begin() + 1060, held.begin() + 1120, held[1060]);  // as it goes in
  EXPECT_EQ(impacts_of(at, held).at(0).flags, std::vector{ImpactFlag::unmarked_dropout});

  std::vector<double> cut = sound;
  const double top = *std::ranges::max_element(sound);
  for (double& value : cut) value = std::min(value, 0.7 * top);
  EXPECT_EQ(impacts_of(at, cut).at(0).flags, std::vector{ImpactFlag::clipped});
}

// A laser that loses its light stands still and goes on beside its course; the bar does not turn.
TEST(FindImpacts, DoesNotTakeALossOfLightForABounce) {
  const Sampling at;
  for (const double lost : {50e-6, 200e-6}) {
    std::vector<double> values =
        sampled(at, [&](double t) { return 0.441 * (t < 0.0 ? t : std::max(0.0, t - lost)); });
    add_noise(values, 0.1e-6, 5);
    EXPECT_TRUE(impacts_of(at, values).empty()) << lost;
  }
}

TEST(FindImpacts, LooksForTheBounceBehindALossOfLight) {
  const Sampling at;
  std::vector<double> values = sampled(
      at, [](double t) { return t < -0.7e-3 ? way(t, 0.5) : way(std::max(t, -0.6e-3), 0.5); });
  add_noise(values, 0.1e-6, 5);
  const auto impacts = impacts_of(at, values);
  ASSERT_EQ(impacts.size(), 1u);
  EXPECT_NEAR(impacts[0].start, 0.0, 0.1 * duration);
}

TEST(FindImpacts, FindsNoBounceInASwingOrAVibration) {
  const Sampling at{.start = -10e-3, .interval = 10e-6, .samples = 4000};
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const double phase = 0.3 * static_cast<double>(seed);
    for (const double frequency : {1.0, 50.0, 700.0}) {
      std::vector<double> values =
          sampled(at, [&](double t) { return 1e-3 * std::sin(2.0 * pi * frequency * t + phase); });
      add_noise(values, 1e-6, seed);
      EXPECT_TRUE(impacts_of(at, values).empty()) << frequency << ' ' << phase;
    }
  }
}

// Behind the bend of its release it shows less than a period before it turns.
TEST(FindImpacts, FindsNoBounceInABarThatIsLetGo) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Noise draw(seed);
    const double frequency = 30.0 * std::pow(30.0, draw.uniform());
    const Sampling at{.start = -2e-3, .interval = 4e-6, .samples = 5000};
    std::vector<double> values = sampled(
        at, [&](double t) { return 1e-3 * std::cos(2.0 * pi * frequency * std::max(t, 0.0)); });
    add_noise(values, seed % 2 == 0 ? 2e-6 : 20e-6, seed);
    EXPECT_TRUE(impacts_of(at, values).empty()) << seed << ' ' << frequency;
  }
}

TEST(FindImpacts, TakesADisplacementOnlyWhereNothingElseTells) {
  const Sampling at;
  const auto impacts = find_impacts(
      record_of({displacement_of(at, sampled(at, [](double t) { return way(t, 0.5); })),
                 velocity_of(at, sampled(at, bounce))}));
  ASSERT_EQ(impacts.size(), 1u);
  EXPECT_EQ(impacts[0].trigger, "Velocity");
  EXPECT_FALSE(impacts[0].rebound);
}

TEST(FindImpacts, HeedsTheThresholdOfADisplacement) {
  const Sampling at;
  std::vector<double> values = sampled(at, [](double t) { return way(t, 0.5); });
  add_noise(values, 0.1e-6, 5);
  const double depth = *std::ranges::max_element(values);
  EXPECT_TRUE(impacts_of(at, values, {.threshold = 1.2 * depth}).empty());
  EXPECT_EQ(impacts_of(at, values, {.threshold = 0.5 * depth}).size(), 1u);
}

}  // namespace

}  // namespace impactrig::acquisition
