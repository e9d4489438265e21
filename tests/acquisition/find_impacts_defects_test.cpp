// SPDX-License-Identifier: BSD-3-Clause
// Recordings with one planted defect each, and sound ones that look like it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "acquisition/conditioning/condition.hpp"
#include "tests/acquisition/scene.hpp"

namespace impactrig::acquisition {

namespace {

using datasets::ImpactFlag;
using namespace tests;

constexpr double duration = 200e-6;  // [s]

double pulse(double t) {
  return half_sine(t, 1500.0, duration);
}

// A spike of three samples as of one: the contact lasts 133.
TEST(FindImpacts, OverlooksSpikesOfAFewSamples) {
  const Sampling at;
  for (const std::size_t samples : {1, 2, 3})
    for (const double height : {3000.0, -700.0, 450.0}) {
      std::vector<double> force = sampled(at, pulse);
      add_noise(force, 1.0, 3);
      const auto plain = find_impacts(record_of({force_of(at, force)}));
      for (std::size_t i = 0; i < samples; ++i) force[700 + i] += height;
      const auto impacts = find_impacts(record_of({force_of(at, force)}));
      SCOPED_TRACE(testing::Message() << samples << " samples of " << height << " N");
      ASSERT_EQ(impacts.size(), 1u);
      EXPECT_NEAR(impacts[0].start, plain.at(0).start, 1e-9);
      EXPECT_NEAR(impacts[0].peak, plain.at(0).peak, 0.1);
      EXPECT_TRUE(impacts[0].has(ImpactFlag::dropout));
      EXPECT_FALSE(impacts[0].has(ImpactFlag::double_hit));
      EXPECT_EQ(std::ranges::count(impacts[0].force->valid, 0), static_cast<long>(samples));
    }
}

// Contacts over 65 % of the record: its median is not what the force rests at. 20 records.
TEST(FindImpacts, KnowsTheLevelWhereContactsFillMostOfTheRecord) {
  const Sampling at{.start = -0.8e-3, .interval = 1e-6, .samples = 5600};
  const auto clean = sampled(at, [](double t) {
    return half_sine(t, 2600.0, 0.4e-3) + half_sine(t, 400.0, 2.0e-3) +
           half_sine(t - 2.8e-3, 500.0, 1.7e-3);
  });
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    auto force = clean;
    add_noise(force, 2.0, seed);
    const auto impacts = find_impacts(record_of({force_of(at, force)}));
    ASSERT_EQ(impacts.size(), 1u) << seed;
    // the first part is at its crest where the second one has 400 sin(0.1 pi)
    EXPECT_NEAR(impacts[0].peak, 2600.0 + 124.0, 5.0 * 2.0) << seed;
    EXPECT_NEAR(impacts[0].impulse, 2.0 * (2600.0 * 0.4e-3 + 400.0 * 2e-3) / std::numbers::pi, 0.01)
        << seed;
    EXPECT_NEAR(impacts[0].start, 0.0, 5e-6) << seed;
    EXPECT_TRUE(impacts[0].has(ImpactFlag::double_hit)) << seed;
  }
}

// The foot of a pulse takes 100 samples to rise through the noise of 5 %. 60 records.
TEST(FindImpacts, FollowsASlowFootThroughTheNoise) {
  const Sampling at{.start = -0.7e-3, .interval = 0.5e-6, .samples = 4000};
  const auto clean = sampled(at, [](double t) { return sine_squared(t, 1500.0, 400e-6); });
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    auto force = clean;
    add_noise(force, 75.0, seed);
    const auto impacts = find_impacts(record_of({force_of(at, force)}));
    ASSERT_EQ(impacts.size(), 1u) << seed;
    EXPECT_NEAR(impacts[0].impulse, 1500.0 * 200e-6, 0.1 * 1500.0 * 200e-6) << seed;
    EXPECT_FALSE(impacts[0].has(ImpactFlag::undersampled)) << seed;
  }
}

}  // namespace

}  // namespace impactrig::acquisition
