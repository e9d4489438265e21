// SPDX-License-Identifier: BSD-3-Clause
#include "models/beams/ancf.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <random>

#include "tests/models/plain_chain.hpp"
#include "tests/models/scenes.hpp"
#include "tests/support/convergence_study.hpp"

namespace {

using namespace impactrig::models;
using namespace impactrig::tests;
using Vector = Eigen::VectorXd;

/// A bar soft enough to bend visibly under forces of a few newtons.
Rig soft_rig() {
  Rig rig = paper_rig();
  rig.beam.youngs_modulus = 1e6;
  rig.gravity = 9.81;
  return rig;
}

/// Gravity askew, masses within the first element, within a later one, on a node and at the tip.
Rig laden_rig() {
  Rig rig = soft_rig();
  rig.beam.masses = {{0.1, 0.3}, {0.75, 0.4}, {0.46, 0.2}, {0.8, 0.5}};
  rig.gravity_direction = 0.6;
  return rig;
}

struct State {
  Vector q, v;
};

State random_state(const AncfBeam& beam, unsigned seed, double angle) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  State state{Vector(beam.size()), Vector(beam.size())};
  beam.set_rigid_motion(angle, 3.0, state.q, state.v);
  for (int i = 0; i < beam.size(); ++i) {
    state.q[i] += 0.03 * unit(random);
    state.v[i] += unit(random);
  }
  return state;
}

TEST(Ancf, AccelerationsFulfilLagrangesEquationsAtLargeRotationsAndStrains) {
  const Rig rig = laden_rig();
  AncfBeam beam(rig, {3, 2});
  const PlainChain plain(rig, {3, 2});
  const int n = beam.size();
  for (double angle : {0.0, 1.3, -2.5}) {
    const State s = random_state(beam, 5, angle);
    for (double force : {0.0, 40.0}) {
      Vector a(n);
      beam.acceleration(s.q, s.v, force, a);
      EXPECT_EQ(beam.struck_acceleration(s.q, s.v, a), beam.struck_point(s.q, a).velocity);
      Vector inertia(n), given(n);
      for (int k = 0; k < n; ++k) {
        Vector unit = Vector::Zero(n);
        unit[k] = 1.0;
        inertia[k] = 0.5 * (plain.kinetic(a + unit) - plain.kinetic(a - unit));  // (M a)_k
        const auto energy = [&](double h) {
          return plain.elastic(s.q + h * unit) + plain.gravitational(s.q + h * unit);
        };
        const auto central = [&](double h) { return (energy(h) - energy(-h)) / (2.0 * h); };
        // the energy is of degree four: two differences give its gradient without truncation
        given[k] = -(4.0 * central(5e-3) - central(1e-2)) / 3.0;
        const Vector pushed = s.q + unit;
        given[k] -= force * (beam.struck_point(pushed, s.v).displacement -
                             beam.struck_point(s.q, s.v).displacement);
      }
      EXPECT_LT((inertia - given).norm(), 1e-10 * given.norm()) << angle << ' ' << force;
    }
  }
}

TEST(Ancf, EnergiesAreThoseOfThePositions) {
  const Rig rig = laden_rig();
  AncfBeam beam(rig, {3, 2});
  const PlainChain plain(rig, {3, 2});
  const State s = random_state(beam, 9, 0.8);
  const BeamEnergy energy = beam.energy(s.q, s.v);
  EXPECT_NEAR(energy.kinetic / plain.kinetic(s.v), 1.0, 1e-13);
  EXPECT_NEAR(energy.elastic / plain.elastic(s.q), 1.0, 1e-13);
  EXPECT_NEAR(energy.gravitational / plain.gravitational(s.q), 1.0, 1e-13);
}

TEST(Ancf, IsNotStrainedByARigidRotationOfAnyAngle) {
  Rig rig = paper_rig();
  AncfBeam beam(rig, {5, 3});
  const int n = beam.size();
  Vector q(n), v(n), a(n);
  for (double angle = -6.0; angle <= 6.0; angle += 0.37) {
    beam.set_rigid_motion(angle, 0.0, q, v);
    // strains of a few roundings, squared
    EXPECT_LT(beam.energy(q, v).elastic,
              1e-29 * rig.beam.youngs_modulus * rig.beam.area * rig.beam.length);
    beam.acceleration(q, v, 0.0, a);
    // E 1e-16 / (ρ l²) with the shortest element, and 105 for the small inertia of a nodal slope
    const double unit =
        105.0 * rig.beam.youngs_modulus * 1e-16 / (rig.beam.density * std::pow(0.11 / 3.0, 2));
    EXPECT_LT(a.cwiseAbs().maxCoeff(), 1e3 * unit) << "angle " << angle;
  }
}

TEST(Ancf, CarriesMassFirstMomentAndInertiaOfTheBar) {
  const Rig rig = soft_rig();
  AncfBeam beam(rig, {3, 2});
  const int n = beam.size() / 2;
  Vector q = Vector::Zero(2 * n), v = Vector::Zero(2 * n);
  // a rotation: ½ I ω²
  beam.set_rigid_motion(0.4, 2.0, q, v);
  EXPECT_NEAR(beam.energy(q, v).kinetic / (0.5 * rig.beam.hinge_inertia() * 4.0), 1.0, 1e-14);
  EXPECT_NEAR(beam.energy(q, v).gravitational /
                  (rig.beam.bar_mass() * 9.81 * 0.5 * rig.beam.length * (1.0 - std::cos(0.4))),
              1.0, 1e-14);
  // the mass the hinge does not hold: the field of a translation, less its first node's value,
  // against the cubic's own integral
  const PlainChain plain(rig, {3, 2});
  Vector one = Vector::Zero(2 * n);
  for (int i = 1; i < n; i += 2) one[i] = 1.0;
  EXPECT_NEAR(beam.energy(q, one).kinetic / plain.kinetic(one), 1.0, 1e-14);
  Vector lifted = Vector::Zero(2 * n);
  lifted.tail(n) = one.head(n);
  EXPECT_NEAR(beam.energy(lifted, v).gravitational / plain.gravitational(lifted), 1.0, 1e-14);
}

TEST(Ancf, FreeSwingFollowsTheMomentOfGravity) {
  // internal forces cannot change the moment of momentum: I d(rate)/dt = ∫ (g cos γ X − g sin γ Y)
  // dm
  const Rig rig = laden_rig();
  AncfBeam beam(rig, {3, 2});
  const PlainChain plain(rig, {3, 2});
  const int n = beam.size();
  const State s = random_state(beam, 3, 0.5);
  Vector a(n);
  beam.acceleration(s.q, s.v, 0.0, a);
  const auto rate = [&](double t) {
    return beam.rigid_part(s.q + t * s.v + 0.5 * t * t * a, s.v + t * a).rate;
  };
  const double measured = (rate(1e-5) - rate(-1e-5)) / 2e-5;
  const Vector across = s.q.head(n / 2);
  const Vector along = s.q.tail(n / 2);
  const auto lever = [&](std::size_t e, double xi) {
    return std::cos(0.6) * plain.field(across, e, xi)[0] -
           std::sin(0.6) * (plain.field(along, e, xi)[0] - plain.x(e, xi));
  };
  const double moment = rig.gravity * (rig.beam.density * rig.beam.area * plain.integral(lever) +
                                       plain.lumped(lever));
  EXPECT_NEAR(measured / (moment / rig.beam.hinge_inertia()), 1.0, 1e-6);
}

TEST(Ancf, RigidPartOfARigidMotionIsThatMotion) {
  AncfBeam beam(paper_rig(), {4, 3});
  Vector q(beam.size()), v(beam.size());
  beam.set_rigid_motion(2e-3, 1.7, q, v);
  const RigidPart rigid = beam.rigid_part(q, v);
  EXPECT_NEAR(rigid.angle, std::sin(2e-3), 1e-16);
  EXPECT_NEAR(rigid.rate, 1.7, 1e-13);
  beam.set_rigid_motion(-2.5, 1.7, q, v);
  EXPECT_NEAR(beam.rigid_part(q, v).along, std::cos(2.5), 1e-14);
}

TEST(Ancf, PointsFollowTheCubicBetweenTheNodes) {
  const Rig rig = soft_rig();
  AncfBeam beam(rig, {3, 2});
  const PlainChain plain(rig, {3, 2});
  const int n = beam.size() / 2;
  const State s = random_state(beam, 13, 0.1);
  for (std::size_t e = 0; e < 5; ++e)
    for (double xi : {0.0, 0.3, 0.9}) {
      const PointMotion p = beam.point(plain.x(e, xi), s.q, s.v);
      EXPECT_NEAR(p.displacement, -plain.field(s.q.head(n), e, xi)[0], 1e-14);
      EXPECT_NEAR(p.velocity, -plain.field(s.v.head(n), e, xi)[0], 1e-13);
    }
  const PointMotion struck = beam.struck_point(s.q, s.v);
  EXPECT_NEAR(beam.point(rig.contact.position, s.q, s.v).displacement, struck.displacement, 1e-15);
}

/// ω² of small vibrations across the hanging bar, rising.
Vector small_vibrations(const Rig& rig, std::array<int, 2> elements) {
  AncfBeam beam(rig, elements);
  const int n = beam.size() / 2;
  const double tiny = 1e-9;
  Eigen::MatrixXd linear(n, n);
  for (int k = 0; k < n; ++k) {
    Vector q = Vector::Zero(2 * n), a(2 * n);
    q[k] = tiny;
    beam.acceleration(q, Vector::Zero(2 * n), 0.0, a);
    linear.col(k) = -a.head(n) / tiny;
  }
  Vector squares = Eigen::EigenSolver<Eigen::MatrixXd>(linear, false).eigenvalues().real();
  std::sort(squares.begin(), squares.end());
  return squares;
}

TEST(Ancf, VibratesWithTheFrequenciesOfThePinnedFreeBarWithOrderFour) {
  Rig rig = paper_rig();
  rig.contact.position = 0.5 * rig.beam.length;  // a uniform mesh
  const double root = 3.926602312047919;         // tan z = tanh z
  const double unit = std::sqrt(rig.beam.youngs_modulus * rig.beam.second_moment /
                                (rig.beam.density * rig.beam.area)) /
                      std::pow(rig.beam.length, 2);
  ConvergenceStudy study;
  for (int half : {3, 4, 5, 6, 8}) {
    const Vector squares = small_vibrations(rig, {half, half});
    // the lowest is the rigid rotation, a zero of rounding
    EXPECT_LT(std::abs(squares[0]), 1e-6 * squares[1]);
    const double omega = std::sqrt(squares[1]);
    EXPECT_GT(omega, root * root * unit);  // elements only stiffen
    study.add(1.0 / half, omega / (root * root * unit) - 1.0);
  }
  EXPECT_NEAR(study.order(), 4.0, 0.15);
  EXPECT_GT(study.correlation(), 0.999);
}

TEST(Ancf, StretchesWithTheFrequencyOfTheBarWave) {
  // fixed-free: ω = (π / 2 L) √(E / ρ)
  Rig rig = paper_rig();
  AncfBeam beam(rig, {8, 2});
  const int n = beam.size() / 2;
  const double tiny = 1e-9;
  Eigen::MatrixXd linear(n, n);
  for (int k = 0; k < n; ++k) {
    // symmetric difference: the strain is quadratic in the stretch
    Vector q = Vector::Zero(2 * n), forward(2 * n), back(2 * n);
    q[n + k] = tiny;
    beam.acceleration(q, Vector::Zero(2 * n), 0.0, forward);
    beam.acceleration(-q, Vector::Zero(2 * n), 0.0, back);
    linear.col(k) = (back - forward).tail(n) / (2.0 * tiny);
  }
  Vector squares = Eigen::EigenSolver<Eigen::MatrixXd>(linear, false).eigenvalues().real();
  std::sort(squares.begin(), squares.end());
  const double expected = 0.5 * std::numbers::pi / rig.beam.length *
                          std::sqrt(rig.beam.youngs_modulus / rig.beam.density);
  // EI |r_xx|² also resists a stretch that is not uniform: (r / 2)² (π / 2L)² / 2 = 1e-4
  EXPECT_NEAR(std::sqrt(squares[0]) / expected, 1.0, 3e-4);
}

}  // namespace
