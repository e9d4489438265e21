// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/decay.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <tuple>
#include <vector>

#include "acquisition/conditioning/hum.hpp"
#include "datasets/sensor_response.hpp"
#include "tests/acquisition/scene.hpp"

namespace impactrig::acquisition {

namespace {

using datasets::TimeSpan;
using namespace tests;

constexpr Sampling at{.start = -10e-3, .interval = 1e-5, .samples = 3000};
const std::vector<TimeSpan> quiet{{-10e-3, -0.1e-3}, {3e-3, 20e-3}};

double pulse(double t) {
  return half_sine(t, 1500.0, 1e-3);
}

double decay(double t, double time) {
  return 12.0 + 80.0 * std::exp(-(t + 10e-3) / time);
}

TEST(RemoveDecay, FindsTheTimeConstant) {
  for (const double time : {2e-3, 8e-3, 50e-3}) {
    auto force = force_of(at, sampled(at, [&](double t) { return pulse(t) + decay(t, time); }));
    const auto edit = remove_decay(force, {quiet, std::nullopt});
    for (std::size_t i = 0; i < at.samples; ++i)
      ASSERT_NEAR(force.value(i), pulse(at.time(i)), 1e-4) << time;
    EXPECT_NEAR(std::stod(edit.parameters.at("time constant")), time, 1e-5 * time);
  }
}

// Five times the points that fits go through: they are means of six neighbours.
TEST(RemoveDecay, FindsTheTimeConstantAmongManySamples) {
  const Sampling fine{.start = -10e-3, .interval = 2e-8, .samples = 1'499'999};
  auto force = force_of(fine, sampled(fine, [](double t) { return decay(t, 8e-3); }));
  const auto edit = remove_decay(force, {{TimeSpan{-10e-3, 20e-3}}, std::nullopt});
  for (std::size_t i = 0; i < fine.samples; ++i) ASSERT_NEAR(force.value(i), 0.0, 1e-5) << i;
  EXPECT_NEAR(std::stod(edit.parameters.at("time constant")), 8e-3, 1e-8);
}

// In 60 noisy records the true T lies within 1.96 stated errors of the found one as often as a
// normal error does: 95 %, here at least 51 of 60 (of less than that a binomial law gives 0.1 %).
TEST(RemoveDecay, StatesItsErrorHonestly) {
  int within = 0;
  double sum = 0.0;
  for (int seed = 1; seed <= 60; ++seed) {
    auto values = sampled(at, [&](double t) { return pulse(t) + decay(t, 8e-3); });
    add_noise(values, 4.0, static_cast<std::uint64_t>(seed));
    auto force = force_of(at, values);
    const auto edit = remove_decay(force, {quiet, std::nullopt});
    const double error = std::stod(edit.parameters.at("time constant")) - 8e-3;
    const double stated = std::stod(edit.parameters.at("uncertainty"));
    if (std::abs(error) < 1.96 * stated) ++within;
    sum += error / stated;
  }
  EXPECT_GE(within, 51);
  EXPECT_LT(std::abs(sum / 60.0), 0.5);  // four standard errors of the mean
}

/// 0.1 s before touch at 20 kHz, 0.2 s after it.
constexpr Sampling with_mains{.start = -0.1, .interval = 50e-6, .samples = 6000};
const std::vector<TimeSpan> quiet_of_mains{{-0.1, -1e-3}, {10e-3, 0.2}};

double pulse_beside(double t) {
  return half_sine(t, 1500.0, 5e-3);
}

double decay_beside(double t) {
  return 12.0 + 80.0 * std::exp(-(t + 0.1) / 40e-3);
}

double hum_beside(double t) {
  const double phase = 2.0 * std::numbers::pi * 50.03 * t;
  return 6.0 * std::sin(phase + 0.7) + 2.0 * std::cos(3.0 * phase - 0.2);
}

/// Both off, the decay first or the hum.
datasets::Edit remove_both(bool decay_first, datasets::Channel& force) {
  const datasets::RemoveHum hum{.frequency = 50.0, .harmonics = 3, .quiet = quiet_of_mains};
  const datasets::RemoveDecay decay{.quiet = quiet_of_mains};
  if (!decay_first) remove_hum(force, hum, &decay);
  const datasets::Edit edit = remove_decay(force, decay, decay_first ? &hum : nullptr);
  if (decay_first) remove_hum(force, hum);
  return edit;
}

TEST(RemoveDecay, AndMainsHumAreToldApartInAnyOrder) {
  for (const bool decay_first : {true, false}) {
    auto force = force_of(with_mains, sampled(with_mains, [](double t) {
                            return pulse_beside(t) + decay_beside(t) + hum_beside(t);
                          }));
    const auto edit = remove_both(decay_first, force);
    EXPECT_NEAR(std::stod(edit.parameters.at("time constant")), 40e-3, 4e-6);
    if (decay_first) {
      EXPECT_NEAR(std::stod(edit.parameters.at("fitted beside").substr(7)), 50.03, 2e-3);
    }
    for (std::size_t i = 0; i < with_mains.samples; ++i)
      ASSERT_NEAR(force.value(i), pulse_beside(with_mains.time(i)), 2e-2) << decay_first << i;
  }
}

// As above, here of the decay beside hum.
TEST(RemoveDecay, BesideHumStatesItsErrorHonestly) {
  for (const bool decay_first : {true, false}) {
    int within = 0;
    double sum = 0.0;
    for (int seed = 1; seed <= 60; ++seed) {
      auto values = sampled(
          with_mains, [](double t) { return pulse_beside(t) + decay_beside(t) + hum_beside(t); });
      add_noise(values, 2.0, static_cast<std::uint64_t>(seed));
      auto force = force_of(with_mains, values);
      const auto edit = remove_both(decay_first, force);
      const double error = std::stod(edit.parameters.at("time constant")) - 40e-3;
      const double stated = std::stod(edit.parameters.at("uncertainty"));
      if (std::abs(error) < 1.96 * stated) ++within;
      sum += error / stated;
    }
    EXPECT_GE(within, 51) << decay_first;
    EXPECT_LT(std::abs(sum / 60.0), 0.5) << decay_first;
  }
}

// In coulombs or in counts the decay is the same one.
TEST(RemoveDecay, FindsTheTimeConstantInAnyUnit) {
  auto values = sampled(at, [&](double t) { return pulse(t) + decay(t, 8e-3); });
  add_noise(values, 4.0, 1);
  auto newtons = force_of(at, values);
  const auto expected = remove_decay(newtons, {quiet, std::nullopt}).parameters;
  for (const double unit : {1e-30, 1e-12, 1e12, 1e30}) {
    auto other = values;
    for (double& value : other) value *= unit;
    auto force = force_of(at, other);
    const auto parameters = remove_decay(force, {quiet, std::nullopt}).parameters;
    EXPECT_EQ(parameters.at("time constant"), expected.at("time constant")) << unit;
    EXPECT_EQ(parameters.at("uncertainty"), expected.at("uncertainty")) << unit;
  }
}

// Quiet only after the contact: what the decay was before that is not in the data.
TEST(RemoveDecay, LeavesWhatLiesBeforeTheQuietStretch) {
  const auto recorded = sampled(at, [&](double t) {
    return pulse(t) + (t > 1e-3 ? -100.0 * std::exp(-(t - 1e-3) / 0.5e-3) : 0.0);
  });
  auto force = force_of(at, recorded);
  remove_decay(force, {{TimeSpan{1.5e-3, 20e-3}}, std::nullopt});
  for (std::size_t i = 0; i < at.samples; ++i) {
    const bool before = at.time(i) < 1.5e-3 - 1e-9;
    ASSERT_NEAR(force.value(i), before ? recorded[i] : 0.0, before ? 0.0 : 1e-4) << i;
  }
}

TEST(RemoveDecay, TakesAStatedTimeConstant) {
  auto force = force_of(at, sampled(at, [&](double t) { return pulse(t) + decay(t, 0.3); }));
  const auto edit = remove_decay(force, {{quiet.front()}, 0.3});
  for (std::size_t i = 0; i < at.samples; ++i) ASSERT_NEAR(force.value(i), pulse(at.time(i)), 1e-6);
  EXPECT_EQ(edit.parameters.at("time constant"), "0.3 s, stated");
}

// An amplifier of two time constants, and one whose stated time constant is off by a fifth.
TEST(RemoveDecay, TellsWhereTheDecayIsAnother) {
  constexpr Sampling long_rest{.start = -50e-3, .interval = 2e-5, .samples = 5000};
  const std::vector<TimeSpan> rest{{-50e-3, -0.5e-3}};
  const auto taken_off = [&](auto&& course, std::optional<double> stated, std::uint64_t seed) {
    std::vector<double> values = sampled(long_rest, course);
    add_noise(values, 0.1, seed);
    auto force = force_of(long_rest, values);
    const auto edit = remove_decay(force, {rest, stated});
    double off = 0.0;
    for (std::size_t i = 0; i < values.size(); ++i)
      off = std::max(off, std::abs(values[i] - force.value(i) - course(long_rest.time(i))));
    const double told = std::stod(edit.parameters.at("uncertainty of what came off"));
    return std::tuple{edit.parameters.contains("misfit"), off, told};
  };
  const auto one = [](double t) { return 3.0 + 20.0 * std::exp(-(t + 50e-3) / 0.02); };
  const auto two = [&](double t) { return one(t) + 4.0 * std::exp(-(t + 50e-3) / 2e-3); };
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(seed);
    EXPECT_FALSE(std::get<0>(taken_off(one, std::nullopt, seed)));
    EXPECT_FALSE(std::get<0>(taken_off(one, 0.02, seed)));
    const auto [told_of_two, off_of_two, error_of_two] = taken_off(two, std::nullopt, seed);
    EXPECT_TRUE(told_of_two);
    EXPECT_LT(off_of_two, 4.0 * error_of_two);
    for (const double stated : {0.016, 0.025}) {
      const auto [told, off, error] = taken_off(one, stated, seed);
      EXPECT_TRUE(told);
      EXPECT_LT(off, 2.0 * error) << stated;
    }
  }
}

// What is not finite is left out as what is marked is; the lines that bridged it counted.
TEST(RemoveDecay, LeavesOutWhatIsNotFinite) {
  auto values = sampled(at, [&](double t) { return pulse(t) + decay(t, 8e-3); });
  add_noise(values, 4.0, 1);
  auto marked = force_of(at, values);
  for (const std::size_t from : {100u, 300u, 500u, 1500u, 2000u})
    std::fill_n(values.begin() + static_cast<std::ptrdiff_t>(from), 150, NAN);
  auto lost = force_of(at, values);
  marked.valid.assign(at.samples, 1);
  for (std::size_t i = 0; i < at.samples; ++i) marked.valid[i] = std::isfinite(values[i]);
  EXPECT_EQ(remove_decay(lost, {quiet, std::nullopt}).parameters,
            remove_decay(marked, {quiet, std::nullopt}).parameters);
}

// A line over 10 ms has no time constant.
TEST(RemoveDecay, RefusesWhatIsALine) {
  auto values = sampled(at, [&](double t) { return pulse(t) + 3.0 * t / 10e-3; });
  add_noise(values, 1.0, 4);
  auto force = force_of(at, values);
  try {
    remove_decay(force, {{quiet.front()}, std::nullopt});
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("do not tell the time constant"), std::string::npos);
  }
  EXPECT_THROW(remove_decay(force, {{TimeSpan{-10e-3, -9.9e-3}}, std::nullopt}),
               std::invalid_argument);
  EXPECT_THROW(remove_decay(force, {quiet, -1.0}), std::invalid_argument);
}

// The chain's own high-pass, undone: the two are written apart (ramp-invariant, trapezoidal).
TEST(UndoLowCut, IsTheInverseOfTheSensorsHighPass) {
  for (const double frequency : {0.3, 3.0, 30.0, 300.0}) {
    datasets::Sensor sensor;
    sensor.low_cut = datasets::BandLimit{frequency, 1};
    const std::vector<double> truth = sampled(at, pulse);
    auto force = force_of(at, datasets::sensor_response(sensor, truth, at.interval));
    undo_low_cut(force, {frequency, TimeSpan{-10e-3, -0.1e-3}});
    const double w_h = 2.0 * std::numbers::pi * frequency * at.interval;
    for (std::size_t i = 0; i < at.samples; ++i)
      ASSERT_NEAR(force.value(i), truth[i], 1500.0 * (w_h * w_h + 1e-9)) << frequency << " " << i;
  }
}

TEST(UndoLowCut, MarksWhatWasNotFinite) {
  auto values = sampled(at, pulse);
  values[2000] = NAN;
  auto force = force_of(at, values);
  undo_low_cut(force, {1.0, TimeSpan{-10e-3, -0.1e-3}});
  ASSERT_EQ(force.valid.size(), at.samples);
  for (std::size_t i = 0; i < at.samples; ++i) ASSERT_EQ(force.is_valid(i), i != 2000) << i;
}

TEST(UndoLowCut, RefusesWhatIsNoFrequency) {
  auto force = force_of(at, sampled(at, pulse));
  EXPECT_THROW(undo_low_cut(force, {0.0, std::nullopt}), std::invalid_argument);
  EXPECT_THROW(undo_low_cut(force, {1.0, TimeSpan{5.0, 6.0}}), std::invalid_argument);
}

}  // namespace

}  // namespace impactrig::acquisition
