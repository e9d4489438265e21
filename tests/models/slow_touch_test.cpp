// SPDX-License-Identifier: BSD-3-Clause
// Bars that touch the stop so slowly that what weight does later is faster by many orders.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "models/rigid_swing.hpp"
#include "models/simulation.hpp"
#include "tests/models/scenes.hpp"

namespace impactrig::tests {
namespace {

using namespace models;
using testing::HasSubstr;

constexpr double right_angle = 0.5 * std::numbers::pi;

/// The paper's bar with e = 0.5 against a spring that it leaves at micrometres a second; its weight
/// pulls it away.
Rig slow_touch() {
  Rig rig = paper_rig();
  rig.contact.law = "linear";
  rig.contact.stiffness = 3e7;
  rig.contact.damping = "exact";
  rig.contact.restitution = 0.5;
  rig.start.velocity = 2e-6;
  rig.gravity = 9.81;
  rig.gravity_direction = -right_angle;
  return rig;
}

Solver rigid_for(double duration, double accuracy) {
  Solver solver = rigid(accuracy);
  solver.duration = duration;
  return solver;
}

/// A stop on the far side, met at 0.6 m/s.
Rig slow_touch_between_stops() {
  Rig rig = slow_touch();
  FurtherStop far{.contact = rig.contact, .side = StopSide::far, .gap = 0.02};
  rig.further_stops.push_back(far);
  return rig;
}

SimulationOptions full_equations() {
  SimulationOptions options;
  options.motion = Motion::full;
  return options;
}

/// Of the bar at an angle, let go at touch.
double speed_at(const Rig& rig, double angle) {
  const double freed = -RigidSwing(rig).potential(angle);
  return rig.contact.position * std::sqrt(2.0 * freed / rig.beam.hinge_inertia());
}

// By the energy of the swing, and by e.
TEST(SlowTouch, TheFastContactAfterItIsAsAccurateAsAFirstOne) {
  const Rig rig = slow_touch_between_stops();
  for (const double accuracy : {1e-4, 1e-7}) {
    const Simulation run = simulate(rig, rigid_for(0.08, accuracy), full_equations());
    const Simulation finer = simulate(rig, rigid_for(0.08, 1e-3 * accuracy), full_equations());
    ASSERT_EQ(run.episodes.size(), 2u);
    ASSERT_EQ(finer.episodes.size(), 2u);
    const Episode& fast = run.episodes[1];
    const double speed = speed_at(rig, -std::asin(0.02 / 0.69)) * std::cos(std::asin(0.02 / 0.69));
    EXPECT_EQ(fast.stop, 1);
    EXPECT_NEAR(fast.approach_velocity / speed, 1.0, accuracy);
    EXPECT_NEAR(fast.separation_velocity / fast.approach_velocity, 0.5, 5e-3);  // and its weight
    EXPECT_NEAR(fast.peak_force / finer.episodes[1].peak_force, 1.0, accuracy);
    EXPECT_NEAR(fast.impulse / finer.episodes[1].impulse, 1.0, accuracy);
  }
}

// Errors that count by the first contact, 10^5 times slower, took 10^5 steps.
TEST(SlowTouch, TheFastContactAfterItTakesNoMoreSteps) {
  const Simulation run =
      simulate(slow_touch_between_stops(), rigid_for(0.08, 1e-7), full_equations());
  EXPECT_LT(run.cost.steps + run.cost.rejected, 500);
  EXPECT_LT(std::abs(run.energy.unbalanced()), 1e-7);
  EXPECT_THAT(run.warnings, testing::Not(testing::Contains(HasSubstr("does not balance"))));
}

// Accuracy is that of the first contact, whatever follows.
TEST(SlowTouch, TheFirstContactDoesNotDependOnWhatFollows) {
  const Simulation alone = simulate(slow_touch_between_stops(), rigid_for(0.03, 1e-7));
  const Simulation run = simulate(slow_touch_between_stops(), rigid_for(0.08, 1e-7));
  ASSERT_EQ(alone.episodes.size(), 1u);
  ASSERT_GE(run.episodes.size(), 2u);
  EXPECT_NEAR(run.episodes[0].peak_force / alone.episodes[0].peak_force, 1.0, 1e-7);
  EXPECT_NEAR(run.episodes[0].impulse / alone.episodes[0].impulse, 1.0, 1e-7);
}

// A plane through the hinge is no stop on the hinge's other side: the bar had been caught there.
TEST(SlowTouch, TheRunEndsWhereTheBarHasTurnedHalfRound) {
  Rig rig = slow_touch();
  rig.gravity_direction = -2.5;  // it stands, and falls over to the other side
  for (const BeamModel model : {BeamModel::rigid, BeamModel::hybrid, BeamModel::ancf}) {
    Solver solver = model == BeamModel::rigid    ? rigid_for(3.0, 1e-5)
                    : model == BeamModel::hybrid ? hybrid(Basis::pinned_free, 1, 1e-4, 3.0)
                                                 : ancf(1, 1, 1e-4, 3.0);
    const Simulation run = simulate(rig, solver);
    EXPECT_EQ(run.episodes.size(), 1u);
    EXPECT_EQ(run.termination, "the bar has turned half round, away from the stop");
    EXPECT_THAT(run.warnings, testing::Contains(HasSubstr("from behind")));
    EXPECT_GT(run.duration, 0.5);
    EXPECT_LT(run.duration, 2.0);
  }
}

// Each half swing is slower by e; below the smallest numbers there are contacts had no end.
TEST(SlowTouch, ARunEndsWhereItsManyContactsHaveBroughtTheBarToRest) {
  Rig rig = paper_rig();
  rig.contact.law = "linear";
  rig.contact.stiffness = 3e7;
  rig.contact.damping = "viscous";
  rig.contact.restitution = 0.05;
  rig.gravity = 9.81;
  const Simulation run = simulate(rig, rigid_for(360.0, 1e-6));
  EXPECT_EQ(run.termination, "the bar has come to rest at the stop");
  ASSERT_GT(run.episodes.size(), 70u);
  EXPECT_LT(run.episodes.back().approach_velocity, 1e-98);
  for (const Episode& episode : run.episodes)
    EXPECT_TRUE(std::isfinite(episode.max_penetration + episode.peak_force + episode.impulse));
}

}  // namespace
}  // namespace impactrig::tests
