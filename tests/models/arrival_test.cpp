// SPDX-License-Identifier: BSD-3-Clause
#include "models/modal/arrival.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "models/ensemble.hpp"
#include "models/modal/bar_cache.hpp"
#include "models/rigid_swing.hpp"
#include "models/simulation.hpp"
#include "tests/models/differences.hpp"
#include "tests/models/scenes.hpp"

namespace impactrig::models {
namespace {

using testing::Contains;
using testing::Not;
using tests::ancf;
using tests::hybrid;
using tests::paper_rig;

constexpr double degree = std::numbers::pi / 180.0;

Rig released(double angle) {
  Rig rig = paper_rig();
  rig.gravity = 9.81;
  rig.contact.damping = "lankarani-nikravesh";
  rig.contact.restitution = 0.5;
  rig.start = {};
  rig.start.release_angle = angle;
  return rig;
}

/// Largest relative difference of the first contacts' peak force, duration and impulse.
double difference(const Simulation& one, const Simulation& other) {
  const Episode& a = one.episodes.at(0);
  const Episode& b = other.episodes.at(0);
  return std::max({std::abs(a.peak_force / b.peak_force - 1.0),
                   std::abs((a.end - a.start) / (b.end - b.start) - 1.0),
                   std::abs(a.impulse / b.impulse - 1.0)});
}

/// The full equations from the release on.
Simulation followed(const Rig& rig, Solver solver) {
  solver.accuracy = 1e-8;
  SimulationOptions exact;
  exact.exact = true;
  return simulate(rig, solver, exact);
}

/// Expects small motion to know the vibration with which the bar arrives, which matters.
void expect_arrival(const Rig& rig, const Solver& solver, double matters = 3.0) {
  const Simulation reference = followed(rig, solver);
  const Simulation run = simulate(rig, solver);
  EXPECT_TRUE(run.small_motion);
  EXPECT_THAT(run.taken, Contains(Simplification::swing_to_touch));
  EXPECT_LT(difference(run, reference), solver.accuracy);
  Rig smooth = rig;
  smooth.start = {};
  smooth.start.velocity = touch_velocity(rig);
  EXPECT_GT(difference(simulate(smooth, solver), reference), matters * solver.accuracy);
}

// The period of a pendulum by its complete elliptic integral.
TEST(RigidSwing, ArrivesAfterAQuarterOfItsPeriod) {
  for (const double angle : {1e-3, 0.3, 2.0, 3.1}) {
    const Rig rig = released(angle);
    const double omega =
        std::sqrt(rig.gravity * rig.beam.first_moment() / rig.beam.hinge_inertia());
    const auto arrival = RigidSwing(rig).arrive(angle);
    ASSERT_TRUE(arrival);
    EXPECT_NEAR(arrival->time * omega / std::comp_ellint_1(std::sin(0.5 * angle)), 1.0, 1e-11);
    EXPECT_NEAR(arrival->rate / (2.0 * omega * std::sin(0.5 * angle)), 1.0, 1e-13);
  }
  EXPECT_FALSE(RigidSwing(released(0.1)).arrive(-0.1));
}

TEST(Arrival, TouchesWhereTheStruckPointDoes) {
  for (const double direction : {0.0, 10.0, 40.0}) {
    Rig rig = released(0.4);
    rig.gravity_direction = direction * degree;
    const auto bar = BarCache().bar(rig, ancf(10, 2, 1e-4, 1e-3));
    const ModalBeam& beam = bar->modes();
    const Arrival arrival = arrive(rig, beam);
    const double place = rig.contact.position * arrival.angle;
    const double bent = beam.struck().dot(arrival.bending.a);
    EXPECT_NEAR(place + bent, 0.0, 1e-15);
    EXPECT_GT(std::abs(bent), 1e-8);
    EXPECT_GT(arrival.vibration, 1e-4);
    EXPECT_LT(arrival.error, 0.1 * arrival.vibration);
  }
}

TEST(Arrival, IsThatOfTheFullEquations) {
  const Solver chain = ancf(7, 1, 1e-4, 1e-3), frame = hybrid(Basis::cantilever, 6, 1e-4, 1e-3);
  for (const double angle : {0.02, 0.3, 1.0}) {
    SCOPED_TRACE(angle);
    expect_arrival(released(angle), chain);
    expect_arrival(released(angle), frame);
  }
}

TEST(Arrival, IsThatOfTheFullEquationsForOtherBarsToo) {
  const Solver chain = ancf(7, 1, 1e-4, 1e-3);
  Rig rig = released(0.3);
  rig.gravity_direction = 15.0 * degree;
  expect_arrival(rig, chain);
  rig.gravity_direction = 60.0 * degree;
  expect_arrival(rig, chain);
  rig = released(0.3);
  rig.beam.damping = {.mass = 2.0, .stiffness = 2e-7};
  expect_arrival(rig, chain, 1.0);
  rig.beam.damping = {};
  rig.hinge.viscous = 0.001;
  expect_arrival(rig, ancf(7, 1, 2e-4, 1e-3), 1.0);
  rig = released(0.3);
  rig.beam.masses = {{.position = 0.8, .mass = 0.4}};
  expect_arrival(rig, chain);
  rig = tests::stepped_rig();
  rig.start = {};
  rig.start.release_angle = 0.3;
  expect_arrival(rig, hybrid(Basis::pinned_free, 6, 1e-4, 1e-3));
  rig.stop = Stop{.mass = 0.02, .stiffness = 5e8, .viscous = 50.0};
  expect_arrival(rig, hybrid(Basis::pinned_free, 6, 1e-4, 1e-3), 0.0);
}

// E = 50 MPa: most of what arrives is vibration.
TEST(Arrival, OfALimpBarIsFollowed) {
  Rig rig = released(0.5);
  rig.beam.youngs_modulus = 5e7;
  const Solver chain = ancf(7, 1, 1e-4, 2e-3);
  const Simulation run = simulate(rig, chain);
  EXPECT_FALSE(run.small_motion);
  EXPECT_THAT(run.taken, Not(Contains(Simplification::swing_to_touch)));
  EXPECT_LT(difference(run, followed(rig, chain)), chain.accuracy);
}

// Where vibration has died away the full equations need no swing.
TEST(Arrival, WithoutVibrationIsThatOfARigidBar) {
  Rig rig = released(0.3);
  rig.beam.damping = {.stiffness = 1e-4};
  const Solver chain = ancf(7, 1, 1e-4, 1e-3);
  SimulationOptions full;
  full.motion = Motion::full;
  const Simulation run = simulate(rig, chain, full);
  EXPECT_THAT(run.taken, Contains(Simplification::swing_to_touch));
  EXPECT_LT(difference(run, followed(rig, chain)), chain.accuracy);
  rig.beam.damping = {};
  EXPECT_THAT(simulate(rig, chain, full).taken, Not(Contains(Simplification::swing_to_touch)));
}

// Its moment keeps the bar bent until it touches, however long ago vibration has died away: of the
// swing that was left out for that, the force was off by up to 77 %. The peak is that of an
// independent program, in absolute nodal coordinates from release on.
TEST(Arrival, OfABarHeldBackByItsHingeIsFollowed) {
  Rig rig = released(0.1);
  const Solver chain = ancf(3, 1, 1e-4, 1e-3);
  for (const double viscous : {0.5, 1.0, 2.0}) {
    rig.hinge.viscous = viscous;
    EXPECT_LT(difference(simulate(rig, chain), followed(rig, chain)), chain.accuracy) << viscous;
  }
  EXPECT_NEAR(simulate(rig, ancf(3, 1, 1e-6, 1e-3)).peak_force / 142.485976937, 1.0, 1e-6);
  rig.hinge.viscous = 1e-3;
  EXPECT_THAT(simulate(rig, chain).taken, Contains(Simplification::swing_to_touch));
}

/// A bar of nylon before a linear stop.
Rig limp_and_released(double angle) {
  Rig rig = released(angle);
  rig.beam.youngs_modulus = 3e9;
  rig.beam.density = 1400.0;
  rig.contact.law = "linear";
  rig.contact.stiffness = 1e5;
  rig.contact.damping = "exact";
  rig.contact.restitution = 0.6;
  return rig;
}

// Friction bends the bar all the way, and lets it arrive with less than a rigid one: the impulse
// was off by 2.9 % at 0.03 N m, 29 times the accuracy, where damping leaves no vibration to follow.
TEST(Arrival, OfABarBentByFrictionIsFollowed) {
  for (const double friction : {0.01, 0.02, 0.03}) {
    Rig rig = limp_and_released(0.02);
    rig.beam.damping.stiffness = 500e-6;
    rig.hinge.friction = friction;
    const Solver solver = ancf(3, 1, 1e-3, 0.05);
    EXPECT_LT(difference(simulate(rig, solver), followed(rig, solver)), 1e-3) << friction;
  }
}

// A pendulum damped to near its critical damping arrives the later and the slower the more a bent
// bar's frequency is below a rigid one's: 60 times what was told of the speed.
TEST(Arrival, OfABarThatDampingHardlyLetsArriveIsFollowed) {
  for (const double mass_damping : {4.0, 7.0, 8.2}) {
    Rig rig = limp_and_released(0.3);
    rig.beam.damping = {.mass = mass_damping, .stiffness = 20e-6};
    const Solver solver = ancf(3, 1, 1e-4, 0.05);
    EXPECT_LT(difference(simulate(rig, solver), followed(rig, solver)), 1e-4) << mass_damping;
  }
}

TEST(Arrival, ThatHardlyComesAboutIsTold) {
  Rig rig = released(0.1);
  const auto creeps = Contains(testing::HasSubstr("lets the bar creep to its stop"));
  rig.hinge.viscous = 2.785;
  EXPECT_THAT(simulate(rig, ancf(3, 1, 1e-3, 1e-3)).warnings, creeps);
  rig.hinge.viscous = 2.5;
  EXPECT_THAT(simulate(rig, ancf(3, 1, 1e-3, 1e-3)).warnings, Not(creeps));
}

TEST(Arrival, IsThatOfSingleRunsInAnEnsemble) {
  std::vector<Rig> rigs;
  for (int k = 0; k < 40; ++k) {
    rigs.push_back(released(0.1 + 0.02 * k));
    rigs.back().beam.youngs_modulus *= 1.0 + 0.003 * k;
    rigs.back().beam.density *= 1.0 - 0.002 * k;
  }
  const Solver solver = hybrid(Basis::pinned_free, 8, 1e-4, 1e-3);
  const std::vector<EnsembleMember> members = simulate_ensemble(rigs, solver);
  for (std::size_t k = 0; k < rigs.size(); ++k) {
    const Simulation single = simulate(rigs[k], solver);
    EXPECT_TRUE(single.small_motion);
    EXPECT_LT(difference(members[k].simulation, single), 1e-9) << k;
    EXPECT_EQ(members[k].simulation.taken, single.taken);
    EXPECT_NEAR(members[k].simulation.neglected / single.neglected, 1.0, 1e-6);
  }
}

constexpr tests::Named of_releases[] = {
    {"release angle", [](Rig& r) -> double& { return *r.start.release_angle; }},
    {"gravity", [](Rig& r) -> double& { return r.gravity; }},
    {"youngs_modulus", [](Rig& r) -> double& { return r.beam.youngs_modulus; }},
    {"density", [](Rig& r) -> double& { return r.beam.density; }},
    {"restitution", [](Rig& r) -> double& { return r.contact.restitution; }},
    {"stiffness_factor", [](Rig& r) -> double& { return r.contact.stiffness_factor; }},
    {"position", [](Rig& r) -> double& { return r.contact.position; }},
};

// Vibrations in the swing are few, so that differences see slopes of their phases; where the struck
// point moves, those of the fast modes of one short element.
// A bar swings slower than a rigid one however little it swings; near the node of its vibration
// that is most of what is left out.
TEST(Arrival, TellsOfHowMuchSlowerABentBarSwings) {
  Rig rig = released(0.008);
  rig.beam.length = 0.601;
  rig.beam.youngs_modulus = 3e9;
  rig.beam.density = 1180.0;
  const double outer = 4.62e-3, inner = 2.87e-3;  // a tube
  rig.beam.area = std::numbers::pi * (outer * outer - inner * inner);
  rig.beam.second_moment = 0.25 * std::numbers::pi * (std::pow(outer, 4) - std::pow(inner, 4));
  rig.contact.position = 0.4489;
  rig.contact.radius = outer;
  rig.contact.counter_radius = 4.836e-3;
  rig.contact.length = 0.0127;
  rig.contact.modulus = 3e9;
  rig.contact.law = "hertz-point";
  const Solver frame = hybrid(Basis::pinned_free, 4, 1e-9, 1e-3);
  SimulationOptions small;
  small.motion = Motion::small;
  const Simulation run = simulate(rig, frame, small);
  const double error = difference(run, followed(rig, frame));
  EXPECT_GT(error, 3e-5);
  EXPECT_LT(error, run.neglected);
  EXPECT_LT(run.neglected, 10.0 * error);
}

TEST(Sensitivities, OfABarThatWasLetGoAreThoseOfDifferences) {
  for (const double direction : {0.0, 0.1}) {
    Rig rig = released(0.2);
    rig.gravity_direction = direction;
    rig.beam.youngs_modulus = 7e8;
    rig.contact.stiffness_factor = 0.1;
    const std::span<const tests::Named> all(of_releases);
    const Solver frame = hybrid(Basis::pinned_free, 4, 1e-12, 1e-3),
                 chain = ancf(4, 1, 1e-12, 1e-3);
    tests::expect_equal_derivatives(rig, frame, 3e-8, all, 1e-4);
    tests::expect_equal_derivatives(rig, chain, 3e-7, all.first(all.size() - 1), 1e-4);
    tests::expect_equal_derivatives(rig, chain, 3e-7, all.last(1), 3e-5);
  }
}

}  // namespace
}  // namespace impactrig::models
