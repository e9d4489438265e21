// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/undo_chain.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "datasets/sensor_response.hpp"

namespace impactrig::fitting {
namespace {

/// A pulse of sine squared, 200 us long, from 100 us on.
std::vector<double> pulse(double interval) {
  std::vector<double> f;
  for (double t = 0.0; t < 0.6e-3; t += interval) {
    const double x = std::clamp((t - 1e-4) / 2e-4, 0.0, 1.0);
    f.push_back(1000.0 * std::pow(std::sin(std::numbers::pi * x), 2));
  }
  return f;
}

double largest_error(const datasets::Sensor& sensor, double interval) {
  const std::vector<double> f = pulse(interval);
  const Undone undone = undo_chain(sensor, datasets::sensor_response(sensor, f, interval), interval,
                                   ChainUndo::resolved);
  EXPECT_TRUE(undone.complete);
  double largest = 0.0;
  for (std::size_t i = 0; i < f.size(); ++i)
    largest = std::max(largest, std::abs(undone.values[i] - f[i]));
  return largest;
}

// What the chain made of a pulse, undone, is the pulse: to 0.2 % of its peak, where the chain
// itself is off by more than 4 % (100 kHz alone delays by 1.6 us).
TEST(UndoChain, GivesBackWhatActedOnTheSensor) {
  datasets::Sensor sensor;
  sensor.resonance = datasets::Resonance{45e3, 20.0};
  EXPECT_LT(largest_error(sensor, 1e-6), 2.0);
  sensor.high_cut = datasets::BandLimit{100e3, 1};
  EXPECT_LT(largest_error(sensor, 1e-6), 2.0);
  sensor.low_cut = datasets::BandLimit{10.0, 1};
  EXPECT_LT(largest_error(sensor, 1e-6), 2.0);
  sensor.low_cut = datasets::BandLimit{10.0, 2};
  EXPECT_LT(largest_error(sensor, 1e-6), 2.0);
  sensor.high_cut = datasets::BandLimit{60e3, 3};
  EXPECT_LT(largest_error(sensor, 1e-6), 10.0);  // at 17 samples a period
}

// At 0 Hz a Butterworth filter of order n delays by 1/(ω sin(π/2n)), a resonance by 1/(Q ω).
TEST(UndoChain, LeavesTheDelayOfWhatTheSamplingDoesNotResolve) {
  datasets::Sensor sensor;
  sensor.resonance = datasets::Resonance{45e3, 20.0};
  sensor.high_cut = datasets::BandLimit{400e3, 2};
  const double omega = 2.0 * std::numbers::pi * 400e3;
  const std::vector<double> f = pulse(1e-6);
  const Undone part = undo_chain(sensor, f, 1e-6, ChainUndo::resolved);
  EXPECT_FALSE(part.complete);
  EXPECT_NEAR(part.delay, std::numbers::sqrt2 / omega, 1e-12);
  const Undone none = undo_chain(sensor, f, 1e-6, ChainUndo::none);
  EXPECT_NEAR(none.delay, std::numbers::sqrt2 / omega + 1.0 / (40.0 * std::numbers::pi * 45e3),
              1e-12);
  EXPECT_EQ(none.values, f);
}

}  // namespace
}  // namespace impactrig::fitting
