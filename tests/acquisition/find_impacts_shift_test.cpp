// SPDX-License-Identifier: BSD-3-Clause
// Forces whose zero the impact shifts, of coarse digitisers.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "acquisition/conditioning/condition.hpp"
#include "tests/acquisition/scene.hpp"

namespace impactrig::acquisition {

namespace {

using datasets::Impact;
using datasets::ImpactFlag;
using namespace tests;

constexpr double duration = 200e-6;      // [s]
constexpr double step = 2000.0 / 128.0;  // [N], of 8 bits over +-2000 N: 1.04 % of the peak

/// A contact of 1500 N in whose middle the zero shifts; noise and shift in digitiser steps.
std::vector<double> shifted_force(double shift, double noise, double offset, std::uint64_t seed) {
  auto force = sampled({}, [&](double t) {
    return half_sine(t, 1500.0, duration) + step * (offset + (t > 0.5 * duration ? shift : 0.0));
  });
  add_noise(force, noise * step, seed);
  round_to(force, step);
  return force;
}

Impact impact_in(std::vector<double> force) {
  const auto impacts = find_impacts(record_of({force_of({}, std::move(force))}));
  EXPECT_EQ(impacts.size(), 1u);
  return impacts.empty() ? Impact{} : impacts[0];
}

// Each level is known to half a step where the noise hides in it, and better where it does not.
TEST(BaselineShiftFlag, FiresBetweenOneAndTwoStepsOfADigitiser) {
  for (const double sign : {1.0, -1.0})
    for (const double noise : {0.05, 0.2, 0.6, 0.8})
      for (std::uint64_t seed = 1; seed <= 10; ++seed)
        EXPECT_TRUE(
            impact_in(shifted_force(sign * 1.6, noise, 0.0, seed)).has(ImpactFlag::baseline_shift))
            << sign << " " << noise << " " << seed;
}

// Levels of any height within a step; a shift of half a step is one of 0.5 % of the peak.
TEST(BaselineShiftFlag, IsSilentOnRounding) {
  for (const double shift : {0.0, 0.5, -0.5})
    for (const double noise : {0.0, 0.2, 0.6, 0.8})
      for (const double offset : {0.0, 0.2, 0.3, 0.45, 0.499})
        EXPECT_FALSE(
            impact_in(shifted_force(shift, noise, offset, 7)).has(ImpactFlag::baseline_shift))
            << shift << " " << noise << " " << offset;
}

// A contact force pushes: what lies below zero behind a second contact is a shift.
TEST(BaselineShiftFlag, FiresBelowZeroBehindSecondContactsToo) {
  for (const double shift : {-0.02, 0.02}) {
    auto force = sampled({}, [&](double t) {
      return half_sine(t, 1500.0, duration) + half_sine(t - 400e-6, 700.0, duration) +
             (t > duration ? shift * 1500.0 : 0.0);
    });
    add_noise(force, 1.0, 3);
    const Impact impact = impact_in(force);
    EXPECT_TRUE(impact.has(ImpactFlag::double_hit)) << shift;
    EXPECT_EQ(impact.has(ImpactFlag::baseline_shift), shift < 0.0) << shift;
  }
}

// Upwards by more than a contact's foot: the force stays above it to the end of the record, at
// rest.
TEST(BaselineShiftFlag, FiresWhereTheForceRestsAboveAContactsFoot) {
  for (const double shift : {0.06, 0.1, 0.2, 0.4})
    for (const double noise : {1.0, 10.0})
      for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        SCOPED_TRACE(testing::Message() << shift << " " << noise << " " << seed);
        auto force = sampled({}, [&](double t) {
          const double ringing =
              t > duration ? 20.0 * std::sin(7e4 * t) * std::exp(-t / 3e-4) : 0.0;
          return half_sine(t, 1500.0, duration) + (t > 0.5 * duration ? shift * 1500.0 : 0.0) +
                 (seed % 2 == 0 && noise < 5.0 ? ringing : 0.0);
        });
        add_noise(force, noise, seed);
        const Impact impact = impact_in(std::move(force));
        EXPECT_TRUE(impact.has(ImpactFlag::baseline_shift));
        EXPECT_FALSE(impact.has(ImpactFlag::too_short));
        EXPECT_FALSE(impact.has(ImpactFlag::truncated_tail));
        if (seed % 2 == 1) {
          EXPECT_NEAR(impact.end, duration, 5e-6);
        }
      }
}

// Most of the record lies at the level that the impact leaves, so far off that it would be a
// contact: the force before touch is the zero none the less.
TEST(FindImpacts, KnowsTheZeroThatTheImpactShifts) {
  for (const double shift : {-9.0, -6.0, -4.5, 4.5, 6.0, 9.0})
    for (const double noise : {0.1, 0.6, 0.8})
      for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        SCOPED_TRACE(testing::Message() << shift << " " << noise << " " << seed);
        const Impact impact = impact_in(shifted_force(shift, noise, 0.0, seed));
        EXPECT_NEAR(impact.start, 0.0, 10e-6);
        EXPECT_FALSE(impact.has(ImpactFlag::missed_start));
        if (shift < 0.0) {
          EXPECT_NEAR(impact.end, duration, 10e-6);
          EXPECT_TRUE(impact.has(ImpactFlag::baseline_shift));
        }
      }
}

}  // namespace

}  // namespace impactrig::acquisition
