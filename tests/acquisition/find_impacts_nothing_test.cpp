// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "acquisition/conditioning/condition.hpp"
#include "datasets/input_error.hpp"
#include "tests/acquisition/scene.hpp"

namespace impactrig::acquisition {
namespace {

using datasets::Quantity;
using datasets::Record;
using namespace tests;

constexpr double pi = std::numbers::pi;

TEST(FindImpacts, FindsNothingInNoise) {
  const Sampling at;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    std::vector<double> values(at.samples, 0.0);
    add_noise(values, 5.0, seed);
    EXPECT_TRUE(find_impacts(record_of({force_of(at, values)})).empty()) << "seed " << seed;
    EXPECT_TRUE(find_impacts(record_of({velocity_of(at, values)})).empty()) << "seed " << seed;
    round_to(values, 12.0);  // 0.4 steps of noise: most samples are 0
    EXPECT_TRUE(find_impacts(record_of({force_of(at, values)})).empty()) << "seed " << seed;
  }
}

// Filters make noise that wanders: time constants of 100, 10 and 3 kHz at 1 MHz.
TEST(FindImpacts, FindsNothingInFilteredNoise) {
  const Sampling at;
  for (const double samples : {1.6, 16.0, 50.0})
    for (std::uint64_t seed = 1; seed <= 70; ++seed) {
      Noise noise(seed);
      double state = 0.0;
      const double r = std::exp(-1.0 / samples);
      const auto values = sampled(at, [&](double) { return state = r * state + noise(); });
      EXPECT_TRUE(find_impacts(record_of({force_of(at, values)})).empty()) << "seed " << seed;
      EXPECT_TRUE(find_impacts(record_of({velocity_of(at, values)})).empty()) << "seed " << seed;
    }
}

TEST(FindImpacts, FindsNothingInHum) {
  for (const double length : {4e-3, 10e-3, 18e-3, 60e-3})
    for (std::uint64_t seed = 1; seed <= 200; ++seed) {
      Noise random(seed);
      const double phase = 2.0 * pi * random.uniform(), third = 2.0 * pi * random.uniform();
      const Sampling at{
          .start = 0.0, .interval = 1e-5, .samples = static_cast<std::size_t>(length / 1e-5)};
      const double noise = 0.1 * static_cast<double>(seed % 3);
      std::vector<double> values = sampled(at, [&](double t) {
        return std::sin(100.0 * pi * t + phase) + 0.3 * std::sin(300.0 * pi * t + third);
      });
      add_noise(values, noise, seed);
      EXPECT_TRUE(find_impacts(record_of({force_of(at, values)})).empty())
          << "seed " << seed << " length " << length;
      EXPECT_TRUE(find_impacts(record_of({velocity_of(at, values)})).empty())
          << "seed " << seed << " length " << length;
    }
}

// A bar that swings freely, knocked before the record or kept in motion: up to three frequencies
// of 100 Hz to 10 kHz, on a line.
TEST(FindImpacts, FindsNothingInAFreeVibration) {
  const Sampling at;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    Noise random(seed);
    const double slope = 200.0 * (random.uniform() - 0.5);
    std::vector<double> values = sampled(at, [&](double t) { return slope * t; });
    for (std::uint64_t mode = 0; mode <= seed % 3; ++mode) {
      const double omega = 2.0 * pi * 100.0 * std::pow(100.0, random.uniform());
      const double height = random.uniform(), phase = 2.0 * pi * random.uniform();
      const double decay = seed % 2 == 0 ? 0.0 : 1e3 * random.uniform();
      for (std::size_t i = 0; i < values.size(); ++i) {
        const double t = at.time(i) - at.start;
        values[i] += height * std::exp(-decay * t) * std::sin(omega * t + phase);
      }
    }
    add_noise(values, 3e-3, seed);
    EXPECT_TRUE(find_impacts(record_of({velocity_of(at, values)})).empty()) << "seed " << seed;
  }
}

TEST(FindImpacts, FindsNothingInDrift) {
  const Sampling at;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    Noise random(seed);
    const double slope = 1e6 * (random.uniform() - 0.5);
    std::vector<double> values = sampled(at, [&](double t) { return slope * t; });
    EXPECT_TRUE(find_impacts(record_of({force_of(at, values)})).empty()) << "seed " << seed;
    EXPECT_TRUE(find_impacts(record_of({velocity_of(at, values)})).empty()) << "seed " << seed;
    add_noise(values, 1.0, seed);
    round_to(values, 2.0);
    EXPECT_TRUE(find_impacts(record_of({force_of(at, values)})).empty()) << "seed " << seed;
    EXPECT_TRUE(find_impacts(record_of({velocity_of(at, values)})).empty()) << "seed " << seed;
  }
}

TEST(FindImpacts, FindsNothingInAConstantOrInAFewSamples) {
  const Sampling at;
  EXPECT_TRUE(find_impacts(record_of({force_of(at, std::vector<double>(4000, 7.0))})).empty());
  EXPECT_TRUE(find_impacts(record_of({force_of(at, {1.0, 2.0, 1.0})})).empty());
  EXPECT_TRUE(find_impacts(record_of({velocity_of(at, {1.0, 2.0, 1.0})})).empty());
}

// --- Errors -------------------------------------------------------------------------------------

std::string message_of(const Record& record, const DetectionOptions& options = {}) {
  try {
    find_impacts(record, options);
  } catch (const datasets::InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(FindImpacts, RefusesARecordWithoutATriggerChannel) {
  const Sampling at;
  EXPECT_EQ(message_of(record_of({channel_of("U", Quantity::voltage, at, {1.0, 2.0})})),
            "shot.csv: there is no force, acceleration, velocity or displacement to look for "
            "impacts in; describe the channels in a rig file under [sensors.force] and "
            "[sensors.velocity], or their roles in a map");
  EXPECT_EQ(message_of(record_of({force_of(at, {1.0, 2.0})}), {.trigger_channel = "F2"}),
            "shot.csv: there is no single channel 'F2' to look for impacts in");
  EXPECT_EQ(message_of(record_of({channel_of("U", Quantity::voltage, at, {1.0, 2.0})}),
                       {.trigger_channel = "U"}),
            "shot.csv: channel 'U' is a voltage; impacts are looked for in a force, an "
            "acceleration, a velocity or a displacement");
}

TEST(FindImpacts, RefusesAnUnitThatIsNotUnderstood) {
  const Sampling at;
  auto force = force_of(at, {1.0, 2.0});
  force.unit = "counts";
  EXPECT_EQ(message_of(record_of({force})),
            "shot.csv: channel 'Force' is in 'counts', which is no unit of force; state its unit "
            "when importing");
}

TEST(FindImpacts, RefusesAChannelWithoutASoundSample) {
  const Sampling at;
  auto force = force_of(at, {1.0, 2.0});
  force.valid = {0, 0};
  EXPECT_EQ(message_of(record_of({force})),
            "shot.csv: channel 'Force' has no sound sample; choose another channel");
}

TEST(FindImpacts, RefusesSenselessOptions) {
  const Sampling at;
  const Record record = record_of({force_of(at, {1.0, 2.0})});
  const char* const message =
      "threshold, pre_trigger and post_trigger must be finite and not negative, not -1";
  EXPECT_THAT([&] { find_impacts(record, {.pre_trigger = -1.0}); },
              testing::ThrowsMessage<std::invalid_argument>(message));
}

// A laser without a signal is no reason not to look for the impact in the force.
TEST(FindImpacts, LooksPastAVelocityWithoutASoundSample) {
  const Sampling at;
  const auto force = force_of(at, sampled(at, [](double t) { return half_sine(t, 1500.0, 1e-3); }));
  const auto dead = velocity_of(at, std::vector<double>(at.samples, std::nan("")));
  const auto impacts = find_impacts(record_of({force, dead}));
  ASSERT_EQ(impacts.size(), 1U);
  EXPECT_FALSE(impacts[0].velocity);
  EXPECT_TRUE(impacts[0].force);
}

}  // namespace
}  // namespace impactrig::acquisition
