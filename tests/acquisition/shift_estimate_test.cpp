// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/shift_estimate.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "tests/acquisition/scene.hpp"

namespace impactrig::acquisition {

namespace {

using datasets::TimeSpan;
using namespace tests;

/// sin^power over [touch, touch + duration] of height 1, in samples.
struct Pulse {
  double touch = 100.0, duration = 20.0;
  int power = 2;
  double noise = 0.0;
  std::uint64_t seed = 1;
};

Trace trace_of(const Pulse& pulse, std::size_t samples = 300) {
  Trace trace{datasets::Quantity::force, 0.0, 1.0, {}, {}};
  for (std::size_t i = 0; i < samples; ++i)
    trace.values.push_back(std::pow(
        half_sine(static_cast<double>(i) - pulse.touch, 1.0, pulse.duration), pulse.power));
  add_noise(trace.values, pulse.noise, pulse.seed);
  return trace;
}

TimeSpan window_of(const Pulse& pulse) {
  return {pulse.touch - pulse.duration, pulse.touch + 2.0 * pulse.duration};
}

std::string refusal(const Trace& x, const Trace& y, const TimeSpan& window, double range) {
  try {
    estimate_shift(x, y, window, range);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return {};
}

// The power of sin² over n samples beyond half of the rate, which aliases, falls as n⁻⁵.
TEST(ShiftEstimate, FindsTheShiftOfPulsesOfAFewSamples) {
  for (const double duration : {5.0, 7.0, 9.0, 14.0, 40.0, 3000.0})
    for (const double shift : {-0.7, -0.25, 0.0, 0.5, 0.61 * duration}) {
      const auto n = static_cast<std::size_t>(200.0 + 5.0 * duration);
      const Pulse first{.touch = 100.3 + duration, .duration = duration};
      Pulse second = first;
      second.touch += shift;
      const ShiftEstimate found =
          estimate_shift(trace_of(first, n), trace_of(second, n), window_of(first), duration);
      const double aliased = 0.04 * std::pow(5.0 / duration, 2.5) + 1e-4;
      EXPECT_NEAR(found.value, shift, aliased) << duration;
    }
}

// Errors are as large as stated, whatever the noise and the sampling.
TEST(ShiftEstimate, StatesItsUncertainty) {
  for (const Pulse& kind : {Pulse{.duration = 8.0, .noise = 0.005}, Pulse{.noise = 0.01},
                            Pulse{.power = 8, .noise = 0.03}, Pulse{.noise = 0.08},
                            Pulse{.touch = 200.0, .duration = 100.0, .noise = 0.03},
                            Pulse{.touch = 200.0, .duration = 100.0, .power = 1, .noise = 0.01}}) {
    double squares = 0.0, most = 0.0;
    constexpr int runs = 100;
    for (int run = 0; run < runs; ++run) {
      Pulse first = kind, second = kind;
      second.touch += 0.013 * run;
      first.seed = static_cast<std::uint64_t>(2 * run + 1);
      second.seed = static_cast<std::uint64_t>(2 * run + 2);
      const ShiftEstimate found = estimate_shift(trace_of(first, 600), trace_of(second, 600),
                                                 window_of(first), kind.duration);
      const double z = (found.value - 0.013 * run) / found.uncertainty;
      squares += z * z / runs;
      most = std::max(most, std::abs(z));
    }
    // 100 squares of normal numbers have a mean of 1 ± 0.14; that of the surest of several steps is
    // stated a little too small, that of pulses of a few samples too large, as some of them may lie
    // beyond half of the rate.
    EXPECT_GT(std::sqrt(squares), 0.6) << kind.duration << ' ' << kind.noise;
    EXPECT_LT(std::sqrt(squares), 1.25) << kind.duration << ' ' << kind.noise;
    EXPECT_LT(most, 5.0) << kind.duration << ' ' << kind.noise;
  }
}

// A force that jumps between two samples tells no more than that.
TEST(ShiftEstimate, StatesWhatAJumpLeavesOpen) {
  double squares = 0.0;
  constexpr int runs = 40;
  for (int run = 0; run < runs; ++run) {
    const auto jump = [&](double touch, std::uint64_t seed) {
      Trace trace{datasets::Quantity::force, 0.0, 1.0, {}, {}};
      for (std::size_t i = 0; i < 300; ++i) {
        const double u = (static_cast<double>(i) - touch) / 50.0;
        trace.values.push_back(u > 0.0 && u < 1.0 ? 1.0 - u : 0.0);
      }
      add_noise(trace.values, 1e-3, seed);
      return trace;
    };
    Noise random(static_cast<std::uint64_t>(run + 1));
    const double first = 100.0 + random.uniform(), second = 100.0 + random.uniform();
    const ShiftEstimate found =
        estimate_shift(jump(first, 1), jump(second, 2), {50.0, 200.0}, 50.0);
    squares += std::pow((found.value - (second - first)) / found.uncertainty, 2) / runs;
  }
  EXPECT_GT(std::sqrt(squares),
            0.5);  // what lies beyond half of the rate is known to a factor of 2
  EXPECT_LT(std::sqrt(squares), 2.0);
}

// Level, drift and size of the two may differ, and so may their clocks.
TEST(ShiftEstimate, LeavesGainOffsetAndDriftFree) {
  const Pulse first{.duration = 24.0};
  const Trace x = trace_of(first);
  Trace y{datasets::Quantity::force, -7.0, 0.7, {}, {}};
  for (std::size_t i = 0; i < 400; ++i) {
    const double t = y.time(static_cast<double>(i));
    y.values.push_back(3.0 - 0.01 * t +
                       0.6 * sine_squared(t - first.touch - 1.37, 1.0, first.duration));
  }
  EXPECT_NEAR(estimate_shift(x, y, window_of(first), 10.0).value, 1.37, 2e-3);
}

TEST(ShiftEstimate, LeavesInvalidSamplesOut) {
  const Pulse first{};
  const Trace x = trace_of(first);
  Trace y = trace_of({.touch = 102.5});
  y.valid.assign(y.values.size(), 1);
  for (std::size_t i = 118; i < 124; ++i) {
    y.values[i] = 0.0;
    y.valid[i] = 0;
  }
  bridge_invalid(y.values, y.valid);
  EXPECT_NEAR(estimate_shift(x, y, window_of(first), 10.0).value, 2.5, 0.1);
}

TEST(ShiftEstimate, RefusesWhatHasNoLikeness) {
  const Pulse first{};
  const Trace x = trace_of(first);
  Trace noise = x;
  std::ranges::fill(noise.values, 0.0);
  add_noise(noise.values, 0.1, 7);
  EXPECT_THAT(refusal(x, noise, window_of(first), 5.0), testing::HasSubstr("left over is"));
  Trace turned = x;
  for (double& value : turned.values) value = -value;
  EXPECT_NE(refusal(x, turned, window_of(first), 5.0), "");
  EXPECT_EQ(refusal(x, trace_of({.touch = 106.0}), window_of(first), 5.0),
            "the best shift is at the edge of +-5 s");
  EXPECT_EQ(refusal(x, x, {100.0, 105.0}, 5.0), "6 samples are too few");
  Trace lost = x;
  lost.valid.assign(lost.values.size(), 1);
  std::fill(lost.valid.begin() + 70, lost.valid.begin() + 130, 0);
  EXPECT_THAT(refusal(x, lost, window_of(first), 5.0), testing::EndsWith("are sound in both"));
}

}  // namespace

}  // namespace impactrig::acquisition
