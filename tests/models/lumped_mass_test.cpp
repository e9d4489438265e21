// SPDX-License-Identifier: BSD-3-Clause
// Masses on the bar: closed forms of the pendulum and of the bar with a mass at its end, and the
// two beam models against each other.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "models/beams/ancf.hpp"
#include "models/beams/bending_modes.hpp"
#include "models/beams/floating_frame.hpp"
#include "models/integration/dop853.hpp"
#include "models/modal/modal_beam.hpp"
#include "models/simulation.hpp"
#include "tests/models/scenes.hpp"
#include "tests/support/convergence_study.hpp"
#include "tests/support/frequency_root.hpp"

namespace {

using namespace impactrig::models;
using namespace impactrig::tests;
using Vector = Eigen::VectorXd;

TEST(LumpedMass, AddsToTheMomentsOfTheBar) {
  Beam beam = paper_rig().beam;
  const double mass = 2766.7 * beam.area * 0.8;
  beam.masses = {{0.8, 0.1}, {0.2, 3.0}};
  EXPECT_DOUBLE_EQ(beam.bar_mass(), mass);
  EXPECT_DOUBLE_EQ(beam.total_mass(), mass + 3.1);
  EXPECT_DOUBLE_EQ(beam.first_moment(), mass * 0.4 + 0.08 + 0.6);
  EXPECT_DOUBLE_EQ(beam.hinge_inertia(), mass * 0.64 / 3.0 + 0.064 + 0.12);
}

/// The paper's bar with a mass at its tip.
Rig tip_laden(double part) {
  Rig rig = paper_rig();
  rig.beam.masses = {{rig.beam.length, part * rig.beam.bar_mass()}};
  return rig;
}

// Pinned at one end, a mass of μ times the bar's at the other: cot z − coth z = 2 μ z, z = βL.
double pinned_mass_root(double part, int number) {
  const double pi = std::numbers::pi;
  return frequency_root(
      [&](double z) {
        return std::cos(z) - std::sin(z) / std::tanh(z) - 2.0 * part * z * std::sin(z);
      },
      number * pi, (number + 0.25) * pi);
}

double frequency(const Beam& beam, double z) {
  return z * z / (beam.length * beam.length) *
         std::sqrt(beam.youngs_modulus * beam.second_moment / (beam.density * beam.area));
}

TEST(LumpedMass, AtTheTipGivesTheAncfBarItsFrequencies) {
  for (double part : {0.05, 1.0, 20.0}) {
    const Rig rig = tip_laden(part);
    const AncfBeam coarse(rig, {14, 2}), fine(rig, {28, 4});
    const ModalBeam few(coarse, rig), many(fine, rig);
    for (int k = 1; k <= 4; ++k) {
      const double exact = frequency(rig.beam, pinned_mass_root(part, k));
      const double error = many.omega()[k] / exact - 1.0;
      EXPECT_GT(error, -1e-9) << k;
      EXPECT_LT(error, 1e-4) << k;
      if (error < 1e-7) continue;  // its digits are rounding
      EXPECT_NEAR((few.omega()[k] / exact - 1.0) / error, 16.0, 1.5) << k;  // order four
    }
  }
}

TEST(LumpedMass, AtTheTipGivesTheHybridBarItsFrequencies) {
  // Its shapes are those of the bar alone: the mass, a shear force at the tip, is approached from
  // above as the modes grow in number.
  for (double part : {0.05, 1.0}) {
    const Rig rig = tip_laden(part);
    for (int k = 1; k <= 2; ++k) {
      const double exact = frequency(rig.beam, pinned_mass_root(part, k));
      double before = 1.0;
      for (int modes : {5, 10, 20, 40}) {
        const FloatingFrameBeam beam(rig, Basis::pinned_free, modes, 0);
        const double error = ModalBeam(beam, rig).omega()[k] / exact - 1.0;
        EXPECT_GT(error, 0.0);
        EXPECT_LT(error, before / 4.0) << modes;  // third power of their number, asymptotically
        before = error;
      }
      EXPECT_LT(before, 1e-4);
    }
  }
}

TEST(LumpedMass, BetweenTwoNodesIsWhereItIs) {
  // the same mass on a node of a fine mesh and inside an element of another
  Rig rig = paper_rig();
  rig.contact.position = 0.4;
  rig.beam.masses = {{0.5, 0.7}};
  const AncfBeam on_node(rig, {32, 32}), inside(rig, {30, 30});
  const ModalBeam a(on_node, rig), b(inside, rig);
  for (int k = 1; k <= 3; ++k) {
    EXPECT_NEAR(b.omega()[k] / a.omega()[k], 1.0, 1e-4) << k;
    EXPECT_NEAR(b.omega()[k] / ModalBeam(AncfBeam(paper_rig(), {28, 4}), rig).omega()[k], 0.8, 0.2);
  }
}

TEST(LumpedMass, OnARigidBarSwingsWithThePeriodOfThePendulum) {
  // a quarter period from rest at angle α: √(I / S g) K(sin(α / 2))
  Rig rig = paper_rig();
  rig.gravity = 9.81;
  rig.beam.masses = {{0.8, 1.3}, {0.1, 2.0}};
  const double mass = rig.beam.bar_mass();
  const double inertia = mass * 0.64 / 3.0 + 1.3 * 0.64 + 2.0 * 0.01;
  const double moment = 9.81 * (mass * 0.4 + 1.3 * 0.8 + 2.0 * 0.1);
  FloatingFrameBeam rigid_bar(rig, Basis::cantilever, 0, 0);
  const Dop853::RightHandSide f = [&](double, const Vector& y, Eigen::Ref<Vector> slope) {
    slope[0] = y[1];
    rigid_bar.acceleration(y.head(1), y.tail(1), 0.0, slope.tail(1));
  };
  for (double angle : {0.1, 2.0}) {
    Vector y(2);
    rigid_bar.set_rigid_motion(-angle, 0.0, y.head(1), y.tail(1));
    const double quarter = std::sqrt(inertia / moment) * std::comp_ellint_1(std::sin(0.5 * angle));
    Dop853 stepper(2);
    stepper.start(0.0, y, f);
    for (int i = 0; i < 200; ++i) {
      stepper.attempt(quarter / 200, Vector::Ones(2), f);
      stepper.accept();
    }
    const double speed = 0.69 * std::sqrt(2.0 * moment * (1.0 - std::cos(angle)) / inertia);
    const PointMotion p = rigid_bar.struck_point(stepper.state().head(1), stepper.state().tail(1));
    EXPECT_NEAR(p.displacement, 0.0, 1e-12);
    EXPECT_NEAR(p.velocity, speed, 1e-11);
    rig.start.release_angle = angle;
    EXPECT_NEAR(touch_velocity(rig), speed, 1e-14 * speed + 1e-15);
  }
}

TEST(LumpedMass, OfARigidBarTakesItsShareOfTheImpulse) {
  // I (1 + e) v / L_p²
  Rig rig = paper_rig();
  rig.contact.damping = "exact";
  rig.contact.restitution = 0.4;
  const double bare = simulate(rig, rigid(1e-10)).impulse;
  rig.beam.masses = {{0.8, 0.5}};
  const Simulation run = simulate(rig, rigid(1e-10));
  const double inertia = rig.beam.bar_mass() * 0.64 / 3.0 + 0.5 * 0.64;
  EXPECT_NEAR(run.impulse / (1.4 * inertia * 0.441 / (0.69 * 0.69)), 1.0, 1e-6);
  EXPECT_NEAR(run.energy.initial, 0.5 * inertia * std::pow(0.441 / 0.69, 2), 1e-12);
  EXPECT_GT(run.impulse, 1.5 * bare);
}

TEST(LumpedMass, ChangesTheImpactOfAFlexibleBarAlikeInBothModels) {
  Rig rig = paper_rig();
  rig.contact.damping = "exact";
  rig.contact.restitution = 0.5;
  Solver many = hybrid(Basis::pinned_free, 40, 1e-7, 3e-4);
  const double bare = simulate(rig, many).peak_force;
  rig.beam.masses = {{0.69, 0.2}, {0.3, 0.1}};
  const double limit = simulate(rig, many).peak_force;
  EXPECT_GT(std::abs(limit / bare - 1.0), 0.1);
  const double coarse = simulate(rig, ancf(14, 2, 1e-7, 3e-4)).peak_force;
  const double fine = simulate(rig, ancf(28, 4, 1e-7, 3e-4)).peak_force;
  EXPECT_NEAR(fine / limit, 1.0, 4e-3);
  EXPECT_LT(std::abs(fine / limit - 1.0), std::abs(coarse / limit - 1.0) + 1e-3);
}

TEST(LumpedMass, IsInTheEnergyAndInSmallMotion) {
  Rig rig = paper_rig();
  rig.gravity = 9.81;
  rig.contact.damping = "lankarani-nikravesh";
  rig.contact.restitution = 0.5;
  rig.beam.masses = {{0.8, 0.3}, {0.37, 0.2}};
  SimulationOptions full, small;
  full.motion = Motion::full;
  small.motion = Motion::small;
  for (Solver solver : {ancf(10, 2, 1e-10, 2e-3), hybrid(Basis::cantilever, 8, 1e-10, 2e-3)}) {
    const Simulation a = simulate(rig, solver, full);
    const Simulation b = simulate(rig, solver, small);
    EXPECT_LT(std::abs(a.energy.imbalance), 1e-9);
    EXPECT_LT(std::abs(b.energy.imbalance), 1e-9);
    EXPECT_LT(b.neglected, 1e-4);
    EXPECT_NEAR(b.peak_force / a.peak_force, 1.0, b.neglected);
    EXPECT_NEAR(b.episodes.at(0).end / a.episodes.at(0).end, 1.0, b.neglected);
    EXPECT_NEAR(b.episodes.at(0).impulse / a.episodes.at(0).impulse, 1.0, b.neglected);
  }
}

TEST(LumpedMass, PullsSmallMotionBackByItsWeight) {
  // The hanging string: EI so small that only tension acts. Massless but for what hangs at the end
  // it swings as √(g / L) and its tension is the same everywhere, so it vibrates as a string of
  // tension m g between hinge and mass: k π / L √(m g / ρA).
  Rig rig = paper_rig();
  rig.gravity = 9.81;
  rig.beam.youngs_modulus = 1e-2;
  rig.beam.density = 1.0;
  rig.beam.masses = {{0.8, 50.0}};
  rig.contact.position = 0.4;
  const AncfBeam chain(rig, {20, 20});
  const FloatingFrameBeam modes(rig, Basis::pinned_free, 30, 0);
  const double unit = std::numbers::pi / 0.8 * std::sqrt(50.0 * 9.81 / rig.beam.area);
  for (const ModalBeam& beam : {ModalBeam(chain, rig), ModalBeam(modes, rig)}) {
    EXPECT_NEAR(beam.omega()[0] / std::sqrt(9.81 / 0.8), 1.0, 1e-4);
    for (int k = 1; k <= 2; ++k) EXPECT_NEAR(beam.omega()[k] / (k * unit), 1.0, 2e-3) << k;
  }
}

TEST(LumpedMass, TakesItsPartOfTheRotationOutOfTheCompliance) {
  // the static sum over all modes of a fine mesh but the rigid rotation
  Rig rig = paper_rig();
  rig.beam.masses = {{0.8, 0.9}, {0.33, 0.4}};
  for (double position : {0.2, 0.5, 0.8}) {
    rig.contact.position = position;
    const AncfBeam mesh(rig, {position < 0.8 ? 20 : 40, position < 0.8 ? 20 : 0});
    const ModalBeam beam(mesh, rig);
    const Eigen::Index bending = beam.modes() - 1;
    const double sum =
        beam.struck().tail(bending).cwiseQuotient(beam.omega().tail(bending)).squaredNorm();
    EXPECT_NEAR(elastic_compliance(rig.beam, position) / sum, 1.0, 1e-6) << position;
  }
}

TEST(LumpedMass, IsInTheInertiaOfEveryCoordinate) {
  Rig rig = paper_rig();
  rig.beam.masses = {{0.8, 0.9}, {0.33, 0.4}};
  AncfBeam chain(rig, {3, 2});
  FloatingFrameBeam frame(rig, Basis::cantilever, 3, 2);
  for (BeamDynamics* beam :
       {static_cast<BeamDynamics*>(&chain), static_cast<BeamDynamics*>(&frame)}) {
    const int n = beam->size();
    const Vector diagonal = beam->inertia_diagonal();
    for (int i = 0; i < n; ++i)
      EXPECT_NEAR(2.0 * beam->energy(Vector::Zero(n), Vector::Unit(n, i)).kinetic / diagonal[i],
                  1.0, 1e-11);
  }
}

TEST(LumpedMass, ShortensWithTheBarItIsOn) {
  // ½ m u̇², u̇ = ∫ w' ẇ' dx: of a rigid rotation by a small angle at a rate, θ θ̇ x
  Rig bare = paper_rig(), laden = paper_rig();
  laden.beam.masses = {{0.8, 0.3}, {0.37, 0.2}, {0.01, 5.0}};
  const auto energy = [](const Rig& rig) {
    const FloatingFrameBeam bar(rig, Basis::cantilever, 0, 0);
    const ModalBeam beam(bar, rig);
    BarStations::Slopes slopes;
    beam.stations().find_slopes(0.02 * beam.rigid(), 3.0 * beam.rigid(), slopes);
    Vector momentum;
    return beam.stations().shorten(slopes, momentum);
  };
  EXPECT_NEAR(energy(laden) - energy(bare),
              0.5 * 0.06 * 0.06 * (0.3 * 0.64 + 0.2 * 0.37 * 0.37 + 5.0 * 1e-4), 1e-15);
}

}  // namespace
