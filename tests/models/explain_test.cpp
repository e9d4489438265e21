// SPDX-License-Identifier: BSD-3-Clause
// What each simplification changes, where it is taken and where it must not be.
#include <gmock/gmock.h>

#include <cmath>

#include "models/explain.hpp"
#include "tests/models/scenes.hpp"

namespace {

using namespace impactrig::models;
using namespace impactrig::tests;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr double no_limit = 60.0;

Rig released() {
  Rig rig = paper_rig();
  rig.gravity = 9.81;
  rig.start.velocity = 0.0;
  rig.start.release_angle = 0.1;
  return rig;
}

TEST(Explain, ComparesWithTheRunWithoutEach) {
  const Rig rig = released();
  const Solver solver = ancf(4, 1, 1e-3, 0.2);
  const Simulation run = simulate(rig, solver);
  ASSERT_THAT(run.taken, ElementsAre(Simplification::small_motion, Simplification::flight_at_once,
                                     Simplification::swing_to_touch));
  const std::vector<Explanation> explanations = explain(rig, solver, {}, no_limit);
  ASSERT_EQ(explanations.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(explanations[i].what, run.taken[i]);
    EXPECT_EQ(explanations[i].sentence, run.skipped[i]);
    EXPECT_THAT(explanations[i].failure, IsEmpty());
    EXPECT_GT(explanations[i].seconds, 0.0);
    EXPECT_GT(explanations[i].seconds_without, 0.0);
  }
  SimulationOptions full;
  full.motion = Motion::full;
  const double peak = simulate(rig, solver, full).episodes.at(0).peak_force;
  EXPECT_DOUBLE_EQ(explanations[0].peak_force, run.episodes.at(0).peak_force / peak - 1.0);
  EXPECT_NE(explanations[0].peak_force, 0.0);
  // a flight comes after the first contact
  EXPECT_EQ(explanations[1].peak_force, 0.0);
  EXPECT_EQ(explanations[1].impulse, 0.0);
}

// Of the full equations derivatives take a hundred times as long as the run.
TEST(Explain, AsksForNoDerivatives) {
  static int asked = 0;
  SimulationOptions options;
  options.sensitivities = {[](Rig& rig) -> double& {
    ++asked;
    return rig.contact.restitution;
  }};
  EXPECT_EQ(explain(released(), ancf(4, 1, 1e-3, 0.2), options, no_limit).size(), 3U);
  EXPECT_EQ(asked, 0);
}

TEST(Explain, HasNothingToSayOfAnExactRun) {
  SimulationOptions exact;
  exact.exact = true;
  EXPECT_THAT(explain(released(), rigid(1e-6), exact, no_limit), IsEmpty());
}

TEST(Explain, SaysWhyARunWithoutGivesNoAnswer) {
  const std::vector<Explanation> explanations =
      explain(released(), ancf(30, 4, 1e-4, 3e-3), {}, 1e-9);
  ASSERT_FALSE(explanations.empty());
  EXPECT_THAT(explanations.front().failure, testing::HasSubstr("solver.time_limit"));
}

TEST(Explain, KnowsNoContactOfASwing) {
  Rig rig = released();
  rig.contact.law = "none";
  rig.contact.position = rig.beam.length;
  const std::vector<Explanation> explanations = explain(rig, ancf(4, 0, 1e-3, 0.1), {}, no_limit);
  ASSERT_EQ(explanations.size(), 1U);
  EXPECT_TRUE(std::isnan(explanations[0].peak_force));
}

// Each is left out when it is not to be taken, and only that.
TEST(Simulate, TakesNoSimplificationThatIsToBeKept) {
  const Rig rig = released();
  const Solver solver = rigid(1e-6);
  SimulationOptions options;
  options.kept = {Simplification::swing_to_touch};
  for (const Simplification taken : simulate(rig, solver, options).taken)
    EXPECT_NE(taken, Simplification::swing_to_touch);
  options.kept = {Simplification::small_motion};
  EXPECT_THAT(simulate(rig, solver, options).taken, ElementsAre(Simplification::swing_to_touch));
}

}  // namespace
