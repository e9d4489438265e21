// SPDX-License-Identifier: BSD-3-Clause
// Gravity in any direction: closed forms of the pendulum that hangs, lies or stands.
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <string>

#include "models/beams/ancf.hpp"
#include "models/beams/floating_frame.hpp"
#include "models/integration/dop853.hpp"
#include "models/mesh_error.hpp"
#include "models/rigid_swing.hpp"
#include "models/simulation.hpp"
#include "tests/models/scenes.hpp"

namespace {

using namespace impactrig::models;
using namespace impactrig::tests;
using Vector = Eigen::VectorXd;

constexpr double degree = std::numbers::pi / 180.0;

Rig leaning(double direction) {
  Rig rig = paper_rig();
  rig.gravity = 9.81;
  rig.gravity_direction = direction;
  return rig;
}

/// m g L / 2 over m L² / 3 [1/s²].
const double unit = 1.5 * 9.81 / 0.8;

TEST(GravityDirection, PartsOfItAreExactWhereTheyVanish) {
  EXPECT_EQ(leaning(0.0).gravity_across(), 0.0);
  EXPECT_EQ(leaning(180.0 * degree).gravity_across(), 0.0);
  EXPECT_EQ(leaning(-180.0 * degree).gravity_across(), 0.0);
  EXPECT_DOUBLE_EQ(leaning(180.0 * degree).gravity_along(), -9.81);
  EXPECT_DOUBLE_EQ(leaning(30.0 * degree).gravity_across(), 9.81 * 0.5);
}

TEST(GravityDirection, TurnsTheDropOfAReleaseIntoSpeed) {
  // from the height of the bar's middle before and at touch: −(L/2) cos of its angle to gravity
  for (double direction : {-20.0, 0.0, 35.0, 90.0, 140.0}) {
    Rig rig = leaning(direction * degree);
    rig.start.release_angle = 0.7;
    rig.start.velocity = 0.0;
    const double drop = std::cos(direction * degree) - std::cos(direction * degree + 0.7);
    if (drop <= 0.0 || direction * degree + 0.7 > std::numbers::pi) {
      EXPECT_EQ(direction, 140.0);  // released beyond the top
      EXPECT_THROW(touch_velocity(rig), std::invalid_argument);
      continue;
    }
    const double speed = 0.69 * std::sqrt(2.0 * unit * drop);
    EXPECT_NEAR(touch_velocity(rig) / speed, 1.0, 1e-15 / drop);
    SimulationOptions exact;
    exact.exact = true;
    const Simulation swung = simulate(rig, rigid(1e-10), exact);
    EXPECT_NEAR(swung.episodes.at(0).approach_velocity / speed, 1.0, 1e-9) << direction;
  }
}

TEST(GravityDirection, SaysWhenAFlexibleBarTurnsBackBeforeTheStop) {
  // as far on the other side of its rest as the stop is on this: the rigid bar just arrives, the
  // middle of the soft one hangs back
  Rig rig = leaning(-0.35);
  rig.contact.position = 0.4;
  rig.beam.youngs_modulus = 1e8;
  rig.start.release_angle = 0.7 + 1e-6;
  SimulationOptions exact;
  exact.exact = true;
  EXPECT_NO_THROW(simulate(rig, rigid(1e-6), exact));
  EXPECT_THAT(
      [&] { simulate(rig, hybrid(Basis::pinned_free, 1, 1e-6, 1e-3), exact); },
      testing::ThrowsMessage<std::runtime_error>(testing::MatchesRegex(
          "the bar turned back [0-9.e-]+ rad before it touched the stop: released, it bends, "
          "and what that takes is missing; release it from further away")));
}

/// Angle of the tip of a bar after a time, from rest at a small angle.
double tip_angle(BeamDynamics& beam, double angle, double time) {
  const int n = beam.size();
  const Dop853::RightHandSide f = [&](double, const Vector& y, Eigen::Ref<Vector> slope) {
    slope.head(n) = y.tail(n);
    beam.acceleration(y.head(n), y.tail(n), 0.0, slope.tail(n));
  };
  Vector y(2 * n);
  beam.set_rigid_motion(angle, 0.0, y.head(n), y.tail(n));
  Dop853 stepper(2 * n);
  stepper.start(0.0, y, f);
  const int steps = 4000;
  for (int i = 0; i < steps; ++i) {
    stepper.attempt(time / steps, Vector::Ones(2 * n), f);
    stepper.accept();
  }
  return beam.point(0.8, stepper.state().head(n), stepper.state().tail(n)).displacement / 0.8;
}

TEST(GravityDirection, AnUprightBarFallsAsTheHyperbolicCosine) {
  // φ = φ₀ cosh Ω t, Ω² = (m g L/2 − k) / I; a spring stiffer than the weight lets it swing instead
  const double angle = 1e-6;
  Rig rig = leaning(180.0 * degree);
  FloatingFrameBeam bare(rig, Basis::cantilever, 0, 0);
  EXPECT_NEAR(tip_angle(bare, angle, 0.8) / (angle * std::cosh(std::sqrt(unit) * 0.8)), 1.0, 1e-9);
  const double inertia = rig.beam.hinge_inertia();
  for (double part : {0.5, 1.5}) {
    rig.hinge.spring = part * unit * inertia;
    FloatingFrameBeam sprung(rig, Basis::cantilever, 0, 0);
    const double expected = part < 1.0 ? std::cosh(std::sqrt((1.0 - part) * unit) * 0.8)
                                       : std::cos(std::sqrt((part - 1.0) * unit) * 0.8);
    EXPECT_NEAR(tip_angle(sprung, angle, 0.8) / (angle * expected), 1.0, 1e-9);
  }
  // The flexible bar does the same but for its bending: that of the weight is (m g L² / EI) / 48 of
  // the angle, 1e-4 here. Coarse and soft, so that explicit steps carry it over the time.
  rig = leaning(180.0 * degree);
  rig.contact.position = 0.4;
  rig.beam.youngs_modulus = 1e9;
  AncfBeam chain(rig, {1, 1});
  EXPECT_NEAR(tip_angle(chain, angle, 0.05) / (angle * std::cosh(std::sqrt(unit) * 0.05)), 1.0,
              1e-3);
}

TEST(GravityDirection, ABarPulledIntoTheStopBouncesLikeABall) {
  // between two contacts it flies 2 v / a, a = g sin γ L_p m (L/2) / I at the struck point
  Rig rig = leaning(90.0 * degree);
  rig.start.velocity = 0.1;
  rig.contact.damping = "exact";
  rig.contact.restitution = 0.6;
  const Simulation run = simulate(rig, rigid(1e-10));
  const double pull = 0.69 * unit;
  ASSERT_GE(run.episodes.size(), 4u);
  for (std::size_t i = 1; i < 4; ++i) {
    const Episode& before = run.episodes[i - 1];
    // the moment of the weight changes with the square of the angle, 1e-6 here
    EXPECT_NEAR((run.episodes[i].start - before.end) / (2.0 * before.separation_velocity / pull),
                1.0, 1e-5);
    EXPECT_NEAR(run.episodes[i].approach_velocity / before.separation_velocity, 1.0, 1e-5);
  }
  EXPECT_LT(std::abs(run.energy.imbalance), 1e-8);
  EXPECT_EQ(run.termination, "0.1 s after first touch the bar was still within reach of the stop");
  rig.gravity_direction = -90.0 * degree;
  EXPECT_EQ(simulate(rig, rigid(1e-10)).episodes.size(), 1u);  // it pulls the bar away
  rig.gravity_direction = 0.0;
  EXPECT_EQ(simulate(rig, rigid(1e-10)).termination, "the bar has left the stop for good");
}

TEST(GravityDirection, ABarThatFallsOverHasLeftForGood) {
  // the top is 10 degrees away: ½ I φ̇² against m g (L/2) (1 − cos 10°)
  Rig rig = leaning(170.0 * degree);
  const double escape = 0.69 * std::sqrt(2.0 * unit * (1.0 - std::cos(10.0 * degree)));
  rig.start.velocity = 1.02 * escape;
  EXPECT_EQ(simulate(rig, rigid(1e-10)).termination, "the bar has left the stop for good");
  rig.start.velocity = 0.98 * escape;
  EXPECT_NE(simulate(rig, rigid(1e-10)).termination, "the bar has left the stop for good");
  // and one that stands upright falls away
  rig = leaning(180.0 * degree);
  EXPECT_EQ(simulate(rig, rigid(1e-10)).termination, "the bar has left the stop for good");
}

TEST(GravityDirection, ABarAtRestOnTheStopPressesWithItsWeight) {
  // strongly damped it settles: F L_p = m g (L/2) sin γ
  Rig rig = leaning(60.0 * degree);
  rig.start.velocity = 0.01;
  rig.contact.law = "linear";
  rig.contact.stiffness = 2e4;
  rig.contact.damping = "none";
  rig.hinge.viscous = 60.0;
  Solver solver = rigid(1e-8);
  solver.duration = 0.5;
  SimulationOptions options;
  options.history.interval = 1e-3;
  const Simulation run = simulate(rig, solver, options);
  const double weight = rig.beam.bar_mass() * 9.81 * 0.4 * std::sin(60.0 * degree) / 0.69;
  EXPECT_NEAR(run.history.force.back() / weight, 1.0, 1e-3);
  EXPECT_TRUE(run.episodes.back().open);
  EXPECT_LT(std::abs(run.energy.imbalance), 1e-6);
}

TEST(GravityDirection, TellsWhereThePushIsNotTheTouch) {
  // laid on a spring its weight presses it: f = W (1 - cos wt), of which work over impulse is
  // (2 / pi) W / sqrt(k m)
  Rig rig = leaning(90.0 * degree);
  rig.start.velocity = 1e-3;
  rig.contact.law = "linear";
  rig.contact.stiffness = 2e4;
  rig.contact.damping = "exact";
  rig.contact.restitution = 0.9999;
  Solver solver = rigid(1e-8);
  solver.duration = 0.02;
  const auto told = [&] {
    for (const std::string& warning : simulate(rig, solver).warnings)
      if (warning.find("its damping divides by the former") != warning.npos) return warning;
    return std::string();
  };
  const double mass = rig.beam.hinge_inertia() / (0.69 * 0.69);
  const double pushed = 2.0 / std::numbers::pi * 0.69 * unit * std::sqrt(mass / 2e4);
  const std::string begin = "the first contact begins at 0.001 m/s and is then closed at ";
  const std::string warning = told();
  ASSERT_THAT(warning, testing::StartsWith(begin));
  EXPECT_NEAR(std::stod(warning.substr(begin.size())) / pushed, 1.0, 0.03);
  rig.contact.restitution_speed = 0.05;
  EXPECT_EQ(told(), "");
  rig.contact.restitution_speed.reset();
  // overdamped, the weight sinks it slowly to where the spring holds it: W² / 2k stored, and as much
  // taken by the damping
  rig.contact.restitution = 0.5;
  rig.start.velocity = 1e-5;
  solver.accuracy = 1e-5;
  solver.duration = 200.0;
  const std::string begins =
      "the first contact begins at 1e-05 m/s and then takes as much energy as one at ";
  const std::string overdamped = told();
  ASSERT_THAT(overdamped, testing::StartsWith(begins));
  const double weight = 0.69 * unit * mass;
  EXPECT_NEAR(std::stod(overdamped.substr(begins.size())) / (weight / std::sqrt(2e4 * mass)),
              std::numbers::sqrt2, 0.03);
  rig.start.velocity = 0.05;
  EXPECT_EQ(told(), "");
}

TEST(GravityDirection, PressesASlowTouchInSmallMotion) {
  // what is left out is a part of what the weight sets free, not of the energy at touch
  Rig rig = leaning(90.0 * degree);
  rig.start.velocity = 1e-7;
  rig.contact.restitution_speed = 1e-3;
  const Solver solver = hybrid(Basis::pinned_free, 6, 1e-5, 3e-3);
  const Simulation small = simulate(rig, solver);
  ASSERT_TRUE(small.small_motion);
  EXPECT_LT(small.neglected, 1e-5);
  SimulationOptions exact;
  exact.exact = true;
  const Simulation full = simulate(rig, solver, exact);
  EXPECT_GT(full.energy.kinetic + full.energy.elastic, 1e6 * full.energy.initial);
  EXPECT_NEAR(small.peak_force / full.peak_force, 1.0, 1e-5 + small.neglected);
  EXPECT_NEAR(small.impulse / full.impulse, 1.0, 1e-5 + small.neglected);
}

TEST(GravityDirection, LeadsToTouchUnderItsPull) {
  for (double direction : {90.0, -60.0, 180.0}) {
    for (double viscous : {0.0, 2.0}) {
      Rig rig = leaning(direction * degree);
      rig.hinge.viscous = viscous;
      const RigidSwing swing(rig);
      const double h = 1e-4;
      for (double t : {-2e-3, 1e-3}) {
        const auto low = swing.near_touch(t - h, 1e-3), high = swing.near_touch(t + h, 1e-3);
        const auto s = swing.near_touch(t, 1e-3);
        EXPECT_NEAR((high.angle - low.angle) / (2.0 * h), s.rate, 1e-6);
        // angles of 4e-5, whose squares the linear swing leaves out
        EXPECT_NEAR((high.rate - low.rate) / (2.0 * h), swing.acceleration(s.angle, s.rate), 1e-5);
      }
    }
  }
  // a constant pull, no more: v t + a t² / 2
  const auto s = RigidSwing(leaning(90.0 * degree)).near_touch(-0.01, 0.5);
  EXPECT_NEAR(s.angle, -0.005 + 0.5 * unit * 1e-4, 1e-12);
  EXPECT_NEAR(s.rate, 0.5 - 0.01 * unit, 1e-12);
}

TEST(GravityDirection, ChangesTheImpactAlikeInBothModels) {
  // a slow touch of a soft bar, whose weight bends it on the stop
  Rig rig = leaning(90.0 * degree);
  rig.beam.youngs_modulus = 1e9;
  rig.contact.modulus = 1e9;
  rig.start.velocity = 0.05;
  const Solver many = hybrid(Basis::pinned_free, 40, 1e-8, 0.02);
  const Simulation limit = simulate(rig, many);
  const Simulation chain = simulate(rig, ancf(28, 8, 1e-8, 0.02));
  EXPECT_EQ(chain.episodes.size(), limit.episodes.size());
  EXPECT_NEAR(chain.impulse / limit.impulse, 1.0, 1e-3);
  EXPECT_NEAR(chain.energy.gravitational / limit.energy.gravitational, 1.0, 1e-4);
  rig.gravity_direction = 0.0;
  EXPECT_GT(limit.impulse / simulate(rig, many).impulse, 1.1);
}

TEST(GravityDirection, ClosesTheEnergyBalanceWithEverythingElse) {
  Rig rig = leaning(75.0 * degree);
  rig.beam.masses = {{0.8, 0.2}, {0.33, 0.1}};
  rig.beam.damping = {.mass = 20.0, .stiffness = 1e-6};
  rig.hinge = {.spring = 2e3, .viscous = 0.8};
  rig.contact.damping = "lankarani-nikravesh";
  rig.contact.restitution = 0.5;
  Solver stiff = rigid(1e-11);
  stiff.duration = 2e-3;
  for (const Solver& solver :
       {stiff, hybrid(Basis::pinned_free, 6, 1e-11, 2e-3),
        hybrid(Basis::cantilever, 6, 1e-11, 2e-3), ancf(6, 2, 1e-11, 2e-3)}) {
    const Simulation run = simulate(rig, solver);
    EXPECT_LT(std::abs(run.energy.imbalance), 1e-9) << name(solver.model);
    EXPECT_GT(run.energy.damped, 1e-3 * run.energy.initial);
  }
}

/// What small motion may leave out is told, and so small here that it agrees to the accuracy.
void expect_agreement_of_small_motion(const Rig& rig, const Solver& solver) {
  SimulationOptions small, full;
  small.motion = Motion::small;
  full.motion = Motion::full;
  small.history.interval = full.history.interval = *solver.duration / 50.0;
  small.history.displacement_position = full.history.displacement_position = 0.5;
  const Simulation in_modes = simulate(rig, solver, small), all = simulate(rig, solver, full);
  ASSERT_TRUE(in_modes.small_motion);
  ASSERT_LT(in_modes.neglected, 3e-7);
  ASSERT_EQ(in_modes.episodes.size(), all.episodes.size());
  const Episode &one = in_modes.episodes.front(), &other = all.episodes.front();
  EXPECT_NEAR(one.peak_force / other.peak_force, 1.0, 3e-7);
  EXPECT_NEAR((one.end - one.start) / (other.end - other.start), 1.0, 3e-7);
  EXPECT_NEAR(one.impulse / other.impulse, 1.0, 3e-7);
  EXPECT_LT(std::abs(in_modes.energy.imbalance), 1e-8);
  EXPECT_NEAR(in_modes.energy.gravitational / all.energy.gravitational, 1.0, 1e-6);
  for (std::size_t k = 0; k < all.history.force.size(); ++k) {
    EXPECT_NEAR(in_modes.history.force[k], all.history.force[k], 1e-5 * all.peak_force) << k;
    EXPECT_NEAR(in_modes.history.velocity[k], all.history.velocity[k], 1e-5 * rig.start.velocity);
    EXPECT_NEAR(in_modes.history.displacement[k], all.history.displacement[k],
                1e-5 * rig.start.velocity * *solver.duration);
  }
}

TEST(GravityDirection, MovesABarInItsModesAsByTheFullEquations) {
  // slow and stiff, so that what small motion leaves out is next to nothing; the weight moves the
  // struck point by a tenth of the blow's way
  Rig rig = leaning(0.0);
  rig.start.velocity = 2e-3;
  Solver stiff = rigid(1e-10);
  stiff.duration = 4e-3;
  const Solver chain = ancf(4, 2, 1e-10, 4e-3), frame = hybrid(Basis::cantilever, 4, 1e-10, 4e-3);
  for (const double direction : {90.0, 40.0, -75.0}) {
    SCOPED_TRACE(direction);
    rig.gravity_direction = direction * degree;
    for (const Solver& solver : {stiff, chain, frame})
      expect_agreement_of_small_motion(rig, solver);
  }
  rig.beam.masses = {{0.8, 0.2}, {0.33, 0.1}};
  rig.beam.damping = {.mass = 5.0};
  rig.hinge.spring = 30.0;
  expect_agreement_of_small_motion(rig, frame);
  rig.beam.damping = {};
  rig.contact.damping = "lankarani-nikravesh";
  rig.contact.restitution = 0.6;
  rig.gravity_direction = 80.0 * degree;
  rig.stop = Stop{.mass = 0.1, .stiffness = 1e8, .viscous = 100.0};
  rig.further_stops = {{.contact = rig.contact, .side = StopSide::far, .gap = 1e-6}};
  expect_agreement_of_small_motion(rig, stiff);
  expect_agreement_of_small_motion(rig, frame);
}

TEST(GravityDirection, BendsALimpBarAsFarInFewModesAsInAll) {
  // the weight of a bar that is held bends it; what fast modes have of that the others stand for
  Rig rig = leaning(90.0 * degree);
  rig.start.velocity = 0.01;
  rig.beam.youngs_modulus = 2e10;
  const Solver fine = ancf(120, 20, 1e-5, 1e-3);
  SimulationOptions all;
  all.kept = {Simplification::fast_vibration};
  const Simulation few = simulate(rig, fine), many = simulate(rig, fine, all);
  ASSERT_TRUE(few.small_motion && many.small_motion);
  ASSERT_GT(few.taken.size(), many.taken.size());
  const Episode &one = few.episodes.front(), &other = many.episodes.front();
  EXPECT_NEAR(one.peak_force / other.peak_force, 1.0, 1e-5);
  EXPECT_NEAR((one.end - one.start) / (other.end - other.start), 1.0, 1e-5);
  EXPECT_NEAR(one.impulse / other.impulse, 1.0, 1e-5);
}

TEST(GravityDirection, IsKnownToSmallMotionUpToARightAngle) {
  SimulationOptions small;
  small.motion = Motion::small;
  const auto refusal = [&](const Rig& rig, const Solver& solver) -> std::string {
    try {
      simulate(rig, solver, small);
    } catch (const std::invalid_argument& refused) {
      return refused.what();
    }
    return {};
  };
  const Solver chain = ancf(4, 2, 1e-3, 2e-4);
  Rig rig = leaning(0.1);
  EXPECT_TRUE(simulate(rig, chain).small_motion);
  for (const double lying : {90.0, -90.0}) {
    rig.gravity_direction = lying * degree;
    EXPECT_TRUE(simulate(rig, chain).small_motion);
  }
  // the slope of the pendulum's square, where that is zero
  SimulationOptions by_direction;
  by_direction.sensitivities = {[](Rig& r) -> double& { return r.gravity_direction; }};
  for (const double direction : {-90.0, 60.0, 90.0}) {
    rig.gravity_direction = direction * degree;
    EXPECT_EQ(simulate(rig, chain, by_direction).small_motion, direction == 60.0);
  }
  EXPECT_TRUE(mesh_error(rig, ancf(6, 2, 1e-3, 2e-4), 10.0).has_value());
  rig.gravity_direction = 91.0 * degree;
  EXPECT_FALSE(simulate(rig, chain).small_motion);
  EXPECT_EQ(refusal(rig, chain),
            "small motion was asked for, but it does not know environment.gravity_direction beyond "
            "90 degrees; ask for the full equations");
  EXPECT_TRUE(mesh_error(rig, ancf(6, 2, 1e-3, 2e-4), 10.0).has_value());
  rig.gravity = 0.0;
  EXPECT_TRUE(simulate(rig, chain).small_motion);
  // a swing about where the bar does not hang is small only where its angle is
  rig = leaning(0.1);
  rig.start = {.release_angle = 0.3};
  SimulationOptions swung;
  swung.kept = {Simplification::swing_to_touch};
  EXPECT_FALSE(simulate(rig, chain, swung).small_motion);
  rig.start.release_angle = 1e-3;
  EXPECT_TRUE(simulate(rig, chain, swung).small_motion);
  rig.contact.law = "none";
  EXPECT_EQ(
      refusal(rig, hybrid(Basis::pinned_free, 3, 1e-3, 0.1)),
      "small motion was asked for, but it does not know environment.gravity_direction without "
      "a stop; ask for the full equations");
}

}  // namespace
