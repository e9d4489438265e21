// SPDX-License-Identifier: BSD-3-Clause
// What small motion says it leaves out, against the full equations.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "models/modal/bar_cache.hpp"
#include "models/modal/small_motion_run.hpp"
#include "models/simulation.hpp"
#include "tests/models/scenes.hpp"

namespace {

using namespace impactrig::models;
using namespace impactrig::tests;

/// Relative changes of the first contact's peak, duration and impulse.
struct Changes {
  double peak = 0.0, duration = 0.0, impulse = 0.0;

  double largest() const {
    return std::max({std::abs(peak), std::abs(duration), std::abs(impulse)});
  }
};

Simulation solve(const Rig& rig, const Solver& solver, Motion motion) {
  SimulationOptions options;
  options.motion = motion;
  return simulate(rig, solver, options);
}

Changes from_small_to_full(const Rig& rig, const Solver& solver) {
  const Episode small = solve(rig, solver, Motion::small).episodes.at(0);
  const Episode full = solve(rig, solver, Motion::full).episodes.at(0);
  return {full.peak_force / small.peak_force - 1.0,
          (full.end - full.start) / (small.end - small.start) - 1.0,
          full.impulse / small.impulse - 1.0};
}

Changes foretold(const Rig& rig, const Solver& solver) {
  SimulationOptions options;
  options.motion = Motion::small;
  SmallMotionRun run(rig, solver, options, make_modal_bar(rig, solver));
  run.run().complete();
  const Episode first = run.conclude().episodes.at(0);
  const ThirdOrder& terms = run.motion().third_order();
  return {terms.of_peak(),
          terms.displacement() / (first.separation_velocity * (first.end - first.start)),
          terms.of_impulse()};
}

/// Within this part of the largest of the three.
void expect_foretold(const Rig& rig, const Solver& solver, double part) {
  const Changes truth = from_small_to_full(rig, solver), told = foretold(rig, solver);
  const double tolerance = part * truth.largest();
  EXPECT_NEAR(told.peak, truth.peak, tolerance);
  EXPECT_NEAR(told.duration, truth.duration, tolerance);
  EXPECT_NEAR(told.impulse, truth.impulse, tolerance);
}

TEST(ThirdOrder, OfARigidBar) {
  Rig rig = paper_rig();
  rig.gravity = 9.81;
  for (const char* damping : {"none", "lankarani-nikravesh"})
    for (const double speed : {1.0, 10.0}) {
      SCOPED_TRACE(testing::Message() << damping << ' ' << speed);
      rig.contact.damping = damping;
      rig.start.velocity = speed;
      expect_foretold(rig, rigid(1e-12), 0.05);
    }
}

TEST(ThirdOrder, OfABarInAFloatingFrame) {
  for (const Basis basis : {Basis::cantilever, Basis::pinned_free})
    for (const double speed : {0.441, 4.0}) {
      SCOPED_TRACE(testing::Message() << static_cast<int>(basis) << ' ' << speed);
      Rig rig = paper_rig();
      rig.gravity = 9.81;
      rig.start.velocity = speed;
      expect_foretold(rig, hybrid(basis, 8, 1e-10, 2e-3), 0.1);
    }
}

// Where the modes are few, much of it is what turns the frame.
TEST(ThirdOrder, OfABarWhoseFrameTurnsAgainstIt) {
  Rig rig = paper_rig();
  rig.contact.position = rig.beam.length;
  rig.contact.law = "linear";
  rig.contact.stiffness = 3e5;
  expect_foretold(rig, hybrid(Basis::cantilever, 3, 1e-10, 2e-2), 0.2);
}

TEST(ThirdOrder, OfABarThatStretches) {
  for (const double speed : {0.441, 4.0}) {
    SCOPED_TRACE(speed);
    Rig rig = paper_rig();
    rig.gravity = 9.81;
    rig.start.velocity = speed;
    expect_foretold(rig, ancf(14, 2, 1e-10, 2e-3), 0.3);
  }
}

TEST(ThirdOrder, OfABarWithAHeavyTip) {
  Rig rig = paper_rig();
  rig.gravity = 9.81;
  rig.start.velocity = 2.0;
  rig.beam.masses = {{.position = rig.beam.length, .mass = 0.5 * rig.beam.total_mass()}};
  expect_foretold(rig, ancf(10, 4, 1e-10, 4e-3), 0.3);
}

TEST(ThirdOrder, OfADampedContact) {
  Rig rig = paper_rig();
  rig.contact.law = "linear";
  rig.contact.stiffness = 2e7;
  rig.contact.damping = "viscous";
  rig.contact.restitution = 0.5;
  expect_foretold(rig, hybrid(Basis::pinned_free, 2, 1e-10, 5e-3), 0.1);
}

// What bending stretches creeps, along the bar and where an element cannot take it back.
TEST(ThirdOrder, OfABarWhoseStretchIsDamped) {
  Rig rig = paper_rig();
  rig.beam.youngs_modulus = 1.2e10;
  rig.beam.density = 600.0;
  rig.beam.damping.stiffness = 4e-5;
  rig.contact.restitution = 0.8;
  rig.start.velocity = 10.0;
  expect_foretold(rig, ancf(4, 1, 1e-10, 5e-3), 0.3);
}

// It is a part of the impulse, but moves a slow end far more.
TEST(ThirdOrder, OfFrictionInTheHinge) {
  Rig rig = paper_rig();
  rig.contact.damping = "exact";
  rig.contact.restitution = 0.2;
  rig.start.velocity = 0.02;
  rig.hinge.friction = 0.01;
  expect_foretold(rig, rigid(1e-10), 0.1);
  expect_foretold(rig, hybrid(Basis::pinned_free, 3, 1e-10, 5e-3), 0.1);
  expect_foretold(rig, ancf(4, 1, 1e-10, 2e-3), 0.1);
}

// Most of what is missing is that the weight pulls at a longer bar.
TEST(ThirdOrder, OfABarThatItsWeightStretches) {
  Rig rig = paper_rig();
  rig.beam.youngs_modulus = 5e8;
  rig.gravity = 2000.0;
  rig.start.velocity = 1e-4;
  rig.contact.law = "linear";
  rig.contact.stiffness = 1e4;
  expect_foretold(rig, ancf(14, 2, 1e-10, 0.1), 0.3);
}

// Struck near the hinge its tip is fast; it is stretched by the turning, and remains so in a
// contact that is over before a wave has been at the tip.
TEST(ThirdOrder, OfABarThatTurningStretches) {
  Rig rig = paper_rig();
  const double radius = 3e-3;
  rig.beam = {.length = 0.16,
              .area = std::numbers::pi * radius * radius,
              .second_moment = std::numbers::pi * std::pow(radius, 4) / 4.0,
              .youngs_modulus = 3.5e9,
              .density = 5100.0};
  rig.contact.position = 0.015;
  rig.contact.law = "linear";
  rig.contact.stiffness = 1e7;
  rig.start.velocity = 0.06;
  expect_foretold(rig, ancf(1, 3, 1e-10, 2e-3), 0.3);
}

// The frame's coordinates lack the fourth power of the angle that the bar bends by.
TEST(ThirdOrder, OfABarThatItsWeightHoldsInAFrame) {
  Rig rig = paper_rig();
  rig.beam.youngs_modulus = 2e7;
  rig.gravity = 50.0;
  rig.start.velocity = 0.01;
  rig.contact.position = 0.3;
  rig.contact.law = "linear";
  rig.contact.stiffness = 300.0;
  expect_foretold(rig, hybrid(Basis::cantilever, 5, 1e-10, 1.0), 0.2);
}

TEST(ThirdOrder, OfMoreAxialModesThanStations) {
  Rig rig = paper_rig();
  rig.gravity = 9.81;
  Solver solver = hybrid(Basis::pinned_free, 8, 1e-9, 2e-3);
  solver.axial_modes = 60;
  expect_foretold(rig, solver, 0.3);
}

// The damping would pull before the bar has left: for most of the contact's time no force holds it,
// and what is missing of its speed then makes the most of what is missing of the way.
TEST(ThirdOrder, OfABarThatItsContactNoLongerPushes) {
  Rig rig = paper_rig();
  rig.contact.law = "linear";
  rig.contact.stiffness = 2e7;
  rig.contact.damping = "viscous";
  rig.contact.restitution = 0.05;
  const Solver solver = hybrid(Basis::pinned_free, 3, 1e-10, 3e-2);
  expect_foretold(rig, solver, 0.15);
}

// Sections that end where a bar shears make its axis kink: integrals of slopes end there.
TEST(ThirdOrder, OfASteppedBarThatShearsUnderItsWeight) {
  Rig rig = paper_rig();
  rig.gravity = 3000.0;
  rig.beam.theory = BeamTheory::timoshenko;
  const auto segment = [&](double part, double scale) {
    return BeamSegment{.length = part * rig.beam.length,
                       .area = rig.beam.area * scale,
                       .second_moment = rig.beam.second_moment * scale * scale,
                       .shear_coefficient = 0.89};
  };
  rig.beam.segments = {segment(0.37, 1.0), segment(0.37, 1.6), segment(0.26, 0.8)};
  rig.start.velocity = 0.02;
  expect_foretold(rig, hybrid(Basis::pinned_free, 5, 1e-10, 3e-3), 0.3);
}

// It leaves the stop at an eighth of its approach: the contact's duration changes by twice the
// strain that its weight makes.
TEST(SmallMotion, TellsWhatAShearingBarsStretchChangesOfASlowEnd) {
  Rig rig = paper_rig();
  const double width = 0.0118157, height = 0.00694836;
  rig.beam = {.length = 6.900979,
              .area = width * height,
              .second_moment = width * std::pow(height, 3) / 12.0,
              .youngs_modulus = 1.565096e8,
              .density = 2951.954,
              .theory = BeamTheory::timoshenko,
              .poisson_ratio = 0.128321,
              .shear_coefficient = 0.842};
  rig.contact.position = 1.576517;
  rig.contact.radius = 0.5 * height;
  rig.contact.counter_radius = 0.003476815;
  rig.contact.length = 0.01069914;
  rig.contact.modulus = rig.beam.youngs_modulus;
  rig.contact.poisson_ratio = rig.beam.poisson_ratio;
  rig.contact.counter_modulus = 1.299075e10;
  rig.contact.counter_poisson_ratio = 0.054926;
  rig.contact.law = "johnson";
  rig.contact.damping = "zhiying-qishao";
  rig.start.velocity = 0.0011444733;
  rig.gravity = 0.730386;
  Solver solver;
  solver.model = BeamModel::ancf;
  solver.elements = {16, 8};
  solver.accuracy = 1e-7;
  solver.duration = 5e-4;
  const double changed = from_small_to_full(rig, solver).largest();
  EXPECT_GT(changed, 1e-4);
  EXPECT_GT(solve(rig, solver, Motion::small).neglected, changed);
}

}  // namespace
