// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/metrics/magnitude_phase.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "tests/fitting/metrics/check_signals.hpp"

namespace impactrig::fitting {
namespace {

using tests::check_signals;
using tests::CheckPair;
using tests::sampled;

TEST(SpragueGeers, OfAScaledHistoryIsTheScale) {
  const CheckPair signals = check_signals("scaled_1p2");
  const MagnitudePhase found = sprague_geers(signals.pair());
  EXPECT_NEAR(found.magnitude, 0.2, 1e-15);
  EXPECT_NEAR(found.phase, 0.0, 1e-15);  // arccos of 1 less rounding would be 5e-9
  EXPECT_NEAR(found.comprehensive, 0.2, 1e-15);
}

TEST(SpragueGeers, OfTheNegativeHistoryHasThePhaseOne) {
  const CheckPair signals = check_signals("sign_flip");
  EXPECT_EQ(sprague_geers(signals.pair()).magnitude, 0.0);
  EXPECT_EQ(sprague_geers(signals.pair()).phase, 1.0);
  EXPECT_NEAR(geers_1984(signals.pair()).phase, 2.0, 1e-15);
}

TEST(SpragueGeers, OfAQuarterPeriodHasThePhaseOneHalf) {
  const CheckPair signals = check_signals("quarter_shift");
  EXPECT_NEAR(sprague_geers(signals.pair()).magnitude, 0.0, 1e-14);
  EXPECT_NEAR(sprague_geers(signals.pair()).phase, 0.5, 1e-14);
  EXPECT_NEAR(geers_1984(signals.pair()).phase, 1.0, 1e-14);
}

// Over whole periods a sine moved by φ has ρ = cos φ: P = φ / π, down to angles whose cosine is 1.
TEST(SpragueGeers, TellsSmallPhasesToAllDigits) {
  for (const double angle : {1.0, 1e-2, 1e-5, 1e-9}) {
    const double step = 2.0 * std::numbers::pi / 256.0;
    const CheckPair signals = sampled(
        256, step, [](double x) { return std::sin(x); },
        [&](double x) { return std::sin(x) * std::cos(angle) - std::cos(x) * std::sin(angle); });
    EXPECT_NEAR(sprague_geers(signals.pair()).phase / (angle / std::numbers::pi), 1.0, 1e-6)
        << angle;
  }
}

// A quiet tail changes neither.
TEST(SpragueGeers, DoesNotSeeAQuietTail) {
  CheckPair signals = check_signals("haversine_pulse");
  const MagnitudePhase before = sprague_geers(signals.pair());
  signals.measured.resize(4000, 0.0);
  signals.computed.resize(4000, 0.0);
  EXPECT_NEAR(sprague_geers(signals.pair()).comprehensive, before.comprehensive, 1e-15);
}

// Twice and half are equally wrong, with opposite signs: q = ±1.5.
TEST(Russell, TreatsTwiceAndHalfAlike) {
  const std::vector<double> m = {1.0, -2.0, 3.0}, twice = {2.0, -4.0, 6.0};
  EXPECT_NEAR(russell({m, twice}).magnitude, std::log10(2.5), 1e-15);
  EXPECT_NEAR(russell({twice, m}).magnitude, -std::log10(2.5), 1e-15);
  EXPECT_NEAR(russell({m, twice}).comprehensive,
              std::sqrt(std::numbers::pi / 4.0) * std::log10(2.5), 1e-15);
}

/// A triangle of straight lines that begins to rise at `start` samples.
std::vector<double> triangle(int start, double height) {
  std::vector<double> x(60, 0.0);
  for (int i = 0; i <= 20; ++i)
    x[static_cast<std::size_t>(start + i)] = height * (10 - std::abs(i - 10)) / 10.0;
  return x;
}

// The computed triangle comes 4 samples late and is 1.5 times as high: moved back it is off by half
// of m everywhere, M = 1/2. 5 % of the height is reached half a sample after the start.
TEST(KnowlesGear, TellsShapeAndArrivalApart) {
  const auto m = triangle(10, 2.0), c = triangle(14, 3.0);
  const KnowlesGear found = knowles_gear({m, c}, 1e-3);
  EXPECT_NEAR(found.arrival_measured, 10.5e-3, 1e-15);
  EXPECT_NEAR(found.arrival_computed, 14.5e-3, 1e-15);
  EXPECT_NEAR(found.magnitude, 0.5, 1e-14);
  EXPECT_NEAR(found.phase, 4.0 / 10.5, 1e-14);
  EXPECT_NEAR(found.comprehensive,
              std::sqrt((10.0 * 0.25 + 2.0 * (4.0 / 10.5) * (4.0 / 10.5)) / 12.0), 1e-14);
}

TEST(KnowlesGear, HasNoPhaseWhereTheFirstSampleHasArrived) {
  const std::vector<double> m = {1.0, 2.0, 1.0}, zero = {0.0, 0.0, 0.0};
  EXPECT_TRUE(std::isnan(knowles_gear({m, m}, 1.0).phase));
  EXPECT_EQ(knowles_gear({m, m}, 1.0).magnitude, 0.0);
  EXPECT_TRUE(std::isnan(knowles_gear({m, zero}, 1.0).magnitude));
}

}  // namespace
}  // namespace impactrig::fitting
