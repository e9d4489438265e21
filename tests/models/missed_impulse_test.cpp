// SPDX-License-Identifier: BSD-3-Clause
//
// What a history's samples, joined by lines, leave out of the impulse where contacts begin and end.
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

/// The sample after a time.
std::size_t sample_after(const History& history, double time) {
  return static_cast<std::size_t>(std::floor((time - history.start) / history.interval + 1e-6)) + 1;
}

/// Of lines from the sample before to this one, jumps in between taken as they are [N s].
double impulse_of_lines(const History& history, std::size_t sample) {
  const double end = history.start + history.interval * static_cast<double>(sample);
  double impulse = 0.0, begin = end - history.interval, force = history.force[sample - 1];
  for (const ForceJump& jump : history.jumps) {
    if (jump.time < begin - 1e-6 * history.interval || jump.time >= end) continue;
    impulse += 0.5 * (force + jump.before) * (jump.time - begin);
    begin = jump.time;
    force = jump.after;
  }
  return impulse + 0.5 * (force + history.force[sample]) * (end - begin);
}

/// By a rigid bar's speed.
void expect_momentum(const Rig& rig, const Simulation& run) {
  const History& history = run.history;
  ASSERT_GE(history.missed.size(), 1u);
  EXPECT_EQ(history.missed.front().time, 0.0);
  for (const ForceSpike& missed : history.missed) {
    const std::size_t k = sample_after(history, missed.time);
    const double passed = rig.effective_mass(0) * (history.velocity[k - 1] - history.velocity[k]);
    EXPECT_NEAR(missed.impulse, passed - impulse_of_lines(history, k), 1e-8 * run.impulse);
  }
}

// The force begins as the fourth root of time (tsuji), the square root (kuwabara-kono), or
// straight, and ends at an angle where it is clipped.
TEST(MissedImpulse, IsWhatARigidBarsSpeedShowsBesides) {
  for (const std::string damping : {"tsuji", "kuwabara-kono", "hunt-crossley"}) {
    SCOPED_TRACE(damping);
    const Rig rig = damped_rig(damping);
    for (const double interval : {4e-6, 1e-6, 0.25e-6})
      expect_momentum(rig, sampled(rig, rigid(1e-9), interval));
  }
}

TEST(MissedImpulse, IsLargeWhereTheForceBeginsAtOnce) {
  const Rig rig = damped_rig("tsuji");
  const Simulation run = sampled(rig, rigid(1e-9), 1e-6);
  EXPECT_GT(run.history.missed.front().impulse, 3e-4 * run.impulse);
}

TEST(MissedImpulse, KnowsTheJumpsOfAForce) {
  Rig rig = damped_rig("viscous");
  rig.contact.law = "linear";
  rig.contact.stiffness = 1e7;
  rig.contact.viscous = 400.0;
  const Simulation run = sampled(rig, rigid(1e-9), 4e-6);
  ASSERT_EQ(run.history.jumps.size(), 1u);
  expect_momentum(rig, run);
}

// Whoever integrates: a history a hundred times as fine shows it, but for what it misses itself,
// half of a step of the force over its interval at most.
TEST(MissedImpulse, IsThatOfEachContact) {
  Rig rig = paper_rig();
  rig.contact.damping = "tsuji";
  rig.contact.restitution = 0.5;
  rig.contact.position = 0.6;
  for (const Solver& solver : {hybrid(Basis::cantilever, 12, 1e-8, 3e-3), ancf(14, 2, 1e-8, 3e-3)})
    for (const Motion motion : {Motion::small, Motion::full}) {
      SimulationOptions options;
      options.motion = motion;
      options.history.interval = 1e-6;
      const Simulation run = simulate(rig, solver, options);
      options.history.interval = 1e-8;
      const History fine = simulate(rig, solver, options).history;
      ASSERT_GT(run.episodes.size(), 1u);
      EXPECT_GE(run.history.missed.size(), 2 * run.episodes.size() - 1);
      for (const ForceSpike& missed : run.history.missed) {
        const std::size_t k = sample_after(run.history, missed.time);
        double passed = 0.0, largest = 0.0;
        for (std::size_t i = 100 * (k - 1) + 1; i <= 100 * k; ++i) {
          passed += 0.5 * fine.interval * (fine.force[i - 1] + fine.force[i]);
          largest = std::max(largest, fine.force[i]);
        }
        EXPECT_NEAR(missed.impulse, passed - impulse_of_lines(run.history, k),
                    0.5 * fine.interval * largest);
      }
    }
}

TEST(MissedImpulse, IsNoneOfASensorThatGivesWay) {
  Rig rig = damped_rig("tsuji");
  rig.stop = Stop{.mass = 0.2, .stiffness = 1e9, .viscous = 5e3};
  EXPECT_TRUE(sampled(rig, rigid(1e-9), 1e-6).history.missed.empty());
}

}  // namespace
