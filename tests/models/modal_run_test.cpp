// SPDX-License-Identifier: BSD-3-Clause
// Small motion against the full equations, where it may be used and where it may not.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "models/modal/bar_cache.hpp"
#include "models/modal/small_motion_run.hpp"
#include "models/simulation.hpp"
#include "tests/models/first_contacts.hpp"
#include "tests/models/scenes.hpp"

namespace {

using namespace impactrig::models;
using namespace impactrig::tests;

/// Random bars, stops and impacts of laboratory size.
struct Scene {
  explicit Scene(unsigned seed) : generator(seed) {
    const double length = spread(0.05, 3.0);
    const double radius = length * spread(0.005, 0.05);
    rig.beam = {.length = length,
                .area = std::numbers::pi * radius * radius,
                .second_moment = std::numbers::pi * std::pow(radius, 4) / 4.0,
                .youngs_modulus = spread(2e9, 2.1e11),
                .density = spread(1000.0, 8000.0)};
    rig.contact.position = length * uniform(0.3, 1.0);
    rig.contact.radius = radius;
    rig.contact.counter_radius = radius * (1.0 + spread(1e-2, 1.0));
    rig.contact.counterface = seed % 2 == 0 ? Counterface::groove : Counterface::plane;
    rig.contact.length = radius * spread(0.3, 3.0);
    rig.contact.modulus = rig.beam.youngs_modulus;
    rig.contact.counter_modulus = spread(2e9, 2e11);
    rig.contact.poisson_ratio = rig.contact.counter_poisson_ratio = 0.3;
    rig.contact.exponent = seed % 3 == 0 ? 3 : 1;
    rig.contact.damping = seed % 5 < 2 ? "exact" : "lankarani-nikravesh";
    rig.contact.restitution = uniform(0.1, 1.0);
    rig.start.velocity = spread(0.02, 10.0);
    const double wave_speed = std::sqrt(rig.beam.youngs_modulus / rig.beam.density);
    const double duration = length / wave_speed * spread(1.0, 100.0);
    const int modes = 1 + static_cast<int>(seed % 8);
    solver = seed % 3 == 0   ? rigid(1e-6)
             : seed % 3 == 1 ? hybrid(Basis::pinned_free, modes, 1e-6, duration)
                             : ancf(1 + modes, 1 + modes % 3, 1e-6, duration);
    solver.duration = duration;
  }

  double uniform(double low, double high) {
    return std::uniform_real_distribution<>(low, high)(generator);
  }

  double spread(double low, double high) {
    return std::exp(uniform(std::log(low), std::log(high)));
  }

  std::mt19937_64 generator;
  Rig rig;
  Solver solver;
};

/// The contact ends, and the elastic law holds.
bool complete(const Scene& scene) {
  try {
    return !simulate_as(Motion::small, scene.rig, scene.solver, 1e-6).episodes.front().open;
  } catch (const std::runtime_error&) {
    return false;
  }
}

TEST(SmallMotion, ErrsNoMoreThanItsEstimate) {
  int compared = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    const Scene scene(seed);
    if (!complete(scene)) continue;
    ++compared;
    const Simulation small = simulate_as(Motion::small, scene.rig, scene.solver, 1e-9);
    const Simulation full = simulate_as(Motion::full, scene.rig, scene.solver, 1e-9);
    ASSERT_TRUE(small.small_motion);
    ASSERT_FALSE(full.small_motion);
    EXPECT_LE(first_contact_difference(small, full), small.neglected + 3e-9) << "seed " << seed;
  }
  EXPECT_GE(compared, 30);
}

TEST(SmallMotion, KeepsTheAccuracyAskedFor) {
  for (unsigned seed = 100; seed < 200; ++seed) {
    const Scene scene(seed);
    if (!complete(scene)) continue;
    const Simulation reference = simulate_as(Motion::small, scene.rig, scene.solver, 1e-12);
    for (const double accuracy : {1e-3, 1e-5, 1e-7, 1e-9}) {
      const Simulation run = simulate_as(Motion::small, scene.rig, scene.solver, accuracy);
      EXPECT_LE(first_contact_difference(run, reference), accuracy) << "seed " << seed;
      EXPECT_LE(std::abs(run.energy.imbalance), 10.0 * accuracy) << "seed " << seed;
    }
  }
}

TEST(SmallMotion, IsTakenWhereItMayBe) {
  Rig rig = paper_rig();
  rig.gravity = 9.81;
  const Simulation run = simulate(rig, ancf(14, 2, 1e-4, 3e-3));
  EXPECT_TRUE(run.small_motion);
  EXPECT_LT(run.neglected, 1e-4);
  EXPECT_THAT(run.skipped, testing::ElementsAre(testing::HasSubstr("foreshortening"),
                                                testing::HasSubstr("looks at the stop")));
}

// At 30 m/s on a slender bar small motion is wrong by more than is asked for, and it knows.
// What is left out after the last contact does not count.
TEST(SmallMotion, IsTakenForAFineImpactOfABarThatCannotStretch) {
  Rig rig = paper_rig();
  rig.gravity = 9.81;
  rig.contact.damping = "lankarani-nikravesh";
  rig.contact.restitution = 0.5;
  const Solver solver = hybrid(Basis::pinned_free, 12, 1e-6, 3e-3);
  const Simulation run = simulate(rig, solver);
  EXPECT_TRUE(run.small_motion);
  EXPECT_LE(first_contact_difference(run, simulate_as(Motion::full, rig, solver, 1e-9)), 1e-6);
}

TEST(SmallMotion, IsNotTakenWhereItMayNotBe) {
  Rig rig = paper_rig();
  rig.start.velocity = 30.0;
  const Solver solver = ancf(14, 2, 1e-4, 3e-3);
  const Simulation run = simulate(rig, solver);
  EXPECT_FALSE(run.small_motion);
  EXPECT_TRUE(run.skipped.empty());
  const Simulation small = simulate_as(Motion::small, rig, solver, 1e-8);
  const Simulation full = simulate_as(Motion::full, rig, solver, 1e-8);
  EXPECT_GT(first_contact_difference(small, full), 1e-4);
}

TEST(SmallMotion, IsNotTakenForAnExactRun) {
  SimulationOptions exact;
  exact.exact = true;
  const Simulation run = simulate(paper_rig(), ancf(14, 2, 1e-3, 1e-3), exact);
  EXPECT_FALSE(run.small_motion);
  EXPECT_TRUE(run.skipped.empty());
}

// Evaluations of the contact law at that accuracy: the paper's scene, damped, 3 ms.
TEST(SmallMotion, NeedsFewEvaluations) {
  Rig rig = paper_rig();
  rig.gravity = 9.81;
  rig.contact.damping = "lankarani-nikravesh";
  rig.contact.restitution = 0.5;
  const Solver solver = ancf(14, 2, 1e-6, 3e-3);
  const double peak = simulate_as(Motion::small, rig, solver, 1e-13).peak_force;

  struct Target {
    double error;
    long evaluations;
  };

  for (const auto& [error, evaluations] : {Target{1e-3, 250}, {1e-6, 450}, {1e-9, 1100}}) {
    const Simulation run = simulate_as(Motion::small, rig, solver, error);
    EXPECT_NEAR(run.peak_force / peak, 1.0, error);
    EXPECT_LE(run.cost.evaluations, evaluations) << error;
  }
}

TEST(SmallMotion, RefusesMoreModesThanItCanCompute) {
  SimulationOptions options;
  options.motion = Motion::small;
  options.kept = {Simplification::fast_vibration};
  EXPECT_THROW(simulate(paper_rig(), ancf(300, 50, 1e-3, 1e-3), options), std::invalid_argument);
  EXPECT_THROW(simulate(paper_rig(), hybrid(Basis::pinned_free, 300, 1e-3, 1e-3), options),
               std::invalid_argument);
}

// What is kept from run to run changes nothing, also where the bar changes in between.
TEST(BarCache, GivesWhatAFreshRunGives) {
  BarCache cache;
  SimulationOptions kept;
  kept.motion = Motion::small;
  kept.bars = &cache;
  const Solver solver = ancf(6, 2, 1e-6, 1e-3);
  for (const double length : {0.8, 0.8, 0.9, 0.8})
    for (const double speed : {0.4, 1.0}) {
      Rig rig = paper_rig();
      rig.beam.length = length;
      rig.start.velocity = speed;
      const Simulation with = simulate(rig, solver, kept);
      const Simulation without = simulate_as(Motion::small, rig, solver, 1e-6);
      EXPECT_EQ(with.peak_force, without.peak_force) << length << " m, " << speed << " m/s";
      EXPECT_EQ(with.impulse, without.impulse) << length << " m, " << speed << " m/s";
    }
}

/// As much more accurately as a run says that its first contact has to be solved again.
double smallness(const Rig& rig, const Solver& solver) {
  SimulationOptions options;
  options.motion = Motion::small;
  SmallMotionRun run(rig, solver, options, make_modal_bar(rig, solver));
  run.run().complete();
  return run.run().smallness();
}

// Errors of the way count as time, the more the slower the bar leaves. Where steps resolve its
// vibration they are so small that no second run is needed.
TEST(SmallMotion, AContactThatEndsSlowlyIsSolvedOnceWhereVibrationIsResolved) {
  std::mt19937 generator(5);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(generator);
  };
  int slow = 0;
  for (int k = 0; k < 60; ++k) {
    Rig rig = paper_rig();
    rig.contact.damping = "lankarani-nikravesh";
    rig.contact.restitution = uniform(0.3, 0.8);
    rig.contact.length *= uniform(0.5, 2.0);
    rig.start.velocity = uniform(0.1, 0.6);
    const Solver solver = hybrid(Basis::pinned_free, 12, std::pow(10.0, -uniform(3.0, 7.0)), 3e-3);
    const Simulation exact = simulate_as(Motion::small, rig, solver, 1e-11);
    const Episode& first = exact.episodes.at(0);
    const double leaves = first.separation_velocity / first.approach_velocity;
    if (leaves > 0.1 || leaves < 0.01) continue;
    ++slow;
    EXPECT_EQ(smallness(rig, solver), 1.0) << leaves;
    EXPECT_LT(
        first_contact_difference(simulate_as(Motion::small, rig, solver, solver.accuracy), exact),
        0.2 * solver.accuracy)
        << leaves << " at " << solver.accuracy;
  }
  EXPECT_GT(slow, 10);
}

// The vibration of a fine mesh is faster than its steps.
// A soft counterface whose damper takes vibration that steps too long for it leave in the force:
// the peak erred by up to 1.6 times the accuracy asked for.
TEST(SmallMotion, LetsTheContactDampWhatItShould) {
  Rig rig = paper_rig();
  const double radius = 0.01028;
  rig.beam = {.length = 0.2093,
              .area = std::numbers::pi * radius * radius,
              .second_moment = std::numbers::pi * std::pow(radius, 4) / 4.0,
              .youngs_modulus = 3.574e10,
              .density = 5571.0};
  rig.contact.position = rig.beam.length;
  rig.contact.counterface = Counterface::cylinder;
  rig.contact.radius = radius;
  rig.contact.counter_radius = 4.79e-4;
  rig.contact.length = 0.01074;
  rig.contact.modulus = rig.beam.youngs_modulus;
  rig.contact.counter_modulus = 3.627e8;
  rig.contact.poisson_ratio = 0.152;
  rig.contact.counter_poisson_ratio = 0.285;
  rig.contact.law = "radzimovsky-1.60";
  rig.contact.damping = "zhiying-qishao";
  rig.contact.restitution = 0.2644;
  rig.start.velocity = 0.1237;
  const Solver solver = ancf(19, 0, 1e-4, 1.232e-3);
  const double exact = simulate_as(Motion::small, rig, solver, 1e-8).peak_force;
  for (const double accuracy : {1e-3, 1e-4, 3e-5, 1e-5, 1e-6})
    EXPECT_NEAR(simulate_as(Motion::small, rig, solver, accuracy).peak_force / exact, 1.0, accuracy)
        << accuracy;
}

TEST(SmallMotion, AContactThatEndsSlowlyIsSolvedAgainWhereVibrationIsNotResolved) {
  Rig rig = paper_rig();
  rig.contact.damping = "lankarani-nikravesh";
  rig.contact.restitution = 0.7;
  const Solver solver = ancf(56, 8, 1e-3, 3e-3);
  const Episode first = simulate_as(Motion::small, rig, solver, 1e-6).episodes.at(0);
  const double leaves = first.separation_velocity / first.approach_velocity;
  ASSERT_LT(leaves, 0.095);
  EXPECT_NEAR(smallness(rig, solver), leaves / 0.1, 0.02 * leaves / 0.1);
}

// After the contact, and where no damping makes force of vibration, four stages need follow less of
// it: 1149 steps had a peak 25 times as accurate as asked for, a duration 400 times, and so have
// 682.
TEST(FullEquations, OfAFineMeshTakeNoMoreStepsThanTheirAccuracyNeeds) {
  const Rig rig = paper_rig();
  SimulationOptions exact;
  exact.exact = true;
  const Simulation run = simulate(rig, ancf(56, 8, 1e-3, 3e-3), exact);
  EXPECT_LT(first_contact_difference(run, simulate(rig, ancf(56, 8, 1e-7, 1e-3), exact)), 1e-4);
  EXPECT_LT(run.cost.steps, 700);
}

}  // namespace
