// SPDX-License-Identifier: BSD-3-Clause
// Forces with spikes, or samples that a recorder lost, and sound ones that look like it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "acquisition/conditioning/condition.hpp"
#include "acquisition/conditioning/glitches.hpp"
#include "tests/acquisition/half_sine_contact.hpp"
#include "tests/acquisition/scene.hpp"

namespace impactrig::acquisition {

namespace {

using datasets::Impact;
using datasets::ImpactFlag;
using namespace tests;

// A recorder loses samples of a pulse, or makes them up. What was there is left out and told.
TEST(FindImpacts, OverlooksGlitchesOfAPulse) {
  const Sampling at;
  for (const std::size_t samples : {1, 2, 3, 20})
    for (const double instead : {0.0, 4500.0, -800.0})
      for (const double noise : {0.0, 2.0})
        for (const double time : {30e-6, 100e-6, 160e-6}) {
          Noise random(1);
          std::vector<double> force = sampled(at, pulse);
          for (double& value : force) value += noise * random();
          const auto first = static_cast<std::size_t>(std::lround((time - at.start) / at.interval));
          const Impact sound = find_impacts(record_of({force_of(at, force)})).at(0);
          for (std::size_t k = 0; k < samples; ++k) force[first + k] = instead;
          const Impact impact = find_impacts(record_of({force_of(at, std::move(force))})).at(0);
          EXPECT_TRUE(impact.has(ImpactFlag::dropout)) << time << " " << instead;
          EXPECT_FALSE(impact.has(ImpactFlag::double_hit)) << time << " " << instead;
          EXPECT_NEAR(impact.end, sound.end, 2e-6) << time << " " << instead;
          EXPECT_NEAR(impact.peak, sound.peak, 0.03 * sound.peak + 4.0 * noise);
        }
}

// Sound ones: ringing of the sensor, a force that jumps, clipping, contacts of few samples.
TEST(FindImpacts, TakesNothingSharpForAGlitch) {
  const Sampling at;
  const auto glitches = [&](auto&& force, double noise) {
    Noise random(2);
    Trace trace;
    trace.start = at.start;
    trace.interval = at.interval;
    trace.values = sampled(at, force);
    for (double& value : trace.values) value += noise * random();
    return find_glitches(trace, 0.0).size();
  };
  for (const double noise : {0.0, 2.0, 50.0}) {
    EXPECT_EQ(glitches(pulse, noise), 0U);
    EXPECT_EQ(glitches([](double t) { return half_sine(t, 1500.0, 20e-6); }, noise), 0U);
    EXPECT_EQ(glitches([](double t) { return half_sine(t, 1500.0, 4e-6); }, noise), 0U);
    EXPECT_EQ(glitches([](double t) { return std::min(pulse(t), 1200.0); }, noise), 0U);
    for (const double rings : {50e3, 120e3, 250e3, 400e3})
      EXPECT_EQ(glitches(
                    [=](double t) {
                      return pulse(t) +
                             (t > 0.0 ? 600.0 * std::sin(2.0 * std::numbers::pi * rings * t) *
                                            std::exp(-t / 100e-6)
                                      : 0.0);
                    },
                    noise),
                0U)
          << rings;
    // to another level, as where a second bar comes in
    EXPECT_EQ(
        glitches([](double t) { return pulse(t) + (t > 60e-6 && t < duration ? 700.0 : 0.0); },
                 noise),
        0U);
    // dampers jump at touch and where they let go
    EXPECT_EQ(
        glitches([](double t) { return t < 0.0 || t > duration ? 0.0 : 700.0 - 3e6 * t; }, noise),
        0U);
    EXPECT_EQ(glitches([](double t) { return pulse(t) + pulse(t - duration - 3e-6); }, noise), 0U);
  }
}

// Electric spikes of more samples on a pulse, whose course they shift.
TEST(FindImpacts, OverlooksSquareSpikesOnAPulse) {
  const Sampling at;
  for (const std::size_t samples : {5, 9, 14})
    for (const double height : {900.0, -450.0})
      for (const double time : {30e-6, 90e-6, 160e-6}) {
        std::vector<double> force = sampled(at, pulse);
        add_noise(force, 1.0, 4);
        const Impact sound = find_impacts(record_of({force_of(at, force)})).at(0);
        const auto first = static_cast<std::size_t>(std::lround((time - at.start) / at.interval));
        for (std::size_t k = 0; k < samples; ++k) force[first + k] += height;
        const Impact impact = find_impacts(record_of({force_of(at, std::move(force))})).at(0);
        SCOPED_TRACE(testing::Message() << samples << " samples of " << height << " at " << time);
        EXPECT_TRUE(impact.has(ImpactFlag::dropout));
        EXPECT_FALSE(impact.has(ImpactFlag::double_hit));
        EXPECT_NEAR(impact.peak, sound.peak, 0.02 * sound.peak);
      }
}

// A sound record of a digitiser whose noise hardly leaves one value. 20 of each.
TEST(FindImpacts, TakesNoToggledStepForAGlitch) {
  const Sampling at;
  const auto clean = sampled(at, pulse);
  for (const double step : {0.1, 1.0, 12.0})
    for (const double noise : {0.0, 0.05, 0.1, 0.2, 0.3, 0.5, 1.0}) {
      int lost = 0;
      for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        auto force = clean;
        add_noise(force, noise * step, seed);
        round_to(force, step);
        lost += find_impacts(record_of({force_of(at, force)})).at(0).has(ImpactFlag::dropout);
      }
      EXPECT_EQ(lost, 0) << "noise of " << noise << " steps of " << step << " N";
    }
}

// Of a clock so fast that 300 us are more samples than can be counted.
TEST(FindImpacts, FindsGlitchesByAnyClock) {
  const Sampling at;
  Trace trace;
  trace.interval = 1e-300;
  trace.values = sampled(at, pulse);
  std::fill_n(trace.values.begin() + 1100, 5, 0.0);
  EXPECT_EQ(find_glitches(trace, 0.0).size(), 5U);
}

// A spike of three samples as of one: the contact lasts 133.
TEST(FindImpacts, OverlooksSpikesOfAFewSamples) {
  const Sampling at;
  for (const std::size_t samples : {1, 2, 3})
    for (const double height : {3000.0, -700.0, 450.0}) {
      std::vector<double> force = sampled(at, pulse);
      add_noise(force, 1.0, 3);
      const auto plain = find_impacts(record_of({force_of(at, force)}));
      for (std::size_t i = 0; i < samples; ++i) force[700 + i] += height;
      const auto impacts = find_impacts(record_of({force_of(at, force)}));
      SCOPED_TRACE(testing::Message() << samples << " samples of " << height << " N");
      ASSERT_EQ(impacts.size(), 1u);
      EXPECT_NEAR(impacts[0].start, plain.at(0).start, 1e-9);
      EXPECT_NEAR(impacts[0].peak, plain.at(0).peak, 0.1);
      EXPECT_TRUE(impacts[0].has(ImpactFlag::dropout));
      EXPECT_FALSE(impacts[0].has(ImpactFlag::double_hit));
      EXPECT_EQ(std::ranges::count(impacts[0].force->valid, 0), static_cast<long>(samples));
    }
}

// More samples on end, that begin and end at once: no contact does.
TEST(FindImpacts, OverlooksSquareSpikes) {
  const Sampling at;
  for (const std::size_t samples : {5, 8, 12})
    for (const double height : {3000.0, -700.0, 750.0})
      for (const std::size_t begin : {600U, 880U, 1600U}) {
        std::vector<double> force = sampled(at, pulse);
        add_noise(force, 1.0, 3);
        const auto plain = find_impacts(record_of({force_of(at, force)}));
        for (std::size_t i = 0; i < samples; ++i) force[begin + i] += height;
        const auto impacts = find_impacts(record_of({force_of(at, force)}));
        SCOPED_TRACE(testing::Message()
                     << samples << " samples of " << height << " N at " << begin);
        ASSERT_EQ(impacts.size(), 1u);
        EXPECT_NEAR(impacts[0].start, plain.at(0).start, 1e-8);
        EXPECT_NEAR(impacts[0].peak, plain.at(0).peak, 0.1);
        EXPECT_TRUE(impacts[0].has(ImpactFlag::dropout));
        EXPECT_FALSE(impacts[0].has(ImpactFlag::double_hit));
      }
}

// Spikes of other shapes, before touch and behind a contact of 200 samples and more: a sample on
// each edge, up and down, a tail, ringing.
TEST(FindImpacts, OverlooksSpikesOfAnyShape) {
  const Sampling at;
  const std::vector<std::vector<double>> shapes = {{0.4, 1.0, 1.0, 1.0, 1.0, 0.3},
                                                   {1.0, 1.0, 1.0, -1.0, -1.0, -1.0},
                                                   {1.0, 0.7, 0.5, 0.35, 0.25, 0.17, 0.12},
                                                   {1.0, -0.7, 0.5, -0.35, 0.25, -0.17, 0.12}};
  for (std::size_t shape = 0; shape < shapes.size(); ++shape)
    for (const double height : {3000.0, -900.0})
      for (const std::size_t begin : {600U, 1600U}) {
        std::vector<double> force = sampled(at, pulse);
        add_noise(force, 1.0, 3);
        const auto plain = find_impacts(record_of({force_of(at, force)}));
        for (std::size_t i = 0; i < shapes[shape].size(); ++i)
          force[begin + i] += height * shapes[shape][i];
        const auto impacts = find_impacts(record_of({force_of(at, force)}));
        SCOPED_TRACE(testing::Message()
                     << "shape " << shape << ", " << height << " N at " << begin);
        ASSERT_EQ(impacts.size(), 1u);
        EXPECT_NEAR(impacts[0].start, plain.at(0).start, 1e-8);
        EXPECT_NEAR(impacts[0].peak, plain.at(0).peak, 0.1);
        EXPECT_TRUE(impacts[0].has(ImpactFlag::dropout));
        EXPECT_FALSE(impacts[0].has(ImpactFlag::double_hit));
        EXPECT_FALSE(impacts[0].has(ImpactFlag::undersampled));
      }
}

// A sensor that rings by little more than half a step of six bits: pulses of one step, some samples
// long, each by itself. 100 records.
TEST(FindImpacts, TakesNoRingingInStepsForSpikes) {
  const Sampling at;
  for (const double step : {70.0, 110.0})
    for (int k = 0; k < 50; ++k) {
      auto force = sampled(at, [&](double t) {
        const double rings = t > duration ? std::sin(2.0 * std::numbers::pi * 45e3 * t) : 0.0;
        return pulse(t) + step * (0.5 + 0.01 * k) * rings * std::exp(-(t - duration) / 150e-6);
      });
      add_noise(force, 0.5, static_cast<std::uint64_t>(k + 1));
      round_to(force, step);
      const auto impacts = find_impacts(record_of({force_of(at, force)}));
      ASSERT_FALSE(impacts.empty());
      for (const Impact& impact : impacts)
        EXPECT_FALSE(impact.has(ImpactFlag::dropout)) << step << " N, " << 0.5 + 0.01 * k;
    }
}

// Contacts of fewer samples than a spike may have: each is the contact all the same.
TEST(FindImpacts, OverlooksASpikeBesideAShortContact) {
  struct Shot {
    double interval, contact;
  };

  for (const Shot& shot : {Shot{2e-6, 133e-6}, Shot{5e-6, 200e-6}, Shot{1e-6, 60e-6}})
    for (const double spike : {-0.3e-3, 0.7e-3}) {
      const Sampling at{.start = -1e-3, .interval = shot.interval, .samples = 3000};
      auto force = sampled(at, [&](double t) { return half_sine(t, 1500.0, shot.contact); });
      add_noise(force, 1.0, 3);
      const auto plain = find_impacts(record_of({force_of(at, force)}));
      force[static_cast<std::size_t>(std::lround((spike - at.start) / shot.interval))] += 900.0;
      const auto impacts = find_impacts(record_of({force_of(at, force)}));
      SCOPED_TRACE(testing::Message()
                   << shot.interval << " s, " << shot.contact << " s, spike at " << spike);
      ASSERT_EQ(impacts.size(), 1u);
      EXPECT_NEAR(impacts[0].start, plain.at(0).start, 0.1 * shot.interval);
      EXPECT_NEAR(impacts[0].peak, plain.at(0).peak, 1.0);
      EXPECT_TRUE(impacts[0].has(ImpactFlag::dropout));
      EXPECT_FALSE(impacts[0].has(ImpactFlag::double_hit));
    }
}

// More spikes than can be counted on two hands, before and behind.
TEST(FindImpacts, OverlooksManySpikes) {
  const Sampling at{.start = -10e-3, .interval = 1e-6, .samples = 40000};
  auto force = sampled(at, pulse);
  add_noise(force, 1.0, 3);
  const auto plain = find_impacts(record_of({force_of(at, force)}));
  for (std::size_t i = 300; i < force.size(); i += 97)
    if (i < 9900 || i > 10300) force[i] += 900.0;
  const auto impacts = find_impacts(record_of({force_of(at, force)}));
  ASSERT_EQ(impacts.size(), 1u);
  EXPECT_NEAR(impacts[0].start, plain.at(0).start, 1e-7);
  EXPECT_NEAR(impacts[0].peak, plain.at(0).peak, 1.0);
}

// What is sharp after a contact and no spike: ringing of few samples a period, a touch whose force
// jumps, a digitiser's steps.
TEST(FindImpacts, TakesNothingSharpForASpike) {
  const Sampling at;
  const auto lost_in = [&](std::vector<double> force) {
    const auto impacts = find_impacts(record_of({force_of(at, std::move(force))}));
    EXPECT_FALSE(impacts.empty());
    return std::ranges::any_of(impacts, [](const Impact& i) { return i.has(ImpactFlag::dropout); });
  };
  for (const double period : {2.0, 3.0, 4.0, 5.0, 7.0, 10.0, 22.0})
    for (const double decay : {1.0, 4.0, 30.0}) {
      std::vector<double> force = sampled(at, pulse);
      for (std::size_t i = 1200; i < force.size(); ++i) {
        const double n = static_cast<double>(i - 1200) + 0.3;
        force[i] +=
            400.0 * std::sin(2.0 * std::numbers::pi * n / period) * std::exp(-n / (decay * period));
      }
      add_noise(force, 1.0, 3);
      EXPECT_FALSE(lost_in(force)) << period << " samples, decay " << decay;
    }
  for (const std::size_t samples : {16U, 24U, 40U}) {
    std::vector<double> force = sampled(at, pulse);
    for (std::size_t i = 0; i < samples; ++i) {
      const double s = static_cast<double>(i) / static_cast<double>(samples);
      force[1500 + i] += 600.0 * (1.0 - s * s);
    }
    add_noise(force, 1.0, 3);
    EXPECT_FALSE(lost_in(force)) << "a jump, then " << samples << " samples";
  }
  std::vector<double> force = sampled(at, pulse);
  add_noise(force, 10.0, 3);
  round_to(force, 200.0);
  EXPECT_FALSE(lost_in(force));
}

}  // namespace

}  // namespace impactrig::acquisition
