// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/between_shots.hpp"

#include <gtest/gtest.h>

#include <array>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

namespace {

using impactrig::fitting::agreement;
using impactrig::fitting::between_shots;
using impactrig::fitting::BetweenShots;
using impactrig::fitting::ShotAgreement;
using impactrig::fitting::ShotSpeed;
using impactrig::fitting::ShotValue;
using impactrig::fitting::speed_trend;
using impactrig::fitting::SpeedTrend;

double student(double probability, double dof) {
  return boost::math::quantile(boost::math::students_t(dof), probability);
}

struct Trial {
  double treated, of_treated, control, of_control, latitude;
};

// 13 trials of the BCG vaccine: cases among vaccinated and controls, latitude [deg]. The example of
// [Viechtbauer2010], whose output is the oracle.
constexpr std::array<Trial, 13> bcg = {{{4, 123, 11, 139, 44},
                                        {6, 306, 29, 303, 55},
                                        {3, 231, 11, 220, 42},
                                        {62, 13598, 248, 12867, 52},
                                        {33, 5069, 47, 5808, 13},
                                        {180, 1541, 372, 1451, 44},
                                        {8, 2545, 10, 629, 19},
                                        {505, 88391, 499, 88391, 13},
                                        {29, 7499, 45, 7277, 27},
                                        {17, 1716, 65, 1665, 42},
                                        {186, 50634, 141, 27338, 18},
                                        {5, 2498, 3, 2341, 33},
                                        {27, 16913, 29, 17854, 33}}};

std::vector<ShotValue> bcg_log_ratios() {
  std::vector<ShotValue> out;
  for (const Trial& t : bcg)
    out.push_back(
        {std::log(t.treated / t.of_treated / (t.control / t.of_control)),
         std::sqrt(1.0 / t.treated - 1.0 / t.of_treated + 1.0 / t.control - 1.0 / t.of_control)});
  return out;
}

/// Shots whose own errors differ by a factor of four.
std::vector<ShotValue> drawn(std::mt19937_64& random, std::size_t shots, double tau,
                             bool equal = false) {
  std::normal_distribution<double> normal;
  std::vector<ShotValue> out;
  for (std::size_t i = 0; i < shots; ++i) {
    const double error =
        equal ? 1.0 : 0.5 + 1.5 * static_cast<double>(i) / static_cast<double>(shots - 1);
    out.push_back({10.0 + tau * normal(random) + error * normal(random), error});
  }
  return out;
}

// Four standard deviations of a share of 0.95 in 4000 draws: wrong by chance once in 16000.
constexpr int campaigns = 4000;
constexpr double chance = 4.0 * 0.00345;

// With one variance s² for all: mean ± t S / √k, Q = (k − 1) S² / s², τ² = S² − s².
TEST(BetweenShots, EqualErrorsGiveTheTextbooksFormulas) {
  const std::vector<ShotValue> shots = {{1.0, 0.5}, {2.0, 0.5}, {4.0, 0.5}, {5.0, 0.5}};
  const BetweenShots found = between_shots(shots);
  const double variance = 10.0 / 3.0;
  EXPECT_DOUBLE_EQ(found.mean, 3.0);
  EXPECT_NEAR(found.std_error, std::sqrt(variance / 4.0), 1e-12);
  EXPECT_NEAR(found.ci95[1], 3.0 + student(0.975, 3) * std::sqrt(variance / 4.0), 1e-11);
  EXPECT_NEAR(found.tau, std::sqrt(variance - 0.25), 1e-12);
  EXPECT_NEAR(found.q, 10.0 / 0.25, 1e-12);
  EXPECT_EQ(found.dof, 3);
  EXPECT_NEAR(found.i2, 1.0 - 3.0 / 40.0, 1e-12);
  EXPECT_NEAR(found.scatter, std::sqrt(variance) / 0.5, 1e-12);
  // 7.81473 is the 95 % point of χ² with 3 degrees of freedom; 40 is far beyond
  EXPECT_LT(found.p_value, 1e-7);
  // χ² points 9.348404 and 0.2157953 of any table: τ² = 10 / χ² − s²
  EXPECT_NEAR(found.tau_ci95[0], std::sqrt(10.0 / 9.348404 - 0.25), 1e-6);
  EXPECT_NEAR(found.tau_ci95[1], std::sqrt(10.0 / 0.2157953 - 0.25), 1e-6);
  EXPECT_EQ(agreement(found), ShotAgreement::scatter);
}

TEST(BetweenShots, ShotsThatAgreeDoNotNarrowTheMeanBelowTheirErrors) {
  const std::vector<ShotValue> shots = {{1.0, 0.5}, {1.001, 0.5}, {0.999, 0.5}, {1.0, 0.5}};
  const BetweenShots found = between_shots(shots);
  EXPECT_EQ(found.tau, 0.0);
  EXPECT_EQ(found.i2, 0.0);
  EXPECT_DOUBLE_EQ(found.std_error, 0.25);
  EXPECT_EQ(agreement(found), ShotAgreement::too_well);
}

// Without errors of their own shots are a plain sample, and leaving one out is Student's test of a
// new observation: (y − ȳ₋) / (S₋ √(1 + 1 / (k − 1))).
TEST(BetweenShots, AShotThatIsLeftOutIsJudgedByTheOthersAlone) {
  std::vector<ShotValue> shots;
  for (const double value : {1.0, 2.0, 4.0, 5.0, 3.0}) shots.push_back({value, 1e-6});
  shots.push_back({60.0, 1e-6});
  const BetweenShots found = between_shots(shots);
  ASSERT_EQ(found.deviations.size(), 6U);
  EXPECT_NEAR(found.deviations[5].residual, 57.0 / std::sqrt(2.5 * 1.2), 1e-6);
  EXPECT_TRUE(found.deviations[5].outlier);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_FALSE(found.deviations[i].outlier) << i;
}

TEST(BetweenShots, GivesThePublishedNumbersOfThirteenTrials) {
  const BetweenShots found = between_shots(bcg_log_ratios());
  EXPECT_NEAR(found.q, 152.2330, 5e-5);
  EXPECT_NEAR(100.0 * found.i2, 92.12, 5e-3);  // as (Q − 12) / Q
}

std::vector<ShotSpeed> exactly(const std::vector<double>& speeds, double std_error = 0.0) {
  std::vector<ShotSpeed> out;
  for (const double speed : speeds) out.push_back({speed, std_error});
  return out;
}

TEST(SpeedTrend, GivesThePublishedResidualScatterOfThirteenTrials) {
  std::vector<double> latitudes;
  for (const Trial& trial : bcg) latitudes.push_back(trial.latitude);
  const auto found = speed_trend(bcg_log_ratios(), exactly(latitudes));
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->q, 30.7331, 5e-5);
  EXPECT_EQ(found->dof, 11);
}

TEST(BetweenShots, ScalesWithItsUnit) {
  std::mt19937_64 random(3);
  std::vector<ShotValue> shots = drawn(random, 7, 1.5);
  const BetweenShots one = between_shots(shots);
  for (ShotValue& shot : shots) shot = {1e-9 * shot.value, 1e-9 * shot.std_error};
  const BetweenShots small = between_shots(shots);
  EXPECT_NEAR(small.mean, 1e-9 * one.mean, 1e-20);
  EXPECT_NEAR(small.tau, 1e-9 * one.tau, 1e-20);
  EXPECT_NEAR(small.tau_ci95[1], 1e-9 * one.tau_ci95[1], 1e-19);
  EXPECT_NEAR(small.q, one.q, 1e-9);
}

// The interval of τ is exact for known errors whatever τ is; a one-sided share of 2.5 % lies below
// a τ of 0, where the interval begins at 0 and cannot fail that way.
TEST(BetweenShots, IntervalsHoldAsOftenAsTheySay) {
  std::mt19937_64 random(20071);
  for (const double tau : {0.0, 1.0, 5.0}) {
    int mean_held = 0, tau_held = 0, false_alarms = 0;
    for (int i = 0; i < campaigns; ++i) {
      const BetweenShots found = between_shots(drawn(random, 8, tau));
      mean_held += found.ci95[0] <= 10.0 && 10.0 <= found.ci95[1] ? 1 : 0;
      tau_held += found.tau_ci95[0] <= tau && tau <= found.tau_ci95[1] ? 1 : 0;
      for (const auto& shot : found.deviations)
        if (shot.outlier) {
          ++false_alarms;
          break;
        }
    }
    const auto share = [](int count) { return static_cast<double>(count) / campaigns; };
    EXPECT_GT(share(mean_held), 0.95 - chance) << tau;
    EXPECT_NEAR(share(tau_held), tau > 0.0 ? 0.95 : 0.975, chance) << tau;
    EXPECT_LT(share(false_alarms), 0.05 + chance) << tau;
  }
}

TEST(BetweenShots, CoverageIsExactWhereShotsScatterAndErrorsAreEqual) {
  std::mt19937_64 random(20072);
  int held = 0;
  for (int i = 0; i < campaigns; ++i) {
    const BetweenShots found = between_shots(drawn(random, 5, 20.0, true));
    held += found.ci95[0] <= 10.0 && 10.0 <= found.ci95[1] ? 1 : 0;
  }
  EXPECT_NEAR(static_cast<double>(held) / campaigns, 0.95, chance);
}

// y on a line, one error for all: the slope of ordinary least squares, with its own scatter.
TEST(SpeedTrend, EqualErrorsGiveTheTextbooksRegression) {
  const std::vector<double> speeds = {0.1, 0.2, 0.3, 0.4, 0.5};
  const std::array<double, 5> values = {1.0, 2.2, 2.8, 4.1, 4.9};
  std::vector<ShotValue> shots;
  for (const double value : values) shots.push_back({value, 0.01});
  const auto found = speed_trend(shots, exactly(speeds));
  ASSERT_TRUE(found);
  // Sxx = 0.1, Sxy = 0.97, Syy = 9.5 (about the mean 3): b = 9.7, residual 0.091, s² = 0.091 / 3
  EXPECT_NEAR(found->slope, 9.7, 1e-10);
  EXPECT_NEAR(found->at_mean_speed, 3.0, 1e-12);
  EXPECT_NEAR(found->mean_speed, 0.3, 1e-15);
  const double error = std::sqrt(0.091 / 3.0 / 0.1);
  EXPECT_NEAR(found->std_error, error, 1e-9);
  EXPECT_NEAR(found->ci95[0], 9.7 - student(0.975, 3) * error, 1e-8);
  EXPECT_NEAR(found->tau, std::sqrt(0.091 / 3.0 - 1e-4), 1e-9);
  EXPECT_NEAR(found->p_value, 2.0 * boost::math::cdf(boost::math::students_t(3.0), -9.7 / error),
              1e-9);
}

TEST(SpeedTrend, SaysNothingWhereTheSpeedsAreAlike) {
  const std::vector<ShotValue> shots(5, {1.0, 0.1});
  EXPECT_FALSE(speed_trend(shots, exactly(std::vector<double>(5, 0.4))));
  EXPECT_FALSE(speed_trend(shots, exactly({0.40, 0.41, 0.40, 0.41, 0.40}, 0.01)));
  EXPECT_TRUE(speed_trend(shots, exactly({0.40, 0.41, 0.40, 0.41, 0.40}, 0.001)));
}

TEST(SpeedTrend, IntervalOfTheSlopeHoldsAsOftenAsItSays) {
  std::mt19937_64 random(20073);
  const std::vector<double> speeds = {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8};
  int held = 0;
  for (int i = 0; i < campaigns; ++i) {
    std::vector<ShotValue> shots = drawn(random, speeds.size(), 3.0);
    for (std::size_t k = 0; k < shots.size(); ++k) shots[k].value += 2.0 * speeds[k];
    const auto found = speed_trend(shots, exactly(speeds));
    ASSERT_TRUE(found);
    held += found->ci95[0] <= 2.0 && 2.0 <= found->ci95[1] ? 1 : 0;
  }
  EXPECT_NEAR(static_cast<double>(held) / campaigns, 0.95, chance + 0.01);
}

// 30 speeds that spread by five of their standard errors, whose errors lean on those of the values:
// a line that takes them for exact is too flat by more than a twentieth.
TEST(SpeedTrend, IntervalHoldsWhereTheSpeedsAreUncertain) {
  std::mt19937_64 random(20074);
  std::normal_distribution<double> normal;
  const double of_speed = 0.06, of_value = 0.05, r = -0.5, slope = 2.0;
  constexpr int repeats = 1000;
  const double luck = 4.0 * std::sqrt(0.95 * 0.05 / repeats);
  for (const double tau : {0.0, 0.1}) {
    int held = 0, held_if_exact = 0;
    double sum = 0.0;
    for (int i = 0; i < repeats; ++i) {
      std::vector<ShotValue> shots;
      std::vector<ShotSpeed> speeds;
      for (int k = 0; k < 30; ++k) {
        const double a = normal(random), b = normal(random);
        const double speed = 0.1 * (1 + k % 10);
        speeds.push_back({speed + of_speed * a, of_speed, r});
        shots.push_back(
            {slope * speed + tau * normal(random) + of_value * (r * a + std::sqrt(1.0 - r * r) * b),
             of_value});
      }
      const auto found = speed_trend(shots, speeds);
      ASSERT_TRUE(found);
      sum += found->slope / repeats;
      held += found->ci95[0] <= slope && slope <= found->ci95[1] ? 1 : 0;
      for (ShotSpeed& speed : speeds) speed.std_error = 0.0;
      const auto exact = speed_trend(shots, speeds);
      held_if_exact += exact->ci95[0] <= slope && slope <= exact->ci95[1] ? 1 : 0;
    }
    EXPECT_NEAR(sum, slope, 0.02) << tau;
    // without scatter of their own, known errors are judged by Student's t: held more often
    EXPECT_GT(static_cast<double>(held) / repeats, 0.95 - luck) << tau;
    EXPECT_LT(static_cast<double>(held) / repeats, 0.95 + luck) << tau;
    EXPECT_LT(static_cast<double>(held_if_exact) / repeats, 0.95 - 2.0 * luck) << tau;
  }
}

TEST(BetweenShots, RefusesWhatIsNoRepetition) {
  EXPECT_THROW(between_shots(std::vector<ShotValue>{{1.0, 0.1}}), std::invalid_argument);
  EXPECT_THROW(between_shots(std::vector<ShotValue>{{1.0, 0.1}, {2.0, 0.0}}),
               std::invalid_argument);
  EXPECT_THROW(between_shots(std::vector<ShotValue>{{1.0, 0.1}, {std::nan(""), 0.1}}),
               std::invalid_argument);
  EXPECT_THROW(speed_trend(std::vector<ShotValue>{{1.0, 0.1}}, std::vector<ShotSpeed>{}),
               std::invalid_argument);
}

}  // namespace
