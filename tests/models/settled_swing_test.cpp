// SPDX-License-Identifier: BSD-3-Clause
#include "models/settled_swing.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "tests/models/hard_scene.hpp"
#include "tests/models/plain_bars.hpp"
#include "tests/models/scenes.hpp"

namespace {

using namespace impactrig::models;
using namespace impactrig::tests;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

Rig free_bar(const Beam& beam) {
  Rig rig = paper_rig();
  rig.beam = beam;
  rig.contact.law = "none";
  rig.contact.position = rig.beam.length;
  rig.gravity = 9.81;
  rig.start = {};
  return rig;
}

Solver hybrid(Basis basis, int modes, double accuracy, double duration) {
  Solver solver;
  solver.model = BeamModel::hybrid;
  solver.basis = basis;
  solver.modes = modes;
  solver.accuracy = accuracy;
  solver.duration = duration;
  return solver;
}

/// Largest difference of displacements, as a part of the length.
double difference(const Rig& rig, const Simulation& run, const Simulation& fine) {
  EXPECT_EQ(run.history.displacement.size(), fine.history.displacement.size());
  double largest = 0.0;
  for (std::size_t i = 0; i < run.history.displacement.size(); ++i)
    largest =
        std::max(largest, std::abs(run.history.displacement[i] - fine.history.displacement[i]));
  return largest / rig.beam.length;
}

/// Scene 38 of `bench_stress --without-stop --seed 1`: 62 m of soft tube with heads near a hinge
/// that rubs, let go at 0.13 rad.
Rig soft_tube_whose_hinge_rubs() {
  Rig rig = free_bar(tube(62.336792588916033, 0.061684609506385518, 0.038380340414363126,
                          288710245.58642077, 2278.2737597689461));
  rig.beam.masses = {{5.0874231846080669, 4349.0801996724085},
                     {1.8966118842757513, 395.36359243218556}};
  rig.hinge.friction = 8.5258071501842991;
  rig.start.release_angle = 0.13143308584936914;
  return rig;
}

// Single steps well solved gave displacements off by 1.7e-4.
TEST(SettledSwing, IsLookedForWhereTheHingeRubs) {
  const Rig rig = soft_tube_whose_hinge_rubs();
  SimulationOptions options;
  options.history.interval = 0.5;
  const double accuracy = 2.9e-5;
  const Simulation run = simulate(rig, hybrid(Basis::cantilever, 6, accuracy, 83.5), options);
  const Simulation fine = simulate(rig, hybrid(Basis::cantilever, 6, 1e-8, 83.5), options);
  EXPECT_THAT(run.warnings, IsEmpty());
  EXPECT_LT(difference(rig, run, fine), accuracy);
}

/// Scene 108: 13 m of rubber rod that start straight, at 18.6 m/s at the tip.
Rig rod_that_flails() {
  Rig rig = free_bar(
      round_bar(13.209916727765197, 0.021437080726849592, 561442121.00024915, 2846.789369451591));
  rig.gravity_direction = -0.41231924074389337;
  rig.start.velocity = 18.611912327826236;
  return rig;
}

// Displacements differed by 1.1 lengths, and nothing was said.
TEST(SettledSwing, ThatIsChaoticIsToldOf) {
  const Simulation run = simulate(rod_that_flails(), hybrid(Basis::pinned_free, 6, 2.9e-4, 36.8));
  EXPECT_THAT(run.warnings, Contains(HasSubstr("displacements change by")));
  EXPECT_THAT(run.warnings, Contains(HasSubstr("times the energy of its swing, and such motion")));
  EXPECT_THAT(run.history.displacement, IsEmpty());  // not asked for
}

/// Scene 209 of seed 6002: a thread with a weight at its end, which in the end vibrates with 0.7 %
/// of its energy.
Rig thread_with_a_weight() {
  Rig rig = free_bar(
      round_bar(0.10407504494701518, 5.6555163528707187e-05, 2732414332.2009401, 4163.7498891));
  rig.beam.poisson_ratio = 0.138979;
  rig.beam.masses = {{rig.beam.length, 7.7768408e-07}};
  rig.beam.damping = {.mass = 0.12211226, .stiffness = 1.5285010e-08};
  rig.gravity = 11.650539821612263;
  rig.start.velocity = 0.7926916061220165;
  return rig;
}

// Its displacements were off by 56 times the accuracy without a word.
TEST(SettledSwing, IsLookedForWhereTheBarIsLimp) {
  SimulationOptions options;
  options.history.interval = 0.01;
  const double accuracy = 1.85e-6;
  const auto swing = [&](double asked) {
    Solver solver = ancf(1, 0, asked, 0.927);
    return simulate(thread_with_a_weight(), solver, options);
  };
  const Simulation run = swing(accuracy);
  EXPECT_THAT(run.warnings, IsEmpty());
  EXPECT_LT(difference(thread_with_a_weight(), run, swing(1e-10)), accuracy);
}

TEST(SettledSwing, KeepsItsAnswerAndSaysSoWhereItCannotBeConfirmed) {
  int solutions = 0;
  const SolveFully once = [&](const Solver& solver, const SimulationOptions&) {
    if (++solutions > 1) throw std::runtime_error("no time is left");
    Simulation run;
    run.solver = solver;
    run.energy.initial = 1.0;
    run.duration = 5.0;
    return run;
  };
  const Simulation run = solve_swing_until_settled(
      soft_tube_whose_hinge_rubs(), hybrid(Basis::cantilever, 6, 1e-3, 5.0), {}, once);
  EXPECT_EQ(run.duration, 5.0);
  ASSERT_EQ(run.warnings.size(), 1U);
  EXPECT_THAT(run.warnings.front(), HasSubstr("could not be shown to stay as they are"));
}

/// Scene 197: a wire with a heavy tip, turned four times as fast as it vibrates.
Rig wire_turned_fast() {
  Rig rig = free_bar(round_bar(0.11949483506666778, 0.00019439843834272174, 33401923.397526756,
                               1855.8086697380934));
  rig.beam.masses = {{rig.beam.length, 0.00023003175814384377}};
  rig.gravity = 0.0;
  rig.hinge.rotation = {.rate = -2.123358385666724, .time = 0.015179476237741634};
  return rig;
}

// Its tip went to 1.4e4 lengths, and nothing was said.
TEST(SettledSwing, BeyondTheHybridModelIsToldOf) {
  const Simulation run = simulate(wire_turned_fast(), hybrid(Basis::cantilever, 2, 1e-4, 2.0));
  EXPECT_THAT(run.warnings, Contains(HasSubstr("the hybrid model knows small deflections only")));
  Solver solver = hybrid(Basis::cantilever, 2, 1e-4, 2.0);
  solver.model = BeamModel::ancf;
  solver.elements = {8, 0};
  EXPECT_THAT(simulate(wire_turned_fast(), solver).warnings,
              Not(Contains(HasSubstr("small deflections"))));
}

TEST(SettledSwing, StandsWithoutDerivativesWhereNoTimeIsLeftForThem) {
  const SolveFully plain_only = [](const Solver& solver, const SimulationOptions& options) {
    if (!options.sensitivities.empty()) throw std::runtime_error("no time is left");
    Simulation run;
    run.solver = solver;
    run.energy.initial = 1.0;
    run.duration = 5.0;
    return run;
  };
  SimulationOptions options;
  options.sensitivities = {[](Rig& r) -> double& { return r.beam.density; }};
  const Simulation run = solve_swing_until_settled(
      soft_tube_whose_hinge_rubs(), hybrid(Basis::cantilever, 6, 1e-3, 5.0), options, plain_only);
  EXPECT_EQ(run.duration, 5.0);
  EXPECT_THAT(run.sensitivities, IsEmpty());
  EXPECT_THAT(run.warnings, Contains(HasSubstr("no time was left for the derivatives")));
}

TEST(SettledSwing, CostsNothingWhereNothingMagnifiesErrors) {
  const Rig rig = [] {
    Rig stiff = free_bar(paper_rig().beam);
    stiff.start.release_angle = 0.3;
    return stiff;
  }();
  int solutions = 0;
  const SolveFully count = [&](const Solver& solver, const SimulationOptions& options) {
    ++solutions;
    return simulate(rig, solver, options);
  };
  solve_swing_until_settled(rig, hybrid(Basis::cantilever, 4, 1e-4, 0.5), {}, count);
  EXPECT_EQ(solutions, 1);
}

}  // namespace
