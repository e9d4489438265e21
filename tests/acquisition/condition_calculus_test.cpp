// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/calculus.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <stdexcept>
#include <string>

#include "acquisition/conditioning/baseline.hpp"
#include "tests/acquisition/scene.hpp"

namespace impactrig::acquisition {

namespace {

using datasets::Channel;
using datasets::Quantity;
using namespace tests;

constexpr double pi = std::numbers::pi;

TEST(RemoveBaseline, TakesTheMeanOfTheQuietPartOff) {
  const Sampling at;
  std::vector<double> values =
      sampled(at, [](double t) { return 12.5 + half_sine(t, 1500.0, 200e-6); });
  Channel channel = force_of(at, values);
  const auto edit = remove_baseline(channel, {-1e-3, -0.1e-3}).edit;
  EXPECT_NEAR(channel.value(0), 0.0, 1e-12);
  EXPECT_NEAR(channel.value(1100), 1500.0, 1e-9);
  EXPECT_EQ(edit.what, "remove baseline");
  EXPECT_EQ(edit.channel, "Force");
  EXPECT_EQ(edit.parameters.at("offset"), "12.5 N");
  EXPECT_EQ(edit.parameters.at("from"), "-0.001 s");
  EXPECT_EQ(edit.parameters.at("to"), "-0.0001 s");
}

TEST(RemoveBaseline, KeepsRawCodes) {
  Channel channel = force_of({}, {});
  channel.raw = std::vector<std::int16_t>{10, 10, 10, 12};
  channel.scale = 0.5;
  remove_baseline(channel, {-1e-3, -0.998e-3});
  EXPECT_EQ(std::get<std::vector<std::int16_t>>(channel.raw)[3], 12);
  EXPECT_DOUBLE_EQ(channel.value(3), 1.0);
}

TEST(RemoveBaseline, RefusesASpanWithoutSamples) {
  Channel channel = force_of({}, {1.0, 2.0, 3.0});
  EXPECT_THAT(
      [&] {
        remove_baseline(channel, {1.0, 2.0});
      },
      testing::ThrowsMessage<std::invalid_argument>(
          "channel 'Force' has 0 samples between 1 s and 2 s; at least 3 are needed to "
          "know its baseline"));
}

// Bridged by what follows, the quiet part would be the impact's first sample.
TEST(RemoveBaseline, RefusesAQuietPartWithoutSoundSamples) {
  const Sampling at;
  Channel channel =
      force_of(at, sampled(at, [](double t) { return 12.5 + half_sine(t, 1500.0, 200e-6); }));
  channel.valid.assign(at.samples, 1);
  for (std::size_t i = 0; i < 1098; ++i) channel.valid[i] = 0;
  const std::string refusal =
      "channel 'Force' has 2 sound samples between -0.001 s and 9.95e-05 s; at least ";
  EXPECT_THAT(
      [&] {
        remove_baseline(channel, {-1e-3, 0.0995e-3});
      },
      testing::ThrowsMessage<std::invalid_argument>(refusal + "3 are needed to know its baseline"));
  EXPECT_THAT(
      [&] {
        remove_drift(channel, {-1e-3, 0.0995e-3});
      },
      testing::ThrowsMessage<std::invalid_argument>(refusal + "8 are needed to know its baseline"));
}

TEST(RemoveDrift, TakesTheLineOfTheQuietPartOffEverything) {
  const Sampling at;
  Channel channel = force_of(
      at, sampled(at, [](double t) { return 3.0 + 2e4 * t + half_sine(t, 1500.0, 200e-6); }));
  const auto edit = remove_drift(channel, {-1e-3, -0.1e-3}).edit;
  EXPECT_NEAR(channel.value(0), 0.0, 1e-9);
  EXPECT_NEAR(channel.value(1100), 1500.0, 1e-9);
  EXPECT_NEAR(channel.value(3999), 0.0, 1e-9);
  EXPECT_EQ(edit.what, "remove drift");
  EXPECT_NEAR(std::stod(edit.parameters.at("slope")), 2e4, 1e-4);
}

TEST(RemoveDrift, IsNotMisledByASpike) {
  const Sampling at;
  std::vector<double> values = sampled(at, [](double t) { return 2e3 * t; });
  add_noise(values, 0.1, 4);
  for (std::size_t i = 300; i < 340; ++i) values[i] += 50.0;
  Channel channel = force_of(at, values);
  remove_drift(channel, {-1e-3, -0.1e-3});
  // sigma sqrt(12/n³) n at the far end of three times the span: 0.1 N * 3.5/30 * 3.
  EXPECT_NEAR(channel.value(0), 0.0, 0.5);
  EXPECT_NEAR(channel.value(3999), 0.0, 0.5);
}

TEST(RemoveDrift, RefusesTooFewSamples) {
  Channel channel = force_of({}, {1.0, 2.0, 3.0});
  EXPECT_THAT(
      [&] {
        remove_drift(channel, {-1e-3, 0.0});
      },
      testing::ThrowsMessage<std::invalid_argument>(
          "channel 'Force' has 3 samples between -0.001 s and 0 s; at least 8 are needed "
          "to know its baseline"));
}

// The integral of A cos w t is A/w sin w t; the rule is off by (w h)²/12 of it.
TEST(Integrate, FollowsTheIntegralOfACosine) {
  const double w = 2.0 * pi * 5e3, h = 1e-6;
  const Sampling at{.start = -1e-3, .interval = h, .samples = 3001};
  const auto velocity = velocity_of(at, sampled(at, [&](double t) { return std::cos(w * t); }));
  const Derived x = integrate(velocity, {.zero_at = 0.0});
  const double bound = 1.1 * (w * h) * (w * h) / 12.0 / w;
  for (std::size_t i = 0; i < at.samples; ++i)
    ASSERT_NEAR(x.channel.value(i), std::sin(w * at.time(i)) / w, bound) << i;
  EXPECT_EQ(x.channel.quantity, Quantity::displacement);
  EXPECT_EQ(x.channel.unit, "m");
  EXPECT_EQ(x.channel.name, "integral of Velocity");
  EXPECT_EQ(x.edit.what, "integrate");
  EXPECT_EQ(x.edit.parameters.at("rule"), "trapezoidal");
}

TEST(Integrate, IsZeroWhereItIsToldTo) {
  const Sampling at{.start = 0.0, .interval = 1.0, .samples = 5};
  // Velocity 2 t: x = t² - t0².
  const auto velocity = velocity_of(at, sampled(at, [](double t) { return 2.0 * t; }));
  const Derived x = integrate(velocity, {.zero_at = 1.5});
  EXPECT_NEAR(x.channel.value(0), -2.25, 1e-12);
  EXPECT_NEAR(x.channel.value(4), 16.0 - 2.25, 1e-12);
}

// An offset b would run to b t, 10 times the wanted velocity at the end of the record.
TEST(Integrate, DoesNotRunAwayWhenTheQuietPartIsStated) {
  const Sampling at;
  const double T = 200e-6;
  std::vector<double> values =
      sampled(at, [&](double t) { return 500.0 + 1e4 * t - half_sine(t, 5000.0, T); });
  const auto acceleration = channel_of("Acc", Quantity::acceleration, at, values);
  const Derived v =
      integrate(acceleration, {.quiet = TimeSpan{-1e-3, -0.05e-3}, .zero_at = -0.5e-3});
  EXPECT_NEAR(v.channel.value(3999), -2.0 * 5000.0 * T / pi, 2e-5);
  EXPECT_EQ(v.channel.quantity, Quantity::velocity);
  EXPECT_TRUE(v.edit.parameters.contains("slope"));
}

// What noise makes of an integral is a walk, and what it makes of the line grows with the square of
// the time: of 100 records as many ends within 1.96 stated errors as of a normal one (at least 87).
TEST(Integrate, StatesItsErrorHonestly) {
  for (const TimeSpan quiet : {TimeSpan{-1e-3, -0.05e-3}, TimeSpan{-0.2e-3, -0.05e-3}}) {
    int within = 0;
    double squares = 0.0;
    for (std::uint64_t seed = 1; seed <= 100; ++seed) {
      const Sampling at;
      std::vector<double> values(at.samples, 7.0);
      add_noise(values, 2.0, seed);
      auto acceleration = channel_of("Acc", Quantity::acceleration, at, values);
      acceleration.unit = "g";
      const Derived v = integrate(acceleration, {.quiet = quiet, .zero_at = -0.1e-3});
      const std::string& told = v.edit.parameters.at("uncertainty of the integral");
      EXPECT_THAT(told, testing::EndsWith(" m/s at most"));
      const double ratio = v.channel.value(at.samples - 1) / std::stod(told);
      within += std::abs(ratio) < 1.96 ? 1 : 0;
      squares += ratio * ratio / 100.0;
    }
    EXPECT_GE(within, 87) << quiet.begin;
    EXPECT_NEAR(std::sqrt(squares), 1.0, 0.25) << quiet.begin;
  }
}

TEST(Integrate, MakesSiOfItsUnit) {
  const Sampling at{.start = 0.0, .interval = 1.0, .samples = 3};
  auto velocity = velocity_of(at, {1.0, 1.0, 1.0});
  velocity.unit = "mm/s";
  const Derived x = integrate(velocity);
  EXPECT_EQ(x.channel.unit, "m");
  EXPECT_DOUBLE_EQ(x.channel.value(2), 2e-3);
  EXPECT_EQ(integrate(force_of(at, {1.0, 1.0, 1.0})).channel.unit, "(N) s");
}

// 4 mV/N are 4 mV s a newton second, and 4 mV/s a newton a second.
TEST(Calculus, KeepsTheCalibrationInUnitsOfItsOwn) {
  const Sampling at{.start = 0.0, .interval = 0.1, .samples = 5};
  Channel force = force_of(at, {1.0, 2.0, 1.0, 2.0, 1.0});
  force.calibration = {0.004, 1e-5, "V", "N", "certificate"};
  const Channel impulse = integrate(force).channel, rate = differentiate(force).channel;
  EXPECT_EQ(impulse.calibration->sensitivity, 0.004);
  EXPECT_EQ(impulse.calibration->uncertainty, 1e-5);
  EXPECT_EQ(impulse.calibration->recorded_unit, "(V) s");
  EXPECT_EQ(impulse.calibration->physical_unit, "(N) s");
  EXPECT_EQ(rate.calibration->recorded_unit, "(V)/s");
  EXPECT_EQ(rate.calibration->physical_unit, "(N)/s");
}

TEST(Integrate, BridgesInvalidSamples) {
  const Sampling at{.start = 0.0, .interval = 1.0, .samples = 5};
  auto velocity = velocity_of(at, {0.0, 1.0, std::nan(""), 3.0, 4.0});
  velocity.valid = {1, 1, 0, 1, 1};
  const Derived x = integrate(velocity);
  EXPECT_DOUBLE_EQ(x.channel.value(4), 8.0);
  EXPECT_EQ(x.channel.valid, velocity.valid);
}

// One sample that is not a number was the end of the integral.
TEST(Integrate, BridgesAndMarksWhatIsNotFinite) {
  const Sampling at{.start = 0.0, .interval = 1.0, .samples = 5};
  const Derived x = integrate(velocity_of(at, {0.0, 1.0, NAN, 3.0, 4.0}));
  EXPECT_DOUBLE_EQ(x.channel.value(4), 8.0);
  EXPECT_EQ(x.channel.valid, (std::vector<std::uint8_t>{1, 1, 0, 1, 1}));
}

TEST(Integrate, StatesWhereItIsZeroWithinTheRecord) {
  const Sampling at{.start = 0.0, .interval = 1.0, .samples = 5};
  const auto velocity = velocity_of(at, {0.0, 1.0, 2.0, 3.0, 4.0});
  EXPECT_EQ(integrate(velocity, {.zero_at = 99.0}).edit.parameters.at("zero at"), "4 s");
  EXPECT_EQ(integrate(velocity, {.zero_at = 1.5}).edit.parameters.at("zero at"), "1.5 s");
}

TEST(Calculus, LeavesWithoutAUnitWhatHasNone) {
  const Sampling at{.start = 0.0, .interval = 1.0, .samples = 5};
  Channel channel = channel_of("x", Quantity::unknown, at, {0.0, 1.0, 2.0, 3.0, 4.0});
  channel.unit.clear();
  EXPECT_EQ(integrate(channel).channel.unit, "");
  EXPECT_EQ(differentiate(channel).channel.unit, "");
}

TEST(Differentiate, IsExactForAPolynomialOfDegreeFour) {
  const Sampling at{.start = -1.0, .interval = 0.125, .samples = 17};
  const auto x = channel_of("x", Quantity::displacement, at, sampled(at, [](double t) {
                              return 1.0 + t * (2.0 + t * (3.0 + t * (4.0 + 5.0 * t)));
                            }));
  const Derived v = differentiate(x);
  for (std::size_t i = 0; i < at.samples; ++i) {
    const double t = at.time(i);
    EXPECT_NEAR(v.channel.value(i), 2.0 + t * (6.0 + t * (12.0 + 20.0 * t)), 1e-11) << i;
  }
  EXPECT_EQ(v.channel.quantity, Quantity::velocity);
  EXPECT_EQ(v.channel.unit, "m/s");
  EXPECT_EQ(v.edit.what, "differentiate");
}

// (w h)⁴/30 of the derivative: halving the step divides the error by 16.
TEST(Differentiate, ConvergesWithOrderFour) {
  const double w = 2.0 * pi;
  const auto error = [&](double h) {
    const Sampling at{.start = 0.0, .interval = h, .samples = static_cast<std::size_t>(2.0 / h)};
    const Derived v = differentiate(channel_of(
        "x", Quantity::displacement, at, sampled(at, [&](double t) { return std::sin(w * t); })));
    double largest = 0.0;
    for (std::size_t i = 2; i + 2 < at.samples; ++i)
      largest = std::max(largest, std::abs(v.channel.value(i) - w * std::cos(w * at.time(i))));
    return largest;
  };
  EXPECT_NEAR(error(0.01), w * std::pow(w * 0.01, 4) / 30.0, 0.01 * error(0.01));
  EXPECT_NEAR(std::log2(error(0.02) / error(0.01)), 4.0, 0.05);
}

TEST(Differentiate, AmplifiesWhiteNoiseAsDocumented) {
  const Sampling at{.start = 0.0, .interval = 1e-6, .samples = 100000};
  std::vector<double> values(at.samples, 0.0);
  add_noise(values, 1e-3, 9);
  const Derived a = differentiate(velocity_of(at, values));
  double power = 0.0;
  for (const double value : a.channel.values()) power += value * value;
  EXPECT_NEAR(std::sqrt(power / 1e5), 0.95 * 1e-3 / 1e-6, 0.02 * 950.0);
}

TEST(Differentiate, MarksWhatTouchesAnInvalidSample) {
  const Sampling at{.start = 0.0, .interval = 1.0, .samples = 13};
  auto velocity = velocity_of(at, std::vector<double>(13, 1.0));
  velocity.valid = {1, 1, 1, 1, 1, 1, 0, 1, 1, 1, 1, 1, 1};
  EXPECT_EQ(differentiate(velocity).channel.valid,
            (std::vector<std::uint8_t>{1, 1, 1, 1, 0, 0, 0, 0, 0, 1, 1, 1, 1}));
}

TEST(Differentiate, MarksWhatTouchesWhatIsNotFinite) {
  const Sampling at{.start = 0.0, .interval = 1.0, .samples = 13};
  auto values = std::vector<double>(13, 1.0);
  values[6] = INFINITY;
  const Channel slope = differentiate(velocity_of(at, values)).channel;
  EXPECT_EQ(slope.valid, (std::vector<std::uint8_t>{1, 1, 1, 1, 0, 0, 0, 0, 0, 1, 1, 1, 1}));
  for (std::size_t i = 0; i < 13; ++i) EXPECT_DOUBLE_EQ(slope.value(i), 0.0) << i;
}

// Each undoes the other up to the error of the trapezoidal rule.
TEST(Differentiate, UndoesIntegrate) {
  const double w = 2.0 * pi * 5e3, h = 1e-6;
  const Sampling at{.start = 0.0, .interval = h, .samples = 1000};
  const auto velocity = velocity_of(at, sampled(at, [&](double t) { return std::cos(w * t); }));
  const Derived back = differentiate(integrate(velocity).channel);
  for (std::size_t i = 2; i + 2 < at.samples; ++i)
    ASSERT_NEAR(back.channel.value(i), velocity.value(i), 1.1 * w * h * w * h / 12.0) << i;
}

TEST(Calculus, RefusesWhatHasNoSoundSample) {
  const Sampling at{.start = 0.0, .interval = 1.0, .samples = 8};
  Channel channel = velocity_of(at, std::vector<double>(8, 1.0));
  channel.valid.assign(8, 0);
  const auto refusal = testing::ThrowsMessage<std::invalid_argument>(
      "channel 'Velocity' has no sound sample; choose another channel");
  EXPECT_THAT([&] { integrate(channel); }, refusal);
  EXPECT_THAT([&] { differentiate(channel); }, refusal);
}

TEST(Calculus, RefusesWhatIsNoHistory) {
  const auto refusal = [](int least) {
    return "channel 'Velocity' cannot be integrated or differentiated: it must be a real time "
           "history of at least " +
           std::to_string(least) + " samples at uniform steps";
  };
  EXPECT_THAT([] { integrate(velocity_of({}, {1.0})); },
              testing::ThrowsMessage<std::invalid_argument>(refusal(2)));
  EXPECT_THAT(
      [] {
        differentiate(velocity_of({}, {1.0, 2.0}));
      },
      testing::ThrowsMessage<std::invalid_argument>(refusal(5)));
}

}  // namespace

}  // namespace impactrig::acquisition
