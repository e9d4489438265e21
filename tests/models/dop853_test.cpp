// SPDX-License-Identifier: BSD-3-Clause
#include "models/integration/dop853.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "models/integration/gauss.hpp"
#include "tests/support/convergence_study.hpp"

namespace {

using namespace impactrig::models;
using impactrig::tests::ConvergenceStudy;
using Vector = Eigen::VectorXd;

// A planet on a circle, x'' = −x / |x|³: nonlinear, with a closed solution and a local error that
// is the same everywhere.
const Dop853::RightHandSide right_hand_side = [](double, const Vector& y,
                                                 Eigen::Ref<Vector> slope) {
  slope.head(2) = y.tail(2);
  slope.tail(2) = -y.head(2) / std::pow(y.head(2).norm(), 3);
};

Vector solution(double t) {
  return Eigen::Vector4d(std::cos(t), std::sin(t), -std::sin(t), std::cos(t));
}

const Vector unit_weights = Vector::Ones(4);

double error_at_end(int steps) {
  const double duration = 3.0;
  Dop853 stepper(4);
  stepper.start(0.0, solution(0.0), right_hand_side);
  for (int i = 0; i < steps; ++i) {
    stepper.attempt(duration / steps, unit_weights, right_hand_side);
    stepper.accept();
  }
  EXPECT_NEAR(stepper.time(), duration, 1e-13);
  return (stepper.state() - solution(duration)).norm();
}

TEST(Dop853, ConvergesWithOrderEight) {
  ConvergenceStudy study;
  for (int steps = 6; steps <= 24; steps += 2) {
    const double error = error_at_end(steps);
    ASSERT_GT(error, 1e-14);  // below, rounding hides the order
    study.add(3.0 / steps, error);
  }
  EXPECT_NEAR(study.order(), 8.0, 0.5);
  EXPECT_GT(study.correlation(), 0.995);
}

TEST(Dop853, DenseOutputHasOrderSeven) {
  // largest error within one step from the solution: h⁸ for a method of order 7
  ConvergenceStudy study;
  for (double h = 0.8; h > 0.1; h *= 0.8) {
    Dop853 stepper(4);
    stepper.start(0.3, solution(0.3), right_hand_side);
    stepper.attempt(h, unit_weights, right_hand_side);
    double error = 0.0;
    Vector y(4);
    for (double theta = 0.05; theta < 1.0; theta += 0.05) {
      stepper.dense(theta, right_hand_side, y);
      error = std::max(error, (y - solution(0.3 + theta * h)).norm());
    }
    study.add(h, error);
  }
  EXPECT_NEAR(study.order(), 8.0, 0.4);
  EXPECT_GT(study.correlation(), 0.995);
}

TEST(Dop853, DenseOutputMeetsBothEndsOfTheStepAndCostsThreeEvaluationsOnce) {
  Dop853 stepper(4);
  stepper.start(0.0, solution(0.0), right_hand_side);
  stepper.attempt(0.4, unit_weights, right_hand_side);
  const long before = stepper.evaluations();
  EXPECT_EQ(before, 13);  // one to start, eleven stages, one at the end of the step
  Vector y(4);
  stepper.dense(0.0, right_hand_side, y);
  EXPECT_LT((y - stepper.state()).norm(), 1e-16);
  stepper.dense(1.0, right_hand_side, y);
  EXPECT_LT((y - stepper.attempted()).norm(), 1e-15);
  EXPECT_EQ(stepper.evaluations(), before + 3);
}

TEST(Dop853, DenseOutputHasTheSlopesOfBothEnds) {
  Dop853 stepper(4);
  stepper.start(0.0, solution(0.0), right_hand_side);
  stepper.attempt(0.4, unit_weights, right_hand_side);
  Vector a(4), b(4);
  const double d = 1e-6;
  stepper.dense(0.0, right_hand_side, a);
  stepper.dense(d, right_hand_side, b);
  EXPECT_LT(((b - a) / (0.4 * d) - stepper.slope()).norm(), 1e-5);
  stepper.dense(1.0 - d, right_hand_side, a);
  stepper.dense(1.0, right_hand_side, b);
  EXPECT_LT(((b - a) / (0.4 * d) - stepper.attempted_slope()).norm(), 1e-5);
}

TEST(Dop853, ErrorEstimateFallsWithOrderEightAndIsNotTooSmall) {
  ConvergenceStudy study;
  for (double h = 0.8; h > 0.15; h *= 0.8) {
    Dop853 stepper(4);
    stepper.start(0.3, solution(0.3), right_hand_side);
    const double estimate = stepper.attempt(h, unit_weights, right_hand_side);
    EXPECT_GT(estimate, (stepper.attempted() - solution(0.3 + h)).norm()) << "h = " << h;
    study.add(h, estimate);
  }
  EXPECT_NEAR(study.order(), 8.0, 0.7);
}

TEST(Dop853, ErrorEstimateIsLinearInTheWeights) {
  Dop853 stepper(4);
  stepper.start(0.3, solution(0.3), right_hand_side);
  const double once = stepper.attempt(0.5, unit_weights, right_hand_side);
  EXPECT_NEAR(stepper.attempt(0.5, 1e6 * unit_weights, right_hand_side) / once, 1e6, 1e-6);
}

TEST(Dop853, AnAttemptLeavesTheStateAloneUntilAccepted) {
  Dop853 stepper(4);
  stepper.start(0.0, solution(0.0), right_hand_side);
  stepper.attempt(0.9, unit_weights, right_hand_side);
  EXPECT_EQ(stepper.state(), solution(0.0));
  EXPECT_EQ(stepper.time(), 0.0);
  stepper.attempt(0.1, unit_weights, right_hand_side);
  const Vector next = stepper.attempted();
  stepper.accept();
  EXPECT_EQ(stepper.state(), next);
  EXPECT_EQ(stepper.time(), 0.1);
  EXPECT_EQ(stepper.slope()[0], next[2]);
  EXPECT_NEAR(stepper.slope()[3], -next[1] / std::pow(next.head(2).norm(), 3), 1e-15);
}

TEST(Dop853, ReportsAnErrorThatIsNotFiniteAndThenAsksForAShorterStep) {
  const Dop853::RightHandSide root = [](double, const Vector& y, Eigen::Ref<Vector> slope) {
    slope[0] = std::sqrt(y[0]);
  };
  Dop853 stepper(1);
  stepper.start(0.0, Vector::Constant(1, 1.0), root);
  EXPECT_FALSE(stepper.attempt(-100.0, Vector::Ones(1), root) <= 1.0);
  EXPECT_EQ(Dop853::suggest(1.0, std::nan("")), 0.2);
  EXPECT_EQ(Dop853::suggest(1.0, std::numeric_limits<double>::infinity()), 0.2);
}

TEST(Dop853, SuggestsTheStepOfAnErrorOfOneWithSomeCaution) {
  EXPECT_NEAR(Dop853::suggest(2.0, 1.0), 1.8, 1e-15);
  EXPECT_NEAR(Dop853::suggest(2.0, std::pow(0.5, 8)), 3.6, 1e-14);
  EXPECT_EQ(Dop853::suggest(2.0, 0.0), 12.0);
  EXPECT_EQ(Dop853::suggest(2.0, 1e30), 0.4);
}

TEST(GaussRule, IsExactForPolynomialsOfDegreeTwiceItsPointsLessOne) {
  for (int n : {1, 2, 5, 8, 20, 60, 260}) {
    const GaussRule rule = gauss_legendre(n);
    for (int degree = 0; degree <= 2 * n - 1; ++degree) {
      double sum = 0.0;
      for (std::size_t i = 0; i < rule.points.size(); ++i)
        sum += rule.weights[i] * std::pow(rule.points[i], degree);
      EXPECT_NEAR(sum * (degree + 1), 1.0, 1e-12) << n << " points, degree " << degree;
    }
    double next = 0.0;
    for (std::size_t i = 0; i < rule.points.size(); ++i)
      next += rule.weights[i] * std::pow(2.0 * rule.points[i] - 1.0, 2 * n);
    if (n <= 5) {
      EXPECT_GT(std::abs(next * (2 * n + 1) - 1.0), 1e-3) << n;
    }
  }
}

TEST(GaussRule, NeedsAPoint) {
  EXPECT_THAT([] { gauss_legendre(0); }, testing::ThrowsMessage<std::invalid_argument>(
                                             "gauss_legendre: needs at least one point"));
}

}  // namespace
