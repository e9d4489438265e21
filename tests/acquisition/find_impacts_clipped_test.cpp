// SPDX-License-Identifier: BSD-3-Clause
// Clipped forces and motions, and sound ones that look like them.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "acquisition/conditioning/condition.hpp"
#include "tests/acquisition/half_sine_contact.hpp"
#include "tests/acquisition/scene.hpp"

namespace impactrig::acquisition {

namespace {

using datasets::Impact;
using datasets::ImpactFlag;
using datasets::Quantity;
using namespace tests;

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

/// Noise of a part of the approach velocity, behind whatever the shot has been through.
bool is_clipped_in_noise(const RandomShot& shot, double rail, double noise, std::uint64_t seed) {
  auto velocity = shot.velocity;
  for (double& value : velocity) value = std::clamp(value, -rail, rail);
  add_noise(velocity, noise, seed + 7777);
  return is_clipped(shot, Quantity::velocity, std::move(velocity));
}

// A limiter in front of a digitiser whose noise hides its steps. Rails that take a fifth of the
// approach or more, and hardly any noise behind a rounded rail.
TEST(ClippedFlag, FiresOnAVelocityAtARailWithNoiseBehindIt) {
  constexpr int shots = 200;
  for (const double rail : {0.8, 0.6})
    for (const double noise : {1e-3, 3e-3}) {
      int told = 0;
      for (std::uint64_t seed = 0; seed < shots; ++seed)
        told += is_clipped_in_noise(random_shot(seed, false), rail, noise, seed);
      EXPECT_GT(told, 0.75 * shots) << rail << " " << noise;
    }
}

// Forces that begin with a jump too, and velocities that are shown 3 us late.
TEST(ClippedFlag, IsSilentOnRandomShotsInNoise) {
  int alarms = 0;
  for (const double noise : {2e-4, 1e-3, 3e-3, 1e-2})
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
      RandomShot shot = random_shot(seed, seed % 2 == 0);
      const std::size_t late = seed % 4 < 2 ? 3 : 0;
      shot.velocity.insert(shot.velocity.begin(), late, shot.velocity.front());
      shot.velocity.resize(shot_sampling.samples);
      alarms += is_clipped_in_noise(shot, 9.0, noise, seed);
    }
  EXPECT_LE(alarms, 1);
}

// Forces that begin with a jump beside a velocity that is shown late, and such that end with one
// beside an early one: it is level, and leaves at once, while the force acts.
TEST(ClippedFlag, IsSilentOnAVelocityThatIsLateOrEarly) {
  int late = 0, early = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const std::size_t delay = std::array<std::size_t, 3>{10, 20, 50}[seed % 3];
    RandomShot shot = random_shot(seed, true);
    shot.velocity.insert(shot.velocity.begin(), delay, shot.velocity.front());
    shot.velocity.resize(shot_sampling.samples);
    late += is_clipped_in_noise(shot, 9.0, 1e-3, seed);
    shot = random_shot(seed, true);
    std::ranges::reverse(shot.force);
    std::ranges::reverse(shot.velocity);
    for (double& value : shot.velocity) value = -value;
    shot.velocity.erase(shot.velocity.begin(),
                        shot.velocity.begin() + static_cast<std::ptrdiff_t>(delay));
    shot.velocity.resize(shot_sampling.samples, shot.velocity.back());
    early += is_clipped_in_noise(shot, 9.0, 1e-3, seed);
  }
  EXPECT_EQ(late, 0);
  EXPECT_EQ(early, 0);
}

}  // namespace

}  // namespace impactrig::acquisition
