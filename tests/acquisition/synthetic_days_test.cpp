// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/synthetic.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "acquisition/conditioning/condition.hpp"
#include "tests/acquisition/scene.hpp"
#include "tests/acquisition/synthetic_motion.hpp"

namespace impactrig::acquisition {

namespace {

using datasets::ImpactFlag;
using datasets::Record;
using namespace tests;

SensorSet paper_sensors() {
  SensorSet sensors = all_sensors();
  sensors.force->channel = "Force";
  sensors.force->sensitivity = {4e-3, 4e-5};  // 4 pC/N at 1 mV/pC
  sensors.force->recorded_unit = "V";
  sensors.force->resonance = {45e3, 20.0};
  sensors.force->low_cut = {0.3, 1};
  sensors.force->high_cut = {100e3, 2};
  sensors.force->delay = {0.1e-6, 0.1e-6, false};
  sensors.force->range = 5000.0;
  sensors.velocity->channel = "Velocity";
  sensors.velocity->sensitivity = {8.0, 0.08};  // 125 mm/s/V
  sensors.velocity->recorded_unit = "V";
  sensors.velocity->high_cut = {250e3, 4};
  sensors.velocity->delay = {0.4e-6, 0.1e-6, false};
  return sensors;
}

TEST(GoodLaboratoryDay, HasTheNumbersOfTheMeasurementChain) {
  const SyntheticOptions day = good_laboratory_day(paper_sensors(), {height, approach});
  // 1.25 times 1500 N are 7.5 V at 4 mV/N: the 10 V range, 2500 N.
  EXPECT_DOUBLE_EQ(day.force.range, 2500.0);
  EXPECT_EQ(day.force.bits, 12);
  const double step = 2500.0 / 2048.0;
  EXPECT_NEAR(day.force.noise, std::hypot(0.0025, 0.764 * step), 1e-9);
  EXPECT_NEAR(day.force.drift, 0.0075, 1e-12);  // 0.03 pC/s
  EXPECT_NEAR(day.force.hum, 2.5, 1e-12);
  // 0.551 m/s are 4.4 V at 8 V s/m: the 5 V range.
  EXPECT_DOUBLE_EQ(day.velocity.range, 0.625);
  EXPECT_NEAR(day.velocity.noise, std::hypot(1e-6 * std::sqrt(250e3), 0.764 * 0.625 / 2048.0),
              1e-12);
  EXPECT_DOUBLE_EQ(day.velocity.low_frequency_noise, 40e-6);
  // 0.441 m/s for 3 ms are 1.3 mm: the decoder range of ±2.56 mm.
  EXPECT_DOUBLE_EQ(day.displacement.range, 2560e-6);
}

TEST(GoodLaboratoryDay, LimitsTheRangeToTheSensors) {
  EXPECT_EQ(good_laboratory_day(paper_sensors(), {4900.0, approach}).force.range, 5000.0);
}

// Of a crawling bar the vibrometer shows hardly more than its noise, 0.5 mm/s.
TEST(GoodLaboratoryDay, HasRoomForNoise) {
  const double range = good_laboratory_day(paper_sensors(), {height, 1e-3}).velocity.range;
  EXPECT_DOUBLE_EQ(range, 0.05 / 8.0);  // 1.25 (1 + 4 * 0.5) mm/s are 30 mV: the 50 mV range
}

// A resonance of 45 kHz doubles a step of force nearly: 1 + exp(-pi / (2 Q)) of it.
TEST(GoodLaboratoryDay, RecordsWhatAResonanceAddsToAStep) {
  SensorSet sensors = paper_sensors();
  sensors.force->high_cut = {2e6, 2};
  sensors.force->low_cut.reset();
  Trajectory step = usual_trajectory();
  std::ranges::fill(step.force, 0.0);
  const auto first = static_cast<std::ptrdiff_t>(std::round(-step.start / step.interval));
  std::fill(step.force.begin() + first, step.force.end(), height);
  const ShownPeaks peaks = shown_peaks(step, sensors);
  EXPECT_NEAR(peaks.force, (1.0 + std::exp(-pi / 40.0)) * height, 1e-3 * height);
  EXPECT_NEAR(peaks.velocity, approach, 1e-3 * approach);
  const Record record = synthesise(step, sensors, good_laboratory_day(sensors, peaks));
  const datasets::Channel& force = record.channels[0];
  double largest = 0.0;
  for (std::size_t i = 0; i < force.size(); ++i) largest = std::max(largest, force.value(i));
  EXPECT_NEAR(largest, 4e-3 * peaks.force, 0.05 * 4e-3 * peaks.force);
  EXPECT_LT(largest, 4e-3 * good_laboratory_day(sensors, peaks).force.range * 2047.0 / 2048.0);
}

TEST(GoodLaboratoryDay, IsReadBackByConditioningAndDetection) {
  const SensorSet sensors = paper_sensors();
  const Trajectory trajectory = usual_trajectory();
  SyntheticOptions day = good_laboratory_day(sensors, {height, approach});
  for (day.seed = 1; day.seed <= 50; ++day.seed) {
    SCOPED_TRACE("seed " + std::to_string(day.seed));
    const Record record = synthesise(trajectory, sensors, day);
    const auto impacts = find_impacts(condition(record, sensors));
    ASSERT_EQ(impacts.size(), 1u);
    const auto& impact = impacts[0];
    const double touch = std::stod(record.attributes.at("truth.first_touch"));
    EXPECT_TRUE(impact.flags.empty());
    // The low-pass shows it 2.25 us late, and the foot of a sine-squared leaves one standard
    // deviation (1 N) after 0.8 % of T, two digitiser steps after 2 %.
    EXPECT_NEAR(impact.start, touch + 2.25e-6 + 0.01 * duration, 4e-6);
    EXPECT_NEAR(impact.peak, 1.005 * height, 0.01 * height);  // gain error, resonance
    EXPECT_NEAR(impact.impulse, 1.005 * height * duration / 2, 0.01 * height * duration / 2);
    // Gain 0.5 %, offset and hum 0.1 % of 0.625 m/s each.
    EXPECT_NEAR(impact.approach_velocity, approach, 0.005 * approach + 2.3 * 0.625e-3);
    EXPECT_NEAR(impact.force->noise, std::hypot(day.force.noise, 2500.0 / 2048.0 / std::sqrt(12.0)),
                0.15 * impact.force->noise);
    EXPECT_NEAR(impact.force->quantum, 2500.0 / 2048.0, 1e-6);
    EXPECT_NEAR(impact.force->gain_uncertainty, 0.01, 1e-12);
    EXPECT_EQ(impact.force->delay, 0.1e-6);
    EXPECT_EQ(impact.velocity->delay_uncertainty, 0.1e-6);
  }
}

TEST(BadDay, IsStillReadBackRoughly) {
  const SensorSet sensors = paper_sensors();
  const Trajectory trajectory = usual_trajectory();
  SyntheticOptions day = bad_day(sensors, {height, approach});
  EXPECT_EQ(day.force.bits, 8);
  EXPECT_EQ(day.trigger_jitter, 1.0);
  for (day.seed = 1; day.seed <= 50; ++day.seed) {
    SCOPED_TRACE("seed " + std::to_string(day.seed));
    const auto impacts = find_impacts(condition(synthesise(trajectory, sensors, day), sensors));
    ASSERT_EQ(impacts.size(), 1u);
    EXPECT_FALSE(impacts[0].has(ImpactFlag::clipped));
    EXPECT_FALSE(impacts[0].has(ImpactFlag::double_hit));
    // Between the ground-loop step at touch and the delayed force.
    EXPECT_GT(impacts[0].start, -15e-6);
    EXPECT_LT(impacts[0].start, 45e-6);
    EXPECT_NEAR(impacts[0].peak, 1.02 * height, 0.08 * height);
    EXPECT_NEAR(impacts[0].approach_velocity, approach, 0.1 * approach);
  }
}

}  // namespace

}  // namespace impactrig::acquisition
