// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/loss.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

namespace impactrig::fitting {
namespace {

constexpr std::array all = {Loss::squares, Loss::huber, Loss::cauchy, Loss::tukey};
constexpr double huber = 1.345, cauchy = 2.385, tukey = 4.685;

// Both sides of every branch, and far from it.
const std::vector<double> places = {-40.0, -4.7, -4.67, -2.0, -1.35, -1.34, -0.3, 1e-3, 0.2,
                                    1.34,  1.35, 2.385, 3.0,  4.67,  4.7,   10.0, 300.0};

TEST(Loss, HasItsClosedForm) {
  EXPECT_DOUBLE_EQ(evaluate(Loss::squares, 3.0).cost, 4.5);
  EXPECT_DOUBLE_EQ(evaluate(Loss::huber, 1.0).cost, 0.5);
  EXPECT_NEAR(2.0 * evaluate(Loss::huber, -5.0).cost, 2.0 * huber * 5.0 - huber * huber, 1e-14);
  EXPECT_NEAR(2.0 * evaluate(Loss::cauchy, cauchy).cost, cauchy * cauchy * std::log(2.0), 1e-14);
  EXPECT_NEAR(2.0 * evaluate(Loss::tukey, 0.5 * tukey).cost,
              tukey * tukey / 3.0 * (1.0 - std::pow(0.75, 3)), 1e-14);
  EXPECT_NEAR(2.0 * evaluate(Loss::tukey, 50.0).cost, tukey * tukey / 3.0, 1e-14);
  EXPECT_EQ(evaluate(Loss::tukey, 50.0).influence, 0.0);
}

// Small residuals cost their squares: 1 − (1 − x)³ must not cancel.
TEST(Loss, OfSmallResidualsIsTheirSquare) {
  for (const Loss loss : all)
    for (const double r : {1e-4, -1e-9, 1e-100})
      EXPECT_NEAR(2.0 * evaluate(loss, r).cost / (r * r), 1.0, 1e-7) << name(loss) << " " << r;
}

// Central differences of step h are off by h² ρ'''/6, below 1e-9 here.
TEST(Loss, DerivativesAreThoseOfItsCost) {
  const double h = 3e-5;
  for (const Loss loss : all)
    for (const double r : places) {
      const LossValue at = evaluate(loss, r), up = evaluate(loss, r + h),
                      down = evaluate(loss, r - h);
      const double scale = std::max(1.0, std::abs(r));
      EXPECT_NEAR(at.influence, (up.cost - down.cost) / (2.0 * h), 1e-7 * scale)
          << name(loss) << " " << r;
      EXPECT_NEAR(at.slope, (up.influence - down.influence) / (2.0 * h), 1e-7)
          << name(loss) << " " << r;
    }
}

TEST(Loss, IsContinuousWhereItsBranchesMeet) {
  for (const auto& [loss, edge] : {std::pair{Loss::huber, huber}, {Loss::tukey, tukey}})
    for (const double side : {-1.0, 1.0}) {
      const LossValue inside = evaluate(loss, side * (edge - 1e-9));
      const LossValue outside = evaluate(loss, side * (edge + 1e-9));
      EXPECT_NEAR(inside.cost, outside.cost, 1e-8);
      EXPECT_NEAR(inside.influence, outside.influence, 1e-8);
    }
}

// What a solver of least squares is given: R²/2 = ρ/2, its derivative, the sign, and so the
// gradient R R' = ψ.
TEST(Loss, ItsResidualSquaredIsTheLoss) {
  const double h = 3e-5;
  for (const Loss loss : all)
    for (const double r : places) {
      const LossResidual at = loss_residual(loss, r);
      const LossValue value = evaluate(loss, r);
      EXPECT_NEAR(0.5 * at.value * at.value, value.cost, 1e-13 * std::max(1.0, r * r));
      EXPECT_GT(at.value * r, 0.0);
      EXPECT_NEAR(at.value * at.slope, value.influence, 1e-12 * std::max(1.0, std::abs(r)));
      const double up = loss_residual(loss, r + h).value, down = loss_residual(loss, r - h).value;
      EXPECT_NEAR(at.slope, (up - down) / (2.0 * h), 1e-7) << name(loss) << " " << r;
    }
}

// Below the root of the smallest number the cost is 0 and its slope must not be 0 / 0 or worse.
TEST(Loss, ItsResidualIsFiniteHoweverSmall) {
  for (const Loss loss : all)
    for (const double r : {0.0, 1e-170, -1e-300}) {
      EXPECT_EQ(loss_residual(loss, r).value, r) << name(loss);
      EXPECT_EQ(loss_residual(loss, r).slope, 1.0) << name(loss);
    }
}

/// Asymptotic efficiency of a location under normal noise: (E ψ')² / E ψ², by the trapezoidal rule,
/// whose error falls with exp(-2 π² / h²) but for ψ' of Huber, which jumps (h = 1e-4 of it).
double efficiency(Loss loss) {
  const double h = 1e-4;
  double slope = 0.0, squares = 0.0;
  for (double r = -10.0; r <= 10.0; r += h) {
    const double weight = h * std::exp(-0.5 * r * r) / std::sqrt(2.0 * std::numbers::pi);
    const LossValue at = evaluate(loss, r);
    slope += weight * at.slope;
    squares += weight * at.influence * at.influence;
  }
  return slope * slope / squares;
}

// [HollandWelsch1977]: the constants, given to three decimals, have 95 %.
TEST(Loss, ConstantsHave95PercentEfficiency) {
  EXPECT_NEAR(efficiency(Loss::squares), 1.0, 1e-6);
  for (const Loss loss : {Loss::huber, Loss::cauchy, Loss::tukey})
    EXPECT_NEAR(efficiency(loss), 0.95, 2e-4) << name(loss);
}

// One minimum is left where the cost is convex: ρ'' >= 0 everywhere.
TEST(Loss, FromAfarIsConvex) {
  for (const Loss loss : all)
    for (double r = -60.0; r <= 60.0; r += 0.1)
      ASSERT_GE(evaluate(loss_from_afar(loss), r).slope, 0.0) << name(loss);
  EXPECT_EQ(loss_from_afar(Loss::squares), Loss::squares);
}

TEST(Loss, IsCalledByItsName) {
  for (const Loss loss : all) EXPECT_EQ(loss_named(name(loss)), loss);
  EXPECT_EQ(loss_names().size(), all.size());
  try {
    loss_named("absolute");
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(),
                 "there is no loss 'absolute'; losses are squares, huber, cauchy, tukey");
  }
}

}  // namespace
}  // namespace impactrig::fitting
