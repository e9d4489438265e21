// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/metrics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace impactrig::fitting {
namespace {

constexpr double pi = std::numbers::pi;

template <typename F>
std::vector<double> sampled(int n, double step, F f) {
  std::vector<double> values;
  for (int i = 0; i < n; ++i) values.push_back(f(step * i));
  return values;
}

// Values of "damped_sine" and "haversine_pulse" in reference/checks/metrics.json (rtol 1e-9).
TEST(Metrics, AgreeWithTheReferenceForADampedSine) {
  const auto m =
      sampled(201, 0.005, [](double t) { return std::exp(-3 * t) * std::sin(4 * pi * t); });
  const auto c = sampled(201, 0.005, [](double t) {
    return 1.1 * std::exp(-2.8 * t) * std::sin(4 * pi * (t - 0.01));
  });
  const auto values = metrics(m, c);
  EXPECT_NEAR(values.at("sprague_geers_magnitude"), 0.11103390419451453, 1e-10);
  EXPECT_NEAR(values.at("sprague_geers_phase"), 0.046157104274010825, 1e-10);
  EXPECT_NEAR(values.at("sprague_geers_comprehensive"), 0.12024560763553295, 1e-10);
  EXPECT_NEAR(values.at("correlation"), 0.9889287164577127, 1e-10);
}

TEST(Metrics, AHistoryComparedWithItselfScaledHasOnlyAMagnitudeError) {
  const auto m = sampled(
      101, 0.01, [](double t) { return std::sin(2 * pi * t) + 0.3 * std::cos(6 * pi * t); });
  auto c = m;
  for (double& value : c) value *= 1.2;
  const auto values = metrics(m, c);
  EXPECT_NEAR(values.at("sprague_geers_magnitude"), 0.2, 1e-14);
  EXPECT_NEAR(values.at("sprague_geers_phase"), 0.0,
              1e-7);  // arccos near 1 has the root of rounding
}

TEST(Metrics, AQuarterPeriodIsHalfAPhaseError) {
  const auto m = sampled(1000, 0.001, [](double t) { return std::sin(2 * pi * t); });
  const auto c = sampled(1000, 0.001, [](double t) { return std::sin(2 * pi * (t - 0.25)); });
  const auto values = metrics(m, c);
  EXPECT_NEAR(values.at("sprague_geers_magnitude"), 0.0, 1e-12);
  EXPECT_NEAR(values.at("sprague_geers_phase"), 0.5, 1e-12);
  EXPECT_NEAR(values.at("correlation"), 0.0, 1e-12);
}

TEST(Metrics, TheDivisorOfNrmseIsThePeak) {
  const std::vector<double> m = {0.0, -4.0, 0.0, 0.0};
  const std::vector<double> c = {1.0, -3.0, 1.0, 1.0};
  EXPECT_DOUBLE_EQ(metrics(m, c).at("nrmse"), 0.25);
}

// "haversine_pulse" of the same table; ISO 18571 only where samples follow each other and are few.
TEST(Metrics, RateAHistoryThatHasNoGaps) {
  const auto m = sampled(401, 1e-6, [](double t) {
    return t >= 50e-6 && t <= 270e-6 ? 4500 * std::sin(pi * (t - 50e-6) / 220e-6) : 0.0;
  });
  const auto c = sampled(401, 1e-6, [](double t) {
    return t >= 60e-6 && t <= 260e-6 ? 4800 * std::sin(pi * (t - 60e-6) / 200e-6) : 0.0;
  });
  const auto values = metrics(m, c);
  EXPECT_NEAR(values.at("theil_u"), 0.04832953233145978, 1e-10);
  EXPECT_NEAR(values.at("whang"), 0.04668756244510931, 1e-10);
  EXPECT_NEAR(values.at("iso18571_rating"),
              0.4 * values.at("iso18571_corridor") +
                  0.2 * (values.at("iso18571_phase") + values.at("iso18571_magnitude") +
                         values.at("iso18571_slope")),
              1e-15);
  EXPECT_FALSE(metrics(m, c, false).contains("iso18571_rating"));
  const std::vector<double> many(10'001, 1.0);
  EXPECT_FALSE(metrics(many, many).contains("iso18571_rating"));
}

TEST(Metrics, NothingIsSaidOfSilence) {
  EXPECT_TRUE(metrics(std::vector{0.0, 0.0}, std::vector{1.0, 2.0}).empty());
  EXPECT_TRUE(metrics(std::vector{1.0, 0.0}, std::vector<double>{1.0, NAN}).empty());
  EXPECT_TRUE(metrics({}, {}).empty());
}

}  // namespace
}  // namespace impactrig::fitting
