// SPDX-License-Identifier: BSD-3-Clause
// Bars that the hinge holds: by a spring that stops them before the contact does, or by friction
// and damping that make them swing like a clamped bar.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "models/simulation.hpp"
#include "tests/models/scenes.hpp"

namespace {

using namespace impactrig::models;
using namespace impactrig::tests;

Simulation solve(const Rig& rig, Solver solver, Motion motion, double accuracy) {
  SimulationOptions options;
  options.motion = motion;
  solver.accuracy = accuracy;
  return simulate(rig, solver, options);
}

double error(const Simulation& run, const Simulation& reference) {
  const Episode& a = run.episodes.at(0);
  const Episode& b = reference.episodes.at(0);
  const auto change = [](double x, double y) { return std::abs(x / y - 1.0); };
  return std::max({change(a.peak_force, b.peak_force), change(a.end - a.start, b.end - b.start),
                   change(a.impulse, b.impulse)});
}

/// A soft contact near a hinge with a stiff spring.
Rig held_bar(double spring, double stiffness) {
  Rig rig = paper_rig();
  rig.contact.position = 0.1;
  rig.contact.law = "linear";
  rig.contact.stiffness = stiffness;
  rig.contact.damping = "exact";
  rig.contact.restitution = 0.6;
  rig.hinge.spring = spring;
  rig.start.velocity = 2.5e-3;
  return rig;
}

// The contact takes 1e-8 to 1e-3 of the energy; its errors count by what it takes.
TEST(HeldBar, KeepsItsAccuracy) {
  for (const double spring : {1e5, 8e5, 1e7})
    for (const double stiffness : {1e3, 8e4})
      for (const Solver& solver :
           {rigid(1e-6), hybrid(Basis::pinned_free, 7, 1e-6, 5e-2), ancf(4, 2, 1e-6, 5e-2)}) {
        SCOPED_TRACE(testing::Message() << spring << ' ' << stiffness << ' ' << name(solver.model));
        const Rig rig = held_bar(spring, stiffness);
        const Simulation reference = solve(rig, solver, Motion::full, 1e-10);
        ASSERT_FALSE(reference.episodes.at(0).open);
        for (const double accuracy : {1e-3, 1e-4, 1e-5, 1e-6}) {
          const Simulation run = solve(rig, solver, Motion::small, accuracy);
          EXPECT_LT(error(run, reference), accuracy + run.neglected) << accuracy;
        }
      }
}

// The spring alone turns a rigid bar back in half its period.
TEST(HeldBar, PartsAfterHalfThePeriodOfItsSpring) {
  const Rig rig = held_bar(1e8, 1e2);
  const double half = std::numbers::pi * std::sqrt(rig.beam.hinge_inertia() / rig.hinge.spring);
  for (const double accuracy : {1e-3, 1e-4, 1e-5, 1e-6}) {
    Solver solver = rigid(accuracy);
    solver.duration = 2e-2;
    const Episode first = simulate(rig, solver).episodes.at(0);
    EXPECT_NEAR(first.end / half, 1.0, accuracy) << accuracy;
  }
}

TEST(HeldBar, HasNotLeftForGoodWhereTheHingeBringsItBack) {
  Rig rig = paper_rig();
  rig.contact.law = "linear";
  rig.contact.stiffness = 1e6;
  Solver open = ancf(7, 1, 1e-5, 0.0);
  open.duration.reset();
  Solver stated = open;
  stated.duration = 0.1;
  for (const bool friction : {true, false}) {
    SCOPED_TRACE(friction);
    rig.hinge = {};
    (friction ? rig.hinge.friction : rig.hinge.viscous) = friction ? 100.0 : 1e4;
    const Simulation run = simulate(rig, open), whole = simulate(rig, stated);
    EXPECT_GE(whole.episodes.size(), 4U);
    EXPECT_EQ(run.episodes.size(), whole.episodes.size());
  }
  rig.hinge = {};
  rig.hinge.friction = 1e-4;  // little of what turns it
  EXPECT_EQ(simulate(rig, open).termination, "the bar has left the stop for good");
}

// Without friction it would get over the hill that gravity from above makes.
TEST(HeldBar, HasNotLeftForGoodWhereFrictionKeepsItFromAHill) {
  Rig rig = paper_rig();
  const double radius = 1e-3;
  rig.beam = {.length = 0.015,
              .area = std::numbers::pi * radius * radius,
              .second_moment = std::numbers::pi * std::pow(radius, 4) / 4.0,
              .youngs_modulus = 7e10,
              .density = 2700.0};
  rig.contact.position = rig.beam.length;
  rig.contact.law = "linear";
  rig.contact.stiffness = 1e4;
  rig.gravity = 9.81;
  rig.gravity_direction = 170.0 * std::numbers::pi / 180.0;
  rig.hinge.friction = 0.81e-6;
  rig.start.velocity = 0.083;
  Solver stated = rigid(1e-6);
  stated.duration = 0.1;
  EXPECT_EQ(simulate(rig, rigid(1e-6)).episodes.size(), simulate(rig, stated).episodes.size());
}

}  // namespace
