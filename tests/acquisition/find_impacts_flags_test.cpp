// SPDX-License-Identifier: BSD-3-Clause
// Every flag but clipped: scenes where it must fire, and the nearest ones where it must not.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "acquisition/conditioning/condition.hpp"
#include "tests/acquisition/half_sine_contact.hpp"
#include "tests/acquisition/scene.hpp"

namespace impactrig::acquisition {

namespace {

using datasets::Impact;
using datasets::ImpactFlag;
using namespace tests;

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

TEST(DropoutFlag, FiresOnAMotionThatIsDead) {
  const Sampling at;
  const auto flagged = [&](std::vector<double> velocity) {
    return find_impacts(record_of({force_of(at, sampled(at, pulse)), velocity_of(at, velocity)}))
        .at(0)
        .has(ImpactFlag::dropout);
  };
  std::vector<double> velocity(at.samples, 0.0);
  EXPECT_TRUE(flagged(velocity));
  velocity[1150] = 1e-3;
  EXPECT_FALSE(flagged(velocity));
  EXPECT_FALSE(flagged(sampled(at, bar_velocity)));
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

// What is on the crest is no rest, and that it falls to one no rail.
TEST(MissedStartFlag, FiresWhereTheRecordBeginsAtTheCrest) {
  for (double part = 0.36; part < 0.5; part += 0.01) {
    SCOPED_TRACE(part);
    const Sampling at{.start = part * duration, .interval = 1e-6, .samples = 3000};
    constexpr double noise = 5.0;
    const Impact impact = impact_in(
        sampled(at,
                [](double t) {
                  return t < duration ? 1000.0 * std::pow(std::sin(pi * t / duration), 2) : 0.0;
                }),
        at, noise);
    EXPECT_TRUE(impact.has(ImpactFlag::missed_start));
    EXPECT_FALSE(impact.has(ImpactFlag::inverted));
    EXPECT_NEAR(impact.peak, 1000.0, 4.0 * noise);
  }
}

// Microseconds taken for seconds: no sample lies within milliseconds of touch.
TEST(FindImpacts, ShowsSamplesOfAContactWhoseTimesAreInAnotherUnit) {
  const Sampling at{.start = -500.0, .interval = 1.0, .samples = 4000};
  const Impact impact = impact_in(sampled(at, [](double t) { return pulse(1e-6 * t); }), at);
  ASSERT_TRUE(impact.force);
  EXPECT_GE(impact.force->values.size(), 8U);
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

TEST(UnsteadyFlag, FiresOnAnAccelerationToo) {
  for (const double slope : {0.0, 50e3, 150e3}) {  // [1/s], of a peak of 1500
    auto values = sampled(Sampling{}, [&](double t) { return pulse(t) + slope * t; });
    const auto impacts = find_impacts(record_of(
        {channel_of("Acc", datasets::Quantity::acceleration, Sampling{}, std::move(values))}));
    ASSERT_EQ(impacts.size(), 1U);
    EXPECT_EQ(impacts[0].has(ImpactFlag::unsteady), slope > 100e3) << slope;
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

/// Behind an amplifier with a low cut of first order of a hundredth of the contact's frequency a
/// force comes to lie below zero, by 3 to 4 % of the peak at the contact's end.
datasets::Record shot_behind_low_cut(double length, double noise, std::uint64_t seed) {
  const Sampling at{.start = -length, .interval = length / 400.0, .samples = 2400};
  double below = 0.0;
  auto force = sampled(at, [&](double t) {
    const double pushed = half_sine(t, 1500.0, length) - below;
    below += 2.0 * pi * 0.01 / length * at.interval * pushed;
    return pushed;
  });
  add_noise(force, noise * 1500.0, seed);
  return record_of({force_of(at, force)});
}

// Noise of the single samples hides little of it.
TEST(BaselineShiftFlag, FiresBelowTheNoiseOfSingleSamplesToo) {
  for (const double length : {0.5e-3, 2e-3, 16e-3})
    for (const double noise : {1e-3, 1e-2, 2e-2})
      for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        const auto impacts = find_impacts(shot_behind_low_cut(length, noise, seed));
        ASSERT_EQ(impacts.size(), 1U);
        EXPECT_TRUE(impacts[0].has(ImpactFlag::baseline_shift))
            << length << " " << noise << " " << seed;
      }
}

// A prediction goes through the low cut that is stated; of half of it, it says nothing.
TEST(BaselineShiftFlag, IsSilentOnTheLowCutThatIsStated) {
  for (const double length : {0.5e-3, 16e-3})
    for (const double part : {1.0, 0.5}) {
      auto record = shot_behind_low_cut(length, 1e-3, 1);
      record.channels[0].attributes["sensor.low_cut"] = std::to_string(part * 0.01 / length);
      EXPECT_EQ(find_impacts(record).at(0).has(ImpactFlag::baseline_shift), part < 1.0)
          << length << " " << part;
    }
}

TEST(BaselineShiftFlag, IsSilentOnNoise) {
  for (const double noise : {1e-3, 1e-2, 3e-2})
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
      auto force = sampled(Sampling{}, pulse);
      add_noise(force, noise * 1500.0, seed);
      EXPECT_FALSE(impact_in(std::move(force)).has(ImpactFlag::baseline_shift))
          << noise << " " << seed;
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
