// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/covariance.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include <Eigen/Dense>

namespace impactrig::fitting {
namespace {

Eigen::MatrixXd straight_line(int n) {
  Eigen::MatrixXd j(n, 2);
  for (int i = 0; i < n; ++i) j.row(i) << 1.0, static_cast<double>(i);
  return j;
}

// Intercept and slope of a line through n equidistant points with unit noise: the textbook's
// variances.
TEST(Uncertainty, IsTheClosedFormForAStraightLine) {
  const int n = 11;
  const Uncertainty u = uncertainty(straight_line(n), {"a", "b"}, {false, false});
  const double mean = 5.0;
  const double spread = 110.0;  // Σ (i − mean)²
  EXPECT_NEAR(u.covariance(1, 1), 1.0 / spread, 1e-14);
  EXPECT_NEAR(u.covariance(0, 0), 1.0 / n + mean * mean / spread, 1e-13);
  EXPECT_NEAR(u.covariance(0, 1), -mean / spread, 1e-14);
  EXPECT_TRUE(u.sentences.empty());
}

// Columns of very different size: only the scaled matrix is well conditioned.
TEST(Uncertainty, DoesNotDependOnUnits) {
  Eigen::MatrixXd j = straight_line(9);
  const Eigen::MatrixXd in_si = uncertainty(j, {"a", "b"}, {false, false}).covariance;
  j.col(1) *= 1e12;
  const Eigen::MatrixXd in_pico = uncertainty(j, {"a", "b"}, {false, false}).covariance;
  EXPECT_NEAR(in_pico(1, 1) * 1e24 / in_si(1, 1), 1.0, 1e-12);
  EXPECT_NEAR(in_pico(0, 0) / in_si(0, 0), 1.0, 1e-12);
}

TEST(Uncertainty, NamesAParameterWithoutInfluence) {
  Eigen::MatrixXd j = Eigen::MatrixXd::Zero(5, 2);
  j.col(0).setOnes();
  const Uncertainty u = uncertainty(j, {"a", "idle"}, {false, false});
  EXPECT_NEAR(u.covariance(0, 0), 0.2, 1e-15);
  EXPECT_TRUE(u.identifiable[0]);
  EXPECT_FALSE(u.identifiable[1]);
  EXPECT_THAT(u.sentences,
              testing::ElementsAre("idle has no influence on what was measured; fix it"));
}

TEST(Uncertainty, NamesACombinationTheDataCannotTellApart) {
  Eigen::MatrixXd j(6, 3);
  for (int i = 0; i < 6; ++i) j.row(i) << 1.0 + i, 2.0 * (1.0 + i), static_cast<double>(i * i);
  const Uncertainty u = uncertainty(j, {"length", "modulus", "offset"}, {false, false, false});
  EXPECT_FALSE(u.identifiable[0]);
  EXPECT_FALSE(u.identifiable[1]);
  EXPECT_TRUE(u.identifiable[2]);
  EXPECT_THAT(u.sentences, testing::ElementsAre("length, modulus: only a combination of these is "
                                                "determined; fix one of them or give it a prior"));
}

// The share of an undetermined way decides, however small: b and a can go to infinity together,
// and c with them at a twentieth of their pace.
TEST(Uncertainty, DoesNotTellWhatGoesWithAnUndeterminedWay) {
  std::mt19937_64 generator(5);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd j(50, 4);
  for (Eigen::Index i = 0; i < j.rows(); ++i) {
    const double a = normal(generator), c = normal(generator);
    j.row(i) << a, -a - 0.05 * c, c, normal(generator);
  }
  const Uncertainty u = uncertainty(j, {"a", "b", "c", "d"}, std::vector<bool>(4, false));
  EXPECT_THAT(u.identifiable, testing::ElementsAre(false, false, false, true));
  ASSERT_EQ(u.undetermined.cols(), 1);
  EXPECT_LT((j * u.undetermined).norm(), 1e-9 * u.undetermined.norm());
  for (Eigen::Index k = 0; k < 3; ++k) EXPECT_TRUE(std::isnan(u.correlations(k, 3))) << k;
  EXPECT_EQ(u.correlations(3, 3), 1.0);
}

// Of a and b the data know x = a + 2b: its variance, and that of the rest beside it, is that of
// the fit in which x stands for both.
TEST(Uncertainty, OfWhatIsDeterminedIsThatOfTheSmallerProblem) {
  Eigen::MatrixXd whole(6, 4), smaller(6, 2);
  for (int i = 0; i < 6; ++i) {
    smaller.row(i) << 1.0 + i, static_cast<double>(i * i);
    whole.row(i) << 1.0 + i, 2.0 * (1.0 + i), static_cast<double>(i * i), 0.0;
  }
  const Uncertainty u = uncertainty(whole, {"a", "b", "c", "idle"}, std::vector<bool>(4, false));
  const Eigen::MatrixXd known = uncertainty(smaller, {"x", "c"}, {false, false}).covariance;
  Eigen::MatrixXd lines = Eigen::MatrixXd::Zero(2, 4);
  lines << 1.0, 2.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0;
  EXPECT_LT((lines * u.covariance * lines.transpose() - known).norm(), 1e-12 * known.norm());
  EXPECT_EQ(u.undetermined.cols(), 2);
  const Eigen::Vector4d sizes(1.0, 1.0, 1.0, 1.0);
  EXPECT_TRUE(determines(u, Eigen::Vector4d(1.0, 2.0, 5.0, 0.0), sizes, 1.0));
  EXPECT_TRUE(determines(u, Eigen::Vector4d(1.0, 2.0, 5.0, 1e-5), sizes, 1.0));
  EXPECT_FALSE(determines(u, Eigen::Vector4d(1.0, 2.0, 5.0, 1e-3), sizes, 1.0));
  EXPECT_FALSE(determines(u, Eigen::Vector4d(1.0, 1.9, 5.0, 0.0), sizes, 1.0));
  const Eigen::VectorXd change = Eigen::VectorXd::LinSpaced(6, -1.0, 3.0).cwiseAbs2();
  const Eigen::Vector2d expected = known * (smaller.transpose() * change);
  EXPECT_LT((lines * u.covariance * (whole.transpose() * change) - expected).norm(),
            1e-12 * expected.norm());
}

TEST(Uncertainty, TellsOfStrongCorrelationsUnlessAPriorHoldsOneOfThem) {
  Eigen::MatrixXd j(100, 2);
  for (int i = 0; i < 100; ++i) j.row(i) << 1.0, 1.0 + 1e-3 * i;
  EXPECT_THAT(uncertainty(j, {"a", "b"}, {false, false}).sentences,
              testing::ElementsAre(
                  testing::HasSubstr("a and b can hardly be told apart (correlation -0.999")));
  EXPECT_TRUE(uncertainty(j, {"a", "b"}, {false, true}).sentences.empty());
}

// Under normal noise a loss of 95 % efficiency has 1 / 0.95 of the variance of squares: the
// sandwich says so from 20000 residuals, which tell it to about 1.5 %.
TEST(Uncertainty, OfARobustLossIsThatOfItsEfficiency) {
  std::mt19937_64 generator(17);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd j(20000, 2);
  Eigen::VectorXd residuals(20000);
  for (Eigen::Index i = 0; i < j.rows(); ++i) {
    j.row(i) << normal(generator), 1.0 + normal(generator);
    residuals[i] = normal(generator);
  }
  const Eigen::MatrixXd squares = uncertainty(j, {"a", "b"}, {false, false}).covariance;
  for (const Loss loss : {Loss::huber, Loss::cauchy, Loss::tukey}) {
    const Eigen::MatrixXd robust =
        uncertainty(j, residuals, loss, 20000, {"a", "b"}, {false, false}).covariance;
    for (Eigen::Index k = 0; k < 2; ++k)
      EXPECT_NEAR(robust(k, k) / squares(k, k), 1.0 / 0.95, 0.05) << name(loss);
  }
}

// Rows behind the data are priors: squared whatever the loss. A prior of unit weight alone: 1.
TEST(Uncertainty, LeavesPriorsToTheirSquares) {
  Eigen::MatrixXd j(2, 2);
  j << 1.0, 0.0, 0.0, 1.0;
  const Eigen::VectorXd residuals = Eigen::Vector2d(1.0, 50.0);
  const Uncertainty u = uncertainty(j, residuals, Loss::tukey, 1, {"a", "b"}, {false, true});
  EXPECT_NEAR(u.covariance(1, 1), 1.0, 1e-14);
  const LossValue at = evaluate(Loss::tukey, 1.0);
  EXPECT_NEAR(u.covariance(0, 0), std::pow(at.influence / at.slope, 2), 1e-14);
}

}  // namespace
}  // namespace impactrig::fitting
