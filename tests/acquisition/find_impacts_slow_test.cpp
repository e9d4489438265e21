// SPDX-License-Identifier: BSD-3-Clause
// Contacts whose foot is slow beside the window that tells the level before them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include "acquisition/conditioning/condition.hpp"
#include "tests/acquisition/half_sine_contact.hpp"
#include "tests/acquisition/scene.hpp"

namespace impactrig::acquisition {

namespace {

using datasets::Impact;
using datasets::ImpactFlag;
using namespace tests;

constexpr double height = 500.0;               // [N]
const Sampling slow_rig{-10e-3, 2e-6, 20000};  // 40 ms

std::vector<Impact> impacts_of(const std::function<double(double)>& force, double noise,
                               std::uint64_t seed) {
  std::vector<double> values = sampled(slow_rig, force);
  add_noise(values, noise * height, seed);
  return find_impacts(record_of({force_of(slow_rig, std::move(values))}));
}

// The impulse of F sin² is F T/2. The foot that noise of 1 % hides, a sixteenth of T at either end,
// has 0.1 % of it; as much again may come from a level that noise has moved.
TEST(FindImpacts, MeasuresASlowPulseInNoise) {
  for (const double duration : {1.5e-3, 3e-3, 5e-3, 8e-3})
    for (const double noise : {0.001, 0.003, 0.01, 0.017})
      for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        SCOPED_TRACE(testing::Message() << duration << " " << noise << " " << seed);
        const auto impacts =
            impacts_of([&](double t) { return sine_squared(t, height, duration); }, noise, seed);
        ASSERT_EQ(impacts.size(), 1U);
        EXPECT_NEAR(impacts[0].impulse / (0.5 * height * duration), 1.0, 0.02);
        EXPECT_NEAR(impacts[0].start, 0.0, 0.1 * duration);
        EXPECT_NEAR(impacts[0].end, duration, 0.1 * duration);
        EXPECT_FALSE(impacts[0].has(ImpactFlag::double_hit));
        EXPECT_FALSE(impacts[0].has(ImpactFlag::baseline_shift));
      }
}

// Of a part p of the height, sin² is cut from t₁ = T/π asin √p on; its impulse is
// F (t₁ - T sin(2π t₁/T)/(2π)) + p F (T - 2 t₁).
TEST(FindImpacts, MeasuresASlowPulseThatIsCut) {
  for (const double duration : {1.5e-3, 3e-3, 8e-3})
    for (const double part : {0.4, 0.6, 0.9})
      for (const double noise : {0.0003, 0.003}) {
        SCOPED_TRACE(testing::Message() << duration << " " << part << " " << noise);
        const auto impacts = impacts_of(
            [&](double t) { return std::min(sine_squared(t, height, duration), part * height); },
            noise, 3);
        ASSERT_EQ(impacts.size(), 1U);
        const double cut = duration / pi * std::asin(std::sqrt(part));
        const double flanks = cut - duration * std::sin(2.0 * pi * cut / duration) / (2.0 * pi);
        const double impulse = height * (flanks + part * (duration - 2.0 * cut));
        EXPECT_NEAR(impacts[0].impulse / impulse, 1.0, 0.02);
        EXPECT_NEAR(impacts[0].start, 0.0, 0.1 * duration);
      }
}

// A drift goes on below the whole contact: 20 % of the peak in the 20 ms of the record, or less.
TEST(FindImpacts, TakesADriftOffASlowPulse) {
  constexpr double duration = 4e-3;
  for (const double slope : {-0.1, -0.02, 0.02, 0.1}) {
    SCOPED_TRACE(slope);
    const auto impacts = impacts_of(
        [&](double t) {
          return sine_squared(t, height, duration) + slope * height * (t - slow_rig.start) / 10e-3;
        },
        0.001, 5);
    ASSERT_EQ(impacts.size(), 1U);
    EXPECT_NEAR(impacts[0].impulse / (0.5 * height * duration), 1.0, 0.02);
  }
}

// A drift that passes the threshold long before touch, and goes on behind.
TEST(FindImpacts, MeasuresAPulseOnADriftThatCrossesTheThreshold) {
  for (const double duration : {1e-3, 2e-3, 4e-3})
    for (const double slope : {-0.07, 0.06, 0.07}) {
      SCOPED_TRACE(testing::Message() << duration << " " << slope);
      const auto impacts = impacts_of(
          [&](double t) {
            return half_sine(t, height, duration) + slope * height * (t - slow_rig.start) / 10e-3;
          },
          0.003, 5);
      ASSERT_EQ(impacts.size(), 1U);
      EXPECT_NEAR(impacts[0].start, 0.0, 0.02 * duration);
      EXPECT_NEAR(impacts[0].peak / height, 1.0, 0.02);
      EXPECT_NEAR(impacts[0].impulse / (2.0 / pi * height * duration), 1.0, 0.02);
    }
}

// The record is quiet, the bar is let go and vibrates, and touches 4 ms later: no foot of the
// pulse.
TEST(FindImpacts, KeepsTheTouchOfABarThatVibratesSinceItWasLetGo) {
  constexpr double duration = 1e-3, let_go = -4e-3;
  for (const double part : {0.015, 0.02})
    for (const double frequency : {600.0, 700.0, 900.0, 1400.0, 1700.0, 1900.0}) {
      SCOPED_TRACE(testing::Message() << part << " " << frequency);
      const auto impacts = impacts_of(
          [&](double t) {
            const double vibration = std::sin(2.0 * pi * frequency * (t - let_go));
            return half_sine(t, height, duration) + (t > let_go ? part * height * vibration : 0.0);
          },
          0.001, 5);
      ASSERT_EQ(impacts.size(), 1U);
      EXPECT_NEAR(impacts[0].start, 0.0, 0.15 * duration);
      EXPECT_NEAR(impacts[0].peak / height, 1.0,
                  2.0 * part + 0.005);  // at the peak and before, noise
    }
}

/// Of a bar that meets a soft stop at 0.5 m/s, which throws it back at half of that.
double slowed_down(double t, double duration) {
  const double part = std::clamp(t / duration, 0.0, 1.0);
  return 0.5 - 0.75 * 0.5 * (1.0 - std::cos(pi * part));
}

// A velocity alone was only looked through for what changes it within 5 ms.
TEST(FindImpacts, FindsASlowChangeOfAVelocityAlone) {
  const Sampling at{-50e-3, 20e-6, 10000};
  for (const double duration : {1e-3, 5e-3, 8e-3, 16e-3, 40e-3})
    for (const double noise : {0.0005, 0.005}) {
      SCOPED_TRACE(testing::Message() << duration << " " << noise);
      std::vector<double> values = sampled(at, [&](double t) { return slowed_down(t, duration); });
      add_noise(values, noise, 3);
      const auto impacts = find_impacts(record_of({velocity_of(at, std::move(values))}));
      ASSERT_EQ(impacts.size(), 1U);
      EXPECT_NEAR(impacts[0].start, 0.0, 0.12 * duration);
      EXPECT_NEAR(impacts[0].end, duration, 0.12 * duration);
      EXPECT_NEAR(impacts[0].peak, -0.75, 0.02);
      EXPECT_NEAR(impacts[0].approach_velocity, 0.5, 0.01);
    }
}

// A bar that is let go sets off as sharply, from rest.
TEST(FindImpacts, FindsNothingInABarThatIsLetGoSlowly) {
  const Sampling at{-50e-3, 20e-6, 20000};
  for (const double frequency : {0.5, 0.8, 1.2})
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      std::vector<double> values = sampled(
          at, [&](double t) { return t > 0.0 ? 0.5 * std::sin(2.0 * pi * frequency * t) : 0.0; });
      add_noise(values, 0.01, seed);
      EXPECT_TRUE(find_impacts(record_of({velocity_of(at, std::move(values))})).empty())
          << frequency << " " << seed;
    }
}

// 200 samples before touch of a slow recorder are longer than hum takes to rise: its crest, of 4
// ms, is no foot of a contact of six samples. Touch is known to the 16 samples that tell the level.
TEST(FindImpacts, TakesNoCrestOfHumForTheFootOfAShortContact) {
  constexpr double duration = 0.4e-3;
  const Sampling at{-20e-3, 62.5e-6, 640};
  for (int phase = 0; phase < 16; ++phase) {
    SCOPED_TRACE(phase);
    std::vector<double> values = sampled(at, [&](double t) {
      return half_sine(t, height, duration) +
             0.0015 * height * std::sin(2.0 * pi * (50.0 * t + phase / 16.0));
    });
    add_noise(values, 0.0004 * height, 11);
    const auto impacts = find_impacts(record_of({force_of(at, std::move(values))}));
    ASSERT_EQ(impacts.size(), 1U);
    EXPECT_NEAR(impacts[0].start, 0.0, 16.5 * at.interval);
  }
}

// What rises before touch may be hum, level for a while before that: no foot where it had risen and
// fallen by as much already.
TEST(FindImpacts, TakesNoSmallHumForTheFootOfASlowContact) {
  constexpr double duration = 25e-3;
  const Sampling at{-20e-3, 10e-6, 10000};
  for (const double part : {0.001, 0.002, 0.004})
    for (int phase = 0; phase < 16; ++phase) {
      SCOPED_TRACE(testing::Message() << part << " " << phase);
      std::vector<double> values = sampled(at, [&](double t) {
        return half_sine(t, height, duration) +
               part * height * std::sin(2.0 * pi * (50.0 * t + phase / 16.0));
      });
      add_noise(values, 0.0005 * height, 11);
      const auto impacts = find_impacts(record_of({force_of(at, std::move(values))}));
      ASSERT_EQ(impacts.size(), 1U);
      EXPECT_NEAR(impacts[0].start, 0.0, 0.02 * duration);
    }
}

// Vibration that passes the threshold of 5 % of the peak was the impact, and the contact one of its
// further hits, or not told at all.
TEST(FindImpacts, FindsTheContactOfABarThatVibratesByMoreThanTheThreshold) {
  constexpr double duration = 0.8e-3;
  for (const double let_go : {-2e-3, -9e-3})
    for (const double part : {0.06, 0.1, 0.14})
      for (const double frequency : {900.0, 1700.0, 2900.0}) {
        SCOPED_TRACE(testing::Message() << let_go << " " << part << " " << frequency);
        const auto impacts = impacts_of(
            [&](double t) {
              const double vibration = std::sin(2.0 * pi * frequency * (t - let_go));
              const double left = t < 0.0 ? 1.0 : std::exp(-4.0 * t / duration);
              return half_sine(t, height, duration) +
                     (t > let_go ? part * height * left * vibration : 0.0);
            },
            0.001, 5);
        ASSERT_EQ(impacts.size(), 1U);
        EXPECT_NEAR(impacts[0].start, 0.0, 0.5 / frequency);
        EXPECT_NEAR(impacts[0].peak / height, 1.0, 1.1 * part);
        EXPECT_FALSE(impacts[0].has(ImpactFlag::double_hit));
      }
}

// A weak contact rings, but not both ways alike until the next.
TEST(FindImpacts, KeepsAWeakContactBeforeAStrongOne) {
  constexpr double duration = 0.8e-3;
  for (const double part : {0.06, 0.1, 0.18})
    for (const double ringing : {0.1, 0.4})
      for (const double before : {3e-3, 7e-3}) {
        SCOPED_TRACE(testing::Message() << part << " " << ringing << " " << before);
        const auto impacts = impacts_of(
            [&](double t) {
              const double since = t + before - duration;
              const double rings = since > 0.0 ? ringing * std::exp(-since / 2e-3) *
                                                     std::sin(2.0 * pi * 9000.0 * since)
                                               : 0.0;
              return half_sine(t, height, duration) +
                     part * (half_sine(t + before, height, duration) + rings * height);
            },
            0.001, 5);
        ASSERT_FALSE(impacts.empty());
        EXPECT_NEAR(impacts[0].start, -before, 0.1 * duration);
        EXPECT_NEAR(impacts[0].peak / height, part, 0.1 * part);
      }
}

/// Of 1.6 ms.
std::vector<Impact> impacts_in_hum(double frequency, double phase) {
  return impacts_of(
      [&](double t) {
        return sine_squared(t, height, 1.6e-3) +
               0.08 * height * std::sin(2.0 * pi * (frequency * t + phase));
      },
      0.001, 7);
}

// What the record follows but for the pulse is known over its whole time.
TEST(FindImpacts, MeasuresASlowPulseInMainsHum) {
  for (const double frequency : {50.0, 60.0})
    for (int phase = 0; phase < 32; ++phase) {
      const auto impacts = impacts_in_hum(frequency, phase / 32.0);
      ASSERT_EQ(impacts.size(), 1U) << phase;
      EXPECT_NEAR(impacts[0].impulse / (0.5 * height * 1.6e-3), 1.0, 0.02) << phase;
    }
}

// Vibration is level for a baseline's window at its crests, and is not for the time of a slow
// contact.
TEST(UnsteadyFlag, FiresOnVibrationThatMovesTheImpulse) {
  constexpr double duration = 1.6e-3;
  int moved = 0;
  for (int phase = 0; phase < 32; ++phase) {
    const auto impacts = impacts_in_hum(80.0, phase / 32.0);
    ASSERT_FALSE(impacts.empty());
    if (std::abs(impacts[0].impulse / (0.5 * height * duration) - 1.0) < 0.05) continue;
    ++moved;
    EXPECT_FALSE(impacts[0].flags.empty()) << phase;
  }
  EXPECT_GT(moved, 2);
}

}  // namespace

}  // namespace impactrig::acquisition
