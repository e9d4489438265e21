// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <numbers>
#include <optional>
#include <string>

#include "acquisition/conditioning/baseline.hpp"
#include "acquisition/conditioning/decay.hpp"
#include "tests/acquisition/marked_samples.hpp"
#include "tests/acquisition/scene.hpp"

namespace impactrig::acquisition {

namespace {

using datasets::Channel;
using datasets::Edit;
using datasets::TimeSpan;
using namespace tests;

constexpr double lead = 1e-3;  // before touch [s]
constexpr Sampling at{.start = -lead, .interval = 1e-6, .samples = 4000};
constexpr TimeSpan quiet{-lead, -0.05e-3};
constexpr int records = 200;
// A standard error holds the truth within 1.96 times itself in 95 %: a binomial law leaves less
// than this of 200 with a probability of 1e-4.
constexpr int least_held = 177;

/// "12 N at 0 s, uncertain by 0.4 N": 0.4.
double uncertainty_in(const std::string& text) {
  const std::string before = "uncertain by ";
  return std::stod(text.substr(text.find(before) + before.size()));
}

/// Noise x_t = memory x_{t-1} + e_t of 2 N on a course and a pulse, digitised.
struct Scene {
  double memory = 0.0;
  double step = 0.0;  // [N]
};

Channel force_with(const Scene& scene, const std::function<double(double)>& course, Noise& noise) {
  auto values = sampled(at, [&](double t) { return course(t) + half_sine(t, 1500.0, 200e-6); });
  double last = noise();
  for (double& value : values) {
    value += 2.0 * last;
    last = scene.memory * last + std::sqrt(1.0 - scene.memory * scene.memory) * noise();
  }
  if (scene.step > 0.0) round_to(values, scene.step);
  return force_of(at, values);
}

/// How often errors lie within 1.96 of what is stated.
struct Held {
  int count = 0;

  void add(double error, double stated) { count += std::abs(error) < 1.96 * stated ? 1 : 0; }
};

constexpr Scene scenes[] = {{0.0, 0.0}, {0.6, 0.0}, {0.9, 0.0}, {0.0, 2.0}, {0.0, 24.0}};

constexpr std::size_t before_touch = 950;  // samples

/// How many drifts of a record held the line that was added to it.
struct HeldDrift {
  Held level, slope, end;

  void take_off(Channel& force, double offset, double rise) {
    const auto course = [&](double t) { return offset + rise * t; };
    const double last = force.value(at.samples - 1);
    const auto parameters = remove_drift(force, quiet).edit.parameters;
    level.add(std::stod(parameters.at("offset")) - course(0.5 * (quiet.begin + quiet.end)),
              uncertainty_in(parameters.at("offset")));
    slope.add(std::stod(parameters.at("slope")) - rise, uncertainty_in(parameters.at("slope")));
    end.add(last - force.value(at.samples - 1) - course(at.time(at.samples - 1)),
            std::stod(parameters.at("uncertainty")));
  }

  void expect_most() const {
    EXPECT_GE(level.count, least_held);
    EXPECT_GE(slope.count, least_held);
    EXPECT_GE(end.count, least_held);
  }
};

// The error of the slope is that of what came off the record's end.
TEST(RemoveDrift, StatesItsErrorHonestly) {
  for (const Scene& scene : scenes) {
    HeldDrift held;
    for (int seed = 1; seed <= records; ++seed) {
      Noise noise(static_cast<std::uint64_t>(seed));
      const double offset = 300.0 * noise.uniform(), rise = 6e4 * (noise.uniform() - 0.5);
      const auto course = [&](double t) { return offset + rise * t; };
      Channel force = force_with(scene, course, noise);
      held.take_off(force, offset, rise);
    }
    SCOPED_TRACE(testing::Message() << scene.memory << " " << scene.step);
    held.expect_most();
  }
}

// Of a coarse digitiser one value or two are seen: 24 N steps of a level in 2 N of noise.
TEST(RemoveBaseline, StatesItsErrorHonestly) {
  for (const Scene& scene : scenes) {
    Held held;
    for (int seed = 1; seed <= records; ++seed) {
      Noise noise(static_cast<std::uint64_t>(seed));
      const double offset = 300.0 * noise.uniform();
      Channel force = force_with(
          scene, [&](double) { return offset; }, noise);
      const auto parameters = remove_baseline(force, quiet).edit.parameters;
      held.add(std::stod(parameters.at("offset")) - offset,
               std::stod(parameters.at("uncertainty")));
    }
    EXPECT_GE(held.count, least_held) << scene.memory << " " << scene.step;
  }
}

// Of samples bridged by lines the two beside a gap would weigh as much as all within it (the mean
// be off by 2.7 times as much), and the steps of a digitiser not be seen.
TEST(RemoveBaseline, LeavesOutWhatIsNotValid) {
  for (const Scene& scene : {Scene{0.0, 0.0}, Scene{0.9, 0.0}, Scene{0.0, 6.0}}) {
    Held held;
    double squares = 0.0;
    for (int seed = 1; seed <= records; ++seed) {
      Noise noise(static_cast<std::uint64_t>(seed));
      const double offset = 300.0 * noise.uniform();
      Channel force = force_with(
          scene, [&](double) { return offset; }, noise);
      mark_stretches(force, 0.4, 0, before_touch, noise);
      const auto parameters = remove_baseline(force, quiet).edit.parameters;
      const double error = std::stod(parameters.at("offset")) - offset;
      held.add(error, std::stod(parameters.at("uncertainty")));
      squares += error * error;
    }
    SCOPED_TRACE(testing::Message() << scene.memory << " " << scene.step);
    EXPECT_GE(held.count, least_held);
    // the mean of 570 samples of 2 N; a root of 200 squares is off by 5 % itself
    if (scene.memory == 0.0 && scene.step == 0.0) {
      EXPECT_NEAR(std::sqrt(squares / records), 2.0 / std::sqrt(570.0), 0.2 * 0.084);
    }
  }
}

// The further half of the span without a sample: the slope is known by the nearer one alone.
TEST(RemoveDrift, LeavesOutWhatIsNotValid) {
  for (const bool half : {false, true})
    for (const Scene& scene : {Scene{0.0, 0.0}, Scene{0.9, 0.0}, Scene{0.0, 6.0}}) {
      HeldDrift held;
      for (int seed = 1; seed <= records; ++seed) {
        Noise noise(static_cast<std::uint64_t>(seed));
        const double offset = 300.0 * noise.uniform(), rise = 6e4 * (noise.uniform() - 0.5);
        const auto course = [&](double t) { return offset + rise * t; };
        Channel force = force_with(scene, course, noise);
        mark_stretches(force, half ? 0.0 : 0.4, 0, before_touch, noise);
        if (half) std::fill_n(force.valid.begin(), 475, std::uint8_t{0});
        held.take_off(force, offset, rise);
      }
      SCOPED_TRACE(testing::Message() << half << " " << scene.memory << " " << scene.step);
      held.expect_most();
    }
}

TEST(RemoveDecay, StatesTheErrorOfWhatCameOffHonestly) {
  for (const bool stated : {true, false})
    for (const Scene& scene : {Scene{0.0, 0.0}, Scene{0.6, 0.0}, Scene{0.0, 2.0}}) {
      Held end, offset, amplitude;
      for (int seed = 1; seed <= records; ++seed) {
        Noise noise(static_cast<std::uint64_t>(seed));
        const double level = 300.0 * noise.uniform(), time = (0.6 + 0.6 * noise.uniform()) * lead;
        const auto course = [&](double t) { return level + 80.0 * std::exp(-(t + lead) / time); };
        Channel force = force_with(scene, course, noise);
        const double last = force.value(at.samples - 1);
        datasets::RemoveDecay wanted{{quiet}, std::nullopt};
        if (stated) wanted.time_constant = time;
        const auto parameters = remove_decay(force, wanted).parameters;
        end.add(last - force.value(at.samples - 1) - course(at.time(at.samples - 1)),
                std::stod(parameters.at("uncertainty of what came off")));
        offset.add(std::stod(parameters.at("offset")) - level,
                   uncertainty_in(parameters.at("offset")));
        amplitude.add(std::stod(parameters.at("amplitude")) - 80.0,
                      uncertainty_in(parameters.at("amplitude")));
      }
      SCOPED_TRACE(testing::Message() << stated << scene.memory << " " << scene.step);
      EXPECT_GE(end.count, least_held);
      EXPECT_GE(offset.count, least_held);
      EXPECT_GE(amplitude.count, least_held);
    }
}

// Steps of 24 N look like a decay of 60 N: its time constant is not in the data.
TEST(RemoveDecay, RefusesOneThatADigitiserHides) {
  for (int seed = 1; seed <= 100; ++seed) {
    Noise noise(static_cast<std::uint64_t>(seed));
    const double level = 300.0 * noise.uniform();
    const auto course = [&](double t) { return level + 60.0 * std::exp(-(t + lead) / lead); };
    Channel force = force_with({0.0, 24.0}, course, noise);
    EXPECT_THROW(remove_decay(force, {{quiet}, std::nullopt}), std::invalid_argument) << seed;
  }
}

// An error b of the baseline grows to b (1 + 2 pi f t).
TEST(UndoLowCut, StatesWhatTheErrorOfTheBaselineGrowsTo) {
  Noise noise(1);
  Channel force = force_with(
      {}, [](double) { return 12.0; }, noise);
  Channel other = force;
  const double baseline =
      std::stod(remove_baseline(force, quiet).edit.parameters.at("uncertainty"));
  const auto parameters = undo_low_cut(other, {100.0, quiet}).parameters;
  EXPECT_NEAR(std::stod(parameters.at("uncertainty")),
              baseline * (1.0 + 2.0 * std::numbers::pi * 100.0 * 4e-3), 0.06 * baseline * 3.5);
}

// Lines over what is not valid, of noise and of a pulse, go into everything behind them.
TEST(UndoLowCut, StatesWhatBridgesMayMiss) {
  for (const double memory : {0.0, 0.9})
    for (const bool in_pulse : {false, true}) {
      Held held;
      for (int seed = 1; seed <= records; ++seed) {
        Noise noise(static_cast<std::uint64_t>(seed));
        Channel force = force_with(
            {memory, 0.0}, [](double) { return 12.0; }, noise);
        Channel whole = force;
        whole.offset -= 12.0;
        undo_low_cut(whole, {1000.0, std::nullopt});
        mark_stretches(force, 0.4, in_pulse ? 1000 : 0, in_pulse ? 1200 : at.samples, noise);
        const auto parameters = undo_low_cut(force, {1000.0, quiet}).parameters;
        held.add(force.value(at.samples - 1) - whole.value(at.samples - 1),
                 std::stod(parameters.at("uncertainty")));
      }
      EXPECT_GE(held.count, least_held) << memory << " " << in_pulse;
    }
}

}  // namespace

}  // namespace impactrig::acquisition
