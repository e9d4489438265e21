// SPDX-License-Identifier: BSD-3-Clause
// What a run of small motion does at every step, several numbers at a time, on every processor that
// this machine can stand for.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include "models/collocation/collocation.hpp"
#include "models/lanes/processor.hpp"
#include "models/lanes/product_kernels.hpp"
#include "models/lanes/station_kernels.hpp"
#include "models/lanes/step_maps.hpp"

namespace impactrig::tests {
namespace {

using namespace models;

/// Those of a function that the processor can run.
template <typename Function>
std::vector<Function*> runnable(Function* plain, Function* avx2, Function* avx512) {
  std::vector<Function*> list = {plain};
  if (processor() >= Processor::avx2) list.push_back(avx2);
  if (processor() >= Processor::avx512) list.push_back(avx512);
  return list;
}

Eigen::MatrixXd random_matrix(Eigen::Index rows, Eigen::Index columns, unsigned seed) {
  std::srand(seed);
  return Eigen::MatrixXd::Random(rows, columns);
}

struct Size {
  int modes, nodes;
};

class StepMaps : public testing::TestWithParam<Size> {
 protected:
  const int m = GetParam().modes, s = GetParam().nodes;
  const Eigen::VectorXd a = random_matrix(m, 1, 1), rate = random_matrix(m, 1, 2);
};

TEST_P(StepMaps, FindAPointAtTheNodes) {
  const Eigen::MatrixXd of_a = random_matrix(2 * s, m, 3), of_rate = random_matrix(2 * s, m, 4);
  const Eigen::VectorXd expected = of_a * a + of_rate * rate;
  for (const auto find : runnable(find_at_nodes_by<2>, find_at_nodes_avx2, find_at_nodes_avx512)) {
    Eigen::VectorXd motion(2 * s);
    find({.modes = m,
          .rows = 2 * s,
          .of_a = of_a.data(),
          .of_rate = of_rate.data(),
          .a = a.data(),
          .rate = rate.data(),
          .motion = motion.data()});
    EXPECT_LE((motion - expected).norm(), 1e-15 * m * (1.0 + expected.norm()));
  }
}

TEST_P(StepMaps, FindTheModesAtTheEnd) {
  const Eigen::MatrixXd free = random_matrix(m, 4, 5);
  const Eigen::MatrixXd of_force = random_matrix(m, s, 6), rate_of_force = random_matrix(m, s, 7);
  const Eigen::VectorXd force = random_matrix(s, 1, 8);
  const auto moved = [&](int column) {
    return Eigen::VectorXd(free.col(column).cwiseProduct(a) +
                           free.col(column + 1).cwiseProduct(rate));
  };
  for (const auto find : runnable(find_at_end_by<2>, find_at_end_avx2, find_at_end_avx512))
    for (const bool pressed : {false, true}) {
      // what is beyond the modes stays as it is
      Eigen::VectorXd end_a = Eigen::VectorXd::Constant(m + 8, 7.0), end_rate = end_a;
      find({.modes = m,
            .nodes = s,
            .a_of_a = free.col(0).data(),
            .a_of_rate = free.col(1).data(),
            .rate_of_a = free.col(2).data(),
            .rate_of_rate = free.col(3).data(),
            .a_of_force = of_force.data(),
            .rate_of_force = rate_of_force.data(),
            .a = a.data(),
            .rate = rate.data(),
            .force = pressed ? force.data() : nullptr,
            .end_a = end_a.data(),
            .end_rate = end_rate.data()});
      Eigen::VectorXd expected_a = moved(0), expected_rate = moved(2);
      if (pressed) {
        expected_a += of_force * force;
        expected_rate += rate_of_force * force;
      }
      EXPECT_LE((end_a.head(m) - expected_a).norm(), 1e-14 * (1.0 + expected_a.norm()));
      EXPECT_LE((end_rate.head(m) - expected_rate).norm(), 1e-14 * (1.0 + expected_rate.norm()));
      EXPECT_TRUE((end_a.tail(8).array() == 7.0).all());
      EXPECT_TRUE((end_rate.tail(8).array() == 7.0).all());
    }
}

TEST_P(StepMaps, FindASumOfArrays) {
  for (const int terms : {1, 2, 4}) {
    const Eigen::MatrixXd arrays = random_matrix(s * m, terms, 10);
    const Eigen::VectorXd weights = random_matrix(terms, 1, 11),
                          factors = random_matrix(s * m, 1, 12);
    std::vector<const double*> columns;
    for (int j = 0; j < terms; ++j) columns.push_back(arrays.col(j).data());
    for (const auto find : runnable(find_sum_by<2>, find_sum_avx2, find_sum_avx512))
      for (const bool scaled : {false, true}) {
        Eigen::VectorXd sum = Eigen::VectorXd::Constant(s * m + 8, 7.0);
        find({.count = s * m,
              .terms = terms,
              .arrays = columns.data(),
              .weights = weights.data(),
              .factors = scaled ? factors.data() : nullptr,
              .sum = sum.data()});
        Eigen::VectorXd expected = arrays * weights;
        if (scaled) expected = expected.cwiseProduct(factors);
        EXPECT_LE((sum.head(s * m) - expected).norm(), 1e-15 * s * m);
        EXPECT_TRUE((sum.tail(8).array() == 7.0).all());
      }
  }
}

TEST_P(StepMaps, FindASeriesAtTheNodes) {
  const NodeVector series = random_matrix(s, 1, 9);
  const Collocation& rule = Collocation::of(s);
  const double begin = 0.3, length = 1.7;  // also beyond
  for (const auto find : runnable(find_values_by<2>, find_values_avx2, find_values_avx512)) {
    NodeVector values(s), terms(s);
    find({.terms = s,
          .nodes = s,
          .series = series.data(),
          .points = rule.points().data(),
          .begin = begin,
          .length = length,
          .values = values.data()});
    for (int i = 0; i < s; ++i) {
      shifted_legendre(begin + length * rule.points()[i], terms);
      EXPECT_NEAR(values[i], terms.dot(series), 1e-14 * terms.cwiseAbs().dot(series.cwiseAbs()));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(OfModesAndNodes, StepMaps,
                         testing::Values(Size{1, 6}, Size{8, 8}, Size{13, 6}, Size{13, 8},
                                         Size{21, 12}, Size{3, 16}),
                         [](const auto& test) {
                           return std::to_string(test.param.modes) + "Modes" +
                                  std::to_string(test.param.nodes) + "Nodes";
                         });

TEST(LaneProduct, IsTheMatrixTimesItsColumns) {
  for (const int rows : {1, 3, 8, 13, 16, 37})
    for (const int columns : {1, 3, 4, 9})
      for (const auto find : runnable(multiply_by<2>, multiply_avx2, multiply_avx512)) {
        const Eigen::MatrixXd a = random_matrix(rows, 6, 1);
        // columns further apart than they are long
        const Eigen::MatrixXd x = random_matrix(9, columns, 2),
                              before = random_matrix(40, columns, 3);
        MatrixProduct product = {.rows = rows,
                                 .inner = 6,
                                 .columns = columns,
                                 .matrix = a.data(),
                                 .x = x.data(),
                                 .x_stride = x.rows(),
                                 .to_stride = before.rows()};
        for (const bool adds : {false, true}) {
          Eigen::MatrixXd to = before;
          product.to = to.data();
          product.adds = adds;
          find(product);
          Eigen::MatrixXd expected = before;
          if (!adds) expected.topRows(rows).setZero();
          for (int i = 0; i < rows; ++i)
            for (int j = 0; j < columns; ++j)
              for (int k = 0; k < 6; ++k) expected(i, j) += a(i, k) * x(k, j);
          EXPECT_LE((to - expected).cwiseAbs().maxCoeff(), 1e-15) << rows << " by " << columns;
        }
      }
}

TEST(LaneProduct, OfTwoRowsIsTheSumOfTheirProducts) {
  for (const int size : {0, 1, 7, 8, 31, 32, 33, 64, 257})
    for (const auto find : runnable(find_dot_by<2>, find_dot_avx2, find_dot_avx512)) {
      const Eigen::MatrixXd numbers = random_matrix(size + 1, 2, 1);
      ProductOfRows rows{
          .size = size, .a = numbers.col(0).data(), .b = numbers.col(1).data(), .sum = 1.0};
      find(rows);
      double expected = 0.0;
      for (int i = 0; i < size; ++i) expected += numbers(i, 0) * numbers(i, 1);
      EXPECT_NEAR(rows.sum, expected, 1e-15 * std::max(size, 1)) << size;
    }
}

class Stations : public testing::TestWithParam<int> {
 protected:
  const int n = GetParam(), m = 5;
  const Eigen::MatrixXd slopes = random_matrix(n, m, 10);
};

TEST_P(Stations, HaveTheModesSlopes) {
  const Eigen::VectorXd a = random_matrix(m, 1, 11), rate = random_matrix(m, 1, 12);
  const Eigen::VectorXd pull = random_matrix(n, 1, 13);
  for (const auto find : runnable(find_slopes_by<2>, find_slopes_avx2, find_slopes_avx512)) {
    Eigen::VectorXd slope(n), slope_rate(n);
    find({n, m, slopes.data(), a.data(), rate.data(), slope.data(), slope_rate.data()});
    EXPECT_LE((slope - slopes * a).norm(), 1e-14 * n);
    EXPECT_LE((slope_rate - slopes * rate).norm(), 1e-14 * n);
  }
  for (const auto find :
       runnable(find_force_of_pull_by<2>, find_force_of_pull_avx2, find_force_of_pull_avx512)) {
    Eigen::VectorXd force(m);
    find({n, m, slopes.data(), pull.data(), force.data()});
    EXPECT_LE((force - slopes.transpose() * pull).norm(), 1e-14 * n);
  }
}

// Against differences of the energy whose gradient the pull is, and the momentum's gain.
TEST_P(Stations, ArePulledDownTheEnergysSlope) {
  const Eigen::VectorXd length = random_matrix(n, 1, 14).cwiseAbs(),
                        weight = random_matrix(n, 1, 15).cwiseAbs(),
                        strain = random_matrix(n, 1, 16), bending = random_matrix(n, 1, 17),
                        before = random_matrix(n, 1, 18), after = random_matrix(n, 1, 19),
                        momentum = random_matrix(n, 1, 20), gained = random_matrix(n, 1, 21);
  const Eigen::VectorXd momentum_after = momentum + gained;
  const double h = 0.6;
  const Eigen::VectorXd middle = 0.5 * (before + after);
  const auto energy = [&](const Eigen::VectorXd& s, bool floats, double psi) {
    double sum = 0.0;
    const auto square = [&](double x) { return x * x - (floats ? (x - psi) * (x - psi) : 0.0); };
    for (int i = 0; i + 1 < n; ++i)
      sum += 0.25 * bending[i] * std::pow(s[i + 1] - s[i], 2) * (square(s[i]) + square(s[i + 1]));
    for (int i = 0; i < n; ++i) {
      const double fourth = std::pow(s[i], 4) - (floats ? std::pow(s[i] - psi, 4) : 0.0);
      sum += length[i] * weight[i] * (0.125 * fourth - 0.5 * strain[i] * s[i] * s[i]);
    }
    return sum;
  };
  for (const auto find : runnable(find_third_order_pull_by<2>, find_third_order_pull_avx2,
                                  find_third_order_pull_avx512))
    for (const bool floats : {false, true}) {
      const double psi = floats ? 0.4 : 0.0;
      Eigen::VectorXd slope(n), pull(n);
      ThirdOrderPull stations{.stations = n,
                              .length = length.data(),
                              .weight = weight.data(),
                              .strain = strain.data(),
                              .bending = bending.data(),
                              .slope_before = before.data(),
                              .slope_after = after.data(),
                              .momentum_before = momentum.data(),
                              .momentum_after = momentum_after.data(),
                              .h = h,
                              .floats = floats,
                              .frame = psi,
                              .slope = slope.data(),
                              .pull = pull.data()};
      find(stations);
      const double step = 1e-3;  // differences of a polynomial of fourth degree by five points
      const auto gradient = [&](const std::function<double(double)>& of) {
        return (8.0 * (of(step) - of(-step)) - (of(2.0 * step) - of(-2.0 * step))) / (12.0 * step);
      };
      for (int i = 0; i < n; ++i) {
        const double of_energy = gradient([&](double moved) {
          Eigen::VectorXd s = middle;
          s[i] += moved;
          return energy(s, floats, psi);
        });
        EXPECT_NEAR(slope[i], middle[i], 1e-15);
        EXPECT_NEAR(pull[i], -of_energy - length[i] * middle[i] * gained[i] / h, 1e-11 * n) << i;
      }
      const double of_frame =
          floats ? gradient([&](double moved) { return energy(middle, floats, psi + moved); })
                 : 0.0;
      EXPECT_NEAR(stations.of_frame, -of_frame, 1e-11 * n);
    }
}

INSTANTIATE_TEST_SUITE_P(AlongABar, Stations, testing::Values(2, 7, 8, 9, 16, 23));

}  // namespace
}  // namespace impactrig::tests
