// SPDX-License-Identifier: BSD-3-Clause
// Modes of finite elements by counts of pivots and inverse iteration, against a dense solver,
// closed forms and what makes them modes.
#include "models/beams/bar_modes.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "tests/models/scenes.hpp"

namespace {

using namespace impactrig::models;
using namespace impactrig::tests;

LinearBar bar_of(const Rig& rig, std::array<int, 2> elements) {
  return LinearBar(rig, bar_elements(rig.beam, rig.contact.position, elements));
}

Rig shearing(Rig rig) {
  rig.beam.theory = BeamTheory::timoshenko;
  rig.beam.shear_coefficient = 0.9;
  rig.beam.poisson_ratio = 0.3;
  return rig;
}

/// Steps, masses, springs and weights from next to nothing to far too much.
Rig random_rig(unsigned seed) {
  std::mt19937 random(seed);
  const auto between = [&](double low, double high) {
    return low * std::pow(high / low, std::uniform_real_distribution<double>(0.0, 1.0)(random));
  };
  Rig rig = paper_rig();
  rig.gravity = seed % 3 == 0 ? 0.0 : between(1e-2, 1e3);
  rig.contact.position = rig.beam.length * between(0.1, 0.99);
  if (seed % 2 == 0) {
    const double first = rig.beam.length * between(0.1, 0.9);
    rig.beam.segments = {{first, rig.beam.area, rig.beam.second_moment, 0.9},
                         {rig.beam.length - first, rig.beam.area * between(0.1, 10.0),
                          rig.beam.second_moment * between(1e-2, 1e2), 0.85}};
  }
  for (unsigned k = 0; k < seed % 4; ++k)
    rig.beam.masses.push_back({rig.beam.length * between(0.05, 1.0), between(1e-3, 10.0)});
  if (seed % 5 < 2) rig.hinge.spring = between(1e-2, 1e5);
  return seed % 3 == 1 ? shearing(rig) : rig;
}

/// The dense problem of the coordinates that are free.
struct Dense {
  Eigen::MatrixXd mass, stiffness;
  Eigen::VectorXd squares;
};

Dense dense(const LinearBar& bar, bool clamped) {
  const SmallMotion motion = bar.small_motion();
  const Eigen::Index n = bar.size() - (clamped ? 1 : 0);
  const Eigen::MatrixXd stiffness =
      motion.stiffness + motion.gravity + motion.spring * motion.hinge * motion.hinge.transpose();
  Dense all{motion.mass.bottomRightCorner(n, n), stiffness.bottomRightCorner(n, n), {}};
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(all.stiffness, all.mass);
  all.squares = solver.eigenvalues();
  return all;
}

void expect_modes_of(const LinearBar& bar, bool clamped) {
  const std::optional<BarModes> modes = BarModeFinder(bar, clamped).all();
  ASSERT_TRUE(modes);
  const Dense expected = dense(bar, clamped);
  const Eigen::Index n = expected.squares.size();
  ASSERT_EQ(modes->squares.size(), n);
  // a part of its last digit is what rounding of the matrices leaves of any square
  const double largest = expected.squares[n - 1];
  for (Eigen::Index k = 0; k < n; ++k)
    EXPECT_NEAR(modes->squares[k], expected.squares[k],
                1e-11 * expected.squares[k] + 1e-14 * largest)
        << k;
  if (clamped) {
    EXPECT_EQ(modes->rows.col(0), Eigen::VectorXd::Zero(n));
  }
  // shapes of modes that are close err by more
  double closest = 1.0;
  for (Eigen::Index k = 0; k + 1 < n; ++k)
    closest = std::min(closest, 1.0 - expected.squares[k] / expected.squares[k + 1]);
  const double tolerance = 1e-10 + 1e-11 / closest;
  const Eigen::MatrixXd rows = modes->rows.rightCols(n);
  const Eigen::MatrixXd unit = rows * expected.mass * rows.transpose();
  EXPECT_LT((unit - Eigen::MatrixXd::Identity(n, n)).cwiseAbs().maxCoeff(), tolerance);
  const Eigen::MatrixXd diagonal = rows * expected.stiffness * rows.transpose();
  const Eigen::MatrixXd off = diagonal - Eigen::MatrixXd(modes->squares.asDiagonal());
  EXPECT_LT(off.cwiseAbs().maxCoeff(), tolerance * largest);
}

TEST(BarModes, AreThoseOfADenseSolver) {
  for (unsigned seed = 0; seed < 100; ++seed)
    for (const bool clamped : {false, true}) {
      SCOPED_TRACE("seed " + std::to_string(seed));
      expect_modes_of(bar_of(random_rig(seed), {7, 5}), clamped);
      expect_modes_of(bar_of(random_rig(seed), {2, 2}), clamped);
    }
}

TEST(BarModes, SlowestAreTheFirstOfAll) {
  for (const Rig& rig : {random_rig(2), random_rig(7)}) {
    const LinearBar bar = bar_of(rig, {14, 6});
    const std::optional<BarModes> all = BarModeFinder(bar).all();
    const std::optional<BarModes> few = BarModeFinder(bar).slowest(9, {});
    ASSERT_TRUE(all && few);
    ASSERT_EQ(few->squares.size(), 9);
    for (int k = 0; k < 9; ++k) {
      EXPECT_NEAR(few->squares[k] / all->squares[k], 1.0, 1e-12) << k;
      const double sign = few->rows.row(k).dot(all->rows.row(k)) < 0.0 ? -1.0 : 1.0;
      EXPECT_LT((few->rows.row(k) - sign * all->rows.row(k)).norm(),
                1e-8 * all->rows.row(k).norm());
    }
  }
}

// Of beam theory, tan βL = tanh βL. The mesh errs by (βh)⁴/720, 3e-13 of ω here and less; a dense
// solver's rounding would be 1e-4 of it.
TEST(BarModes, OfAVeryFineMeshAreRightToAllDigits) {
  Rig rig = paper_rig();
  rig.gravity = 0.0;
  const std::optional<BarModes> modes = BarModeFinder(bar_of(rig, {896, 128})).slowest(12, {});
  ASSERT_TRUE(modes);
  const double scale = std::sqrt(rig.beam.youngs_modulus * rig.beam.second_moment /
                                 (rig.beam.density * rig.beam.area)) /
                       std::pow(rig.beam.length, 2);
  const double beta[] = {3.926602312047919, 7.068582745628732, 10.210176122813030,
                         13.351768777754094};
  EXPECT_NEAR(modes->squares[0], 0.0, 1e-12 * modes->squares[1]);
  for (int k = 0; k < 4; ++k)
    EXPECT_NEAR(std::sqrt(modes->squares[1 + k]) / (scale * beta[k] * beta[k]), 1.0,
                std::pow(beta[k] / 1024.0, 4) / 720.0 * 2.0 + 2e-13)
        << k;
}

// Two pendulums of one weightless rod would be as slow as each other: here a bar far stiffer than
// its weight, so that the first mode is the rigid pendulum's.
// Of elements that are all alike 48 of 112 vibrate, clamped, as fast by themselves as all do, to
// seven digits, and so on: elimination loses these.
TEST(BarModes, AreFoundWherePartsOfTheBarVibrateAsFast) {
  Rig rig = paper_rig();
  rig.gravity = 0.0;
  for (const bool clamped : {true, false})
    for (int count = 14; count <= 60; count += 2) {
      SCOPED_TRACE(count);
      const int elements = 32 + 4 * count;
      const LinearBar bar(rig, bar_elements(rig.beam, rig.beam.length, {elements, 0}));
      const std::optional<BarModes> modes = BarModeFinder(bar, clamped).slowest(count, {});
      ASSERT_TRUE(modes);
      const Eigen::MatrixXd masses =
          modes->rows * bar.small_motion().mass * modes->rows.transpose();
      const double off = (masses - Eigen::MatrixXd::Identity(count, count)).cwiseAbs().maxCoeff();
      EXPECT_LT(off, 1e-8);
    }
}

TEST(BarModes, SlowestIsTheRigidPendulum) {
  Rig rig = paper_rig();
  rig.gravity = 9.81;
  rig.beam.youngs_modulus *= 1e6;
  const std::optional<BarModes> modes = BarModeFinder(bar_of(rig, {35, 5})).slowest(3, {});
  ASSERT_TRUE(modes);
  EXPECT_NEAR(modes->squares[0], 1.5 * rig.gravity / rig.beam.length, 1e-7);
  rig.gravity_direction = std::numbers::pi;  // it stands on its hinge
  const std::optional<BarModes> standing = BarModeFinder(bar_of(rig, {35, 5})).slowest(3, {});
  ASSERT_TRUE(standing);
  EXPECT_NEAR(standing->squares[0], -1.5 * rig.gravity / rig.beam.length, 1e-7);
}

TEST(BarModes, TellRigidRotationHingeAndWeight) {
  for (const unsigned seed : {2u, 4u, 5u, 7u, 8u, 10u, 14u, 20u, 26u, 32u}) {
    SCOPED_TRACE(seed);
    const Rig rig = random_rig(seed);
    const bool fine = seed % 2 == 0;
    const LinearBar bar = fine ? bar_of(rig, {50, 30}) : bar_of(rig, {9, 4});
    const std::optional<BarModes> modes = BarModeFinder(bar).all();
    ASSERT_TRUE(modes);
    const SmallMotion motion = bar.small_motion();
    const Eigen::VectorXd rigid = modes->rows * (motion.mass * motion.rigid);
    EXPECT_LT((modes->rigid - rigid).norm(), 1e-9 * rigid.norm());
    EXPECT_LT((modes->hinge - modes->rows * motion.hinge).norm(), 1e-12 * modes->hinge.norm());
    const Eigen::MatrixXd weight = modes->rows * motion.gravity * modes->rows.transpose();
    const Eigen::Index held = modes->weight.rows();
    ASSERT_GT(held, 0);
    EXPECT_LT((modes->weight - weight.topLeftCorner(held, held)).norm(), 1e-9 * weight.norm());
    for (Eigen::Index k = held; k < weight.rows(); ++k)
      EXPECT_LT(weight(k, k), 1.001e-6 * modes->squares[k]) << k;
  }
}

// Whatever few modes there are: the steady deflection under a force at a point is the bar's.
TEST(BarModes, StandInsBendAsAllTheOthersDo) {
  for (unsigned seed = 0; seed < 30; ++seed) {
    const Rig rig = random_rig(seed);
    const LinearBar bar = bar_of(rig, {14, 6});
    const auto compliance = [&](const BarModes& modes) {
      const LinearBar::Row at = bar.row_at(rig.contact.position);
      double sum = 0.0;
      for (Eigen::Index k = 1; k < modes.squares.size(); ++k) {
        double moved = 0.0;
        for (std::size_t i = 0; i < BarElement::values; ++i)
          if (at.places[i] >= 0)
            moved += at.values[static_cast<int>(i)] * modes.rows(k, at.places[i]);
        sum += moved * moved / modes.squares[k];
      }
      return sum;
    };
    const std::optional<BarModes> all = BarModeFinder(bar).all();
    const std::optional<BarModes> few =
        BarModeFinder(bar).slowest(8, {bar.row_at(rig.contact.position)});
    ASSERT_TRUE(all && few);
    ASSERT_EQ(few->squares.size(), 9);
    EXPECT_EQ(few->own, 8);
    const double error = std::pow(all->squares[1] / all->squares[8], 2);
    EXPECT_NEAR(compliance(*few) / compliance(*all), 1.0, error + 1e-10) << seed;
  }
}

// A soft bar that stands on its hinge would fall over in more than one way.
TEST(BarModes, AreFoundBelowZeroToo) {
  Rig rig = paper_rig();
  rig.gravity = 9.81;
  rig.gravity_direction = std::numbers::pi;
  rig.beam.youngs_modulus *= 1e-5;
  const LinearBar bar = bar_of(rig, {14, 6});
  const LinearBar::Row at = bar.row_at(rig.contact.position);
  const std::optional<BarModes> all = BarModeFinder(bar).all();
  const std::optional<BarModes> few = BarModeFinder(bar).slowest(12, {at});
  ASSERT_TRUE(all && few);
  ASSERT_LT(all->squares[1], 0.0);
  const auto moved = [&](const BarModes& modes, Eigen::Index k) {
    double sum = 0.0;
    for (std::size_t i = 0; i < BarElement::values; ++i)
      if (at.places[i] >= 0) sum += at.values[static_cast<int>(i)] * modes.rows(k, at.places[i]);
    return sum * sum / modes.squares[k];
  };
  double left_out = 0.0;
  for (Eigen::Index k = 12; k < all->squares.size(); ++k) left_out += moved(*all, k);
  const double error =
      std::pow((std::abs(all->squares[0]) + std::abs(all->squares[1])) / all->squares[12], 2);
  EXPECT_NEAR(moved(*few, 12) / left_out, 1.0, error + 1e-10);
}

TEST(BarModes, StandInsOfOnePointTwiceAreOne) {
  const Rig rig = paper_rig();
  const LinearBar bar = bar_of(rig, {14, 6});
  const LinearBar::Row at = bar.row_at(rig.contact.position);
  const std::optional<BarModes> modes = BarModeFinder(bar).slowest(8, {at, at});
  ASSERT_TRUE(modes);
  EXPECT_EQ(modes->squares.size(), 9);
  EXPECT_EQ(modes->rows.rows(), 9);
}

}  // namespace
