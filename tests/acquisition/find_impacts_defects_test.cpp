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

}  // namespace

}  // namespace impactrig::acquisition
