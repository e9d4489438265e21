// SPDX-License-Identifier: BSD-3-Clause
//
// What the force passes on from one sample of a history to the next where contacts begin and end.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "models/simulation.hpp"
#include "tests/models/scenes.hpp"

namespace {

using namespace impactrig::models;
using namespace impactrig::tests;

Rig damped_rig(const std::string& damping) {
  Rig rig = paper_rig();
  rig.gravity = 0.0;
  rig.contact.law = "hertz-point";
  rig.contact.damping = damping;
  rig.contact.restitution = 0.5;
  return rig;
}

Simulation sampled(const Rig& rig, const Solver& solver, double interval) {
  SimulationOptions options;
  options.history.interval = interval;
  return simulate(rig, solver, options);
}

/// By a rigid bar's speed.
void expect_momentum(const Rig& rig, const Simulation& run) {
  const History& history = run.history;
  ASSERT_GE(history.impulses.size(), 1u);
  EXPECT_EQ(history.impulses.front().time, 0.0);
  for (const SampleImpulse& passed : history.impulses) {
    const double after =
        passed.time - history.start - history.interval * static_cast<double>(passed.sample - 1);
    EXPECT_GE(after, -1e-6 * history.interval);
    EXPECT_LT(after, history.interval);
    const double change = history.velocity[passed.sample - 1] - history.velocity[passed.sample];
    EXPECT_NEAR(passed.impulse, rig.effective_mass(0) * change, 1e-8 * run.impulse);
  }
}

// The force begins as the fourth root of time (tsuji), the square root (kuwabara-kono), or
// straight, and ends at an angle where it is clipped.
TEST(SampleImpulses, AreWhatARigidBarsSpeedChangesBy) {
  for (const std::string damping : {"tsuji", "kuwabara-kono", "hunt-crossley"}) {
    SCOPED_TRACE(damping);
    const Rig rig = damped_rig(damping);
    for (const double interval : {4e-6, 1e-6, 0.25e-6})
      expect_momentum(rig, sampled(rig, rigid(1e-9), interval));
  }
}

TEST(SampleImpulses, KnowJumpsOfTheForce) {
  Rig rig = damped_rig("viscous");
  rig.contact.law = "linear";
  rig.contact.stiffness = 1e7;
  rig.contact.viscous = 400.0;
  const Simulation run = sampled(rig, rigid(1e-9), 4e-6);
  ASSERT_EQ(run.history.jumps.size(), 1u);
  expect_momentum(rig, run);
}

Rig often_struck_rig() {
  Rig rig = paper_rig();
  rig.contact.damping = "tsuji";
  rig.contact.restitution = 0.5;
  rig.contact.position = 0.6;
  return rig;
}

// Whoever integrates: a history a hundred times as fine shows it, but for what lines between its
// samples miss, half of a step of the force over its interval at most.
TEST(SampleImpulses, AreThoseOfEachContact) {
  const Rig rig = often_struck_rig();
  for (const Solver& solver : {hybrid(Basis::cantilever, 12, 1e-8, 3e-3), ancf(14, 2, 1e-8, 3e-3)})
    for (const Motion motion : {Motion::small, Motion::full}) {
      SimulationOptions options;
      options.motion = motion;
      options.history.interval = 1e-6;
      const Simulation run = simulate(rig, solver, options);
      options.history.interval = 1e-8;
      const History fine = simulate(rig, solver, options).history;
      ASSERT_GT(run.episodes.size(), 1u);
      EXPECT_GE(run.history.impulses.size(), 2 * run.episodes.size() - 1);
      for (const SampleImpulse& passed : run.history.impulses) {
        double impulse = 0.0, largest = 0.0;
        for (std::size_t i = 100 * (passed.sample - 1) + 1; i <= 100 * passed.sample; ++i) {
          impulse += 0.5 * fine.interval * (fine.force[i - 1] + fine.force[i]);
          largest = std::max(largest, fine.force[i]);
        }
        EXPECT_NEAR(passed.impulse, impulse, 0.5 * fine.interval * largest + 1e-12);
      }
    }
}

// Central differences of whole runs; touches move with the parameter between samples.
TEST(SampleImpulses, HaveDerivatives) {
  const Rig rig = often_struck_rig();
  for (const Motion motion : {Motion::small, Motion::full}) {
    SimulationOptions options;
    options.motion = motion;
    options.history.interval = 1e-6;
    const Solver solver = ancf(14, 2, 1e-9, 2e-3);
    const double step = 1e-5;
    const auto at = [&](double change) {
      Rig moved = rig;
      moved.contact.restitution = 0.5 + change;
      return simulate(moved, solver, options).history.impulses;
    };
    const auto above = at(step), below = at(-step);
    options.sensitivities = {[](Rig& r) -> double& { return r.contact.restitution; }};
    const Simulation run = simulate(rig, solver, options);
    const auto& slopes = run.sensitivities.at(0).history.impulses;
    ASSERT_EQ(slopes.size(), run.history.impulses.size());
    ASSERT_EQ(above.size(), slopes.size());
    ASSERT_EQ(below.size(), slopes.size());
    for (std::size_t k = 0; k < slopes.size(); ++k) {
      const double difference = (above[k].impulse - below[k].impulse) / (2.0 * step);
      EXPECT_EQ(slopes[k].sample, run.history.impulses[k].sample);
      EXPECT_NEAR(slopes[k].impulse, difference, 1e-5 * std::abs(difference) + 1e-7 * run.impulse)
          << k;
    }
  }
}

// Goldsmith's law is so steep at touch that tsuji's damping begins with a jump, and rounding of the
// depth there would have a slope of 1e74. By differences of whole runs.
TEST(ForceJumps, AtLaterTouchesHaveTheDerivativesOfTheirSpeed) {
  SimulationOptions options;
  options.history.interval = 1e-6;
  options.motion = Motion::small;
  options.sensitivities = {[](Rig& r) -> double& { return r.start.velocity; }};
  const Solver solver = hybrid(Basis::cantilever, 12, 1e-9, 2e-3);
  for (int k = 0; k < 8; ++k) {
    Rig rig = often_struck_rig();
    rig.start.velocity += 1e-3 * k;
    const auto at = [&](double change) {
      Rig moved = rig;
      moved.start.velocity += change;
      return simulate(moved, solver, options).history.jumps;
    };
    const double step = 1e-5;
    const auto above = at(step), below = at(-step);
    const auto slopes = simulate(rig, solver, options).sensitivities.at(0).history.jumps;
    ASSERT_GT(slopes.size(), 1U);
    ASSERT_EQ(above.size(), slopes.size());
    ASSERT_EQ(below.size(), slopes.size());
    for (std::size_t j = 0; j < slopes.size(); ++j) {
      const double difference = (above[j].after - below[j].after) / (2.0 * step);
      EXPECT_NEAR(slopes[j].after, difference, 1e-3 * std::abs(difference) + 1e-3) << k << ' ' << j;
    }
  }
}

TEST(SampleImpulses, AreNoneOfASensorThatGivesWay) {
  Rig rig = damped_rig("tsuji");
  rig.stop = Stop{.mass = 0.2, .stiffness = 1e9, .viscous = 5e3};
  EXPECT_TRUE(sampled(rig, rigid(1e-9), 1e-6).history.impulses.empty());
}

}  // namespace
