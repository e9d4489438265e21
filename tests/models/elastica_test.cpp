// SPDX-License-Identifier: BSD-3-Clause
// ANCF at rest under a dead load across the tip that bends it to 80 % of its length. The slope of
// the hinge across the bar is held, so the bar is a cantilever. Two references: the elastica of an
// inextensible bar in elliptic integrals, and the model's own continuous equations, shot by
// Boost.Odeint.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <boost/numeric/odeint.hpp>
#include <cmath>
#include <numbers>

#include "models/beams/ancf.hpp"
#include "tests/models/elastica.hpp"
#include "tests/models/scenes.hpp"
#include "tests/support/convergence_study.hpp"

namespace {

using namespace impactrig::models;
using namespace impactrig::tests;
using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

/// Bar of unit length, EI and line density with EA = 1 / extensibility, struck at its tip.
Rig unit_rig(double extensibility) {
  Rig rig;
  rig.beam = {.length = 1.0,
              .area = 1.0,
              .second_moment = extensibility,
              .youngs_modulus = 1.0 / extensibility,
              .density = 1.0};
  rig.contact.position = 1.0;
  rig.gravity = 0.0;
  return rig;
}

/// Equilibrium of an AncfBeam seen through its accelerations: force = M a, and M is read off the
/// kinetic energy.
class HeldBar {
 public:
  HeldBar(double extensibility, int elements)
      : beam_(unit_rig(extensibility), {elements, 0}),
        n_(beam_.size()),
        mass_(n_, n_),
        q_(Vector::Zero(n_)) {
    const auto kinetic = [&](const Vector& v) { return beam_.energy(q_, v).kinetic; };
    for (int i = 0; i < n_; ++i)
      for (int j = 0; j < n_; ++j)
        mass_(i, j) = kinetic(unit(i) + unit(j)) - kinetic(unit(i)) - kinetic(unit(j));
  }

  TipDeflection tip_under(double load) {
    const int steps = 10;
    for (int step = 1; step <= steps; ++step) solve(load * step / steps);
    return {q_[n_ / 2 - 2], q_[n_ - 2]};
  }

  /// What holds the hinge's slope, times the length of its tangent: the clamping moment.
  double clamping_moment(double load) { return force(q_, load)[0] * (1.0 - q_[n_ / 2]); }

 private:
  Vector unit(int i) const { return Vector::Unit(n_, i); }

  Vector force(const Vector& q, double load) {
    Vector a(n_);
    beam_.acceleration(q, Vector::Zero(n_), load, a);
    return mass_ * a;
  }

  void solve(double load) {
    const int free = n_ - 1;  // all but the slope of the hinge across the bar, the first
    Matrix tangent(n_, free);
    for (int iteration = 0; iteration < 30; ++iteration) {
      const double h = 1e-6;
      for (int k = 0; k < free; ++k)
        tangent.col(k) =
            (force(q_ + h * unit(k + 1), load) - force(q_ - h * unit(k + 1), load)) / (2.0 * h);
      const Vector step = tangent.bottomRows(free).partialPivLu().solve(force(q_, load).tail(free));
      q_.tail(free) -= step;
      if (step.cwiseAbs().maxCoeff() < 1e-11) return;
    }
    FAIL() << "no equilibrium found under " << load;
  }

  AncfBeam beam_;
  int n_;
  Matrix mass_;
  Vector q_;
};

/// The model's continuous equations: with t = r' the load F leaves EI t'' = EA ε t − F of U = ½ ∫
/// EA ε² + EI r''·r'' dx. The slope across at the hinge is held, everything else is free: t' = 0 at
/// the tip, along the bar also at the hinge. Solved by multiple shooting.
class ContinuousBar {
 public:
  explicit ContinuousBar(double extensibility)
      : extensibility_(extensibility),
        nodes_(4 * segments) {
    for (int i = 0; i < segments; ++i) nodes_.segment<4>(4 * i) << 0.0, 1.0, 0.0, 0.0;
  }

  TipDeflection tip_under(double load) {
    const int steps = 10;
    for (int step = 1; step <= steps; ++step) solve(load * step / steps);
    TipDeflection tip{0.0, 1.0};
    for (int i = 0; i < segments; ++i) {
      const State end = shoot(load, nodes_.segment<4>(4 * i));
      tip.across += end[4];
      tip.shortening -= end[5];
    }
    return tip;
  }

 private:
  using State = std::array<double, 6>;  // t across and along, their derivatives, r across and along
  static constexpr int segments = 16;

  State shoot(double load, const Eigen::Vector4d& start) const {
    State y{start[0], start[1], start[2], start[3], 0.0, 0.0};
    boost::numeric::odeint::runge_kutta_fehlberg78<State> stepper;
    const auto slope = [&](const State& s, State& d, double) {
      const double tension = 0.5 * (s[0] * s[0] + s[1] * s[1] - 1.0) / extensibility_;
      d = {s[2], s[3], tension * s[0] - load, tension * s[1], s[0], s[1]};
    };
    const int steps = 20;  // a tenth of the thinnest layer, √(EI / EA), each: rounding
    for (int i = 0; i < steps; ++i) stepper.do_step(slope, y, 0.0, 1.0 / (segments * steps));
    return y;
  }

  Eigen::Vector4d end_of(double load, const Eigen::Vector4d& start) const {
    const State y = shoot(load, start);
    return {y[0], y[1], y[2], y[3]};
  }

  /// Jumps between the segments, and what the ends ask for.
  void solve(double load) {
    const int n = 4 * segments;
    for (int iteration = 0; iteration < 30; ++iteration) {
      Vector residual(n);
      Matrix tangent = Matrix::Zero(n, n);
      for (int i = 0; i < segments; ++i) {
        const Eigen::Vector4d start = nodes_.segment<4>(4 * i);
        const Eigen::Vector4d end = end_of(load, start);
        Eigen::Matrix4d map;
        const double h = 1e-5;
        for (int k = 0; k < 4; ++k)
          map.col(k) = (end_of(load, start + h * Eigen::Vector4d::Unit(k)) -
                        end_of(load, start - h * Eigen::Vector4d::Unit(k))) /
                       (2.0 * h);
        if (i + 1 < segments) {
          residual.segment<4>(4 * i) = end - nodes_.segment<4>(4 * i + 4);
          tangent.block<4, 4>(4 * i, 4 * i) = map;
          tangent.block<4, 4>(4 * i, 4 * i + 4) = -Eigen::Matrix4d::Identity();
        } else {
          residual.segment<2>(4 * i) = end.tail<2>();
          tangent.block<2, 4>(4 * i, 4 * i) = map.bottomRows<2>();
        }
      }
      residual.tail<2>() << nodes_[0], nodes_[3];
      tangent(n - 2, 0) = tangent(n - 1, 3) = 1.0;
      const Vector step = tangent.partialPivLu().solve(residual);
      nodes_ -= step;
      if (step.cwiseAbs().maxCoeff() < 1e-11) return;
    }
    FAIL() << "no equilibrium found under " << load;
  }

  double extensibility_;
  Vector nodes_;  // t and t' at the beginning of each segment
};

// Source: [Mattiasson1981], five decimals: slope, deflection and shortening of the tip.
TEST(Elastica, OfEllipticIntegralsIsTheTabulatedOne) {
  struct Row {
    double load, slope, across, shortening;
  };

  for (const Row& row :
       {Row{1.0, 0.46135, 0.30172, 0.05643}, Row{2.0, 0.78175, 0.49346, 0.16064},
        Row{5.0, 1.21537, 0.71379, 0.38763}, Row{10.0, 1.43029, 0.81061, 0.55500}}) {
    const Elastica elastica(row.load);
    EXPECT_NEAR(elastica.tip_slope, row.slope, 5e-6) << row.load;
    EXPECT_NEAR(elastica.tip.across, row.across, 5e-6) << row.load;
    EXPECT_NEAR(elastica.tip.shortening, row.shortening, 5e-6) << row.load;
  }
}

// Displacements of nodes of cubic elements under a fourth-order operator: 2 (3 + 1 − 2) = 4.
TEST(AncfElastica, ConvergesToItsContinuousEquationsWithOrderFour) {
  const double load = 10.0;
  for (const double extensibility : {1e-2, 1e-3}) {
    const TipDeflection exact = ContinuousBar(extensibility).tip_under(load);
    ConvergenceStudy across, shortening;
    for (const int elements : {8, 12, 16, 24}) {
      HeldBar bar(extensibility, elements);
      const TipDeflection tip = bar.tip_under(load);
      across.add(1.0 / elements, std::abs(tip.across - exact.across));
      shortening.add(1.0 / elements, std::abs(tip.shortening - exact.shortening));
      // elements turn without strain, so moments balance in any mesh; rounding of EA t grows with
      // the mesh
      EXPECT_NEAR(bar.clamping_moment(load), load * (1.0 - tip.shortening), 1e-8);
    }
    EXPECT_NEAR(across.order(), 4.0, 0.25) << extensibility;
    EXPECT_NEAR(shortening.order(), 4.0, 0.25) << extensibility;
    EXPECT_GT(across.correlation(), 0.999);
    EXPECT_GT(shortening.correlation(), 0.999);
  }
}

// Stretching and shortening of the curve are of the order of 1 / (EA L² / EI); the next term is
// that to the power 3/2, 3 % of it or less here.
TEST(AncfElastica, ApproachesTheInextensibleElasticaWithOrderOne) {
  for (const double load : {1.0, 5.0, 10.0}) {
    const Elastica elastica(load);
    ConvergenceStudy study;
    for (const double extensibility : {1e-3, 2.5e-4, 6.25e-5}) {
      const TipDeflection fine = HeldBar(extensibility, 24).tip_under(load);
      const TipDeflection coarse = HeldBar(extensibility, 12).tip_under(load);
      // the mesh error of order four taken out
      const double across = fine.across + (fine.across - coarse.across) / 15.0;
      study.add(extensibility, std::abs(across - elastica.tip.across));
    }
    EXPECT_NEAR(study.order(), 1.0, 0.03) << load;
    EXPECT_GT(study.correlation(), 0.9999) << load;
  }
}

}  // namespace
