// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/delay.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <stdexcept>

#include "tests/acquisition/marked_samples.hpp"
#include "tests/acquisition/scene.hpp"

namespace impactrig::acquisition {

namespace {

using datasets::Quantity;
using datasets::TimeSpan;
using namespace tests;

constexpr double pi = std::numbers::pi;
constexpr double width = 200e-6;  ///< of the pulse [s]
constexpr Sampling at;            // from -1 ms, 1 MHz, 4 ms

double force_at(double t) {
  return 2000.0 * std::pow(half_sine(t, 1.0, width), 1.5);
}

/// The speed that a kernel a t^(-1/2) + b + c t^(1/2) takes from 0.44 m/s: substituted s = t - u²,
/// so that the integrand is smooth, and summed by the midpoint rule.
double struck_velocity(double t) {
  if (t <= 0.0) return 0.44;
  constexpr int n = 4000;
  const double top = std::sqrt(t), step = top / n;
  double lost = 0.0;
  for (int i = 0; i < n; ++i) {
    const double u = step * (i + 0.5);
    lost += 2.0 * step * (0.02 + 2.5 * u + 40.0 * u * u) * force_at(t - u * u);
  }
  return 0.44 - lost;
}

TimeSpan to_peak() {
  return {-450e-6, 0.5 * width};
}

TEST(EstimateDelay, OfAStruckBarIsFoundWithoutKnowingTheBar) {
  for (const double delay : {-7.3e-6, -0.4e-6, 0.0, 0.25e-6, 3.0e-6, 21.7e-6}) {
    const auto force = force_of(at, sampled(at, force_at));
    const auto velocity =
        velocity_of(at, sampled(at, [&](double t) { return struck_velocity(t - delay); }));
    const DelayEstimate found = estimate_delay(force, velocity, to_peak(), 50e-6);
    EXPECT_NEAR(found.value, delay, 3.0 * found.uncertainty) << delay;
    EXPECT_LT(found.uncertainty, 0.2e-6) << delay;
    // The other way round it is the other sign.
    EXPECT_NEAR(estimate_delay(velocity, force, to_peak(), 50e-6).value, -delay,
                3.0 * found.uncertainty);
  }
}

// 40 noisy records: the errors are what is stated. By chi² their mean square in units of the stated
// one lies within 0.4 and 2 with more than 99.9 % when they are normal; less is allowed, since what
// a further term would change is a bound and no standard deviation.
TEST(EstimateDelay, OfAStruckBarStatesItsErrorHonestly) {
  const auto clean = sampled(at, [](double t) { return struck_velocity(t - 2.4e-6); });
  double squares = 0.0;
  int within = 0;
  std::vector<double> stated;
  constexpr int trials = 40;
  for (int seed = 1; seed <= trials; ++seed) {
    auto force = sampled(at, force_at);
    add_noise(force, 3.0, static_cast<std::uint64_t>(seed));
    auto velocity = clean;
    add_noise(velocity, 1.25e-3, static_cast<std::uint64_t>(1000 + seed));
    const DelayEstimate found =
        estimate_delay(force_of(at, force), velocity_of(at, velocity), to_peak(), 50e-6);
    const double error = (found.value - 2.4e-6) / found.uncertainty;
    squares += error * error / trials;
    within += std::abs(error) < 2.0;
    stated.push_back(found.uncertainty);
  }
  std::ranges::sort(stated);
  EXPECT_LT(stated[trials / 2], 2e-6);
  EXPECT_LT(squares, 2.0);
  EXPECT_GE(within, trials * 9 / 10);
}

/// As above, with what comes back from a free end: cos(x²/4at) beside t^(-1/2), of which no power
/// of the root of time is a part. `echo` is x²/4a [s]; shear takes away what is faster than 5 us.
std::vector<double> velocity_near_an_end(double duration, double echo) {
  constexpr int n = 2000;
  return sampled(at, [&](double t) {
    if (t <= 0.0) return 0.44;
    const double top = std::sqrt(t), step = top / n;
    double lost = 0.0;
    for (int i = 0; i < n; ++i) {
      const double u = step * (i + 0.5), s = u * u;
      const double back = std::cos(echo / s) * std::exp(-std::pow(echo * 5e-6 / (s * s), 2));
      const double force = 2000.0 * std::pow(half_sine(t - s, 1.0, duration), 1.5);
      lost += 2.0 * step * (0.02 * (1.0 + back) + 2.5 * u) * force;
    }
    return 0.44 - lost;
  });
}

// Of 24 errors 5 were beyond twice what was stated, up to six times.
TEST(EstimateDelay, NearAnEndStatesWhatTheExpansionLeavesOut) {
  int within = 0, trials = 0;
  for (const double duration : {150e-6, 250e-6, 350e-6})
    for (const double echo : {100e-6, 200e-6, 320e-6, 500e-6})
      for (const double noise : {0.1, 1.0}) {
        auto force = sampled(
            at, [&](double t) { return 2000.0 * std::pow(half_sine(t, 1.0, duration), 1.5); });
        auto velocity = velocity_near_an_end(duration, echo);
        add_noise(force, noise, 1);
        add_noise(velocity, 4e-4 * noise, 2);
        const DelayEstimate found =
            estimate_delay(force_of(at, force), velocity_of(at, velocity),
                           {-2.0 * duration - 50e-6, 0.5 * duration}, 50e-6);
        within += std::abs(found.value) < 2.0 * found.uncertainty;
        ++trials;
      }
  EXPECT_GE(10 * within, 9 * trials) << within << " of " << trials;
}

TEST(EstimateDelay, OfTheSameMotionTwice) {
  for (const double delay : {-3.3e-6, 0.0, 0.07e-6, 12.0e-6}) {
    double squares = 0.0;
    constexpr int trials = 30;
    const auto clean = sampled(at, struck_velocity);
    const auto late =
        sampled(at, [&](double t) { return 1.03 * struck_velocity(t - delay) + 0.02; });
    for (int seed = 1; seed <= trials; ++seed) {
      auto first = clean, second = late;
      add_noise(first, 0.5e-3, static_cast<std::uint64_t>(seed));
      add_noise(second, 1e-3, static_cast<std::uint64_t>(100 + seed));
      const DelayEstimate found =
          estimate_delay(velocity_of(at, first), velocity_of(at, second), {-0.3e-3, 0.6e-3}, 50e-6);
      EXPECT_EQ(found.terms, 1);
      EXPECT_LT(found.uncertainty, 0.1e-6);
      const double error = (found.value - delay) / found.uncertainty;
      squares += error * error / trials;
    }
    EXPECT_GT(squares, 0.35) << delay;
    EXPECT_LT(squares, 2.2) << delay;
  }
}

// Delays of two noisy records of one motion, whichever of them has the noise: of 60 intervals of 95
// % at least 52 hold but for one in 100 such tests. The noise of the reference has slopes too,
// which were taken for the motion's: 29 held. Where these are nine times the motion's own, how much
// of the sum is left is hardly known: 47 hold, 12 did.
TEST(EstimateDelay, OfNoisyRecordsOfOneMotionStatesItsErrorHonestly) {
  const Sampling longer{.start = -1e-3, .interval = 1e-6, .samples = 3000};
  const auto motion = [](double t) { return 0.4 - 0.55 / (1.0 + std::exp(-(t - 2e-4) / 3e-5)); };
  for (const auto& [of_reference, of_channel] :
       {std::pair{0.01, 0.01}, std::pair{0.02, 0.02}, std::pair{0.01, 0.0}, std::pair{0.0, 0.01}}) {
    int held = 0;
    double squares = 0.0, stated = 0.0;
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
      Noise random(seed);
      const double delay = 40e-6 * (random.uniform() - 0.5);
      auto first = sampled(longer, motion);
      auto second = sampled(longer, [&](double t) { return motion(t - delay); });
      add_noise(first, of_reference, 2 * seed);
      add_noise(second, of_channel, 2 * seed + 1);
      const DelayEstimate found = estimate_delay(velocity_of(longer, first),
                                                 velocity_of(longer, second), {-1e-3, 2e-3}, 50e-6);
      held += std::abs(found.value - delay) <= 1.96 * found.uncertainty ? 1 : 0;
      squares += std::pow(found.value - delay, 2);
      stated += std::pow(found.uncertainty, 2);
    }
    EXPECT_GE(held, of_reference == 0.02 ? 45 : 52) << of_reference << " " << of_channel;
    EXPECT_LT(stated, 4.0 * squares) << of_reference << " " << of_channel;
  }
}

// Displacement against velocity of the same laser: the decoder's own delay.
TEST(EstimateDelay, OfAnIntegral) {
  std::vector<double> way(at.samples, 0.0);
  const auto velocity = sampled(at, struck_velocity);
  for (std::size_t i = 1; i < way.size(); ++i)
    way[i] = way[i - 1] + 0.5e-6 * (velocity[i - 1] + velocity[i]);
  auto shifted = channel_of("x", Quantity::displacement, at, way);
  shifted.clock.start += 0.9e-6;
  const auto reference = velocity_of(at, velocity);
  const TimeSpan window{-0.3e-3, 0.6e-3};
  EXPECT_NEAR(estimate_delay(reference, shifted, window, 20e-6).value, 0.9e-6, 2e-9);
  EXPECT_NEAR(estimate_delay(shifted, reference, window, 20e-6).value, -0.9e-6, 2e-9);
}

// 40 noisy records as above. White noise of the velocity is a random walk of its integral.
TEST(EstimateDelay, OfAnIntegralStatesItsErrorHonestly) {
  std::vector<double> way(at.samples, 0.0);
  const auto clean = sampled(at, struck_velocity);
  for (std::size_t i = 1; i < way.size(); ++i)
    way[i] = way[i - 1] + 0.5e-6 * (clean[i - 1] + clean[i]);
  double squares = 0.0;
  constexpr int trials = 40;
  for (int seed = 1; seed <= trials; ++seed) {
    auto velocity = clean, displacement = way;
    add_noise(velocity, 1e-3, static_cast<std::uint64_t>(seed));
    add_noise(displacement, 20e-9, static_cast<std::uint64_t>(500 + seed));
    auto shifted = channel_of("x", Quantity::displacement, at, displacement);
    shifted.clock.start += 0.9e-6;
    const DelayEstimate found =
        estimate_delay(velocity_of(at, velocity), shifted, {-0.5e-3, 0.6e-3}, 20e-6);
    EXPECT_LT(found.uncertainty, 0.1e-6);
    squares += std::pow((found.value - 0.9e-6) / found.uncertainty, 2) / trials;
  }
  EXPECT_GT(squares, 0.4);
  EXPECT_LT(squares, 2.0);
}

TEST(RemoveEstimatedDelay, TakesItOffTheClockBesideWhatWasKnown) {
  auto late = velocity_of(at, sampled(at, struck_velocity));
  late.delay = datasets::Delay{2e-6, 1e-6, true};
  const auto edit = remove_estimated_delay({5e-6, 0.2e-6, 0.01, 2}, "Force", late);
  EXPECT_NEAR(late.clock.start, at.start - 5e-6, 1e-12);
  EXPECT_NEAR(late.delay->value, 7e-6, 1e-12);
  EXPECT_EQ(late.delay->uncertainty, 0.2e-6);
  EXPECT_TRUE(late.delay->removed);
  EXPECT_EQ(edit.what, "align");
  EXPECT_EQ(edit.parameters.at("reference"), "Force");
  EXPECT_EQ(edit.parameters.at("delay"), "5e-06 s");
  EXPECT_EQ(edit.parameters.at("uncertainty"), "2e-07 s");
}

std::string refusal(const datasets::Channel& reference, const datasets::Channel& channel,
                    const TimeSpan& window, double range) {
  try {
    estimate_delay(reference, channel, window, range);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return {};
}

TEST(EstimateDelay, RefusesWhatHasNoRelation) {
  const auto velocity = velocity_of(at, sampled(at, struck_velocity));
  const TimeSpan window{-0.3e-3, 0.6e-3};
  EXPECT_EQ(refusal(velocity, channel_of("T", Quantity::temperature, at, sampled(at, force_at)),
                    window, 20e-6),
            "channel 'T' (temperature) does not follow from 'Velocity' (velocity), so no delay "
            "between them can be estimated");
  auto late = velocity;
  late.clock.start += 40e-6;
  EXPECT_EQ(refusal(velocity, late, window, 20e-6),
            "no delay within 2e-05 s makes one channel follow the other: the best one is at the "
            "edge of that range");
  std::vector<double> other(at.samples, 0.0);
  add_noise(other, 1.0, 3);
  EXPECT_NE(refusal(velocity, velocity_of(at, other), window, 20e-6), "");
  EXPECT_NE(refusal(velocity, velocity, {0.0, 5e-6}, 20e-6), "");
  EXPECT_NE(refusal(velocity, velocity, window, 0.0), "");
}

// It was taken off, with an uncertainty of more than the range: right clocks were moved.
TEST(EstimateDelay, RefusesWhatTellsNoMoreThanTheRange) {
  int unknown = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    std::vector<double> noisy = sampled(at, struck_velocity);
    add_noise(noisy, 0.03, seed);
    const std::string why =
        refusal(force_of(at, sampled(at, force_at)), velocity_of(at, noisy), to_peak(), 10e-6);
    if (why.find("as much as if nothing but the range of 1e-05 s") != std::string::npos) ++unknown;
    if (!why.empty()) continue;
    EXPECT_LE(estimate_delay(force_of(at, sampled(at, force_at)), velocity_of(at, noisy), to_peak(),
                             10e-6)
                  .uncertainty,
              10e-6 / std::sqrt(3.0));
  }
  EXPECT_GE(unknown, 3);
}

/// A velocity of a ringing bar and its integral, exact.
double ringing_velocity(double t) {
  const double part = std::clamp(t / width, 0.0, 1.0);
  const double ringing =
      t > 0.0 ? 0.05 * std::sin(2.0 * pi * t / 150e-6) * std::exp(-t / 3e-4) : 0.0;
  return 0.5 - 0.45 * (1.0 - std::cos(pi * part)) + ringing;
}

double ringing_displacement(double t) {
  const double part = std::clamp(t / width, 0.0, 1.0), late = std::max(0.0, t);
  const double w = 2.0 * pi / 150e-6, d = 1.0 / 3e-4;
  const double decayed = std::exp(-d * late) * (d * std::sin(w * late) + w * std::cos(w * late));
  const double flight = std::min(0.0, t) - std::max(0.0, t - width);  // at 0.45 and -0.45 m/s
  return 0.05 * t + 0.45 * flight + 0.45 * width / pi * std::sin(pi * part) +
         0.05 * (w - decayed) / (w * w + d * d);
}

// 40 records each with two fifths of both channels marked in stretches of 5 to 40 samples. Lines in
// their place were followed: 26 errors of two velocities were within 1.96 stated ones, 15 of a
// velocity and a displacement.
TEST(EstimateDelay, LeavesOutWhatIsNotValid) {
  for (const bool integrated : {false, true}) {
    int within = 0;
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
      Noise noise(seed);
      const double delay = 20e-6 * (noise.uniform() - 0.5);
      auto first = sampled(at, ringing_velocity);
      auto second = sampled(at, [&](double t) {
        return integrated ? ringing_displacement(t - delay) : ringing_velocity(t - delay);
      });
      add_noise(first, 2e-3, seed + 100);
      add_noise(second, integrated ? 1e-7 : 2e-3, seed + 200);
      auto reference = velocity_of(at, first);
      auto channel =
          channel_of("Later", integrated ? Quantity::displacement : Quantity::velocity, at, second);
      mark_stretches(reference, 0.4, 500, 1700, noise, 5, 40);
      mark_stretches(channel, 0.4, 500, 1700, noise, 5, 40);
      const DelayEstimate found = estimate_delay(reference, channel, {-400e-6, 600e-6}, 30e-6);
      within += std::abs(found.value - delay) < 1.96 * found.uncertainty;
    }
    EXPECT_GE(within, 33) << integrated;  // fewer: 0.6 % of a normal law
  }
}

TEST(EstimateDelay, RefusesWhereTooLittleIsValid) {
  auto reference = velocity_of(at, sampled(at, ringing_velocity));
  auto channel = reference;
  channel.valid.assign(at.samples, 1);
  std::fill_n(channel.valid.begin() + 605, 990, std::uint8_t{0});
  EXPECT_THROW(estimate_delay(reference, channel, {-400e-6, 600e-6}, 30e-6), std::invalid_argument);
}

}  // namespace

}  // namespace impactrig::acquisition
