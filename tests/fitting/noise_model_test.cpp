// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/noise_model.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>
#include <vector>

#include "tests/fitting/diagnostics/noise.hpp"

namespace impactrig::fitting {
namespace {

using tests::gaussian_noise;

/// x_t = a x_{t−1} + b x_{t−2} + e_t, its first thousand samples left out.
std::vector<double> second_order_noise(std::size_t count, std::uint64_t seed, double a, double b) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  std::vector<double> out(count);
  double last = 0.0, before = 0.0;
  for (std::size_t k = 0; k < count + 1000; ++k) {
    const double next = a * last + b * before + normal(generator);
    before = last;
    last = next;
    if (k >= 1000) out[k - 1000] = next;
  }
  return out;
}

/// What colour() does to a stretch, as a matrix: column k from the k-th unit vector.
Eigen::MatrixXd colouring(const NoiseModel& noise, Eigen::Index n) {
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(n, n);
  for (Eigen::Index k = 0; k < n; ++k)
    noise.colour({matrix.col(k).data(), static_cast<std::size_t>(n)});
  return matrix;
}

/// The model's own coefficients, from its answer to one shock long after the start.
struct SecondOrder {
  double a, b, shock;
};

SecondOrder coefficients(const NoiseModel& noise) {
  std::vector<double> answer(8, 0.0);
  answer[5] = 1.0;
  noise.colour(answer);
  const double a = answer[6] / answer[5];
  return {a, (answer[7] - a * answer[6]) / answer[5], answer[5]};
}

/// Covariance of n samples by Yule and Walker's equations [BrockwellDavis1991]:
/// ρ_1 = a / (1 − b), ρ_k = a ρ_{k−1} + b ρ_{k−2}.
Eigen::MatrixXd toeplitz(const SecondOrder& of, double sigma, Eigen::Index n) {
  std::vector<double> rho(static_cast<std::size_t>(n), 1.0);
  rho[1] = of.a / (1.0 - of.b);
  for (std::size_t k = 2; k < rho.size(); ++k) rho[k] = of.a * rho[k - 1] + of.b * rho[k - 2];
  Eigen::MatrixXd matrix(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j)
      matrix(i, j) = sigma * sigma * rho[static_cast<std::size_t>(std::abs(i - j))];
  return matrix;
}

/// The whitened covariance is the identity, and colour's is the covariance: L L' = C.
void expect_exact_whitening(const NoiseModel& noise, const SecondOrder& of, double sigma) {
  constexpr Eigen::Index n = 30;
  const Eigen::MatrixXd covariance = toeplitz(of, sigma, n);
  const Eigen::MatrixXd lower = colouring(noise, n);
  EXPECT_LT((lower * lower.transpose() - covariance).norm() / covariance.norm(), 1e-12);
  Eigen::MatrixXd whitened = covariance;
  for (Eigen::Index k = 0; k < n; ++k)
    noise.whiten({whitened.col(k).data(), static_cast<std::size_t>(n)});
  whitened.transposeInPlace();
  for (Eigen::Index k = 0; k < n; ++k)
    noise.whiten({whitened.col(k).data(), static_cast<std::size_t>(n)});
  EXPECT_LT((whitened - Eigen::MatrixXd::Identity(n, n)).cwiseAbs().maxCoeff(), 1e-10);
}

/// Of noise scaled to the standard deviation `sigma`, without trends.
NoiseModel estimated(std::vector<double> quiet, double sigma) {
  for (double& value : quiet) value *= 0.1 * sigma;
  const Eigen::Map<const Eigen::VectorXd> values(quiet.data(),
                                                 static_cast<Eigen::Index>(quiet.size()));
  return NoiseModel::estimate(values, Eigen::MatrixXd(values.size(), 0)).at_least(sigma);
}

// φ is known to √((1 − φ²) / n) = 0.0031; bound at four of that.
TEST(NoiseModel, WhitensFirstOrderNoiseExactly) {
  const double phi = 0.9, sigma = 2.5;
  const NoiseModel noise = estimated(gaussian_noise(20000, 7, phi), sigma);
  ASSERT_EQ(noise.order(), 1);
  const SecondOrder found = coefficients(noise);
  EXPECT_NEAR(found.a, phi, 0.013);
  EXPECT_NEAR(found.b, 0.0, 1e-12);
  EXPECT_NEAR(found.shock, sigma * std::sqrt(1.0 - found.a * found.a), 1e-12);
  EXPECT_NEAR(noise.correlation_time(), (1.0 + found.a) / (1.0 - found.a), 1e-9);
  EXPECT_EQ(noise.independent_share(), 1.0);
  expect_exact_whitening(noise, found, sigma);
}

// Spectral density at zero over variance: σ_e² / (1 − a − b)², with
// σ_e² = 1 − a ρ_1 − b ρ_2. a and b are known to √((1 − b²) / n) = 0.0061.
TEST(NoiseModel, WhitensSecondOrderNoiseExactly) {
  const double sigma = 0.3;
  const NoiseModel noise = estimated(second_order_noise(20000, 8, 1.2, -0.5), sigma);
  ASSERT_EQ(noise.order(), 2);
  const SecondOrder found = coefficients(noise);
  EXPECT_NEAR(found.a, 1.2, 0.025);
  EXPECT_NEAR(found.b, -0.5, 0.025);
  const double rho1 = found.a / (1.0 - found.b), rho2 = found.a * rho1 + found.b;
  const double shock = 1.0 - found.a * rho1 - found.b * rho2;
  EXPECT_NEAR(found.shock, sigma * std::sqrt(shock), 1e-12);
  EXPECT_NEAR(noise.correlation_time(), shock / std::pow(1.0 - found.a - found.b, 2), 1e-9);
  expect_exact_whitening(noise, found, sigma);
}

TEST(NoiseModel, AsIfWhiteHasTheSameDeviation) {
  std::mt19937_64 generator(3);
  std::normal_distribution<double> normal;
  Eigen::VectorXd values(4000);
  double last = 0.0;
  for (double& value : values) value = last = 0.9 * last + normal(generator);
  const NoiseModel noise = NoiseModel::estimate(values, Eigen::MatrixXd(values.size(), 0));
  ASSERT_GT(noise.order(), 0);
  EXPECT_EQ(noise.as_if_white().order(), 0);
  EXPECT_EQ(noise.as_if_white().sigma(), noise.sigma());
  std::vector<double> constant(5, 3.0);
  noise.as_if_white().whiten(constant);
  for (const double value : constant) EXPECT_DOUBLE_EQ(value, 3.0 / noise.sigma());
}

// Of higher order too the covariance of any stretch is Toeplitz, of the variance stated.
TEST(NoiseModel, IsStationaryFromTheFirstSampleOn) {
  std::vector<double> hard = second_order_noise(4000, 9, 1.6, -0.8);
  const std::vector<double> other = second_order_noise(4000, 10, -0.9, -0.3);
  for (std::size_t k = 0; k < hard.size(); ++k) hard[k] += 2.0 * other[k];
  const NoiseModel noise = estimated(hard, 1.7);
  ASSERT_GT(noise.order(), 2);
  const Eigen::MatrixXd lower = colouring(noise, 60);
  const Eigen::MatrixXd covariance = lower * lower.transpose();
  EXPECT_NEAR(covariance(0, 0), 1.7 * 1.7, 1e-12);
  for (Eigen::Index i = 1; i < 60; ++i)
    for (Eigen::Index j = 1; j < 60; ++j)
      ASSERT_NEAR(covariance(i, j), covariance(i - 1, j - 1), 1e-10) << i << " " << j;
}

TEST(NoiseModel, ColourTakesBackWhiten) {
  const NoiseModel noise = estimated(second_order_noise(2000, 11, 1.2, -0.5), 3.0);
  const std::vector<double> before = gaussian_noise(500, 12);
  std::vector<double> after = before;
  noise.whiten(after);
  noise.colour(after);
  for (std::size_t k = 0; k < before.size(); ++k) ASSERT_NEAR(after[k], before[k], 1e-12);
}

// Of white noise one more order gains χ² with one degree of freedom and costs ln 1000 = 6.9: it is
// taken in 0.9 % of records, any in about 1.2 %: 2.4 of 200, ten and more with probability 3e-4.
TEST(NoiseModel, TakesWhiteNoiseForWhite) {
  int coloured = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed)
    coloured += estimated(gaussian_noise(1000, seed), 1.0).order() > 0 ? 1 : 0;
  EXPECT_LT(coloured, 10);
}

// Likewise one order too many; none too few: the gain of the true one is n ln(1 − φ²) = 1660, of
// the second coefficient −0.5 n ln(1 − b²) = 288.
TEST(NoiseModel, FindsTheOrder) {
  int first = 0, second = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const NoiseModel of_one = estimated(gaussian_noise(1000, seed, 0.9), 1.0);
    const NoiseModel of_two = estimated(second_order_noise(1000, seed, 1.2, -0.5), 1.0);
    EXPECT_GE(of_one.order(), 1) << "seed " << seed;
    EXPECT_GE(of_two.order(), 2) << "seed " << seed;
    first += of_one.order() == 1 ? 1 : 0;
    second += of_two.order() == 2 ? 1 : 0;
  }
  EXPECT_GT(first, 93);
  EXPECT_GT(second, 93);
}

/// Of a line and mains hum over three quarters of its period.
Eigen::MatrixXd trends_of(Eigen::Index n) {
  Eigen::MatrixXd trends(n, 6);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double part = static_cast<double>(i) / static_cast<double>(n),
                 turn = 1.5 * 3.14159 * part;
    trends.row(i) << 1.0, part, std::sin(turn), std::cos(turn), std::sin(3.0 * turn),
        std::cos(3.0 * turn);
  }
  return trends;
}

// Six trends take most of what is slow in 100 independent samples: of the variance of a long mean,
// which is 19, 0.76 was left before that was given back. 200 records know its mean to 0.02.
TEST(NoiseModel, GivesBackWhatTrendsTakeOfSlowNoise) {
  const Eigen::Index n = 1900;
  const Eigen::MatrixXd trends = trends_of(n);
  double slow = 0.0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const std::vector<double> noise = gaussian_noise(static_cast<std::size_t>(n), seed, 0.9);
    const NoiseModel model =
        NoiseModel::estimate(Eigen::Map<const Eigen::VectorXd>(noise.data(), n), trends);
    slow += model.sigma() * model.sigma() * model.correlation_time() / 19.0 / 200.0;
    const double independent = static_cast<double>(n) / (1.0 + 2.0 * model.correlation_time());
    EXPECT_NEAR(model.freedom(), independent - 6.0, 1e-9);
  }
  EXPECT_NEAR(slow, 1.0, 0.08);
}

// The residual sum of squares over n - p.
TEST(NoiseModel, TakesItsDegreesOfFreedomOffWhiteNoise) {
  const std::vector<double> noise = gaussian_noise(60, 3);
  const Eigen::Map<const Eigen::VectorXd> quiet(noise.data(), 60);
  const Eigen::MatrixXd trends = trends_of(60);
  const NoiseModel model = NoiseModel::estimate(quiet, trends);
  ASSERT_EQ(model.order(), 0);
  const double rest = (quiet - trends * trends.householderQr().solve(quiet)).squaredNorm();
  EXPECT_NEAR(model.sigma(), std::sqrt(rest / 54.0), 1e-3 * model.sigma());
}

// What rounding leaves of a constant record has neither size nor colour.
TEST(NoiseModel, TakesNoColourFromConstantRecords) {
  for (const double level : {0.0, 0.3, -1e7}) {
    const NoiseModel model =
        NoiseModel::estimate(Eigen::VectorXd::Constant(400, level), trends_of(400)).at_least(0.5);
    EXPECT_EQ(model.order(), 0);
    EXPECT_EQ(model.sigma(), 0.5);
    std::vector<double> ones(3, 1.0);
    model.whiten(ones);
    EXPECT_EQ(ones, std::vector<double>(3, 2.0));
  }
}

// Of 4 samples that count as one, n have the information of n / 4.
TEST(NoiseModel, CountsSamplesTakenForWhiteOnce) {
  const NoiseModel noise(2.0, 4.0);
  EXPECT_DOUBLE_EQ(noise.independent_share(), 0.25);
  EXPECT_DOUBLE_EQ(noise.correlation_time(), 4.0);
  std::vector<double> ones(100, 1.0);
  noise.whiten(ones);
  double information = 0.0;
  for (const double value : ones) information += value * value;
  EXPECT_NEAR(information, 100.0 / 4.0 / (2.0 * 2.0), 1e-12);
}

}  // namespace
}  // namespace impactrig::fitting
