// SPDX-License-Identifier: BSD-3-Clause
// Every flag: scenes where it must fire, and the nearest ones where it must not.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <tuple>

#include "acquisition/conditioning/condition.hpp"
#include "tests/acquisition/scene.hpp"

namespace impactrig::acquisition {

namespace {

using datasets::Impact;
using datasets::ImpactFlag;
using datasets::Quantity;
using namespace tests;

constexpr double pi = std::numbers::pi;
constexpr double duration = 200e-6;  // [s]

double pulse(double t) {
  return half_sine(t, 1500.0, duration);
}

/// The only impact in a force history.
Impact impact_in(std::vector<double> force, const Sampling& at = {}, double noise = 5.0) {
  add_noise(force, noise, 17);
  const auto impacts = find_impacts(record_of({force_of(at, std::move(force))}));
  EXPECT_EQ(impacts.size(), 1u);
  return impacts.empty() ? Impact{} : impacts[0];
}

// --- clipped ------------------------------------------------------------------------------------

TEST(ClippedFlag, FiresOnAFlatTop) {
  const Sampling at;
  for (const double range : {750.0, 1200.0, 1450.0, 1490.0}) {
    const auto impacts = find_impacts(record_of(
        {force_of(at, sampled(at, [&](double t) { return std::min(range, pulse(t)); }))}));
    ASSERT_EQ(impacts.size(), 1u);
    EXPECT_TRUE(impacts[0].has(ImpactFlag::clipped)) << range;
  }
}

TEST(ClippedFlag, FiresOnAFlatTopOfAnEightBitDigitiser) {
  const Sampling at;
  std::vector<double> force = sampled(at, pulse);
  add_noise(force, 1.0, 1);
  round_to(force, 2.0 * 1200.0 / 256.0);
  for (double& value : force) value = std::min(value, 127.0 * 2.0 * 1200.0 / 256.0);
  const auto impacts = find_impacts(record_of({force_of(at, force)}));
  ASSERT_EQ(impacts.size(), 1u);
  EXPECT_TRUE(impacts[0].has(ImpactFlag::clipped));
}

TEST(ClippedFlag, FiresOnAFlatBottom) {
  const Sampling at;
  const auto impacts = find_impacts(record_of(
      {force_of(at, sampled(at, [&](double t) { return std::max(-1200.0, -pulse(t)); }))}));
  ASSERT_EQ(impacts.size(), 1u);
  EXPECT_TRUE(impacts[0].has(ImpactFlag::clipped));
}

// A charge amplifier at its limit, with the digitiser's noise behind it.
TEST(ClippedFlag, FiresOnAFlatTopWithNoiseBehindIt) {
  for (const double range : {750.0, 1200.0, 1350.0})
    for (const double noise : {0.15, 1.0, 3.0})
      for (const double sign : {1.0, -1.0})
        EXPECT_TRUE(
            impact_in(sampled({}, [&](double t) { return sign * std::min(range, pulse(t)); }), {},
                      noise)
                .has(ImpactFlag::clipped))
            << range << " " << noise << " " << sign;
}

// Pulses that are flat by themselves: x^4, x^8 and x^20 instead of a parabola, yielding, a slope.
// Without noise, or rounded to coarse steps, the flat ones have equal top samples as a rail has.
TEST(ClippedFlag, IsSilentOnPlateausOfTheContact) {
  const auto flat = [](double exponent) {
    return [exponent](double t) {
      const double x = std::abs(2.0 * t / duration - 1.0);
      return x < 1.0 ? 1500.0 * (1.0 - std::pow(x, exponent)) : 0.0;
    };
  };
  const auto yielding = [](double t) { return 1200.0 * std::tanh(pulse(t) / 700.0); };
  const auto leaning = [](double t) { return std::min(pulse(t), 1100.0 + 200.0 * t / duration); };

  struct Plateau {
    const char* name;
    std::function<double(double)> force;
    double least_noise, largest_step;
  };

  const Plateau plateaus[] = {{"sine", pulse, 0.0, 16.0},        {"x^2", flat(2), 0.0, 16.0},
                              {"x^4", flat(4), 0.1, 1.0},        {"x^8", flat(8), 0.1, 1.0},
                              {"yielding", yielding, 0.0, 16.0}, {"x^20", flat(20), 0.1, 1.0},
                              {"slope", leaning, 0.1, 1.0}};
  for (const Plateau& plateau : plateaus)
    for (const double noise : {0.0, 0.15, 1.0, 3.0, 20.0})
      for (const double step : {0.0, 1.0, 16.0}) {
        if (noise < plateau.least_noise || step > plateau.largest_step) continue;
        auto values = sampled({}, plateau.force);
        add_noise(values, noise, 9);
        if (step > 0.0) round_to(values, step);
        const auto impacts = find_impacts(record_of({force_of({}, values)}));
        ASSERT_EQ(impacts.size(), 1u);
        EXPECT_FALSE(impacts[0].has(ImpactFlag::clipped))
            << plateau.name << " " << noise << " " << step;
      }
}

// A crest of a coarse digitiser stays on one value for many samples.
TEST(ClippedFlag, IsSilentOnACoarselyDigitisedCrest) {
  const Sampling at;
  for (const int bits : {6, 8, 10, 12, 16}) {
    std::vector<double> force = sampled(at, pulse);
    round_to(force, 2.0 * 2000.0 / std::pow(2.0, bits));
    const auto impacts = find_impacts(record_of({force_of(at, force)}));
    ASSERT_EQ(impacts.size(), 1u);
    EXPECT_FALSE(impacts[0].has(ImpactFlag::clipped)) << bits;
  }
}

TEST(ClippedFlag, FiresAtTheKnownRangeAndNotBelowIt) {
  const Sampling at;
  auto force = force_of(at, sampled(at, pulse));
  force.attributes["sensor.range"] = "1500";
  EXPECT_TRUE(find_impacts(record_of({force})).at(0).has(ImpactFlag::clipped));
  force.attributes["sensor.range"] = "1600";
  EXPECT_FALSE(find_impacts(record_of({force})).at(0).has(ImpactFlag::clipped));
}

TEST(ClippedFlag, FiresWhereTheRecorderMarkedTheTop) {
  const Sampling at;
  auto force = force_of(at, sampled(at, [](double t) { return std::min(1200.0, pulse(t)); }));
  force.valid.assign(at.samples, 1);
  for (std::size_t i = 0; i < at.samples; ++i)
    if (pulse(at.time(i)) > 1200.0) force.valid[i] = 0;
  const auto impacts = find_impacts(record_of({force}));
  ASSERT_EQ(impacts.size(), 1u);
  EXPECT_TRUE(impacts[0].has(ImpactFlag::clipped));
  EXPECT_FALSE(impacts[0].has(ImpactFlag::dropout));  // clipped, not lost
}

// What is missing above half of the peak is lost, on the flank as on the crest.
TEST(ClippedFlag, IsSilentOnMissingSamplesOfAForce) {
  const Sampling at;
  const auto missing = [&](std::size_t from, std::size_t count, double value) {
    auto force = force_of(at, sampled(at, pulse));
    force.valid.assign(at.samples, 1);
    for (std::size_t i = from; i < from + count; ++i) {
      std::get<std::vector<double>>(force.raw)[i] = value;
      force.valid[i] = 0;
    }
    return find_impacts(record_of({force})).at(0);
  };
  for (const auto& [from, count, value] :
       {std::tuple<std::size_t, std::size_t, double>{1100, 1, NAN},
        {1050, 20, NAN},
        {1060, 20, 0.0},
        {1050, 20, 1300.0}}) {
    const Impact impact = missing(from, count, value);
    EXPECT_FALSE(impact.has(ImpactFlag::clipped)) << from << " " << value;
    EXPECT_TRUE(impact.has(ImpactFlag::dropout)) << from << " " << value;
  }
}

// A velocity at its range is clipped, not lost; those samples say nothing.
TEST(ClippedFlag, FiresOnAVelocityBeyondItsRange) {
  const Sampling at;
  for (const double range : {0.3, 0.6}) {
    auto velocity =
        velocity_of(at, sampled(at, [&](double t) {
                      const double speed =
                          0.44 - 0.3 * (1.0 - std::cos(pi * std::clamp(t / duration, 0.0, 1.0)));
                      return std::clamp(speed, -range, range);
                    }));
    velocity.attributes["sensor.range"] = std::to_string(range);
    const auto impacts = find_impacts(record_of({force_of(at, sampled(at, pulse)), velocity}));
    ASSERT_EQ(impacts.size(), 1u);
    EXPECT_EQ(impacts[0].has(ImpactFlag::clipped), range < 0.4);
    EXPECT_FALSE(impacts[0].has(ImpactFlag::dropout));
    EXPECT_EQ(impacts[0].velocity->valid.empty(), range > 0.4);
  }
}

/// A bar's velocity: constant, a contact with the force of `pulse`, constant.
double bar_velocity(double t) {
  return 0.5 - 0.45 * (1.0 - std::cos(pi * std::clamp(t / duration, 0.0, 1.0)));
}

bool velocity_is_clipped(std::vector<double> velocity, const Sampling& at = {}) {
  const auto impacts = find_impacts(
      record_of({force_of(at, sampled(at, pulse)), velocity_of(at, std::move(velocity))}));
  EXPECT_EQ(impacts.size(), 1u);
  return !impacts.empty() && impacts[0].has(ImpactFlag::clipped);
}

// Noise is everywhere but at the rail. No range is stated.
TEST(ClippedFlag, FiresOnAVelocityAtARail) {
  for (const auto& [least, most] : {std::pair{-0.3, 0.45}, {-0.3, 9.0}, {-9.0, 0.45}, {-9.0, 9.0}})
    for (const double step : {0.0, 1e-4}) {
      auto velocity = sampled({}, bar_velocity);
      add_noise(velocity, 5e-4, 5);
      if (step > 0.0) round_to(velocity, step);
      for (double& value : velocity) value = std::clamp(value, least, most);
      EXPECT_EQ(velocity_is_clipped(velocity), least > -1.0 || most < 1.0) << least << " " << most;
    }
}

// Without noise above a digitiser step constant speeds are long runs of equal extreme samples.
TEST(ClippedFlag, IsSilentOnConstantSpeedsOfADigitiser) {
  for (const int bits : {6, 8, 10, 12, 16})
    for (const double noise : {0.0, 1e-5, 2e-4, 1e-3}) {
      auto velocity = sampled({}, bar_velocity);
      add_noise(velocity, noise, 6);
      round_to(velocity, 2.0 / std::pow(2.0, bits));
      EXPECT_FALSE(velocity_is_clipped(velocity)) << bits << " " << noise;
    }
  EXPECT_FALSE(velocity_is_clipped(sampled({}, bar_velocity)));
}

/// A motion before, in and after a contact that takes a share of its approach as rebound: forces of
/// several shapes, one of which begins with a jump, and a bar that rings on afterwards.
struct RandomShot {
  std::vector<double> force, velocity, displacement;
};

const Sampling shot_sampling{-5e-4, 1e-6, 1800};

RandomShot random_shot(std::uint64_t seed, bool with_jumps) {
  Noise random(seed);
  const double length = 50e-6 * std::pow(10.0, random.uniform());  // [s]
  const double rebound = 0.2 + 0.75 * random.uniform();
  const double jump = with_jumps ? 0.5 * random.uniform() : 0.0;
  const double power = 1.0 + random.uniform();  // of a half sine
  const double ringing = random.uniform() < 0.5 ? 0.1 * random.uniform() : 0.0;
  const double period = 30e-6 + 500e-6 * random.uniform();
  const Sampling& at = shot_sampling;
  RandomShot shot;
  shot.force = sampled(at, [&](double t) {
    if (t <= 0.0 || t >= length) return 0.0;
    return std::max(std::pow(std::sin(pi * t / length), power), jump * (1.0 - t / length));
  });
  double impulse = 0.0;
  for (const double value : shot.force) impulse += value;
  double v = 1.0, x = 0.0;
  for (std::size_t i = 0; i < at.samples; ++i) {
    v -= (1.0 + rebound) * shot.force[i] / impulse;
    x += v * at.interval;
    const double t = std::max(0.0, at.time(i));
    shot.velocity.push_back(v + ringing * (1.0 - std::cos(2.0 * pi * t / period)) *
                                    std::exp(-t / 500e-6));
    shot.displacement.push_back(x);
  }
  return shot;
}

/// What a digitiser makes of it: `used` of its range by the larger end, `noise` in steps.
std::vector<double> digitised(std::vector<double> values, int bits, double used, double noise,
                              std::uint64_t seed) {
  double largest = 0.0;
  for (const double value : values) largest = std::max(largest, std::abs(value));
  const double half = std::pow(2.0, bits - 1);
  for (double& value : values) value *= used * half / largest;
  add_noise(values, noise, seed);
  round_to(values, 1.0);
  for (double& value : values) value = std::clamp(value, -half, half - 1.0) / half;
  return values;
}

bool is_clipped(const RandomShot& shot, Quantity quantity, std::vector<double> values) {
  const auto impacts =
      find_impacts(record_of({force_of(shot_sampling, shot.force),
                              channel_of("Motion", quantity, shot_sampling, std::move(values))}));
  return !impacts.empty() && impacts[0].has(ImpactFlag::clipped);
}

constexpr double noises[] = {0.0, 0.1, 0.3, 0.6, 1.0, 2.0};  // in digitiser steps

// 8 bits hold four fifths of the approach velocity, a tenth of the change; noise is below half of a
// step.
TEST(ClippedFlag, FiresOnAVelocityAtARailOfACoarseDigitiser) {
  for (const double noise : {0.0, 0.1, 0.3})
    for (const double sign : {1.0, -1.0}) {
      auto velocity = sampled({}, [&](double t) { return sign * bar_velocity(t); });
      for (double& value : velocity) value *= 127.0 / 0.4;
      add_noise(velocity, noise, 5);
      round_to(velocity, 1.0);
      for (double& value : velocity) value = std::clamp(value, -128.0, 127.0);
      EXPECT_TRUE(velocity_is_clipped(velocity)) << noise << " " << sign;
    }
}

// A false alarm in 8000 of velocities (24 000 shots), none of displacements.
TEST(ClippedFlag, IsSilentOnRandomShotsOfCoarseDigitisers) {
  int alarms = 0;
  for (std::uint64_t seed = 0; seed < 1200; ++seed) {
    const int bits = std::array{6, 8, 12}[seed % 3];
    const double noise = noises[seed / 3 % 6];
    const RandomShot shot = random_shot(seed, seed / 18 % 2 == 0);
    const double used = 0.2 + 0.75 * Noise(seed + 1000000).uniform();
    for (const auto quantity : {Quantity::velocity, Quantity::displacement}) {
      const auto& motion = quantity == Quantity::velocity ? shot.velocity : shot.displacement;
      if (is_clipped(shot, quantity, digitised(motion, bits, used, noise, seed))) ++alarms;
    }
  }
  EXPECT_LE(alarms, 1);
}

// Where the rail takes 9 to 38 % of the larger end; rails that take little of a crest are none.
TEST(ClippedFlag, FiresOnMostRandomShotsBeyondEightBits) {
  int velocities = 0, displacements = 0;
  constexpr int shots = 120;
  for (std::uint64_t seed = 0; seed < shots; ++seed) {
    const RandomShot shot = random_shot(seed, false);
    const double over = 1.1 + 0.5 * Noise(seed + 1000000).uniform();
    const auto recorded = [&](const std::vector<double>& motion) {
      return digitised(motion, 8, over, noises[seed % 4], seed);
    };
    velocities += is_clipped(shot, Quantity::velocity, recorded(shot.velocity));
    displacements += is_clipped(shot, Quantity::displacement, recorded(shot.displacement));
  }
  EXPECT_GT(velocities, 0.65 * shots);
  EXPECT_GT(displacements, 0.85 * shots);
}

// --- double hit ---------------------------------------------------------------------------------

TEST(DoubleHitFlag, FiresOnASecondContact) {
  const Sampling at;
  for (const double later : {0.21e-3, 0.3e-3, 1e-3, 2.5e-3})
    for (const double part : {0.06, 0.2, 0.6, 1.5}) {
      const Impact impact = impact_in(sampled(
          at, [&](double t) { return pulse(t) + half_sine(t - later, part * 1500.0, duration); }));
      EXPECT_TRUE(impact.has(ImpactFlag::double_hit)) << later << " " << part;
      EXPECT_NEAR(impact.end, duration, 3e-6) << later << " " << part;
      EXPECT_NEAR(impact.peak, 1500.0, 20.0) << later << " " << part;
    }
}

TEST(DoubleHitFlag, IsSilentBelowFivePercent) {
  const Sampling at;
  const Impact impact = impact_in(sampled(
      at, [&](double t) { return pulse(t) + half_sine(t - 1e-3, 0.03 * 1500.0, duration); }));
  EXPECT_FALSE(impact.has(ImpactFlag::double_hit));
}

// The response of a one-degree-of-freedom sensor to a half-sine (shared reference: ringing
// 2 r/(1 - r²) |cos(pi/2r)| of the peak after the pulse, r = 1/(2 f T)); added here as what is left
// after the pulse, in all phases.
TEST(DoubleHitFlag, IsSilentOnSensorRinging) {
  const Sampling at;
  for (const double frequency : {8e3, 11e3, 20e3, 45e3})
    for (const double part : {0.02, 0.1, 0.3})
      for (double phase = 0.0; phase < 2.0 * pi; phase += 0.5) {
        const Impact impact = impact_in(sampled(at, [&](double t) {
          if (t <= duration) return pulse(t);
          const double decay = std::exp(-pi * frequency / 20.0 * (t - duration));
          return part * 1500.0 * decay * std::sin(2.0 * pi * frequency * (t - duration) + phase);
        }));
        EXPECT_FALSE(impact.has(ImpactFlag::double_hit))
            << frequency << " " << part << " " << phase;
      }
}

TEST(DoubleHitFlag, IsSilentOnADroopingBaseline) {
  const Sampling at;
  const Impact impact = impact_in(sampled(at, [&](double t) {
    return pulse(t) - (t > duration ? 30.0 * std::exp(-(t - duration) / 5e-3) : 0.0);
  }));
  EXPECT_FALSE(impact.has(ImpactFlag::double_hit));
}

TEST(DoubleHitFlag, FiresOnASecondContactDuringRinging) {
  const Sampling at;
  const Impact impact = impact_in(sampled(at, [&](double t) {
    const double ringing = t > duration ? 100.0 * std::exp(-(t - duration) / 1e-3) *
                                              std::sin(2.0 * pi * 11e3 * (t - duration))
                                        : 0.0;
    return pulse(t) - ringing + half_sine(t - 1e-3, 600.0, duration);
  }));
  EXPECT_TRUE(impact.has(ImpactFlag::double_hit));
}

// --- too short ----------------------------------------------------------------------------------

TEST(TooShortFlag, FiresWhenTheRecordBeginsInsideThePulse) {
  for (const std::size_t samples : {300u, 4000u}) {
    const Sampling at{.start = 50e-6, .interval = 1e-6, .samples = samples};
    const Impact impact = impact_in(sampled(at, pulse), at);
    EXPECT_TRUE(impact.has(ImpactFlag::too_short)) << samples;
    EXPECT_EQ(impact.start, at.start) << samples;
  }
}

TEST(TooShortFlag, FiresWhenTheRecordEndsInsideThePulse) {
  for (const double begin : {-35e-6, -1e-3}) {
    const Sampling at{.start = begin,
                      .interval = 1e-6,
                      .samples = static_cast<std::size_t>((100e-6 - begin) / 1e-6)};
    const Impact impact = impact_in(sampled(at, pulse), at);
    EXPECT_TRUE(impact.has(ImpactFlag::too_short)) << begin;
    EXPECT_NEAR(impact.end, at.time(at.samples - 1), 1e-12) << begin;
  }
}

TEST(TooShortFlag, IsSilentWhenTheContactIsWholeAndTheWindowIsNot) {
  const Sampling at{.start = -60e-6, .interval = 1e-6, .samples = 300};
  EXPECT_FALSE(impact_in(sampled(at, pulse), at).has(ImpactFlag::too_short));
}

// --- dropout ------------------------------------------------------------------------------------

TEST(DropoutFlag, FiresOnInvalidSamplesWithinTheWindowOnly) {
  const Sampling at;
  auto force = force_of(at, sampled(at, pulse));
  force.valid.assign(at.samples, 1);
  force.valid[10] = 0;  // 990 us before touch; the window begins 500 us before
  EXPECT_FALSE(find_impacts(record_of({force})).at(0).has(ImpactFlag::dropout));
  force.valid[700] = 0;
  const auto impacts = find_impacts(record_of({force}));
  ASSERT_EQ(impacts.size(), 1u);
  EXPECT_TRUE(impacts[0].has(ImpactFlag::dropout));
  EXPECT_FALSE(impacts[0].has(ImpactFlag::clipped));
  ASSERT_EQ(impacts[0].force->valid.size(), impacts[0].force->values.size());
  EXPECT_EQ(std::ranges::count(impacts[0].force->valid, 0), 1);
}

TEST(DropoutFlag, FiresOnTheOtherChannelsToo) {
  const Sampling at;
  std::vector<double> velocity(at.samples, 0.441);
  velocity[1100] = std::numeric_limits<double>::quiet_NaN();
  const auto impacts =
      find_impacts(record_of({force_of(at, sampled(at, pulse)), velocity_of(at, velocity)}));
  ASSERT_EQ(impacts.size(), 1u);
  EXPECT_TRUE(impacts[0].has(ImpactFlag::dropout));
  for (const double value : impacts[0].velocity->values) EXPECT_EQ(value, 0.441);  // bridged
}

// The velocity turns round in the contact and swings on, which is none.
TEST(UnmarkedDropoutFlag, FiresWhereALaserLosesItsLight) {
  const Sampling at;
  const auto impact_with = [&](std::size_t lost, std::size_t first) {
    std::vector<double> velocity(at.samples);
    for (std::size_t i = 0; i < at.samples; ++i) {
      const double t = 1e-6 * (static_cast<double>(i) - 1000.0);
      const double turned = std::clamp(t / 300e-6, 0.0, 1.0);
      velocity[i] = 0.441 - 0.6 * std::pow(std::sin(1.5707963 * turned), 2) +
                    (t > 0.0 ? 0.05 * std::sin(2e4 * t) : 0.0) +
                    1e-3 * std::sin(7.1 * static_cast<double>(i * i % 997));
    }
    for (std::size_t i = first; i < first + lost; ++i) velocity[i] *= 0.02;
    return find_impacts(record_of({force_of(at, sampled(at, pulse)), velocity_of(at, velocity)}))
        .at(0);
  };
  EXPECT_FALSE(impact_with(0, 1100).has(ImpactFlag::unmarked_dropout));
  EXPECT_TRUE(impact_with(30, 1040).has(ImpactFlag::unmarked_dropout));  // in the contact
  EXPECT_TRUE(impact_with(30, 700).has(ImpactFlag::unmarked_dropout));
  EXPECT_FALSE(impact_with(30, 700).has(ImpactFlag::dropout));
}

// The shock takes the light from the first contact on; a bar that hits again is no reason to be
// silent of that, but is of what lies behind it.
TEST(UnmarkedDropoutFlag, FiresWhereTheShockTakesTheLightAndTheBarHitsAgain) {
  const Sampling at;
  const auto flagged = [&](std::size_t first, std::size_t lost) {
    auto velocity =
        sampled(at, [](double t) { return bar_velocity(t) + 0.3 * bar_velocity(t - 1e-3); });
    add_noise(velocity, 1e-3, 8);
    for (std::size_t i = first; i < first + lost; ++i) velocity[i] *= 0.02;
    const auto impacts = find_impacts(record_of(
        {force_of(at, sampled(at, [](double t) { return pulse(t) + 0.5 * pulse(t - 1e-3); })),
         velocity_of(at, velocity)}));
    EXPECT_EQ(impacts.size(), 1U);
    EXPECT_TRUE(impacts.at(0).has(ImpactFlag::double_hit));
    return impacts.at(0).has(ImpactFlag::unmarked_dropout);
  };
  EXPECT_FALSE(flagged(0, 0));
  for (const std::size_t lost : {40, 60, 80}) EXPECT_TRUE(flagged(1005, lost)) << lost;
}

// --- undersampled -------------------------------------------------------------------------------

TEST(UndersampledFlag, FiresBelowTwentySamples) {
  for (const double interval : {12e-6, 20e-6, 40e-6}) {
    const Sampling at{.start = -2e-3, .interval = interval, .samples = 500};
    EXPECT_TRUE(impact_in(sampled(at, pulse), at).has(ImpactFlag::undersampled)) << interval;
  }
}

TEST(UndersampledFlag, IsSilentAboveTwentySamples) {
  for (const double interval : {1e-6, 4e-6, 9e-6}) {
    const Sampling at{.start = -2e-3, .interval = interval, .samples = 4000};
    EXPECT_FALSE(impact_in(sampled(at, pulse), at).has(ImpactFlag::undersampled)) << interval;
  }
}

// --- multiple hits ------------------------------------------------------------------------------

TEST(MultipleHitsFlag, FiresFromTheThirdContactOn) {
  const Sampling at;
  for (const int hits : {1, 2, 3, 4}) {
    const Impact impact = impact_in(sampled(at, [&](double t) {
      double force = 0.0;
      for (int k = 0; k < hits; ++k) force += (k == 0 ? 1.0 : 0.4) * pulse(t - 0.5e-3 * k);
      return force;
    }));
    EXPECT_EQ(impact.has(ImpactFlag::double_hit), hits > 1) << hits;
    EXPECT_EQ(impact.has(ImpactFlag::multiple_hits), hits > 2) << hits;
  }
}

// --- missed start, truncated tail ---------------------------------------------------------------

TEST(TooShortFlag, SaysAtWhichEnd) {
  const Sampling late{.start = 40e-6, .interval = 1e-6, .samples = 4000};
  const Impact missed = impact_in(sampled(late, pulse), late);
  EXPECT_TRUE(missed.has(ImpactFlag::too_short));
  EXPECT_TRUE(missed.has(ImpactFlag::missed_start));
  EXPECT_FALSE(missed.has(ImpactFlag::truncated_tail));
  const Sampling short_one{.start = -1e-3, .interval = 1e-6, .samples = 1120};
  const Impact cut = impact_in(sampled(short_one, pulse), short_one);
  EXPECT_TRUE(cut.has(ImpactFlag::too_short));
  EXPECT_FALSE(cut.has(ImpactFlag::missed_start));
  EXPECT_TRUE(cut.has(ImpactFlag::truncated_tail));
  const Impact whole = impact_in(sampled(Sampling{}, pulse));
  EXPECT_FALSE(whole.has(ImpactFlag::missed_start) || whole.has(ImpactFlag::truncated_tail));
}

// --- noisy --------------------------------------------------------------------------------------

TEST(NoisyFlag, FiresAboveTwoPercent) {
  for (const double part : {0.002, 0.015, 0.025, 0.06})
    for (int seed = 1; seed <= 5; ++seed) {
      auto force = sampled(Sampling{}, pulse);
      add_noise(force, part * 1500.0, static_cast<std::uint64_t>(seed));
      const auto impacts = find_impacts(record_of({force_of(Sampling{}, force)}));
      ASSERT_EQ(impacts.size(), 1U);
      EXPECT_EQ(impacts[0].has(ImpactFlag::noisy), part > 0.02) << part << " " << seed;
    }
}

TEST(NoisyFlag, IsForTheVelocityToo) {
  const Sampling at;
  for (const double noise : {1e-3, 40e-3}) {
    auto velocity = sampled(at, [](double t) {
      return 0.44 - 0.3 * (1.0 - std::cos(pi * std::clamp(t / duration, 0.0, 1.0)));
    });
    add_noise(velocity, noise, 3);
    const auto impacts =
        find_impacts(record_of({force_of(at, sampled(at, pulse)), velocity_of(at, velocity)}));
    ASSERT_EQ(impacts.size(), 1U);
    EXPECT_EQ(impacts[0].has(ImpactFlag::noisy), noise > 0.01) << noise;
  }
}

// --- unsteady -----------------------------------------------------------------------------------

TEST(UnsteadyFlag, FiresOnDriftHumAndEarlierRinging) {
  // Each spans `part` of the peak within the 0.475 ms that are judged.
  const auto wandering = [](double part, int kind, double t) {
    if (kind == 0) return t < 0.0 ? part * 1500.0 * t / 0.475e-3 : 0.0;          // drift
    if (kind == 1) return part * 750.0 * std::sin(2.0 * pi * 1500.0 * t + 1.0);  // hum, ringing
    return t < 0.0 ? part * 1500.0 * std::exp(-std::max(0.0, t + 0.475e-3) / 0.1e-3)
                   : 0.0;  // decay
  };
  for (int kind = 0; kind < 3; ++kind)
    for (const double part : {0.0, 0.005, 0.04}) {
      const Impact impact = impact_in(
          sampled(Sampling{}, [&](double t) { return pulse(t) + wandering(part, kind, t); }));
      EXPECT_EQ(impact.has(ImpactFlag::unsteady), part > 0.02) << kind << " " << part;
    }
}

// A record that leans by 40 % of the peak, or has a fifth of a period of strong hum in it: the
// contact is none the less where it is.
TEST(UnsteadyFlag, IsOfARecordThatLeansToo) {
  for (const bool drifts : {true, false})
    for (const double sign : {1.0, -1.0})
      for (int phase = 0; phase < 8; ++phase) {
        if (drifts && phase > 0) continue;
        SCOPED_TRACE(testing::Message() << drifts << sign << " " << phase);
        auto force = sampled(Sampling{}, [&](double t) {
          const double hum = 0.2 * 1500.0 * std::sin(2.0 * pi * (50.0 * t + phase / 8.0));
          return pulse(t) + (drifts ? sign * 150e3 * t : sign * hum);
        });
        add_noise(force, 3.0, 5);
        const Impact impact = impact_in(force);
        EXPECT_FALSE(impact.has(ImpactFlag::missed_start));
        EXPECT_FALSE(impact.has(ImpactFlag::inverted));
        EXPECT_NEAR(impact.start, 0.0, 10e-6);
        EXPECT_NEAR(impact.peak / 1500.0, 1.0, 0.2);  // as high as the hum
      }
}

TEST(UnsteadyFlag, IsSilentOnNoise) {
  for (const double noise : {1.0, 20.0, 60.0})
    for (int seed = 1; seed <= 40; ++seed) {
      auto force = sampled(Sampling{}, pulse);
      add_noise(force, noise, static_cast<std::uint64_t>(seed));
      const auto impacts = find_impacts(record_of({force_of(Sampling{}, force)}));
      ASSERT_EQ(impacts.size(), 1U);
      EXPECT_FALSE(impacts[0].has(ImpactFlag::unsteady)) << noise << " " << seed;
    }
}

// --- baseline shift -----------------------------------------------------------------------------

TEST(BaselineShiftFlag, FiresWhereTheForceDoesNotComeBack) {
  for (const double part : {-0.04, -0.015, 0.0, 0.015, 0.04})
    for (const double decay : {2e-3, 1.0}) {
      const Impact impact = impact_in(sampled(Sampling{}, [&](double t) {
        const double after = t > duration ? part * 1500.0 * std::exp(-(t - duration) / decay) : 0.0;
        return pulse(t) + after;
      }));
      EXPECT_EQ(impact.has(ImpactFlag::baseline_shift), part != 0.0) << part << " " << decay;
    }
}

// A sensor that rings has a mean of zero, however much.
TEST(BaselineShiftFlag, IsSilentOnRinging) {
  for (const double frequency : {1e3, 3e3, 8e3, 20e3})
    for (const double part : {0.02, 0.1, 0.3}) {
      const Impact impact = impact_in(sampled(Sampling{}, [&](double t) {
        const double after = t > duration ? part * 1500.0 *
                                                std::exp(-(t - duration) * frequency * pi / 20.0) *
                                                -std::sin(2.0 * pi * frequency * (t - duration))
                                          : 0.0;
        return pulse(t) + after;
      }));
      EXPECT_FALSE(impact.has(ImpactFlag::baseline_shift)) << frequency << " " << part;
    }
}

// --- inverted -----------------------------------------------------------------------------------

TEST(InvertedFlag, FiresOnTensionAndOnABarThatLeaves) {
  const Sampling at;
  EXPECT_TRUE(impact_in(sampled(at, [](double t) { return -pulse(t); })).has(ImpactFlag::inverted));
  EXPECT_FALSE(impact_in(sampled(at, pulse)).has(ImpactFlag::inverted));
  for (const double sign : {1.0, -1.0}) {
    auto velocity = sampled(at, [&](double t) {
      return sign * (0.44 - 0.3 * (1.0 - std::cos(pi * std::clamp(t / duration, 0.0, 1.0))));
    });
    add_noise(velocity, 1e-3, 3);
    const auto impacts =
        find_impacts(record_of({force_of(at, sampled(at, pulse)), velocity_of(at, velocity)}));
    ASSERT_EQ(impacts.size(), 1U);
    EXPECT_EQ(impacts[0].has(ImpactFlag::inverted), sign < 0.0);
  }
}

// A record that begins late in the contact shows a bar that is on its way back already.
TEST(InvertedFlag, IsSilentWhereTheStartIsMissed) {
  for (const double part : {0.6, 0.7, 0.8}) {
    const Sampling at{.start = part * duration, .interval = 1e-6, .samples = 3000};
    auto velocity = sampled(at, [&](double t) {
      return 0.44 - 0.4 * (1.0 - std::cos(pi * std::clamp(t / duration, 0.0, 1.0)));
    });
    add_noise(velocity, 1e-3, 3);
    const auto impacts =
        find_impacts(record_of({force_of(at, sampled(at, pulse)), velocity_of(at, velocity)}));
    ASSERT_EQ(impacts.size(), 1U);
    EXPECT_TRUE(impacts[0].has(ImpactFlag::missed_start)) << part;
    EXPECT_FALSE(impacts[0].has(ImpactFlag::inverted)) << part;
  }
}

}  // namespace

}  // namespace impactrig::acquisition
