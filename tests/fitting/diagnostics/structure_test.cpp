// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/diagnostics/structure.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/fitting/diagnostics/noise.hpp"

namespace impactrig::fitting {
namespace {

using tests::gaussian_noise;

constexpr std::size_t count = 1500;
constexpr double interval = 1e-6, contact = 300e-6;

/// A pulse of 500, then a vibration of 5 at 4 kHz.
double pulse(double t) {
  const double hit =
      t < contact ? 500.0 * std::pow(std::sin(std::numbers::pi * t / contact), 2.0) : 0.0;
  return hit + 5.0 * std::sin(2.0 * std::numbers::pi * 4000.0 * t);
}

std::vector<double> model() {
  std::vector<double> out;
  for (std::size_t i = 0; i < count; ++i) out.push_back(pulse(interval * static_cast<double>(i)));
  return out;
}

std::vector<Structure> found_in(const std::vector<double>& residual) {
  const std::vector<double> m = model();
  return structures({residual, m, 0.0, interval, contact, "N"},
                    noise_colour(gaussian_noise(2000, 77)));
}

const Structure& of(const std::vector<Structure>& all, const std::string& kind) {
  for (const Structure& s : all)
    if (s.kind == kind) return s;
  throw std::out_of_range(kind);
}

template <typename Shape>
std::vector<double> noise_and(Shape shape) {
  std::vector<double> out = gaussian_noise(count, 78);
  for (std::size_t i = 0; i < count; ++i) out[i] += shape(interval * static_cast<double>(i));
  return out;
}

TEST(Structures, TellADelayFromAGain) {
  const double late = 0.5e-6;
  const auto delayed = found_in(noise_and([&](double t) { return pulse(t - late) - pulse(t); }));
  const Structure& delay = of(delayed, "delay");
  EXPECT_NEAR(delay.amount, late, 4.0 * delay.std_error);
  EXPECT_LT(delay.p_value, 1e-10);
  EXPECT_GT(delay.share, 5.0 * of(delayed, "gain").share);
  const auto louder = found_in(noise_and([](double t) { return 0.02 * pulse(t); }));
  const Structure& gain = of(louder, "gain");
  EXPECT_NEAR(gain.amount, 0.02, 4.0 * gain.std_error);
  EXPECT_LT(gain.p_value, 1e-10);
  EXPECT_GT(gain.share, 5.0 * of(louder, "delay").share);
}

TEST(Structures, SizeOffsetAndDrift) {
  const auto shifted = found_in(noise_and([](double) { return 0.7; }));
  EXPECT_NEAR(of(shifted, "offset").amount, 0.7, 4.0 * of(shifted, "offset").std_error);
  const auto drifting = found_in(noise_and([](double t) { return 1000.0 * t; }));
  EXPECT_NEAR(of(drifting, "drift").amount, 1000.0, 4.0 * of(drifting, "drift").std_error);
  EXPECT_EQ(of(drifting, "drift").unit, "N/s");
}

// 1200 samples after the contact resolve 1 / 1.2 ms = 833 Hz, a line's place far better.
TEST(Structures, FindALineTheModelLacks) {
  const auto ringing = found_in(noise_and(
      [](double t) { return 0.6 * std::cos(2.0 * std::numbers::pi * 21300.0 * t + 0.4); }));
  const Structure& line = of(ringing, "vibration");
  EXPECT_NEAR(line.frequency, 21300.0, 250.0);
  EXPECT_NEAR(line.amount, 0.6, 4.0 * line.std_error);
  EXPECT_LT(line.p_value, 1e-10);
  EXPECT_LT(line.model_amplitude, 0.6);
  const auto mistuned =
      found_in(noise_and([](double t) { return std::cos(2.0 * std::numbers::pi * 4000.0 * t); }));
  EXPECT_NEAR(of(mistuned, "vibration").model_amplitude, 5.0, 0.5);
}

// Bonferroni's bound: at most 5 %; 300 noises, 15 and four deviations of 3.8.
TEST(Structures, RarelySeeALineInNoise) {
  int seen = 0;
  const std::vector<double> m = model();
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    const std::vector<double> x = gaussian_noise(1000 + count, 300 + seed, 0.7);
    const std::span<const double> all(x);
    const NoiseColour colour = noise_colour(all.first(1000));
    const AfterTouch after{all.subspan(1000), m, 0.0, interval, contact, "N"};
    seen += vibration(after, colour).p_value < 0.05 ? 1 : 0;
  }
  EXPECT_LE(seen, 30);
}

}  // namespace
}  // namespace impactrig::fitting
