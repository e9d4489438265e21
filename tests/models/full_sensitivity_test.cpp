// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <array>
#include <numbers>
#include <span>
#include <vector>

#include "models/rigid_swing.hpp"
#include "models/simulation.hpp"
#include "tests/models/differences.hpp"
#include "tests/models/plain_bars.hpp"
#include "tests/models/scenes.hpp"

namespace impactrig::tests {
namespace {

using namespace models;

void expect_equal_full_derivatives(const Rig& rig, const Solver& solver,
                                   std::span<const Named> of = parameters, double spacing = 5e-4,
                                   Side side = Side::both) {
  ASSERT_FALSE(sharp(rig, solver, Motion::full, {of[0].of}).sensitivities.empty());
  expect_equal_derivatives(rig, solver, 1e-8, of, spacing, Motion::full, side);
}

TEST(FullSensitivities, OfARigidBarAreThoseOfDifferences) {
  Solver solver = rigid(1e-12);
  solver.duration = 5e-4;
  expect_equal_full_derivatives(damped_rig(), solver);
}

TEST(FullSensitivities, OfAncfAreThoseOfDifferences) {
  expect_equal_full_derivatives(damped_rig(), ancf(4, 1, 1e-12, 5e-4));
}

TEST(FullSensitivities, OfHybridAreThoseOfDifferences) {
  expect_equal_full_derivatives(damped_rig(), hybrid(Basis::pinned_free, 4, 1e-12, 4.8e-4));
}

TEST(FullSensitivities, OfAShearingBarAreThoseOfDifferences) {
  Rig rig = damped_rig();
  rig.beam.theory = BeamTheory::timoshenko;
  rig.beam.shear_coefficient = 0.9;
  constexpr std::array of = {
      Named{"restitution", [](Rig& r) -> double& { return r.contact.restitution; }},
      Named{"youngs_modulus", [](Rig& r) -> double& { return r.beam.youngs_modulus; }},
      Named{"shear_coefficient", [](Rig& r) -> double& { return r.beam.shear_coefficient; }},
      Named{"density", [](Rig& r) -> double& { return r.beam.density; }},
  };
  expect_equal_full_derivatives(rig, ancf(3, 1, 1e-12, 4e-4), of);
  expect_equal_full_derivatives(rig, hybrid(Basis::pinned_free, 3, 1e-12, 5e-4), of);
}

// Of damping in bar and hinge too, of which the last is zero at first.
TEST(FullSensitivities, OfDampedBarsAreThoseOfDifferences) {
  Rig rig = damped_rig();
  rig.beam.damping = {.mass = 20.0, .stiffness = 2e-7};
  rig.hinge = {.spring = 50.0, .viscous = 5.0};
  expect_equal_full_derivatives(rig, ancf(3, 1, 1e-12, 4.5e-4), of_damped_bars);
  expect_equal_full_derivatives(rig, hybrid(Basis::pinned_free, 4, 1e-12, 4.5e-4), of_damped_bars);
}

TEST(FullSensitivities, OfSectionsAndMassesAreThoseOfDifferences) {
  Rig rig = damped_rig();
  rig.beam.masses = {{0.4, 0.2}};
  expect_equal_full_derivatives(rig, ancf(3, 1, 1e-12, 4e-4), of_sections);
  expect_equal_full_derivatives(rig, hybrid(Basis::pinned_free, 4, 1e-12, 4e-4), of_sections);
}

TEST(FullSensitivities, OfAMassAtAnElementsEndAreThoseOfDifferences) {
  constexpr std::array of_place = {of_sections[3]};
  Rig rig = damped_rig();
  rig.beam.masses = {{0.345, 0.05}};  // in the middle before the struck point
  const Solver solver = ancf(2, 1, 1e-12, 5e-4);
  for (const Side side : {Side::below, Side::above})
    expect_equal_full_derivatives(rig, solver, of_place, 1e-3, side);
  rig.beam.theory = BeamTheory::timoshenko;  // the sections shear by a step at the mass
  rig.beam.shear_coefficient = 0.9;
  expect_equal_full_derivatives(rig, solver, of_place, 5e-4, Side::below);
  rig.beam.masses[0].position = 0.4;
  expect_equal_full_derivatives(rig, hybrid(Basis::pinned_free, 3, 1e-12, 5e-4), of_place, 1e-3,
                                Side::below);
}

TEST(FullSensitivities, OfAMassAtTheTipAreThoseOfDifferences) {
  constexpr std::array of_place = {of_sections[3]}, of_length = {parameters[11]};
  Rig rig = damped_rig();
  rig.beam.masses = {{0.8, 1e-3}};
  for (const Solver& solver :
       {ancf(2, 1, 1e-12, 5e-4), hybrid(Basis::pinned_free, 3, 1e-12, 5e-4)}) {
    expect_equal_full_derivatives(rig, solver, of_place, 2e-4, Side::below);
    expect_equal_full_derivatives(rig, solver, of_length, 5e-4, Side::above);
  }
}

TEST(FullSensitivities, OfSegmentsAreThoseOfDifferences) {
  Rig rig = stepped_rig();
  expect_equal_full_derivatives(rig, ancf(3, 1, 1e-12, 5e-4), of_segments_that_bend);
  expect_equal_full_derivatives(rig, hybrid(Basis::pinned_free, 3, 1e-12, 5e-4),
                                of_segments_that_bend);
  rig.beam.theory = BeamTheory::timoshenko;
  expect_equal_full_derivatives(rig, ancf(3, 1, 1e-12, 4.4e-4), of_segments);
  expect_equal_full_derivatives(rig, hybrid(Basis::pinned_free, 3, 1e-12, 5e-4), of_segments);
}

// Where the bar hangs, too.
TEST(FullSensitivities, OfGravityAreThoseOfDifferences) {
  Rig rig = damped_rig();
  Solver stiff = rigid(1e-12);
  stiff.duration = 5e-4;
  for (const double direction : {0.7, 0.0}) {
    rig.gravity_direction = direction;
    rig.beam.theory = BeamTheory::euler_bernoulli;
    expect_equal_full_derivatives(rig, stiff, of_gravity);
    expect_equal_full_derivatives(rig, ancf(3, 1, 1e-12, 4e-4), of_gravity);
    expect_equal_full_derivatives(rig, hybrid(Basis::pinned_free, 3, 1e-12, 4e-4), of_gravity);
    rig.beam.theory = BeamTheory::timoshenko;
    rig.beam.shear_coefficient = 0.9;
    expect_equal_full_derivatives(rig, ancf(3, 1, 1e-12, 4e-4), of_gravity);
  }
}

// A rubber-like bar that bends by a good part of its length while it is stopped.
TEST(FullSensitivities, OfLargeDeflectionAreThoseOfDifferences) {
  Rig rig = damped_rig();
  rig.beam.youngs_modulus = 2e8;
  rig.start.velocity = 6.0;
  rig.contact.position = 0.5;
  rig.contact.modulus = 1e9;
  const Solver solver = ancf(4, 2, 1e-12, 6e-3);
  SimulationOptions small, full;
  small.motion = Motion::small;
  full.motion = Motion::full;
  const Simulation linear = simulate(rig, solver, small), exact = simulate(rig, solver, full);
  ASSERT_GT(std::abs(linear.impulse / exact.impulse - 1.0), 0.02);
  expect_equal_full_derivatives(rig, solver, without_places, 2e-4);
}

// The last steps before separation are so short that what could be rounding is most of what slopes
// change by in them.
TEST(FullSensitivities, OfALongSoftBarAreThoseOfDifferences) {
  Rig rig = damped_rig();
  rig.beam = round_bar(15.0, 0.24, 1.1e9, 3300.0);
  rig.contact.position = 7.0;
  rig.contact.radius = 0.24;
  rig.contact.counterface = Counterface::plane;
  rig.contact.counter_depth = 0.7;
  rig.contact.length = 2.0;
  rig.contact.modulus = 1.1e9;
  rig.contact.counter_modulus = 6.7e8;
  rig.contact.law = "goldsmith";
  rig.contact.exponent = 3;
  rig.contact.damping = "hu-guo";
  rig.start.velocity = 19.0;
  constexpr std::array of = {
      Named{"restitution", [](Rig& r) -> double& { return r.contact.restitution; }},
      Named{"youngs_modulus", [](Rig& r) -> double& { return r.beam.youngs_modulus; }},
      Named{"density", [](Rig& r) -> double& { return r.beam.density; }},
      Named{"position", [](Rig& r) -> double& { return r.contact.position; }},
  };
  expect_equal_full_derivatives(rig, hybrid(Basis::cantilever, 8, 1e-12, 0.015), of, 2e-4);
}

TEST(FullSensitivities, OfSeveralStopsAreThoseOfDifferences) {
  Rig rig = damped_rig();
  FurtherStop second{.contact = rig.contact, .side = StopSide::near, .gap = 2e-6};
  second.contact.position = 0.5;
  second.contact.restitution = 0.7;
  rig.further_stops = {second};
  const Solver solver = hybrid(Basis::pinned_free, 4, 1e-12, 4e-4);
  ASSERT_GE(sharp(rig, solver, Motion::full).episodes.size(), 2u);
  expect_equal_full_derivatives(rig, solver, of_further_stops);
  expect_equal_full_derivatives(rig, ancf(3, 2, 1e-12, 3e-4), of_further_stops);
}

// A head that rings, one that is damped, one that creeps back; a light stiff one.
TEST(FullSensitivities, OfAStopThatGivesWayAreThoseOfDifferences) {
  Rig rig = damped_rig();
  for (const double viscous : {300.0, 5e3, 4e4}) {
    SCOPED_TRACE(viscous);
    rig.stop = Stop{.mass = 0.2, .stiffness = 1e9, .viscous = viscous};
    const Solver solver = hybrid(Basis::pinned_free, 4, 1e-12, 5e-4);
    ASSERT_TRUE(sharp(rig, solver, Motion::full).sensor);
    expect_equal_full_derivatives(rig, solver, of_compliant_stops);
  }
  expect_equal_full_derivatives(rig, ancf(3, 1, 1e-12, 5e-4), of_compliant_stops);
  rig.stop = Stop{.mass = 2e-3, .stiffness = 2e10, .viscous = 2e3};
  expect_equal_full_derivatives(rig, hybrid(Basis::pinned_free, 1, 1e-12, 1e-3), of_compliant_stops,
                                4e-3);
}

// The run ends, as stated, while the head without contact presses its sensor more and more.
TEST(FullSensitivities, OfASensorThatCarriesMoreAndMoreAreThoseOfDifferences) {
  Rig rig = damped_rig();
  rig.stop = Stop{.mass = 0.5, .stiffness = 1e7, .viscous = 50.0};
  const Solver solver = hybrid(Basis::pinned_free, 2, 1e-12, 3e-4);
  const Simulation run = sharp(rig, solver, Motion::full);
  ASSERT_EQ(run.sensor->peak_time, run.duration);
  ASSERT_LT(run.episodes.front().end, 0.5 * run.duration);
  expect_equal_full_derivatives(rig, solver, of_compliant_stops);
}

// The first of them gives way.
TEST(FullSensitivities, OfStopsOfBothKindsAreThoseOfDifferences) {
  Rig rig = damped_rig();
  FurtherStop second{.contact = rig.contact, .side = StopSide::far, .gap = 1e-5};
  second.contact.position = 0.5;
  second.contact.restitution = 0.7;
  rig.further_stops = {second};
  rig.contact.restitution = 0.8;
  rig.stop = Stop{.mass = 0.2, .stiffness = 1e9, .viscous = 5e3};
  Solver solver = rigid(1e-12);
  solver.duration = 5e-4;
  ASSERT_GE(sharp(rig, solver, Motion::full).episodes.size(), 2u);
  expect_equal_full_derivatives(rig, solver, of_further_stops);
  expect_equal_full_derivatives(rig, solver, of_compliant_stops);
  rig.further_stops.clear();
  rig.start = {.release_angle = 0.2};
  expect_equal_full_derivatives(rig, solver, std::span(of_compliant_stops).first(5));
}

// The swing from release to touch is followed: touch itself moves.
TEST(FullSensitivities, OfAReleasedBarAreThoseOfDifferences) {
  Rig rig = damped_rig();
  rig.start = {.release_angle = 0.2};
  rig.hinge.viscous = 0.05;
  constexpr std::array of = {
      Named{"release angle", [](Rig& r) -> double& { return *r.start.release_angle; }},
      Named{"gravity", [](Rig& r) -> double& { return r.gravity; }},
      Named{"viscous hinge", [](Rig& r) -> double& { return r.hinge.viscous; }},
      Named{"restitution", [](Rig& r) -> double& { return r.contact.restitution; }},
      Named{"density", [](Rig& r) -> double& { return r.beam.density; }},
  };
  Solver solver = rigid(1e-12);
  solver.duration = 5e-4;
  expect_equal_full_derivatives(rig, solver, of);
  rig.beam.youngs_modulus = 1e8;  // and is followed with the vibration that release leaves
  expect_equal_full_derivatives(rig, hybrid(Basis::pinned_free, 1, 1e-12, 5e-3), of);
}

// Of vibration that nothing damps slopes grow with time: errors of its phase move them by far more
// than the bar.
TEST(FullSensitivities, OfABarThatSwingsFarAreAsAccurateAsTheRun) {
  Rig rig = damped_rig();
  rig.beam.youngs_modulus = 1e9;
  rig.start = {.release_angle = 0.5};
  const auto by = [&](double accuracy) {
    SimulationOptions options;
    options.exact = true;
    options.sensitivities = {parameters[9].of, parameters[7].of};
    return simulate(rig, ancf(4, 1, accuracy, 2e-4), options).sensitivities;
  };
  const std::vector<Sensitivity> plain = by(1e-6), exact = by(1e-8);
  for (std::size_t i = 0; i < exact.size(); ++i) {
    EXPECT_NEAR(plain[i].peak_force / exact[i].peak_force, 1.0, 3e-6) << i;
    EXPECT_NEAR(plain[i].impulse / exact[i].impulse, 1.0, 3e-6) << i;
  }
}

// Runs of ordinary accuracy differentiate along a stencil of fewer places.
TEST(FullSensitivities, AreAsAccurateAsTheRun) {
  const std::vector<RigParameter> by = {parameters[0].of, parameters[1].of, parameters[7].of};
  for (const Solver& solver :
       {ancf(4, 1, 1e-6, 5e-4), hybrid(Basis::pinned_free, 4, 1e-6, 4.8e-4)}) {
    SimulationOptions options;
    options.exact = true;
    options.sensitivities = by;
    const Simulation plain = simulate(damped_rig(), solver, options);
    const Simulation exact = sharp(damped_rig(), solver, Motion::full, by);
    for (std::size_t i = 0; i < by.size(); ++i) {
      const Sensitivity& is = plain.sensitivities.at(i);
      const Sensitivity& should = exact.sensitivities.at(i);
      EXPECT_NEAR(is.peak_force / should.peak_force, 1.0, 1e-5) << i;
      EXPECT_NEAR(is.duration / should.duration, 1.0, 1e-5) << i;
      EXPECT_NEAR(is.impulse / should.impulse, 1.0, 1e-5) << i;
    }
  }
}

constexpr std::array of_friction = {
    Named{"friction", [](Rig& r) -> double& { return r.hinge.friction; }},
    Named{"restitution", [](Rig& r) -> double& { return r.contact.restitution; }},
    Named{"gravity", [](Rig& r) -> double& { return r.gravity; }},
    Named{"youngs_modulus", [](Rig& r) -> double& { return r.beam.youngs_modulus; }},
    Named{"density", [](Rig& r) -> double& { return r.beam.density; }},
    Named{"position", [](Rig& r) -> double& { return r.contact.position; }},
};

// The rigid bar's hinge changes its direction in the deepest penetration; released, it breaks loose
// at once.
TEST(FullSensitivities, OfARubbingHingeAreThoseOfDifferences) {
  Rig rig = damped_rig();
  rig.hinge.friction = 2.0;
  rig.contact.stiffness_factor = 0.9;  // the hinge turns between two samples, where no slope jumps
  Solver solver = rigid(1e-12);
  solver.duration = 5e-4;
  expect_equal_full_derivatives(rig, solver, of_friction);
  rig.start = {.release_angle = 0.3};
  rig.hinge.friction = 0.4;
  expect_equal_full_derivatives(rig, solver, of_friction);
}

/// How often a hinge that has turned comes to rest, by the axis close to it.
int rests(const Rig& rig, const Solver& solver) {
  SimulationOptions options;
  options.exact = true;
  options.history = {.interval = 1e-5, .displacement_position = 1e-4 * rig.beam.length};
  const std::vector<double> places = simulate(rig, solver, options).history.displacement;
  int count = 0;
  bool rested = true;
  for (std::size_t i = 1; i < places.size(); ++i) {
    const bool rest = std::abs(places[i] - places[i - 1]) < 1e-5 * std::abs(places[1] - places[0]);
    if (rest && !rested) ++count;
    rested = rest;
  }
  return count;
}

// A soft bar's hinge sticks and breaks loose while the bar vibrates against the stop.
TEST(FullSensitivities, OfAHingeThatSticksAndSlipsAreThoseOfDifferences) {
  Rig rig = damped_rig();
  rig.beam.youngs_modulus = 2e9;
  rig.hinge.friction = 20.0;
  ASSERT_GE(rests(rig, hybrid(Basis::pinned_free, 3, 1e-8, 4e-3)), 1);
  ASSERT_GE(rests(rig, ancf(2, 1, 1e-8, 4e-3)), 1);
  expect_equal_full_derivatives(rig, hybrid(Basis::pinned_free, 3, 1e-12, 4e-3), of_friction, 1e-4);
  expect_equal_full_derivatives(rig, ancf(2, 1, 1e-12, 4e-3), of_friction, 1e-4);
  rig.beam.theory = BeamTheory::timoshenko;
  rig.beam.shear_coefficient = 0.9;
  expect_equal_full_derivatives(rig, ancf(2, 1, 1e-12, 4e-3), of_friction, 1e-4);
}

TEST(FullSensitivities, OfFrictionAreTakenFromTheFullEquations) {
  const std::vector<RigParameter> friction = {of_friction[0].of};
  const Solver solver = hybrid(Basis::pinned_free, 2, 1e-4, 5e-4);
  Rig rig = damped_rig();
  rig.hinge.friction = 1e-3;
  SimulationOptions options;
  EXPECT_TRUE(simulate(rig, solver, options).small_motion);
  options.sensitivities = friction;
  const Simulation run = simulate(rig, solver, options);
  EXPECT_FALSE(run.small_motion);
  EXPECT_EQ(run.sensitivities.size(), 1U);
}

// The frequency of a pendulum that lies has no slope, its square has.
TEST(FullSensitivities, OfWhatWouldHoldALyingPendulumAreTakenFromTheFullEquations) {
  const Solver solver = hybrid(Basis::pinned_free, 2, 1e-4, 5e-4);
  Rig rig = damped_rig();
  rig.gravity_direction = -0.5 * std::numbers::pi;
  for (const Named& by : {of_gravity[0], of_damped_bars[3]}) {
    SCOPED_TRACE(by.name);
    SimulationOptions options;
    EXPECT_TRUE(simulate(rig, solver, options).small_motion);
    options.sensitivities = {by.of};
    const Simulation run = simulate(rig, solver, options);
    EXPECT_FALSE(run.small_motion);
    EXPECT_EQ(run.sensitivities.size(), 1U);
    EXPECT_TRUE(sharp(rig, solver, Motion::small, {by.of}).sensitivities.empty());
  }
}

// Rather nothing than numbers that do not hold: of friction that is none only one side exists.
TEST(FullSensitivities, AreNotOfNoFriction) {
  const std::vector<RigParameter> friction = {of_friction[0].of};
  const Solver solver = hybrid(Basis::pinned_free, 2, 1e-4, 5e-4);
  EXPECT_TRUE(sharp(damped_rig(), solver, Motion::full, friction).sensitivities.empty());
  EXPECT_TRUE(
      sharp(damped_rig(), ancf(2, 1, 1e-4, 5e-4), Motion::full, friction).sensitivities.empty());
  EXPECT_TRUE(sharp(damped_rig(), solver, Motion::small, friction).sensitivities.empty());
}

TEST(FullSensitivities, LeaveTheRunAsItIs) {
  const Rig rig = damped_rig();
  const Solver solver = ancf(4, 1, 1e-12, 5e-4);
  const Simulation plain = sharp(rig, solver, Motion::full);
  const Simulation followed = sharp(rig, solver, Motion::full, {parameters[0].of});
  EXPECT_NEAR(followed.peak_force / plain.peak_force, 1.0, 1e-11);
  EXPECT_NEAR(followed.episodes.front().end / plain.episodes.front().end, 1.0, 1e-11);
}

}  // namespace
}  // namespace impactrig::tests
