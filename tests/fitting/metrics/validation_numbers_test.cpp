// SPDX-License-Identifier: BSD-3-Clause
//
// Comparison error, area metric, reliability, information criteria: independently computed numbers
// and closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "fitting/metrics/area_metric.hpp"
#include "fitting/metrics/comparison_error.hpp"
#include "fitting/metrics/information_criteria.hpp"

namespace impactrig::fitting {
namespace {

const std::vector<double> experiment = {1.08, 1.12, 1.01, 1.2};

template <typename Call>
std::string complaint(Call call) {
  try {
    call();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(ComparisonError, IsThatOfVV20) {
  const ComparisonError force =
      comparison_error(4513.0, 4300.0, {.numerical = 20.0, .input = 90.0, .data = 60.0});
  EXPECT_DOUBLE_EQ(force.error, 213.0);
  EXPECT_NEAR(force.uncertainty, 110.0, 1e-9);
  EXPECT_NEAR(force.low, -7.0, 1e-9);
  EXPECT_NEAR(force.high, 433.0, 1e-9);
  EXPECT_EQ(force.verdict, ComparisonVerdict::unresolved);
  const ComparisonError time =
      comparison_error(2.08e-05, 2.2e-05, {.numerical = 1e-7, .input = 4e-7, .data = 6e-7});
  EXPECT_NEAR(time.error, -1.2e-06, 1e-15);
  EXPECT_NEAR(time.uncertainty, 7.280109889280518e-07, 1e-15);
}

TEST(ComparisonError, SaysWhatItCanTell) {
  const ComparisonUncertainty u = {.numerical = 0.0, .input = 3.0, .data = 4.0};
  EXPECT_EQ(comparison_error(105.0, 100.0, u).verdict, ComparisonVerdict::within_noise);
  EXPECT_EQ(comparison_error(110.0, 100.0, u).verdict, ComparisonVerdict::unresolved);
  EXPECT_EQ(comparison_error(89.9, 100.0, u).verdict, ComparisonVerdict::model_error);
  EXPECT_EQ(comparison_error(110.0, 100.0, u, 1.0).verdict, ComparisonVerdict::model_error);
  EXPECT_EQ(name(ComparisonVerdict::within_noise), "within noise");
  EXPECT_EQ(name(ComparisonVerdict::unresolved), "unresolved");
  EXPECT_EQ(name(ComparisonVerdict::model_error), "model error");
}

// What both share cancels: S and D wrong by the same 3 differ by nothing.
TEST(ComparisonError, TakesOffWhatSimulationAndDataShare) {
  EXPECT_NEAR(
      comparison_error(1.0, 1.0, {.input = 3.0, .data = 3.0, .covariance = 9.0}).uncertainty, 0.0,
      1e-12);
  EXPECT_NEAR(
      comparison_error(1.0, 1.0, {.input = 3.0, .data = 4.0, .covariance = 4.5}).uncertainty, 4.0,
      1e-12);
}

TEST(ComparisonError, RefusesWhatCannotBe) {
  EXPECT_EQ(complaint([] { comparison_error(1, 1, {.input = -1.0}); }),
            "standard uncertainties must not be negative");
  EXPECT_EQ(complaint([] { comparison_error(1, 1, {.data = 1.0}, 0.0); }),
            "a coverage factor must be greater than zero");
  EXPECT_EQ(complaint([] { comparison_error(1, 1, {.input = 1, .data = 1, .covariance = 2}); }),
            "the covariance must not exceed the product of the uncertainties of simulation and "
            "data");
}

TEST(AreaMetric, AgreesWithTheNumbersOfTwoSamplesAndOfANormalLaw) {
  EXPECT_NEAR(area_metric(std::vector{1.02, 1.1, 0.97, 1.05, 1.0}, experiment), 0.0745, 1e-10);
  EXPECT_NEAR(area_metric(1.05, 0.05, experiment), 0.05278128155277063, 1e-10);
}

TEST(AreaMetric, OfEqualCountsIsTheMeanDistanceOfTheSorted) {
  const std::vector<double> a = {3.0, 1.0, 2.0}, b = {2.5, 9.0, 1.5};
  EXPECT_NEAR(area_metric(a, b), (0.5 + 0.5 + 6.0) / 3.0, 1e-14);
  EXPECT_NEAR(area_metric(a, a), 0.0, 1e-15);
  EXPECT_NEAR(area_metric(std::vector{4.0}, a), 2.0, 1e-14);  // a single prediction: mean distance
}

// One value at the mean of a normal law: ∫|Φ − step| = E|z| σ = σ √(2/π).
TEST(AreaMetric, OfANormalLawAgainstItsMeanIsItsMeanDistance) {
  EXPECT_NEAR(area_metric(5.0, 2.0, std::vector{5.0}), 2.0 * std::sqrt(2.0 / M_PI), 1e-14);
  // far away only the distance counts
  EXPECT_NEAR(area_metric(5.0, 2.0, std::vector{105.0, 105.0}), 100.0, 1e-11);
}

// The uniform law against a step at u: ∫_0^u x dx + ∫_u^1 (1 − x) dx.
TEST(AreaMetric, PoolsPlacesAgainstTheUniformLaw) {
  EXPECT_DOUBLE_EQ(u_pooled_area(std::vector{0.5}), 0.25);
  EXPECT_DOUBLE_EQ(u_pooled_area(std::vector{0.0, 0.0}), 0.5);
  EXPECT_DOUBLE_EQ(u_pooled_area(std::vector{1.0}), 0.5);
  // steps in the middle of n equal parts leave triangles: n · 2 · (1 / 2n)² / 2
  EXPECT_NEAR(u_pooled_area(std::vector{0.125, 0.625, 0.375, 0.875}), 1.0 / 16.0, 1e-15);
}

TEST(AreaMetric, RefusesWhatIsNoSample) {
  EXPECT_EQ(complaint([] { area_metric(std::vector<double>{}, experiment); }),
            "an area metric needs at least one value");
  EXPECT_EQ(complaint([] { area_metric(std::vector<double>{NAN}, experiment); }),
            "values of an area metric must be finite");
  EXPECT_EQ(complaint([] { area_metric(1.0, 0.0, experiment); }),
            "the model's standard deviation must be greater than zero");
  EXPECT_EQ(complaint([] { u_pooled_area(std::vector{1.1}); }),
            "values of a distribution function lie between 0 and 1");
}

TEST(Reliability, AgreesWithTheNumbers) {
  EXPECT_NEAR(reliability(10.0, 20.0, 35.0), 0.8821257536781, 1e-9);
  EXPECT_NEAR(reliability(-0.02, 0.03, 0.05), 0.8315294174398977, 1e-9);
  EXPECT_EQ(complaint([] { reliability(0.0, 0.0, 1.0); }),
            "a reliability needs a standard deviation and a tolerance greater than zero");
}

TEST(InformationCriteria, AgreeWithTheNumbers) {
  const InformationCriteria five = information_criteria(401, 6, 163000.0);
  EXPECT_NEAR(five.aic, 2421.0251650454147, 1e-9 * 2421);
  EXPECT_NEAR(five.aicc, 2421.238363014958, 1e-9 * 2421);
  EXPECT_NEAR(five.bic, 2444.988933609254, 1e-9 * 2444);
  const InformationCriteria four = information_criteria(401, 5, 175000.0);
  EXPECT_NEAR(four.aic, 2447.5105100652318, 1e-9 * 2447);
  EXPECT_NEAR(four.aicc, 2447.662408799409, 1e-9 * 2447);
  EXPECT_NEAR(four.bic, 2467.4803172017646, 1e-9 * 2467);
  const InformationCriteria few = information_criteria(30, 6, 2.1);
  EXPECT_NEAR(few.aic, -67.77780110798334, 1e-9 * 67);
  EXPECT_NEAR(few.aicc, -64.12562719493985, 1e-9 * 64);
  EXPECT_NEAR(few.bic, -59.370616818010404, 1e-9 * 59);
  EXPECT_TRUE(std::isinf(information_criteria(7, 6, 1.0).aicc));
  EXPECT_EQ(complaint([] { information_criteria(7, 6, 0.0); }),
            "information criteria need samples and a residual sum of squares greater than zero");
}

}  // namespace
}  // namespace impactrig::fitting
