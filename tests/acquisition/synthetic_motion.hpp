// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>
#include <vector>

#include "acquisition/synthetic.hpp"
#include "tests/acquisition/scene.hpp"

// Motions, sensors and options, for the tests of synthetic recordings.
namespace impactrig::tests {

using acquisition::SensorSet;
using acquisition::SyntheticOptions;
using acquisition::Trajectory;

inline constexpr double pi = std::numbers::pi;
inline constexpr double height = 1500.0;      // [N]
inline constexpr double duration = 200e-6;    // [s]
inline constexpr double approach = 0.441;     // [m/s]
inline constexpr double fine_step = 0.05e-6;  // [s]

/// Sine-squared force and the velocity it gives a mass whose restitution is 0.5, from -50 us on.
inline Trajectory trajectory_until(double end) {
  Trajectory t;
  t.start = -50e-6;
  t.interval = fine_step;
  const auto n = static_cast<std::size_t>(std::round((end - t.start) / fine_step)) + 1;
  for (std::size_t i = 0; i < n; ++i) {
    const double time = t.start + fine_step * static_cast<double>(i);
    const double u = std::clamp(time / duration, 0.0, 1.0);
    const double gone = u - std::sin(2.0 * pi * u) / (2.0 * pi);  // of the impulse
    const double way = u * u / 2 + (std::cos(2.0 * pi * u) - 1.0) / (4.0 * pi * pi);
    const double after = std::max(0.0, time - duration);
    t.force.push_back(sine_squared(time, height, duration));
    t.velocity.push_back(approach * (1.0 - 1.5 * gone));
    t.displacement.push_back(approach * (time - 1.5 * (way * duration + after)));
  }
  return t;
}

inline Trajectory usual_trajectory() {
  return trajectory_until(3.2e-3);
}

/// One that does nothing, for looking at disturbances.
inline Trajectory nothing(double seconds) {
  const double step = 1e-5;
  const auto n = static_cast<std::size_t>(seconds / step) + 100;
  return {0.0, step, std::vector<double>(n, 0.0), std::vector<double>(n, 0.0),
          std::vector<double>(n, 0.0)};
}

inline datasets::Sensor sensor_of(datasets::Quantity quantity) {
  datasets::Sensor sensor;
  sensor.quantity = quantity;
  return sensor;
}

inline SensorSet force_only() {
  return {.force = sensor_of(datasets::Quantity::force)};
}

inline SensorSet all_sensors() {
  return {.force = sensor_of(datasets::Quantity::force),
          .velocity = sensor_of(datasets::Quantity::velocity),
          .displacement = sensor_of(datasets::Quantity::displacement)};
}

inline SyntheticOptions still() {
  SyntheticOptions options;
  options.trigger_jitter = 0.0;
  return options;
}

/// Long, slow recording of nothing by the velocity sensor, so that statistics can be taken.
inline SyntheticOptions long_and_slow(double seconds) {
  SyntheticOptions options = still();
  options.sample_rate = 1e4;
  options.pre_trigger = 0.0;
  options.duration = seconds;
  return options;
}

inline double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

inline double rms_of(const std::vector<double>& values) {
  return std::sqrt(std::inner_product(values.begin(), values.end(), values.begin(), 0.0) /
                   static_cast<double>(values.size()));
}

}  // namespace impactrig::tests
