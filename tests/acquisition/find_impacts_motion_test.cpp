// SPDX-License-Identifier: BSD-3-Clause
// What find_impacts tells of a velocity, and the contact it finds in one.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "acquisition/conditioning/condition.hpp"
#include "tests/acquisition/half_sine_contact.hpp"
#include "tests/acquisition/scene.hpp"

namespace impactrig::acquisition {

namespace {

using datasets::Quantity;
using namespace tests;

/// The impact of a half sine of force and a velocity in noise of 1 mm/s, whose approach it has to
/// tell: 475 samples have a standard error of 0.05 mm/s.
datasets::Impact approach_in_noise(const Sampling& at, std::vector<double> velocity) {
  add_noise(velocity, 1e-3, 5);
  const auto impacts = find_impacts(
      record_of({force_of(at, sampled(at, [](double t) { return half_sine(t, 1500.0, duration); })),
                 velocity_of(at, velocity)}));
  EXPECT_EQ(impacts.size(), 1u);
  const datasets::Impact impact = impacts.at(0);
  EXPECT_NEAR(impact.approach_velocity, 0.441, 2e-4);
  EXPECT_NEAR(impact.velocity->noise, 1e-3, 1.3e-4);
  return impact;
}

TEST(FindImpacts, ReportsTheApproachVelocityAndItsNoise) {
  const Sampling at;
  const std::vector<double> velocity = sampled(at, bounce);
  const datasets::Impact impact = approach_in_noise(at, velocity);
  EXPECT_EQ(impact.velocity->baseline, 0.0);  // the motion is no baseline
}

// The bar accelerates freely before touch: that is no noise.
TEST(FindImpacts, DoesNotTakeFreeFallForNoise) {
  const Sampling at;
  const double g = 9.81;
  std::vector<double> velocity =
      sampled(at, [&](double t) { return bounce(t) + g * std::min(t, 0.0); });
  std::vector<double> displacement =
      sampled(at, [&](double t) { return t < 0.0 ? 0.441 * t + 0.5 * g * t * t : 0.0; });
  add_noise(velocity, 1e-4, 5);
  add_noise(displacement, 1e-9, 6);
  const auto impacts = find_impacts(
      record_of({force_of(at, sampled(at, [](double t) { return half_sine(t, 1500.0, duration); })),
                 velocity_of(at, velocity),
                 channel_of("Displacement", Quantity::displacement, at, displacement)}));
  ASSERT_EQ(impacts.size(), 1u);
  EXPECT_NEAR(impacts[0].velocity->noise, 1e-4, 1.3e-5);
  EXPECT_NEAR(impacts[0].displacement->noise, 1e-9, 1.3e-10);
}

TEST(FindImpacts, LeavesADropoutOutOfTheApproachVelocity) {
  const Sampling at;
  const std::vector<double> velocity = sampled(at, [](double t) {
    return t > -0.3e-3 && t < -0.22e-3 ? 0.02 : bounce(t);  // 80 us towards zero
  });
  approach_in_noise(at, velocity);
}

TEST(FindImpacts, FindsTheJumpOfAVelocity) {
  const Sampling at;
  std::vector<double> velocity = sampled(at, bounce);
  add_noise(velocity, 1e-3, 5);
  const auto impacts = find_impacts(record_of({velocity_of(at, velocity)}));
  ASSERT_EQ(impacts.size(), 1u);
  // The velocity leaves 3 sigma (0.5 % of the jump) after acos(1 - 2*0.0045)/pi = 4 % of T.
  EXPECT_NEAR(impacts[0].start, 0.0, 0.05 * duration);
  EXPECT_NEAR(impacts[0].end, duration, 0.05 * duration);
  EXPECT_NEAR(impacts[0].peak, -0.6615, 1e-3);
  EXPECT_NEAR(impacts[0].peak_time, duration / 2, 2e-6);
  EXPECT_NEAR(impacts[0].width, duration * 2.0 / 3.0, 3e-6);
  EXPECT_NEAR(impacts[0].approach_velocity, 0.441, 3e-4);
  // Symmetric about its middle: mean velocity (0.441 - 0.2205)/2 over the contact.
  EXPECT_NEAR(impacts[0].impulse, 0.11025 * duration, 0.06 * 0.11025 * duration);
  ASSERT_TRUE(impacts[0].velocity);
  EXPECT_FALSE(impacts[0].force);
}

TEST(FindImpacts, FindsTheJumpThatFillsItsRecord) {
  const Sampling at{.start = -50e-6, .interval = 1e-6, .samples = 300};
  std::vector<double> velocity = sampled(at, bounce);
  add_noise(velocity, 1e-3, 5);
  const auto impacts = find_impacts(record_of({velocity_of(at, velocity)}));
  ASSERT_EQ(impacts.size(), 1u);
  EXPECT_NEAR(impacts[0].peak, -0.6615, 5e-3);
  EXPECT_NEAR(impacts[0].peak_time, duration / 2, 3e-6);
}

/// A flexible bar that closes at 0.441 m/s and vibrates after touch at 0; before it by `hum`.
std::vector<double> struck_bar(const Sampling& at, double fall, double hum) {
  return sampled(at, [&](double t) {
    const double before = 0.441 + hum * std::sin(2.0 * pi * 700.0 * t + 1.0);
    if (t <= 0.0) return before;
    return before - 0.45 * (1.0 - std::exp(-t / fall)) - 0.15 * std::sin(2.0 * pi * 1300.0 * t) -
           0.12 * std::sin(2.0 * pi * 3700.0 * t);
  });
}

// The vibration it is left in is half of the change, as laser records of slender bars show it.
TEST(FindImpacts, FindsTheTouchOfAVelocityThatVibratesAfterwards) {
  const Sampling at;
  for (const double fall : {20e-6, 80e-6, 250e-6})
    for (const double hum : {0.0, 0.03}) {
      std::vector<double> velocity = struck_bar(at, fall, hum);
      add_noise(velocity, 2e-3, 5);
      const auto impacts = find_impacts(record_of({velocity_of(at, velocity)}));
      ASSERT_EQ(impacts.size(), 1u) << fall << ' ' << hum;
      EXPECT_NEAR(impacts[0].start, 0.0, 30e-6) << fall << ' ' << hum;  // 2 % of the change
      EXPECT_LT(impacts[0].peak, -0.2);
      EXPECT_NEAR(impacts[0].approach_velocity, 0.441, 0.5 * hum + 1e-3);
    }
}

// A dropout comes back: nothing has happened to the bar.
TEST(FindImpacts, DoesNotTakeADropoutForAJump) {
  const Sampling at;
  for (const double length : {20e-6, 60e-6, 120e-6, 200e-6}) {
    std::vector<double> velocity =
        sampled(at, [&](double t) { return t > 1e-3 && t < 1e-3 + length ? 0.0 : 0.441; });
    add_noise(velocity, 1e-3, 5);
    EXPECT_TRUE(find_impacts(record_of({velocity_of(at, velocity)})).empty()) << length;
  }
}

TEST(FindImpacts, LooksForTheTouchBehindADropout) {
  const Sampling at;
  for (const double length : {20e-6, 60e-6, 200e-6}) {
    std::vector<double> velocity = struck_bar(at, 80e-6, 0.0);
    for (std::size_t i = 0; i < velocity.size(); ++i)
      if (at.time(i) > -0.7e-3 && at.time(i) < -0.7e-3 + length) velocity[i] = 0.0;
    add_noise(velocity, 1e-3, 5);
    const auto impacts = find_impacts(record_of({velocity_of(at, velocity)}));
    ASSERT_EQ(impacts.size(), 1u) << length;
    EXPECT_NEAR(impacts[0].start, 0.0, 30e-6) << length;
  }
}

}  // namespace

}  // namespace impactrig::acquisition
