// SPDX-License-Identifier: BSD-3-Clause
// Flexible impacts: against a linear modal model, and hybrid coordinates against ANCF.
#include <gtest/gtest.h>

#include <cmath>

#include "models/contact/damping_law.hpp"
#include "models/simulation.hpp"
#include "tests/models/scenes.hpp"
#include "tests/support/convergence_study.hpp"

namespace {

using namespace impactrig::models;
using namespace impactrig::tests;

// Linear modal model of the paper's bar, no gravity, 1.2 ms: check values beam_impact_modal of the
// project's reference pages. Stated there: 2e-4 in peak force and separation time, 5e-4 in impulse,
// 2e-3 in restitution.
struct ModalCase {
  int modes;
  const char* damping;
  double peak, peak_time, separation, rebound, impulse, rigid_rebound;
};

constexpr ModalCase modal_cases[] = {
    {0, "none", 4513.758057993736, 0.00010993, 0.00021986712205931708, 0.9999999958056336,
     0.618320390812784, 0.9999999961375583},
    {0, "lankarani-nikravesh", 4242.860794409423, 7.42e-05, 0.00022309326984502875,
     0.7252411118014819, 0.5333758797378388, 0.7252411129690699},
    {0, "exact", 4560.999103370821, 5.259e-05, 0.00023233307634262096, 0.4999999992293075,
     0.46374029291836744, 0.49999999927082484},
    {1, "none", 3817.072029287522, 9.393e-05, 0.0001879106600224306, 0.998374859124962,
     0.4469459627684466, 0.44567757431977906},
    {1, "lankarani-nikravesh", 3588.2000255819416, 6.338e-05, 0.00019069880561876326,
     0.7233982061101284, 0.3855919437664514, 0.24722376415697794},
    {1, "exact", 3857.544806475805, 4.491e-05, 0.00019866754184597897, 0.4978535861908839,
     0.33532361970208613, 0.08462740012260202},
    {3, "none", 3617.9594041214796, 8.938e-05, 0.00017955212694698678, 0.9759446423907359,
     0.40431415251013886, 0.307782040875442},
    {3, "lankarani-nikravesh", 3400.1550573620893, 6.029e-05, 0.00018276543710152922,
     0.6979846764647007, 0.3494204646875996, 0.1302246165203876},
    {3, "exact", 3654.6113769936064, 4.27e-05, 0.00019153607229440735, 0.4682522791025937,
     0.30482224660669577, -0.014031397161583579},
    {5, "none", 2679.5629094267715, 6.807e-05, 0.0001474255449713946, 0.6110451740720653,
     0.3691900234591306, 0.1941706178161536},
    {5, "lankarani-nikravesh", 2508.989806224754, 4.572e-05, 0.00016974264443814186,
     0.13873393916565963, 0.3487566289455181, 0.12807739253540384},
    {5, "exact", 2688.3839923884766, 3.214e-05, 0.00036477591638973863, 0.2728253859908613,
     0.3290062696623081, 0.06419349420456769},
    {7, "none", 2278.848834266361, 5.916e-05, 0.0002994937665822617, 0.3660098515638526,
     0.3184588288316216, 0.03007706813273588},
    {7, "lankarani-nikravesh", 2124.4178908769622, 3.955e-05, 0.0004171425276977101,
     0.16565278529341193, 0.32048261624016894, 0.03662314871416055},
    {7, "exact", 2267.7463545761525, 2.755e-05, 0.000399009689200151, 0.13248877514447935,
     0.3210270573912488, 0.038384182193293995},
    {10, "none", 2222.040166839134, 5.85e-05, 0.00030891212433398386, 0.19763018677772226,
     0.31599722034380034, 0.022114825557209523},
    {10, "lankarani-nikravesh", 2062.220627996647, 3.901e-05, 0.0004059675758503279,
     0.06012072337598268, 0.3183854182801596, 0.029839617067703432},
    {10, "exact", 2191.024574899995, 2.689e-05, 0.00039002478819005233, 0.06264402186938724,
     0.3195569267278003, 0.03362894304193317},
};

TEST(HybridImpact, AgreesWithTheCheckValuesOfALinearModalModel) {
  for (const ModalCase& expected : modal_cases) {
    SCOPED_TRACE(testing::Message() << expected.modes << " modes, " << expected.damping);
    Rig rig = paper_rig();
    rig.contact.damping = expected.damping;
    rig.contact.restitution = 0.5;
    Solver solver = hybrid(Basis::pinned_free, expected.modes, 1e-10, 1.2e-3);
    if (expected.modes == 0) solver.model = BeamModel::rigid;
    const Simulation run = simulate(rig, solver);
    ASSERT_FALSE(run.episodes.empty());
    const Episode& first = run.episodes[0];
    EXPECT_NEAR(first.peak_force / expected.peak, 1.0, 2e-4);
    EXPECT_NEAR(first.peak_time, expected.peak_time, 3e-8);  // read there from a grid of 10 ns
    EXPECT_NEAR(first.end / expected.separation, 1.0, 2e-4);
    EXPECT_NEAR(run.restitution.kinematic, expected.rebound, 2e-3);
    // there a damped re-contact keeps the first approach speed in its factor; here it has its own
    if (run.episodes.size() > 1 && run.energy.dissipated > 0.0) continue;
    EXPECT_NEAR(run.impulse / expected.impulse, 1.0, 5e-4);
    // rigid rebound: moment of momentum over its initial value, I (1 + e) = impulse
    EXPECT_NEAR(run.impulse / (effective_mass(rig) * 0.441) - 1.0, expected.rigid_rebound, 2e-3);
  }
}

TEST(HybridImpact, WithElasticContactTakesNoEnergyFromTheBar) {
  Rig rig = paper_rig();
  for (Basis basis : {Basis::cantilever, Basis::pinned_free}) {
    const Simulation run = simulate(rig, hybrid(basis, 7, 1e-11, 1e-3));
    EXPECT_EQ(run.energy.dissipated, 0.0);
    EXPECT_NEAR((run.energy.kinetic + run.energy.elastic) / run.energy.initial, 1.0, 1e-9);
    EXPECT_GT(run.energy.vibration, 0.9 * run.energy.initial);  // hardly anything bounces back
    EXPECT_NEAR(run.restitution.energetic, 1.0, 1e-9);
    EXPECT_LT(run.restitution.kinematic, 0.7);  // although the contact loses nothing
  }
}

/// Peak force and impulse of the paper's impact without loss; one episode and a bit.
Simulation impact(const Solver& solver) {
  Rig rig = paper_rig();
  rig.contact.damping = "exact";
  rig.contact.restitution = 0.5;
  return simulate(rig, solver);
}

TEST(HybridImpact, DoesNotDependOnTheBasisOnceThereAreEnoughModes) {
  const Simulation pinned = impact(hybrid(Basis::pinned_free, 30, 1e-7, 5e-4));
  const Simulation cantilever = impact(hybrid(Basis::cantilever, 30, 1e-7, 5e-4));
  EXPECT_NEAR(cantilever.peak_force / pinned.peak_force, 1.0, 3e-3);
  EXPECT_NEAR(cantilever.impulse / pinned.impulse, 1.0, 3e-3);
}

TEST(AncfImpact, ConvergesAndMeetsTheHybridModelOfManyModes) {
  // What the paper's conclusion (1) denies: in this scene both descriptions have one limit.
  Solver many = hybrid(Basis::pinned_free, 40, 1e-7, 3e-4);
  many.axial_modes = 4;
  const double limit = impact(many).peak_force;
  const double coarse = impact(ancf(14, 2, 1e-7, 3e-4)).peak_force;
  const double fine = impact(ancf(28, 4, 1e-7, 3e-4)).peak_force;
  EXPECT_NEAR(coarse / limit, 1.0, 5e-3);
  EXPECT_NEAR(fine / limit, 1.0, 2.5e-3);
  EXPECT_LT(std::abs(fine / limit - 1.0), std::abs(coarse / limit - 1.0));
}

TEST(AncfImpact, OfOneElementEachSideIsAlreadyAnImpact) {
  const Simulation run = impact(ancf(1, 1, 1e-9, 3e-4));
  EXPECT_GT(run.peak_force, 1000.0);
  EXPECT_LT(std::abs(run.energy.imbalance), 1e-8);
}

TEST(AncfImpact, CanStrikeTheTip) {
  Rig rig = paper_rig();
  rig.contact.position = rig.beam.length;
  const Simulation run = simulate(rig, ancf(10, 0, 1e-9, 3e-4));
  const Simulation modal = simulate(rig, hybrid(Basis::pinned_free, 25, 1e-9, 3e-4));
  EXPECT_NEAR(run.peak_force / modal.peak_force, 1.0, 0.03);
  EXPECT_NEAR(run.episodes.at(0).approach_velocity, 0.441, 1e-12);
}

TEST(StiffBar, ReboundsLikeARigidOne) {
  // a bar 10³ times as stiff against a soft spring: contact much slower than its vibration
  Rig rig = paper_rig();
  rig.contact.law = "linear";
  rig.contact.stiffness = 1e5;
  rig.beam.youngs_modulus *= 1e3;
  rig.contact.damping = "exact";
  rig.contact.restitution = 0.5;
  const Simulation stiff = simulate(rig, hybrid(Basis::pinned_free, 2, 1e-8, 0.01));
  EXPECT_NEAR(stiff.restitution.kinematic, 0.5, 1e-3);
  EXPECT_NEAR(stiff.peak_force / simulate(rig, rigid(1e-8)).peak_force, 1.0, 1e-3);
  const Simulation chain = simulate(rig, ancf(1, 1, 1e-6, 0.01));
  EXPECT_NEAR(chain.restitution.kinematic, 0.5, 1e-3);
}

}  // namespace
