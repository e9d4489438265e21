// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/synthetic.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "acquisition/conditioning/condition.hpp"
#include "acquisition/random_stream.hpp"
#include "datasets/sensor_response.hpp"
#include "tests/acquisition/scene.hpp"

namespace impactrig::acquisition {

namespace {

using datasets::Channel;
using datasets::ImpactFlag;
using datasets::Quantity;
using datasets::Record;
using datasets::Sensor;
using namespace tests;

constexpr double pi = std::numbers::pi;
constexpr double height = 1500.0;      // [N]
constexpr double duration = 200e-6;    // [s]
constexpr double approach = 0.441;     // [m/s]
constexpr double fine_step = 0.05e-6;  // [s]

/// Sine-squared force and the velocity it gives a mass whose restitution is 0.5, from -50 us on.
Trajectory trajectory_until(double end) {
  Trajectory t;
  t.start = -50e-6;
  t.interval = fine_step;
  const auto n = static_cast<std::size_t>(std::round((end - t.start) / fine_step)) + 1;
  for (std::size_t i = 0; i < n; ++i) {
    const double time = t.start + fine_step * static_cast<double>(i);
    const double u = std::clamp(time / duration, 0.0, 1.0);
    const double gone = u - std::sin(2.0 * pi * u) / (2.0 * pi);  // of the impulse
    const double way = u * u / 2 + (std::cos(2.0 * pi * u) - 1.0) / (4.0 * pi * pi);
    const double after = std::max(0.0, time - duration);
    t.force.push_back(sine_squared(time, height, duration));
    t.velocity.push_back(approach * (1.0 - 1.5 * gone));
    t.displacement.push_back(approach * (time - 1.5 * (way * duration + after)));
  }
  return t;
}

Trajectory usual_trajectory() {
  return trajectory_until(3.2e-3);
}

/// One that does nothing, for looking at disturbances.
Trajectory nothing(double seconds) {
  const double step = 1e-5;
  const auto n = static_cast<std::size_t>(seconds / step) + 100;
  return {0.0, step, std::vector<double>(n, 0.0), std::vector<double>(n, 0.0),
          std::vector<double>(n, 0.0)};
}

Sensor sensor_of(Quantity quantity) {
  Sensor sensor;
  sensor.quantity = quantity;
  return sensor;
}

SensorSet force_only() {
  return {.force = sensor_of(Quantity::force)};
}

SensorSet all_sensors() {
  return {.force = sensor_of(Quantity::force),
          .velocity = sensor_of(Quantity::velocity),
          .displacement = sensor_of(Quantity::displacement)};
}

SyntheticOptions still() {
  SyntheticOptions options;
  options.trigger_jitter = 0.0;
  return options;
}

/// Long, slow recording of nothing by the velocity sensor, so that statistics can be taken.
SyntheticOptions long_and_slow(double seconds) {
  SyntheticOptions options = still();
  options.sample_rate = 1e4;
  options.pre_trigger = 0.0;
  options.duration = seconds;
  return options;
}

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double rms_of(const std::vector<double>& values) {
  return std::sqrt(std::inner_product(values.begin(), values.end(), values.begin(), 0.0) /
                   static_cast<double>(values.size()));
}

// --- The chain ----------------------------------------------------------------------------------

TEST(Synthesise, ShowsTheTrajectoryThroughAPerfectChain) {
  const Record record = synthesise(usual_trajectory(), all_sensors(), still());
  ASSERT_EQ(record.channels.size(), 3u);
  EXPECT_EQ(record.channels[0].name, "Force");
  EXPECT_EQ(record.channels[1].name, "Velocity");
  EXPECT_EQ(record.channels[2].name, "Displacement");
  EXPECT_EQ(record.channels[0].unit, "N");
  EXPECT_EQ(record.channels[1].unit, "m/s");
  EXPECT_EQ(record.channels[2].unit, "m");
  for (const Channel& channel : record.channels) {
    ASSERT_EQ(channel.size(), 4000u);
    EXPECT_EQ(channel.clock.start, -1e-3);
    EXPECT_EQ(channel.clock.interval, 1e-6);
  }
  for (std::size_t i = 0; i < 4000; ++i) {
    const double t = -1e-3 + 1e-6 * static_cast<double>(i);
    ASSERT_NEAR(record.channels[0].value(i), sine_squared(t, height, duration), 1e-7 * height);
  }
  // Before the trajectory begins the bar flies freely.
  EXPECT_NEAR(record.channels[1].value(0), approach, 1e-12);
  EXPECT_NEAR(record.channels[2].value(0), -approach * 1e-3, 1e-12);
  EXPECT_NEAR(record.channels[1].value(3999), -0.5 * approach, 1e-9);
}

// Cubic interpolation between samples of 0.05 us: (pi h/T)⁴ of the height, 4e-13.
TEST(Synthesise, InterpolatesBetweenTheTrajectorysSamples) {
  SyntheticOptions options = still();
  options.sample_rate = 1e6 / 1.000123;
  const Record record = synthesise(usual_trajectory(), force_only(), options);
  for (std::size_t i = 1010; i < 1190; ++i) {
    const double t = record.channels[0].clock.time(i);
    ASSERT_NEAR(record.channels[0].value(i), sine_squared(t, height, duration), 1e-9 * height);
  }
}

TEST(Synthesise, ShowsWhatSensorResponseSays) {
  Sensor sensor = sensor_of(Quantity::force);
  sensor.resonance = {45e3, 20.0};
  sensor.low_cut = {0.3, 1};
  sensor.high_cut = {100e3, 2};
  const Trajectory trajectory = usual_trajectory();
  const Record record = synthesise(trajectory, {.force = sensor}, still());
  const auto shown = sensor_response(sensor, trajectory.force, trajectory.interval);
  const auto recorded = record.channels[0].values();
  for (std::size_t i = 960; i < 4000; ++i) {
    const auto fine = static_cast<std::size_t>(20 * (i - 950));  // -50 us is sample 950
    ASSERT_NEAR(recorded[i], shown[fine], 1e-9 * height) << i;
  }
  const double peak = *std::ranges::max_element(shown);
  // A sample is at most half a step from the crest: (pi h/T)² = 2.5e-4 / 4.
  EXPECT_NEAR(*std::ranges::max_element(recorded), peak, 7e-5 * peak);
}

// A first-order low-pass shows a ramp late by its time constant.
TEST(Synthesise, LetsADisplacementRampThroughALowPassFromTheBeginning) {
  Sensor sensor = sensor_of(Quantity::displacement);
  sensor.high_cut = {20e3, 1};
  const Record record = synthesise(usual_trajectory(), {.displacement = sensor}, still());
  const double late = 1.0 / (2.0 * pi * 20e3);
  for (const std::size_t i : {0u, 500u, 999u})
    EXPECT_NEAR(record.channels[0].value(i), approach * (record.channels[0].clock.time(i) - late),
                1e-6 * approach * 1e-3)
        << i;
}

// The delay where the correlation with the closed form is greatest.
TEST(Synthesise, DelaysBySensorAndError) {
  Sensor sensor = sensor_of(Quantity::force);
  sensor.delay = {2.3e-6, 1e-7, false};
  SyntheticOptions options = still();
  options.force.delay_error = 0.45e-6;
  options.force.noise = 1.0;
  const Record record = synthesise(usual_trajectory(), {.force = sensor}, options);
  const auto lag_of = [](const Channel& channel) {
    const auto correlation = [&](double lag) {
      double sum = 0.0;
      for (std::size_t i = 0; i < channel.size(); ++i)
        sum += channel.value(i) * sine_squared(channel.clock.time(i) - lag, 1.0, duration);
      return sum;
    };
    double low = -10e-6, high = 10e-6;
    while (high - low > 1e-9) {
      const double a = low + (high - low) / 3.0, b = high - (high - low) / 3.0;
      (correlation(a) < correlation(b) ? low : high) = correlation(a) < correlation(b) ? a : b;
    }
    return 0.5 * (low + high);
  };
  EXPECT_NEAR(lag_of(record.channels[0]), 2.75e-6, 0.02e-6);
  EXPECT_EQ(record.attributes.at("truth.force.delay"), "2.75e-06");
  // Conditioning takes off what is stated and leaves the error.
  EXPECT_NEAR(lag_of(condition(record, {.force = sensor}).channels[0]), 0.45e-6, 0.02e-6);
}

TEST(Synthesise, ComesBackFromVoltsAndPolarity) {
  Sensor sensor = sensor_of(Quantity::force);
  sensor.channel = "CH1";
  sensor.sensitivity = {4e-3, 0.0};
  sensor.recorded_unit = "V";
  sensor.polarity = -1.0;
  const Record record = synthesise(usual_trajectory(), {.force = sensor}, still());
  EXPECT_EQ(record.channels[0].name, "CH1");
  EXPECT_EQ(record.channels[0].unit, "V");
  EXPECT_EQ(record.channels[0].quantity, Quantity::voltage);
  EXPECT_NEAR(record.channels[0].value(1100), -height * 4e-3, 1e-9);
  EXPECT_NEAR(condition(record, {.force = sensor}).channels[0].value(1100), height, 1e-6);
}

TEST(Synthesise, PutsIndexedSensorsAtTheirIndex) {
  SensorSet sensors = all_sensors();
  sensors.force->channel = "2";
  sensors.velocity->channel = "0";
  sensors.displacement->channel = "1";
  const Record record = synthesise(usual_trajectory(), sensors, still());
  EXPECT_EQ(record.channels[0].name, "Velocity");
  EXPECT_EQ(record.channels[1].name, "Displacement");
  EXPECT_EQ(record.channels[2].name, "Force");
  EXPECT_EQ(condition(record, sensors).channels.size(), 3u);
}

// --- Disturbances -------------------------------------------------------------------------------

TEST(Synthesise, AddsWhiteNoiseOfTheStatedStrength) {
  SyntheticOptions options = long_and_slow(20.0);
  options.force.noise = 2.5;
  const auto noise = synthesise(nothing(20.0), force_only(), options).channels[0].values();
  ASSERT_EQ(noise.size(), 200'000u);
  EXPECT_NEAR(rms_of(noise), 2.5, 0.01 * 2.5);  // standard error 0.16 %
  EXPECT_NEAR(mean_of(noise), 0.0, 0.03);
  for (std::size_t lag = 1; lag <= 3; ++lag) {
    double product = 0.0;
    for (std::size_t i = lag; i < noise.size(); ++i) product += noise[i] * noise[i - lag];
    EXPECT_NEAR(product / 200'000.0 / 6.25, 0.0, 0.01) << lag;
  }
  double fourth = 0.0;
  for (const double value : noise) fourth += std::pow(value / 2.5, 4) / 200'000.0;
  EXPECT_NEAR(fourth, 3.0, 0.1);  // normal
}

// Five recursions of equal power with corners f: mean of exp(-2 pi f lag).
TEST(Synthesise, AddsLowFrequencyNoiseOfTheStatedSpectrum) {
  SyntheticOptions options = long_and_slow(200.0);
  options.force.low_frequency_noise = 3.0;
  const auto noise = synthesise(nothing(200.0), force_only(), options).channels[0].values();
  for (const std::size_t lag : {0u, 5u, 20u, 100u}) {
    double product = 0.0, expected = 0.0;
    for (std::size_t i = lag; i < noise.size(); ++i) product += noise[i] * noise[i - lag];
    for (int k = 0; k < 5; ++k)
      expected +=
          std::exp(-2.0 * pi * 10.0 * std::pow(10.0, 0.5 * k) * static_cast<double>(lag) * 1e-4) /
          5.0;
    EXPECT_NEAR(product / static_cast<double>(noise.size()) / 9.0, expected, 0.05) << lag;
  }
}

TEST(Synthesise, AddsHumDriftOffsetGainAndStep) {
  SyntheticOptions options = long_and_slow(1.0);
  options.force.hum = 2.0;
  const auto hum = synthesise(nothing(1.0), force_only(), options).channels[0].values();
  for (const auto& [frequency, amplitude] : {std::pair{50.0, 2.0}, {150.0, 0.6}, {100.0, 0.0}}) {
    double cosine = 0.0, sine = 0.0;
    for (std::size_t i = 0; i < hum.size(); ++i) {
      const double phase = 2.0 * pi * frequency * 1e-4 * static_cast<double>(i);
      cosine += 2.0 * hum[i] * std::cos(phase) / 1e4;
      sine += 2.0 * hum[i] * std::sin(phase) / 1e4;
    }
    EXPECT_NEAR(std::hypot(cosine, sine), amplitude, 1e-9) << frequency;
  }
  SyntheticOptions rest = still();
  rest.force.drift = 100.0;
  rest.force.offset = 5.0;
  rest.force.gain_error = 0.02;
  rest.force.step = 7.0;
  const Record record = synthesise(usual_trajectory(), force_only(), rest);
  EXPECT_NEAR(record.channels[0].value(0), 5.0, 1e-9);
  EXPECT_NEAR(record.channels[0].value(999), 5.0 + 0.0999, 1e-6);
  EXPECT_NEAR(record.channels[0].value(1100), 1.02 * height + 5.0 + 7.0 + 0.11, 1e-6);
  EXPECT_EQ(record.attributes.at("truth.force.gain"), "1.02");
}

TEST(Synthesise, RoundsByHalfADigitiserStepAtMost) {
  for (const int bits : {8, 12, 14, 16, 24}) {
    SyntheticOptions options = still();
    const auto exact = synthesise(usual_trajectory(), force_only(), options).channels[0].values();
    options.force.bits = bits;
    options.force.range = 2000.0;
    const Channel channel = synthesise(usual_trajectory(), force_only(), options).channels[0];
    const double step = 4000.0 / std::pow(2.0, bits);
    EXPECT_DOUBLE_EQ(channel.scale, step);
    EXPECT_EQ(std::holds_alternative<std::vector<std::int16_t>>(channel.raw), bits <= 16);
    EXPECT_EQ(std::holds_alternative<std::vector<std::int32_t>>(channel.raw), bits > 16);
    for (std::size_t i = 0; i < exact.size(); ++i)
      ASSERT_LE(std::abs(channel.value(i) - exact[i]), 0.5 * step * (1.0 + 1e-9)) << bits;
  }
}

TEST(Synthesise, ClipsAtTheRange) {
  SyntheticOptions options = still();
  options.force.range = 1000.0;
  const auto clipped = synthesise(usual_trajectory(), force_only(), options).channels[0].values();
  EXPECT_EQ(*std::ranges::max_element(clipped), 1000.0);
  options.force.bits = 12;
  const auto codes = synthesise(usual_trajectory(), force_only(), options).channels[0];
  EXPECT_EQ(std::ranges::max(std::get<std::vector<std::int16_t>>(codes.raw)), 2047);
  const auto impacts = find_impacts(record_of({codes}));
  ASSERT_EQ(impacts.size(), 1u);
  EXPECT_TRUE(impacts[0].has(ImpactFlag::clipped));
}

TEST(Synthesise, LosesTheLightWhereItSays) {
  SyntheticOptions options = long_and_slow(20.0);
  options.velocity.dropouts_per_second = 5.0;
  Trajectory trajectory = nothing(20.0);
  trajectory.velocity.assign(trajectory.velocity.size(), 0.3);
  const Record record =
      synthesise(trajectory, {.velocity = sensor_of(Quantity::velocity)}, options);
  const auto spans = nlohmann::json::parse(record.attributes.at("truth.dropouts"));
  EXPECT_NEAR(static_cast<double>(spans.size()), 100.0,
              50.0);  // those shorter than a step are lost
  const Channel& channel = record.channels[0];
  EXPECT_TRUE(channel.valid.empty());  // unmarked
  std::size_t within = 0;
  for (std::size_t i = 0; i < channel.size(); ++i) {
    const double t = channel.clock.time(i);
    const bool lost = std::ranges::any_of(spans, [&](const auto& span) {
      return t >= span[0].template get<double>() - 1e-9 &&
             t < span[1].template get<double>() - 1e-9;
    });
    within += lost ? 1 : 0;
    ASSERT_EQ(channel.value(i) != 0.3, lost) << t;
  }
  EXPECT_GT(within, 20u);
  for (const auto& span : spans) {
    const double length = span[1].get<double>() - span[0].get<double>();
    EXPECT_GE(length, 20e-6 - 1e-8);
    EXPECT_LE(length, 200e-6 + 1e-8);
  }
}

TEST(Synthesise, LosesTheLightInTheContactOnRequest) {
  SyntheticOptions options = still();
  options.velocity.dropout_in_contact = true;
  const Record record = synthesise(usual_trajectory(), all_sensors(), options);
  const auto spans = nlohmann::json::parse(record.attributes.at("truth.dropouts"));
  ASSERT_EQ(spans.size(), 1u);
  const double begin = spans[0][0].get<double>();
  EXPECT_GE(begin, 0.0);
  EXPECT_LE(begin, 50e-6);
}

TEST(Synthesise, LosesCountsOfTheDisplacement) {
  SyntheticOptions options = still();
  options.displacement.dropout_in_contact = true;
  const SensorSet sensors{.displacement = sensor_of(Quantity::displacement)};
  const auto lost = synthesise(usual_trajectory(), sensors, options);
  const auto whole = synthesise(usual_trajectory(), sensors, still()).channels[0].values();
  const auto spans = nlohmann::json::parse(lost.attributes.at("truth.dropouts"));
  ASSERT_EQ(spans.size(), 1u);
  const auto values = lost.channels[0].values();
  const double offset = whole[3999] - values[3999];
  EXPECT_NEAR(whole[2000] - values[2000], offset, 1e-15);  // for good
  EXPECT_NE(offset, 0.0);
  EXPECT_EQ(values[900], whole[900]);
}

// --- Determinism --------------------------------------------------------------------------------

SyntheticOptions noisy(std::uint64_t seed) {
  SyntheticOptions options;
  options.seed = seed;
  options.force.noise = 1.0;
  options.velocity.noise = 1e-3;
  options.velocity.dropouts_per_second = 500.0;
  return options;
}

TEST(Synthesise, GivesTheSameRecordForTheSameSeed) {
  const Record a = synthesise(usual_trajectory(), all_sensors(), noisy(7));
  const Record b = synthesise(usual_trajectory(), all_sensors(), noisy(7));
  const Record c = synthesise(usual_trajectory(), all_sensors(), noisy(8));
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(a.channels[i].raw, b.channels[i].raw);
  EXPECT_EQ(a.attributes, b.attributes);
  EXPECT_NE(a.channels[0].raw, c.channels[0].raw);
}

TEST(Synthesise, KeepsAChannelsNoiseWhenAnotherIsAdded) {
  const Record all = synthesise(usual_trajectory(), all_sensors(), noisy(7));
  const Record one = synthesise(usual_trajectory(), force_only(), noisy(7));
  EXPECT_EQ(all.channels[0].raw, one.channels[0].raw);
}

// The first number was computed with an independent implementation of the seeding and of
// mt19937-64 in Python, itself checked by the generator's published 10000th number.
TEST(RandomStream, IsTheSameEverywhere) {
  RandomStream a(1, "force noise"), b(1, "velocity noise"), c(2, "force noise");
  const double first = a.uniform();
  EXPECT_EQ(first, 3541748669750713.0 * 0x1.0p-53);
  EXPECT_NE(first, b.uniform());
  EXPECT_NE(first, c.uniform());
}

// --- Trigger ------------------------------------------------------------------------------------

TEST(Synthesise, JittersTheTriggerWithinItsBoundsAndSaysBy) {
  double mean = 0.0, square = 0.0;
  const int runs = 200;
  for (int seed = 1; seed <= runs; ++seed) {
    SyntheticOptions options;
    options.seed = static_cast<std::uint64_t>(seed);
    const Record record = synthesise(usual_trajectory(), force_only(), options);
    const double touch = std::stod(record.attributes.at("truth.first_touch"));
    EXPECT_LE(std::abs(touch), 0.5e-6);
    mean += touch / runs;
    square += touch * touch / runs;
    // The sample nearest to the crest shows it that much off.
    const double t = 100e-6 - touch;
    EXPECT_NEAR(record.channels[0].value(1100), sine_squared(t, height, duration), 1e-6 * height);
  }
  EXPECT_NEAR(mean, 0.0, 0.07e-6);  // uniform over ±0.5 us
  EXPECT_NEAR(std::sqrt(square), 0.5e-6 / std::sqrt(3.0), 0.03e-6);
}

// --- Days ---------------------------------------------------------------------------------------

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
  const SyntheticOptions day = good_laboratory_day(paper_sensors(), height, approach);
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
  EXPECT_EQ(good_laboratory_day(paper_sensors(), 4900.0, approach).force.range, 5000.0);
}

TEST(GoodLaboratoryDay, IsReadBackByConditioningAndDetection) {
  const SensorSet sensors = paper_sensors();
  const Trajectory trajectory = usual_trajectory();
  SyntheticOptions day = good_laboratory_day(sensors, height, approach);
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
  SyntheticOptions day = bad_day(sensors, height, approach);
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

// --- Errors -------------------------------------------------------------------------------------

std::string message_of(const Trajectory& trajectory, const SensorSet& sensors,
                       const SyntheticOptions& options) {
  try {
    synthesise(trajectory, sensors, options);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "no error";
}

TEST(Synthesise, RefusesATrajectoryThatIsTooShort) {
  EXPECT_EQ(message_of(trajectory_until(1e-3), force_only(), still()),
            "the trajectory's force ends at 0.001 s, but the recording needs it until 0.002999 s; "
            "simulate longer or record shorter");
}

TEST(Synthesise, RefusesACoarseTrajectory) {
  SyntheticOptions options = still();
  options.sample_rate = 4e6;
  EXPECT_EQ(message_of(usual_trajectory(), force_only(), options),
            "the trajectory's step of 5e-08 s must be at least 10 times finer than the recording's "
            "of 2.5e-07 s");
}

TEST(Synthesise, RefusesAMissingHistory) {
  Trajectory trajectory = usual_trajectory();
  trajectory.velocity.clear();
  EXPECT_EQ(message_of(trajectory, all_sensors(), still()),
            "the trajectory has no velocity, which a sensor is to record");
}

TEST(Synthesise, RefusesSenselessOptions) {
  SyntheticOptions options = still();
  options.force.bits = 12;
  EXPECT_EQ(message_of(usual_trajectory(), force_only(), options),
            "a digitiser of 12 bits needs the range of the force");
  options.force.bits = 33;
  EXPECT_EQ(message_of(usual_trajectory(), force_only(), options),
            "a digitiser of 33 bits cannot be made; 2 to 32, or 0 for none");
  options = still();
  options.duration = -1.0;
  EXPECT_EQ(message_of(usual_trajectory(), force_only(), options),
            "a recording of -1 s at 1000000 Hz cannot be made");
  SensorSet sensors = force_only();
  sensors.force->sensitivity = {0.0, 0.0};
  EXPECT_EQ(message_of(usual_trajectory(), sensors, still()), "the sensitivity of the force is 0");
}

// --- As a source --------------------------------------------------------------------------------

TEST(SyntheticSource, CountsItsSeedsUp) {
  SyntheticSource source(usual_trajectory(), force_only(), noisy(5), 2);
  const auto first = source.next(), second = source.next();
  ASSERT_TRUE(first);
  ASSERT_TRUE(second);
  EXPECT_EQ(first->attributes.at("truth.seed"), "5");
  EXPECT_EQ(second->attributes.at("truth.seed"), "6");
  EXPECT_EQ(second->channels[0].raw,
            synthesise(usual_trajectory(), force_only(), noisy(6)).channels[0].raw);
  EXPECT_FALSE(source.next());
  EXPECT_FALSE(source.next());
}

}  // namespace

}  // namespace impactrig::acquisition
