// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/synthetic.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "acquisition/conditioning/condition.hpp"
#include "tests/acquisition/scene.hpp"
#include "tests/acquisition/synthetic_motion.hpp"

namespace impactrig::acquisition {

namespace {

using datasets::Channel;
using datasets::ImpactFlag;
using datasets::Quantity;
using datasets::Record;
using namespace tests;

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

}  // namespace

}  // namespace impactrig::acquisition
