// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/synthetic.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "acquisition/conditioning/condition.hpp"
#include "acquisition/random_stream.hpp"
#include "datasets/sensor_response.hpp"
#include "tests/acquisition/scene.hpp"
#include "tests/acquisition/synthetic_motion.hpp"

namespace impactrig::acquisition {

namespace {

using datasets::Channel;
using datasets::Quantity;
using datasets::Record;
using datasets::Sensor;
using namespace tests;

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
