// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "acquisition/conditioning/condition.hpp"
#include "datasets/impact.hpp"
#include "tests/acquisition/scene.hpp"

namespace impactrig::tests {

inline constexpr double pi = std::numbers::pi;
inline constexpr double duration = 200e-6;  ///< of a contact [s]

/// The force of a contact [N].
inline double pulse(double t) {
  return half_sine(t, 1500.0, duration);
}

/// A bar's velocity: constant, a contact with the force of `pulse`, constant.
inline double bar_velocity(double t) {
  return 0.5 - 0.45 * (1.0 - std::cos(pi * std::clamp(t / duration, 0.0, 1.0)));
}

/// From 0.441 m/s to -0.2205 m/s by a half-sine deceleration on [0, duration]; e = 0.5.
inline double bounce(double t) {
  const double part = std::clamp(t / duration, 0.0, 1.0);
  return 0.441 - 0.6615 * 0.5 * (1.0 - std::cos(pi * part));
}

/// The only impact in a force history.
inline datasets::Impact impact_in(std::vector<double> force, const Sampling& at = {},
                                  double noise = 5.0) {
  add_noise(force, noise, 17);
  const auto impacts = acquisition::find_impacts(record_of({force_of(at, std::move(force))}));
  EXPECT_EQ(impacts.size(), 1u);
  return impacts.empty() ? datasets::Impact{} : impacts[0];
}

}  // namespace impactrig::tests
