// SPDX-License-Identifier: BSD-3-Clause
#include "models/beams/band_cholesky.hpp"

#include <gmock/gmock.h>

#include <Eigen/Dense>
#include <random>
#include <stdexcept>

namespace {

using namespace impactrig::models;

struct Pair {
  BandMatrix band;
  Eigen::MatrixXd dense;
};

/// L L' of a random lower band matrix: positive definite.
Pair random_pair(int n, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> entry(-1.0, 1.0);
  Eigen::MatrixXd lower = Eigen::MatrixXd::Zero(n, n);
  for (int j = 0; j < n; ++j) {
    lower(j, j) = 1.5 + entry(random);
    for (int i = j + 1; i < std::min(n, j + 4); ++i) lower(i, j) = entry(random);
  }
  Pair pair{BandMatrix(n), lower * lower.transpose()};
  for (int i = 0; i < n; ++i)
    for (int j = std::max(0, i - 3); j <= i; ++j) pair.band.add(i, j, pair.dense(i, j));
  return pair;
}

TEST(BandMatrix, MultipliesAndReadsLikeTheDenseMatrix) {
  for (int n = 1; n <= 12; ++n) {
    const Pair pair = random_pair(n, 7);
    const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(n, -1.0, 2.0);
    Eigen::VectorXd y(n);
    pair.band.multiply(x, y);
    EXPECT_LT((y - pair.dense * x).norm(), 1e-14 * (1.0 + y.norm()));
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) EXPECT_EQ(pair.band.at(i, j), pair.dense(i, j));
  }
}

TEST(BandCholesky, SolvesLikeADenseFactorisation) {
  for (int n : {1, 2, 3, 4, 5, 17, 101}) {
    const Pair pair = random_pair(n, 11);
    const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(n, -1.0, 2.0);
    Eigen::VectorXd x = b;
    BandCholesky(pair.band).solve_in_place(x);
    const Eigen::VectorXd expected = pair.dense.llt().solve(b);
    EXPECT_LT((pair.dense * x - b).norm(), 1e-13 * pair.dense.norm() * x.norm()) << "n = " << n;
    EXPECT_LT((x - expected).norm(), 1e-9 * expected.norm()) << "n = " << n;
  }
}

TEST(BandCholesky, RefusesAMatrixThatIsNotPositiveDefinite) {
  BandMatrix matrix(2);
  matrix.add(0, 0, 1.0);
  matrix.add(1, 0, 1.0);
  matrix.add(1, 1, 1.0);
  EXPECT_THAT([&] { BandCholesky factor(matrix); },
              testing::ThrowsMessage<std::invalid_argument>(
                  "BandCholesky: the matrix is not positive definite"));
}

}  // namespace
