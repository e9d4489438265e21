// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/diagnostics/discrepancy.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/fitting/diagnostics/noise.hpp"

namespace impactrig::fitting {
namespace {

using tests::gaussian_noise;

constexpr std::size_t before = 1000, after = 1500;
constexpr double interval = 1e-6, contact = 300e-6;

double bump(double t) {
  return 3.0 * std::exp(-0.5 * std::pow((t - 150e-6) / 40e-6, 2.0));
}

Discrepancy found_in(const std::vector<double>& x) {
  const std::span<const double> all(x);
  return discrepancy({all.subspan(before), interval, contact, 0.05},
                     noise_colour(all.first(before)));
}

std::vector<double> with_bump(std::vector<double> x) {
  for (std::size_t i = 0; i < after; ++i)
    x[before + i] += bump(interval * static_cast<double>(i + 1));
  return x;
}

TEST(Discrepancy, FindsNothingInPureNoise) {
  int seen = 0, seen_in_coloured = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    seen += found_in(gaussian_noise(before + after, 100 + seed)).significant ? 1 : 0;
    seen_in_coloured +=
        found_in(gaussian_noise(before + after, 100 + seed, 0.8)).significant ? 1 : 0;
  }
  EXPECT_LE(seen, 10);
  EXPECT_LE(seen_in_coloured, 10);
}

// The band is pointwise: 95 % of it all over the curve holds on average over shots, and in one shot
// within what the few independent stretches of the curve scatter.
TEST(Discrepancy, HoldsAKnownBumpInItsBand) {
  double inside = 0.0, points = 0.0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Discrepancy found = found_in(with_bump(gaussian_noise(before + after, 500 + seed)));
    ASSERT_TRUE(found.significant) << seed;
    EXPECT_NEAR(found.largest, 3.0, 4.0 * found.largest_error) << seed;
    EXPECT_NEAR(found.largest_time, 150e-6, 25e-6) << seed;
    EXPECT_GT(found.length, 20e-6) << seed;
    for (std::size_t i = 0; i < found.time.size(); ++i) {
      const double away = std::abs(found.mean[i] - bump(found.time[i]));
      inside += away <= 1.96 * found.error[i] ? 1.0 : 0.0;
      points += 1.0;
    }
  }
  EXPECT_GT(inside / points, 0.90);
}

// Short bumps long after the contact, where few samples are kept: the highest is among them.
TEST(Discrepancy, KeepsItsCrests) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    std::vector<double> x = gaussian_noise(before + 10000, seed);
    for (std::size_t i = 0; i < 10000; ++i) {
      const double t = interval * static_cast<double>(i + 1);
      for (const double at : {0.2e-3, 3.0e-3, 4.123e-3, 6.02e-3, 8.7e-3})
        x[before + i] += 6.0 * std::exp(-0.5 * std::pow((t - at) / 8e-6, 2.0));
    }
    const Discrepancy found = found_in(x);
    ASSERT_TRUE(found.significant) << seed;
    double highest = 0.0;
    for (const double mean : found.mean) highest = std::max(highest, std::abs(mean));
    EXPECT_EQ(highest, std::abs(found.largest)) << seed;
    EXPECT_LE(found.time.size(), 502U);
  }
}

TEST(Discrepancy, HoldsItInColouredNoiseToo) {
  double inside = 0.0, points = 0.0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Discrepancy found = found_in(with_bump(gaussian_noise(before + after, 900 + seed, 0.7)));
    ASSERT_TRUE(found.significant) << seed;
    for (std::size_t i = 0; i < found.time.size(); ++i) {
      const double away = std::abs(found.mean[i] - bump(found.time[i]));
      inside += away <= 1.96 * found.error[i] ? 1.0 : 0.0;
      points += 1.0;
    }
  }
  EXPECT_GT(inside / points, 0.88);
}

// Nothing of the answer may hang on the unit of the channel.
TEST(Discrepancy, ScalesWithTheUnit) {
  std::vector<double> x = with_bump(gaussian_noise(before + after, 42));
  const Discrepancy plain = found_in(x);
  for (double& value : x) value *= 1e-3;
  const Discrepancy milli = found_in(x);
  EXPECT_NEAR(milli.largest, 1e-3 * plain.largest, 1e-9);
  EXPECT_NEAR(milli.rms, 1e-3 * plain.rms, 1e-9);
  EXPECT_DOUBLE_EQ(milli.length, plain.length);
}

TEST(Discrepancy, BridgesMissingSamples) {
  std::vector<double> x = with_bump(gaussian_noise(before + after, 43));
  for (std::size_t i = before + 140; i < before + 160; ++i)
    x[i] = std::numeric_limits<double>::quiet_NaN();
  const Discrepancy found = found_in(x);
  ASSERT_TRUE(found.significant);
  EXPECT_NEAR(found.largest, 3.0, 4.0 * found.largest_error);
}

}  // namespace
}  // namespace impactrig::fitting
