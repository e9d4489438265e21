// SPDX-License-Identifier: BSD-3-Clause
#include "models/sensitivities/add_sensitivity.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace impactrig::tests {
namespace {

using namespace models;

/// Each number another one.
Sensitivity numbered(double from) {
  double next = from;
  const auto some = [&] { return std::vector<double>{next++, next++}; };
  Sensitivity s{.peak_force = next++,
                .max_penetration = next++,
                .duration = next++,
                .impulse = next++,
                .separation_velocity = next++,
                .sensor_peak_force = next++,
                .restitution = {0.0, next++, next++, next++},
                .history = {}};
  s.history.start = -1.0;
  s.history.interval = 0.1;
  for (const auto channel :
       {&History::force, &History::penetration, &History::velocity, &History::displacement,
        &History::velocity_slope, &History::displacement_slope, &History::sensor_force,
        &History::deflection, &History::extension})
    s.history.*channel = some();
  s.history.further = {{some(), some()}, {some(), some()}};
  s.history.jumps = {{next++, next++, next++}, {next++, next++, next++}};
  s.history.impulses = {{0.3, 13, next++}, {0.5, 15, next++}};
  return s;
}

std::vector<double> all(const Sensitivity& s) {
  std::vector<double> numbers = {s.peak_force,
                                 s.max_penetration,
                                 s.duration,
                                 s.impulse,
                                 s.separation_velocity,
                                 s.sensor_peak_force,
                                 s.restitution.kinematic,
                                 s.restitution.kinetic,
                                 s.restitution.energetic};
  const auto append = [&](const std::vector<double>& more) {
    numbers.insert(numbers.end(), more.begin(), more.end());
  };
  const History& h = s.history;
  for (const std::vector<double>& channel :
       {h.force, h.penetration, h.velocity, h.displacement, h.velocity_slope, h.displacement_slope,
        h.sensor_force, h.deflection, h.extension})
    append(channel);
  for (const StopHistory& stop : h.further) {
    append(stop.force);
    append(stop.penetration);
  }
  for (const ForceJump& jump : h.jumps) append({jump.time, jump.before, jump.after});
  for (const SampleImpulse& passed : h.impulses) append({passed.impulse});
  return numbers;
}

TEST(AddSensitivity, SumsAllThatIsDifferentiated) {
  const Sensitivity one = numbered(1.0), two = numbered(100.0);
  Sensitivity sum;
  add_sensitivity(2.0, one, sum);
  add_sensitivity(-3.0, two, sum);
  const std::vector<double> first = all(one), second = all(two), is = all(sum);
  ASSERT_EQ(is.size(), 43U);
  for (std::size_t k = 0; k < is.size(); ++k)
    EXPECT_EQ(is[k], 2.0 * first[k] - 3.0 * second[k]) << k;
  EXPECT_EQ(sum.restitution.law, 0.0);
  EXPECT_EQ(sum.history.start, -1.0);
  EXPECT_EQ(sum.history.interval, 0.1);
  EXPECT_EQ(sum.history.impulses[1].time, 0.5);
  EXPECT_EQ(sum.history.impulses[1].sample, 15U);
}

}  // namespace
}  // namespace impactrig::tests
