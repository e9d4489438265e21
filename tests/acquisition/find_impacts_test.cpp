// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "acquisition/conditioning/condition.hpp"
#include "tests/acquisition/half_sine_contact.hpp"
#include "tests/acquisition/scene.hpp"

namespace impactrig::acquisition {

namespace {

using datasets::Impact;
using datasets::Quantity;
using datasets::Record;
using namespace tests;

// Peak F, full width at half of it 2 T/3, impulse 2 F T/pi; the pulse begins between two samples.
TEST(FindImpacts, MeasuresAHalfSineByItsClosedForm) {
  const double begin = 0.3e-6;  // [s]
  const Sampling at;
  const auto impacts = find_impacts(record_of({force_of(
      at, sampled(at, [&](double t) { return half_sine(t - begin, 1500.0, duration); }))}));
  ASSERT_EQ(impacts.size(), 1u);
  const Impact& impact = impacts[0];
  EXPECT_NEAR(impact.start, begin, 1e-9);
  EXPECT_NEAR(impact.end, begin + duration, 1e-9);
  // The crest is at most half a step from a sample: 1 - cos(pi/2 h/T) = 3e-5.
  EXPECT_NEAR(impact.peak, 1500.0, 0.05);
  EXPECT_NEAR(impact.peak_time, begin + duration / 2, 0.5e-6);
  EXPECT_NEAR(impact.width, duration * 2.0 / 3.0, 1e-9);
  // The trapezoidal rule is short by (pi h/T)²/12 = 2e-5.
  EXPECT_NEAR(impact.impulse, 2.0 * 1500.0 * duration / pi, 3e-5 * impact.impulse);
  EXPECT_TRUE(impact.flags.empty());
  EXPECT_EQ(impact.recording, "shot.csv");
}

// An electric spike is one sample: no contact of a rig whose other one lasts 133.
TEST(FindImpacts, OverlooksSpikesBeforeTheContact) {
  const Sampling at;
  std::vector<double> force = sampled(at, [](double t) { return half_sine(t, 1500.0, duration); });
  add_noise(force, 1.0, 3);
  const auto plain = find_impacts(record_of({force_of(at, force)}));
  force[300] += 5000.0;
  force[700] -= 3000.0;
  const auto impacts = find_impacts(record_of({force_of(at, force)}));
  ASSERT_EQ(impacts.size(), 1u);
  // a bridged sample of the 500 before touch moves the baseline by a part of the noise
  EXPECT_NEAR(impacts[0].start, plain[0].start, 1e-10);
  EXPECT_NEAR(impacts[0].peak, plain[0].peak, 1.0 / 100);
  EXPECT_TRUE(impacts[0].has(datasets::ImpactFlag::dropout));
  ASSERT_TRUE(impacts[0].force);
  const auto& valid = impacts[0].force->valid;
  EXPECT_EQ(std::ranges::count(valid, 0), 1);  // the other one is before the window
}

// A single high sample with nothing longer beside it may be the contact itself.
TEST(FindImpacts, TakesALoneSampleWhereNothingLastsLonger) {
  const Sampling at;
  std::vector<double> force(at.samples, 0.0);
  add_noise(force, 1.0, 3);
  force[1500] += 2000.0;
  const auto impacts = find_impacts(record_of({force_of(at, force)}));
  ASSERT_EQ(impacts.size(), 1u);
  EXPECT_NEAR(impacts[0].peak_time, at.time(1500), 1e-9);
  // and a long one that is far lower is no contact of the same kind
  for (std::size_t i = 2000; i < 2200; ++i) force[i] += 100.0;
  EXPECT_NEAR(find_impacts(record_of({force_of(at, force)})).at(0).peak_time, at.time(1500), 1e-9);
}

// F sin² has the width T/2 and the impulse F T/2; its flat foot hides in the noise.
TEST(FindImpacts, MeasuresASineSquaredPulseInNoise) {
  const Sampling at;
  std::vector<double> force =
      sampled(at, [](double t) { return sine_squared(t, 1500.0, duration); });
  add_noise(force, 2.0, 7);
  const auto impacts = find_impacts(record_of({force_of(at, force)}));
  ASSERT_EQ(impacts.size(), 1u);
  // The foot leaves 3 sigma (0.4 % of the peak) after asin(sqrt(0.004))/pi = 2 % of T.
  EXPECT_NEAR(impacts[0].start, 0.0, 0.02 * duration);
  EXPECT_NEAR(impacts[0].end, duration, 0.02 * duration);
  EXPECT_NEAR(impacts[0].peak, 1500.0, 4.0 * 2.0);
  EXPECT_NEAR(impacts[0].width, duration / 2, 0.5e-6);
  EXPECT_NEAR(impacts[0].impulse, 1500.0 * duration / 2, 0.002 * 1500.0 * duration / 2);
}

// 300 records: unbiased to a tenth of the sample interval and of the noise.
TEST(FindImpacts, IsUnbiasedInNoise) {
  const double sigma = 5.0;  // [N]
  const Sampling at;
  const int runs = 300;
  double start = 0.0, start_squared = 0.0, impulse = 0.0, baseline = 0.0, noise = 0.0,
         correlation = 0.0;
  for (int seed = 1; seed <= runs; ++seed) {
    std::vector<double> force =
        sampled(at, [](double t) { return 20.0 + half_sine(t, 1500.0, duration); });
    add_noise(force, sigma, static_cast<std::uint64_t>(seed));
    const auto impacts = find_impacts(record_of({force_of(at, force)}));
    ASSERT_EQ(impacts.size(), 1u) << "seed " << seed;
    EXPECT_TRUE(impacts[0].flags.empty()) << "seed " << seed;
    start += impacts[0].start / runs;
    start_squared += impacts[0].start * impacts[0].start / runs;
    impulse += impacts[0].impulse / runs;
    baseline += impacts[0].force->baseline / runs;
    noise += impacts[0].force->noise / runs;
    correlation += impacts[0].force->noise_correlation / runs;
  }
  EXPECT_NEAR(start, 0.0, 0.25e-6);
  EXPECT_LT(std::sqrt(start_squared), 1e-6);
  EXPECT_NEAR(impulse, 2.0 * 1500.0 * duration / pi, 1e-4 * impulse);
  EXPECT_NEAR(baseline, 20.0, 0.1 * sigma);
  EXPECT_NEAR(noise, sigma, 0.01 * sigma);
  EXPECT_NEAR(correlation, 1.0, 0.1);
}

// A first-order recursion with time constant tau has (1 + r)/(1 - r) correlated samples,
// r = exp(-1/tau).
TEST(FindImpacts, ReportsCorrelatedNoise) {
  const double r = std::exp(-1.0 / 5.0);
  const Sampling at{.start = -4e-3, .interval = 1e-6, .samples = 6000};
  double correlation = 0.0, sigma = 0.0;
  const int runs = 40;
  for (int seed = 1; seed <= runs; ++seed) {
    Noise noise(static_cast<std::uint64_t>(seed));
    double state = 0.0;
    std::vector<double> force = sampled(at, [&](double t) {
      state = r * state + std::sqrt(1.0 - r * r) * noise();
      return 3.0 * state + half_sine(t, 1500.0, duration);
    });
    const auto impacts = find_impacts(record_of({force_of(at, force)}), {.pre_trigger = 3.5e-3});
    ASSERT_EQ(impacts.size(), 1u) << "seed " << seed;
    correlation += impacts[0].force->noise_correlation / runs;
    sigma += impacts[0].force->noise / runs;
  }
  EXPECT_NEAR(correlation, (1.0 + r) / (1.0 - r), 0.1 * (1.0 + r) / (1.0 - r));
  EXPECT_NEAR(sigma, 3.0, 0.03 * 3.0);
}

TEST(FindImpacts, DoesNotTurnANegativePulseRound) {
  const Sampling at;
  std::vector<double> force =
      sampled(at, [](double t) { return 100.0 - half_sine(t, 1500.0, duration); });
  add_noise(force, 5.0, 3);
  const auto impacts = find_impacts(record_of({force_of(at, force)}));
  ASSERT_EQ(impacts.size(), 1u);
  EXPECT_NEAR(impacts[0].peak, -1500.0, 20.0);
  EXPECT_NEAR(impacts[0].impulse, -2.0 * 1500.0 * duration / pi, 1e-3);
  EXPECT_GT(impacts[0].width, 0.0);
  EXPECT_LT(*std::ranges::min_element(impacts[0].force->values), -1480.0);
}

TEST(FindImpacts, TakesTheBaselineOffTheForceAndSaysSo) {
  const Sampling at;
  const auto impacts = find_impacts(record_of({force_of(
      at, sampled(at, [](double t) { return 100.0 + half_sine(t, 1500.0, duration); }))}));
  ASSERT_EQ(impacts.size(), 1u);
  EXPECT_NEAR(impacts[0].force->baseline, 100.0, 1e-9);
  EXPECT_NEAR(impacts[0].force->values.front(), 0.0, 1e-9);
  EXPECT_NEAR(impacts[0].peak, 1500.0, 0.05);
}

// Hum of 5 N at 50 Hz changes by 1.6 N/ms; a constant baseline would be wrong by several times the
// noise of 0.1 N, and first touch would be looked for in the middle of the quiet part.
TEST(FindImpacts, FollowsHumUpToFirstTouch) {
  const Sampling at;
  for (const double phase : {0.0, 1.0, 2.0, 3.0, 4.0, 5.0}) {
    std::vector<double> force = sampled(at, [&](double t) {
      return 5.0 * std::sin(100.0 * pi * t + phase) + half_sine(t, 1500.0, duration);
    });
    add_noise(force, 0.1, 11);
    const auto impacts = find_impacts(record_of({force_of(at, force)}));
    ASSERT_EQ(impacts.size(), 1u) << "phase " << phase;
    EXPECT_NEAR(impacts[0].start, 0.0, 1e-6) << "phase " << phase;
    EXPECT_NEAR(impacts[0].force->baseline, 5.0 * std::sin(phase), 0.2) << "phase " << phase;
  }
}

// A vibration of 10 % of the peak lifts the force before touch by more than its noise, whatever its
// phase there.
TEST(FindImpacts, FindsTheTouchOfAForceThatVibratesBefore) {
  const Sampling at;
  for (const double frequency : {1500.0, 2500.0, 4000.0})
    for (int k = 0; k < 8; ++k) {
      std::vector<double> force = sampled(at, [&](double t) {
        return half_sine(t, 1500.0, duration) +
               150.0 * std::sin(2.0 * pi * frequency * t + 0.25 * pi * k);
      });
      add_noise(force, 3.0, 5);
      const auto impacts = find_impacts(record_of({force_of(at, force)}));
      ASSERT_FALSE(impacts.empty()) << frequency << ' ' << k;
      EXPECT_NEAR(impacts[0].start, 0.0, 5e-6) << frequency << ' ' << k;  // 2.5 % of the contact
    }
}

TEST(FindImpacts, CutsTheWindowToTheOptionsAndTheRecord) {
  const Sampling at{.start = -1e-3, .interval = 1e-6, .samples = 4000};
  const Record record = record_of({force_of(
      at, sampled(at, [](double t) { return half_sine(t - 0.3e-6, 1500.0, duration); }))});
  const auto inside = find_impacts(record, {.pre_trigger = 0.25e-3, .post_trigger = 1e-3});
  ASSERT_EQ(inside.size(), 1u);
  EXPECT_NEAR(inside[0].force->start, -249e-6, 1e-12);  // the first sample after -249.7 us
  EXPECT_EQ(inside[0].force->values.size(), 1250u);
  const auto beyond = find_impacts(record, {.pre_trigger = 1.0, .post_trigger = 1.0});
  ASSERT_EQ(beyond.size(), 1u);
  EXPECT_EQ(beyond[0].force->start, at.start);
  EXPECT_EQ(beyond[0].force->values.size(), at.samples);
}

// A soft contact takes longer than what is kept of others: cut in the middle, a fit told nothing of
// e. What is stated is kept to.
TEST(FindImpacts, KeepsAsLongAfterALongContactAsItTook) {
  const Sampling at{.start = -10e-3, .interval = 20e-6, .samples = 4000};
  for (const double length : {1e-3, 2.4e-3, 4e-3, 16e-3}) {
    const Record record = record_of({force_of(
        at, sampled(at, [&](double t) { return half_sine(t - 0.3e-6, 1500.0, length); }))});
    const auto kept = [&](const DetectionOptions& options) {
      const auto impacts = find_impacts(record, options);
      const auto& force = impacts.at(0).force;
      return force->time(force->values.size() - 1);
    };
    EXPECT_NEAR(kept({}), std::max(5e-3, 2.0 * length), 40e-6) << length;
    EXPECT_NEAR(kept({.post_trigger = 3e-3}), 3e-3, 40e-6) << length;
  }
}

// A force that stays after the impact, to the end of a long record, is no contact of that length.
TEST(FindImpacts, KeepsNoWholeRecordOfAForceThatStays) {
  const Sampling at{.start = -10e-3, .interval = 20e-6, .samples = 20000};
  const Record record =
      record_of({force_of(at, sampled(at, [](double t) {
                            const double stays = t > 0.0 ? 300.0 * (1.0 + std::exp(-t / 0.2)) : 0.0;
                            return half_sine(t, 1500.0, 4e-3) + stays;
                          }))});
  const auto impacts = find_impacts(record);
  ASSERT_EQ(impacts.size(), 1U);
  EXPECT_TRUE(impacts[0].has(datasets::ImpactFlag::truncated_tail));
  EXPECT_LT(impacts[0].force->values.size(), 2000U);  // 40 ms
}

// Noise is judged by what lies before touch: 0.5 ms of it are ten samples at 20 kHz, and as few
// that tell something of their own behind a low-pass.
TEST(FindImpacts, KeepsMoreBeforeTouchOfSlowAndOfFilteredChannels) {
  const Sampling slow{.start = -30e-3, .interval = 50e-6, .samples = 1000};
  const Sampling fast{.start = -30e-3, .interval = 1e-6, .samples = 50000};
  const auto pulse = [](double t) { return half_sine(t - 0.3e-6, 1500.0, 5.0 * duration); };
  const auto before = [](const Record& record) {
    const auto impacts = find_impacts(record);
    return impacts.at(0).start - impacts.at(0).force->start;
  };
  EXPECT_NEAR(before(record_of({force_of(fast, sampled(fast, pulse))})), 0.5e-3, 2e-6);
  EXPECT_NEAR(before(record_of({force_of(slow, sampled(slow, pulse))})), 10e-3, 100e-6);
  Record filtered = record_of({force_of(fast, sampled(fast, pulse))});
  filtered.provenance.edits.push_back({"low-pass, zero phase",
                                       filtered.channels[0].name,
                                       {{"cutoff", "20000 Hz"}, {"order", "4"}}});
  EXPECT_NEAR(before(filtered), 5e-3, 2e-6);
  const Sampling slowest{.start = -300e-3, .interval = 0.5e-3, .samples = 1000};
  const auto long_pulse = [](double t) { return half_sine(t - 1e-6, 1500.0, 100.0 * duration); };
  EXPECT_NEAR(before(record_of({force_of(slowest, sampled(slowest, long_pulse))})), 50e-3, 1e-3);
}

TEST(FindImpacts, CutsChannelsOfDifferentClocksToTheSameWindow) {
  const Sampling fast, slow{.start = -0.99987e-3, .interval = 4e-6, .samples = 1000};
  const auto impacts = find_impacts(
      record_of(
          {velocity_of(slow, sampled(slow, bounce)),
           force_of(fast, sampled(fast, [](double t) { return half_sine(t, 1500.0, duration); }))}),
      {.pre_trigger = 0.5e-3, .post_trigger = 1e-3});
  ASSERT_EQ(impacts.size(), 1u);
  ASSERT_TRUE(impacts[0].velocity);
  EXPECT_GE(impacts[0].velocity->start, impacts[0].start - 0.5e-3);
  EXPECT_LT(impacts[0].velocity->start, impacts[0].start - 0.5e-3 + 4e-6);
  EXPECT_EQ(impacts[0].velocity->interval, 4e-6);
  const auto& velocity = *impacts[0].velocity;
  EXPECT_NEAR(velocity.time(velocity.values.size() - 1), 1e-3, 4e-6);
}

TEST(FindImpacts, SeesTheDigitiserStep) {
  const double step = 10000.0 / 4096.0;  // 12 bits over ±5 kN
  const Sampling at;
  std::vector<double> force = sampled(at, [](double t) { return half_sine(t, 1500.0, duration); });
  add_noise(force, 1.0, 5);
  const auto unrounded = find_impacts(record_of({force_of(at, force)}));
  round_to(force, step);
  const auto rounded = find_impacts(record_of({force_of(at, force)}));
  ASSERT_EQ(unrounded.size(), 1u);
  ASSERT_EQ(rounded.size(), 1u);
  EXPECT_EQ(unrounded[0].force->quantum, 0.0);
  EXPECT_NEAR(rounded[0].force->quantum, step, 1e-9);
  // Sheppard: rounding adds step²/12 to the variance.
  EXPECT_NEAR(rounded[0].force->noise, std::sqrt(1.0 + step * step / 12.0), 0.12);
}

TEST(FindImpacts, TellsSeparateImpacts) {
  const Sampling at{.start = -1e-3, .interval = 1e-6, .samples = 20000};
  std::vector<double> force = sampled(at, [](double t) {
    return half_sine(t, 1500.0, duration) + half_sine(t - 8e-3, 700.0, duration);
  });
  add_noise(force, 5.0, 3);
  const auto impacts = find_impacts(record_of({force_of(at, force)}));
  ASSERT_EQ(impacts.size(), 2u);
  EXPECT_NEAR(impacts[0].start, 0.0, 2e-6);
  EXPECT_NEAR(impacts[1].start, 8e-3, 2e-6);
  EXPECT_NEAR(impacts[1].peak, 700.0, 20.0);
  EXPECT_TRUE(impacts[0].flags.empty());
  EXPECT_TRUE(impacts[1].flags.empty());
  const auto cut = find_impacts(record_of({force_of(at, force)}),
                                {.pre_trigger = 20e-3, .post_trigger = 7.9e-3});
  ASSERT_EQ(cut.size(), 2u);  // windows end and begin at the neighbour
  const auto& first = *cut[0].force;
  EXPECT_LT(first.time(first.values.size() - 1), cut[1].start);
  EXPECT_GE(cut[1].force->start, cut[0].end);
}

// The paper's kind of record: 300 samples, 35 of them before touch, the pulse takes two thirds.
TEST(FindImpacts, FindsAPulseThatFillsItsRecord) {
  for (const double before : {35e-6, 50e-6, 90e-6}) {
    const Sampling at{.start = -before, .interval = 1e-6, .samples = 300};
    std::vector<double> force =
        sampled(at, [](double t) { return half_sine(t, 1500.0, duration); });
    add_noise(force, 20.0, 3);
    const auto impacts = find_impacts(record_of({force_of(at, force)}));
    ASSERT_EQ(impacts.size(), 1u) << before;
    EXPECT_NEAR(impacts[0].start, 0.0, 4e-6) << before;
    EXPECT_NEAR(impacts[0].end, duration, 4e-6) << before;
    EXPECT_NEAR(impacts[0].impulse, 2.0 * 1500.0 * duration / pi, 0.01 * impacts[0].impulse);
    EXPECT_TRUE(impacts[0].flags.empty()) << before;
  }
}

TEST(FindImpacts, FindsAPulseWithoutAnyQuietPartBefore) {
  const Sampling at{.start = 0.0, .interval = 1e-6, .samples = 4000};
  std::vector<double> force = sampled(at, [](double t) { return half_sine(t, 1500.0, duration); });
  add_noise(force, 5.0, 3);
  const auto impacts = find_impacts(record_of({force_of(at, force)}));
  ASSERT_EQ(impacts.size(), 1u);
  EXPECT_NEAR(impacts[0].start, 0.0, 2e-6);
  EXPECT_NEAR(impacts[0].force->noise, 5.0, 1.0);
  EXPECT_NEAR(impacts[0].force->baseline, 0.0, 1.0);
}

// Of 200 samples at 5 us, 0 to 8 of the record before touch: their foot is no level. 90 records.
TEST(FindImpacts, MeasuresAPulseThatBeginsWithItsRecord) {
  constexpr double lasts = 1e-3;
  for (const int before : {0, 1, 2, 3, 4, 5, 6, 7, 8}) {
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      const double touch = (before + 0.1 * static_cast<double>(seed - 1)) * 5e-6;
      const Sampling at{.start = -touch, .interval = 5e-6, .samples = 460};
      auto force = sampled(at, [](double t) { return half_sine(t, 100.0, lasts); });
      add_noise(force, 0.3, seed);
      const auto impacts = find_impacts(record_of({force_of(at, force)}));
      ASSERT_EQ(impacts.size(), 1u) << before << ' ' << seed;
      const double impulse = 100.0 * lasts * 2.0 / std::numbers::pi;
      EXPECT_NEAR(impacts[0].impulse / impulse, 1.0, 0.02) << before << ' ' << seed;
      EXPECT_NEAR(impacts[0].start, 0.0, 20e-6) << before << ' ' << seed;
    }
  }
}

// An amplifier that drifts by 8 % to 120 % of the peak over 40 ms, 10 ms of them before touch.
TEST(FindImpacts, FindsAPulseOnASteadyDrift) {
  for (const double lasts : {0.3e-3, 1e-3})
    for (const double slope :
         {-30.0, -5.0, 2.0, 5.0, 7.5, 9.0, 15.0, 30.0}) {  // % of peak in 10 ms
      const Sampling at{.start = -10e-3, .interval = 2e-6, .samples = 20000};
      auto force = sampled(at, [&](double t) {
        return sine_squared(t, 500.0, lasts) + slope * 5.0 * (t + 10e-3) / 10e-3;
      });
      add_noise(force, 0.25, 5);
      const auto impacts = find_impacts(record_of({force_of(at, force)}));
      ASSERT_EQ(impacts.size(), 1u) << slope;
      EXPECT_NEAR(impacts[0].impulse / (0.5 * 500.0 * lasts), 1.0, 0.005) << slope;
      EXPECT_NEAR(impacts[0].peak, 500.0, 1.5) << slope;
      EXPECT_NEAR(impacts[0].start, 0.0, 0.05 * lasts) << slope;
    }
}

// An amplifier on its way back: 5 % to 40 % of the peak at first, of time constants from a contact
// to half of the record.
TEST(FindImpacts, FindsAPulseOnADecay) {
  constexpr double lasts = 1e-3;
  for (const double time : {2e-3, 5e-3, 20e-3})
    for (const double part : {-0.4, -0.1, 0.05, 0.1, 0.4}) {
      const Sampling at{.start = -8e-3, .interval = 2e-6, .samples = 20000};
      auto force = sampled(at, [&](double t) {
        return sine_squared(t, 500.0, lasts) + part * 500.0 * std::exp(-(t + 8e-3) / time);
      });
      add_noise(force, 0.5, 7);
      const auto impacts = find_impacts(record_of({force_of(at, force)}));
      ASSERT_EQ(impacts.size(), 1u) << time << ' ' << part;
      EXPECT_NEAR(impacts[0].impulse / (0.5 * 500.0 * lasts), 1.0, 0.01) << time << ' ' << part;
      EXPECT_NEAR(impacts[0].start, 0.0, 0.1 * lasts) << time << ' ' << part;
    }
}

TEST(FindImpacts, TakesTheThresholdTheUserStates) {
  const Sampling at;
  std::vector<double> force = sampled(at, [](double t) {
    return half_sine(t, 40.0, duration) + half_sine(t - 1e-3, 1500.0, duration);
  });
  add_noise(force, 1.0, 3);
  const Record record = record_of({force_of(at, force)});
  // 5 % of 1500 N is above the first touch of 40 N.
  EXPECT_NEAR(find_impacts(record).at(0).start, 1e-3, 2e-6);
  EXPECT_NEAR(find_impacts(record, {.threshold = 20.0}).at(0).start, 0.0, 4e-6);
  EXPECT_TRUE(find_impacts(record, {.threshold = 2000.0}).empty());
}

TEST(FindImpacts, PrefersForceThenAccelerationThenVelocity) {
  const Sampling at;
  const auto pulse = [&](double begin) {
    return sampled(at, [=](double t) { return half_sine(t - begin, 1500.0, duration); });
  };
  const auto velocity = velocity_of(at, sampled(at, bounce));
  const auto acceleration = channel_of("Acc", Quantity::acceleration, at, pulse(0.4e-3));
  const auto force = force_of(at, pulse(0.8e-3));
  EXPECT_NEAR(find_impacts(record_of({velocity, acceleration, force})).at(0).start, 0.8e-3, 1e-9);
  EXPECT_NEAR(find_impacts(record_of({velocity, acceleration})).at(0).start, 0.4e-3, 1e-9);
  EXPECT_NEAR(find_impacts(record_of({velocity})).at(0).start, 0.0, 2e-6);
  EXPECT_NEAR(find_impacts(record_of({velocity, acceleration, force}), {.trigger_channel = "Acc"})
                  .at(0)
                  .start,
              0.4e-3, 1e-9);
}

TEST(FindImpacts, ConvertsTheTriggerToSi) {
  const Sampling at;
  auto force = force_of(at, sampled(at, [](double t) { return half_sine(t, 1.5, duration); }));
  force.unit = "kN";
  const auto impacts = find_impacts(record_of({force}));
  ASSERT_EQ(impacts.size(), 1u);
  EXPECT_NEAR(impacts[0].peak, 1500.0, 0.1);
}

TEST(FindImpacts, CarriesCalibrationAndDelay) {
  const Sampling at;
  auto force = force_of(at, sampled(at, [](double t) { return half_sine(t, 1500.0, duration); }));
  force.calibration = {4e-3, 8e-5, "V", "N", "certificate"};
  force.delay = {2e-6, 1e-7, true};
  const auto impacts = find_impacts(record_of({force}));
  ASSERT_EQ(impacts.size(), 1u);
  EXPECT_NEAR(impacts[0].force->gain_uncertainty, 0.02, 1e-12);
  EXPECT_EQ(impacts[0].force->delay, 2e-6);
  EXPECT_EQ(impacts[0].force->delay_uncertainty, 1e-7);
}

}  // namespace

}  // namespace impactrig::acquisition
