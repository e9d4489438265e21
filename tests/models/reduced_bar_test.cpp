// SPDX-License-Identifier: BSD-3-Clause
// Fine meshes in few coordinates, against the mesh in all its modes and against closed forms.
#include "models/modal/reduced_bar.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "models/modal/bar_cache.hpp"
#include "models/modal/small_motion_run.hpp"
#include "models/simulation.hpp"
#include "tests/models/first_contacts.hpp"
#include "tests/models/scenes.hpp"

namespace {

using namespace impactrig::models;
using namespace impactrig::tests;
using testing::Contains;
using testing::Not;

/// Everything that a bar before stops can have.
Rig involved_rig() {
  Rig rig = paper_rig();
  rig.gravity = 9.81;
  rig.beam.segments = {{0.5, rig.beam.area, rig.beam.second_moment, 0.9},
                       {0.3, 0.8 * rig.beam.area, 0.6 * rig.beam.second_moment, 0.85}};
  rig.beam.masses = {{0.8, 0.1}, {0.33, 0.05}};
  rig.hinge.spring = 20.0;
  rig.contact.damping = "lankarani-nikravesh";
  rig.contact.restitution = 0.6;
  FurtherStop beyond;
  beyond.contact = rig.contact;
  beyond.contact.position = 0.4;
  beyond.gap = 1e-5;
  rig.further_stops = {beyond};
  return rig;
}

Rig shearing(Rig rig) {
  rig.beam.theory = BeamTheory::timoshenko;
  rig.beam.shear_coefficient = 0.9;
  rig.beam.poisson_ratio = 0.3;
  return rig;
}

std::shared_ptr<const ModalBar> make_few(const Rig& rig, const Solver& solver, int modes) {
  return std::make_shared<const ModalBar>(make_reduced_bar(rig, solver, modes), rig);
}

/// Displacement of a point under a steady unit force at another, without the rigid rotation [m/N].
double compliance(const ModalBeam& bar, const Eigen::VectorXd& at, const Eigen::VectorXd& force) {
  const Eigen::Index elastic = bar.modes() - 1;
  return (at.array() * force.array() / bar.omega().array().square()).tail(elastic).sum();
}

// Of beam theory, tan βL = tanh βL for the pinned-free bar. The mesh errs by (βh)⁴/720; its
// stiffest elements vibrate 10⁶ times as fast, whose rounding the modes would have if they were
// computed with them.
TEST(ReducedBar, HasTheSlowModesOfAVeryFineMeshToAllDigits) {
  const Rig rig = paper_rig();
  const auto bar = make_few(rig, ancf(896, 128, 1e-6, 3e-3), 48);
  const double scale = std::sqrt(rig.beam.youngs_modulus * rig.beam.second_moment /
                                 (rig.beam.density * rig.beam.area)) /
                       std::pow(rig.beam.length, 2);
  const double beta[] = {3.926602312047919, 7.068582745628732, 10.210176122813030,
                         13.351768777754094};
  EXPECT_NEAR(bar->modes().omega()[0], 0.0, 1e-6);
  for (int k = 0; k < 4; ++k)
    EXPECT_NEAR(bar->modes().omega()[1 + k] / (scale * beta[k] * beta[k]), 1.0, 1e-10) << k;
}

// The steady deflections of all pairs of struck points, whatever few coordinates there are.
TEST(ReducedBar, BendsUnderSteadyForcesAsTheMeshDoes) {
  for (const Rig& rig : {involved_rig(), shearing(involved_rig())}) {
    const Solver solver = ancf(25, 7, 1e-6, 3e-3);
    const auto whole = make_modal_bar(rig, solver);
    const auto few = make_few(rig, solver, 10);
    ASSERT_EQ(few->modes().modes(), 12);
    for (int at = 0; at < rig.stops(); ++at)
      for (int force = 0; force < rig.stops(); ++force) {
        const double expected =
            compliance(whole->modes(), whole->modes().struck(at), whole->modes().struck(force));
        const double found =
            compliance(few->modes(), few->modes().struck(at), few->modes().struck(force));
        // the weight's pull is no load, and bends only by what the coordinates have
        EXPECT_NEAR(found / expected, 1.0, 2e-6) << at << ' ' << force;
      }
  }
}

// Modes of the mesh first, then one for each point that stands for the others: slower than twice
// the fastest of those, faster than all of them.
TEST(ReducedBar, HasTheMeshsOwnModesFirst) {
  for (const Rig& rig : {paper_rig(), involved_rig(), shearing(involved_rig())}) {
    const Solver solver = ancf(35, 5, 1e-6, 3e-3);
    const auto whole = make_modal_bar(rig, solver);
    const auto few = make_few(rig, solver, 30);
    ASSERT_EQ(few->own_modes(), 30);
    ASSERT_EQ(few->modes().modes(), 30 + rig.stops());
    EXPECT_TRUE(few->is_reduced());
    for (int k = 1; k < 30; ++k) {
      EXPECT_NEAR(few->modes().omega()[k] / whole->modes().omega()[k], 1.0, 1e-12) << k;
      EXPECT_NEAR(std::abs(few->modes().struck()[k] / whole->modes().struck()[k]), 1.0, 1e-8) << k;
    }
    for (int k = 30; k < few->modes().modes(); ++k) {
      EXPECT_GT(few->modes().omega()[k], few->modes().omega()[29]);
      EXPECT_LE(few->modes().omega()[k], 2.0 * few->modes().omega()[29] * (1.0 + 1e-12));
    }
  }
}

TEST(ReducedBar, OfAllModesIsTheMesh) {
  const Rig rig = involved_rig();
  const Solver solver = ancf(9, 2, 1e-6, 3e-3);
  const auto whole = make_modal_bar(rig, solver);
  const auto all = make_few(rig, solver, 1000);
  EXPECT_FALSE(all->is_reduced());
  EXPECT_EQ(all->modes().omega(), whole->modes().omega());
  EXPECT_EQ(all->modes().struck(), whole->modes().struck());
}

TEST(ReducedBar, FromFewerModesIsTheSame) {
  for (const Rig& rig : {involved_rig(), shearing(involved_rig())}) {
    const auto fewer = make_reduced_bar(rig, ancf(35, 5, 1e-6, 3e-3), 12);
    const ModalBar more(std::make_shared<const ReducedBar>(*fewer, 30), rig);
    const auto anew = make_few(rig, ancf(35, 5, 1e-6, 3e-3), 30);
    ASSERT_EQ(more.modes().modes(), anew->modes().modes());
    for (int k = 1; k < more.modes().modes(); ++k) {
      EXPECT_NEAR(more.modes().omega()[k] / anew->modes().omega()[k], 1.0, 1e-9) << k;
      EXPECT_NEAR(std::abs(more.modes().struck()[k] / anew->modes().struck()[k]), 1.0, 1e-8) << k;
    }
  }
}

/// A run in so many coordinates; all: 0.
struct FewRun {
  Simulation result;
  double left_out;
};

FewRun solve_in(const Rig& rig, const Solver& solver, int coordinates,
                const HistoryRequest& history = {}) {
  SimulationOptions options;
  options.motion = Motion::small;
  options.history = history;
  SmallMotionRun run(
      rig, solver, options,
      coordinates == 0 ? make_modal_bar(rig, solver) : make_few(rig, solver, coordinates));
  run.run().complete();
  Simulation result = run.conclude();
  return {std::move(result), run.left_out()};
}

TEST(ReducedBar, ErrsLessThanItSays) {
  Rig damped = paper_rig();
  damped.contact.damping = "lankarani-nikravesh";
  damped.contact.restitution = 0.5;
  Rig pulled = paper_rig();
  pulled.contact.damping = "viscous";
  pulled.contact.restitution = 0.5;
  Rig giving = damped;
  giving.stop = {.mass = 0.05, .stiffness = 2e8};
  Rig point = paper_rig();
  point.contact.law = "hertz-point";
  Rig braked = paper_rig();
  braked.hinge.viscous = 0.5;
  braked.beam.damping.stiffness = 1e-7;
  for (const Rig& rig : {paper_rig(), damped, pulled, giving, point, braked, involved_rig(),
                         shearing(involved_rig()), shearing(paper_rig())}) {
    const Solver solver = ancf(35, 5, 1e-9, 1.5e-3);
    const FewRun whole = solve_in(rig, solver, 0);
    for (const int coordinates : {20, 30, 40}) {
      const FewRun few = solve_in(rig, solver, coordinates);
      EXPECT_GT(few.left_out, 0.0);
      EXPECT_LT(first_contact_difference(few.result, whole.result), few.left_out)
          << rig.contact.law << ' ' << rig.contact.damping << ' ' << coordinates;
    }
    // and falls steeply with them where the force does not jump, in shear more slowly
    if (rig.contact.damping == "viscous") continue;
    EXPECT_LT(solve_in(rig, solver, 40).left_out,
              (rig.beam.shears() ? 0.5 : 0.1) * solve_in(rig, solver, 20).left_out);
  }
}

TEST(ReducedBar, TellsWhatHistoriesLack) {
  Rig rig = paper_rig();
  const Solver solver = ancf(35, 5, 1e-9, 1.5e-3);
  const HistoryRequest history{.interval = 1e-6, .velocity_position = 0.75};
  const FewRun whole = solve_in(rig, solver, 0, history);
  for (const int coordinates : {20, 30, 40}) {
    const FewRun few = solve_in(rig, solver, coordinates, history);
    double most = 0.0;
    for (std::size_t i = 0; i < few.result.history.velocity.size(); ++i)
      most = std::max(
          most, std::abs(few.result.history.velocity[i] - whole.result.history.velocity.at(i)));
    EXPECT_LT(most / rig.start.velocity, few.left_out) << coordinates;
  }
}

// With masses, weight and spring, in modes or in coordinates that stand for many.
TEST(ModalBeam, NoModeStretchesMoreThanTheBarCan) {
  for (const Rig& rig : {paper_rig(), involved_rig()})
    for (const auto& bar : {make_modal_bar(rig, ancf(6, 2, 1e-6, 1e-3)),
                            make_few(rig, ancf(35, 5, 1e-6, 1e-3), 30)}) {
      const ModalBeam& modes = bar->modes();
      for (int k = 1; k < modes.modes(); ++k) {
        Eigen::VectorXd a = Eigen::VectorXd::Unit(modes.modes(), k) / modes.omega()[k];
        a += 0.3 * Eigen::VectorXd::Unit(modes.modes(), 1) / modes.omega()[1];
        const double energy = 0.5 * modes.omega().cwiseProduct(a).squaredNorm();
        EXPECT_LT(modes.stretching_energy(a), modes.most_stretching(energy) * energy) << k;
        EXPECT_GT(modes.stretching_energy(a), 0.0) << k;
      }
    }
}

const auto fast_vibration = Simplification::fast_vibration;

SimulationOptions as(Motion motion) {
  SimulationOptions options;
  options.motion = motion;
  return options;
}

TEST(FastVibration, IsLeftOutOfFineMeshesWithinTheAccuracy) {
  for (const Rig& rig : {paper_rig(), involved_rig()}) {
    const Simulation exact = solve_in(rig, ancf(112, 16, 1e-9, 1.5e-3), 0).result;
    for (const double accuracy : {1e-3, 1e-4, 1e-5}) {
      if (accuracy < 1e-3 && !rig.further_stops.empty()) continue;  // the more forces, the more
      const Simulation result = simulate(rig, ancf(112, 16, accuracy, 1.5e-3));
      ASSERT_THAT(result.taken, Contains(fast_vibration)) << accuracy;
      EXPECT_LT(first_contact_difference(result, exact), accuracy);
    }
  }
}

// How many modes these contacts need differs by a factor of three; a coarse solution tells.
TEST(FastVibration, IsLeftOutAsTheContactsDampingAllows) {
  for (const double restitution : {0.3, 0.6, 0.95}) {
    Rig rig = paper_rig();
    rig.contact.damping = "lankarani-nikravesh";
    rig.contact.restitution = restitution;
    const Simulation exact = solve_in(rig, ancf(112, 16, 1e-9, 1.5e-3), 0).result;
    for (const double accuracy : {1e-3, 1e-4}) {
      const Simulation result = simulate(rig, ancf(112, 16, accuracy, 1.5e-3));
      ASSERT_THAT(result.taken, Contains(fast_vibration)) << restitution << ' ' << accuracy;
      EXPECT_LT(first_contact_difference(result, exact), accuracy) << restitution;
    }
  }
}

// What they neglect beside vibration is too much for small motion: a coarse solution of few modes
// tells, and is not the answer.
TEST(FastVibration, IsNotTheAnswerWhereSmallMotionIsNone) {
  Rig rig = paper_rig();
  rig.contact.damping = "lankarani-nikravesh";
  rig.contact.restitution = 0.5;
  rig.start.velocity = 20.0;
  const Simulation result = simulate(rig, ancf(56, 8, 1e-5, 1e-3));
  EXPECT_FALSE(result.small_motion);
  EXPECT_THAT(result.taken, Not(Contains(fast_vibration)));
}

TEST(FastVibration, IsNotLeftOutWhereItMatters) {
  const Rig rig = paper_rig();
  const auto taken = [&](const Rig& scene, const Solver& solver, const SimulationOptions& options) {
    return simulate(scene, solver, options).taken;
  };
  // hardly more modes than would be needed
  EXPECT_THAT(taken(rig, ancf(9, 2, 1e-3, 1e-3), {}), Not(Contains(fast_vibration)));
  EXPECT_THAT(taken(rig, ancf(42, 6, 1e-9, 1e-3), {}), Not(Contains(fast_vibration)));
  const Solver fine = ancf(56, 8, 1e-3, 1e-3);
  ASSERT_THAT(taken(rig, fine, {}), Contains(fast_vibration));
  SimulationOptions kept;
  kept.kept = {fast_vibration};
  EXPECT_THAT(taken(rig, fine, kept), Not(Contains(fast_vibration)));
  SimulationOptions exact;
  exact.exact = true;
  EXPECT_THAT(taken(rig, fine, exact), testing::IsEmpty());
  // a force that jumps at touch makes it vibrate much
  Rig jumping = rig;
  jumping.contact.damping = "viscous";
  jumping.contact.restitution = 0.3;
  EXPECT_THAT(taken(jumping, fine, {}), Not(Contains(fast_vibration)));
  // slopes by what the coordinates themselves depend on
  SimulationOptions slopes;
  slopes.sensitivities = {[](Rig& r) -> double& { return r.contact.length; }};
  EXPECT_THAT(taken(rig, fine, slopes), Contains(fast_vibration));
  slopes.sensitivities = {[](Rig& r) -> double& { return r.beam.density; }};
  EXPECT_THAT(taken(rig, fine, slopes), Not(Contains(fast_vibration)));
}

// What stands for its modes is slower by far, and does not ring as they do.
TEST(FastVibration, OfAShortElementIsLeftOutWithinTheAccuracy) {
  const auto difference = [](double length, double stiffness, const char* damping) {
    Rig rig = paper_rig();
    rig.contact.position = rig.beam.length - length;
    rig.contact.law = "linear";
    rig.contact.stiffness = stiffness;
    rig.contact.damping = damping;
    rig.contact.restitution = 0.7;
    const Simulation result = simulate(rig, ancf(4, 1, 5e-7, 1e-3));
    const Simulation exact = solve_in(rig, ancf(4, 1, 1e-9, 1e-3), 0).result;
    return first_contact_difference(result, exact);
  };
  EXPECT_LT(difference(3e-4, 1e10, "viscous"), 5e-7);
  EXPECT_LT(difference(3e-4, 1e11, "viscous"), 5e-7);
  EXPECT_LT(difference(1e-3, 1e6, "kuwabara-kono"), 5e-7);
}

// More modes than can be computed.
TEST(FastVibration, LeftOutMakesVeryFineMeshesSmallMotions) {
  const Rig rig = paper_rig();
  const Simulation fine = simulate(rig, ancf(448, 64, 1e-6, 1.5e-3));
  EXPECT_TRUE(fine.small_motion);
  ASSERT_THAT(fine.taken, Contains(fast_vibration));
  // meshes of a half: the error falls with the fourth power of the elements' length
  const Simulation half = simulate(rig, ancf(224, 32, 1e-8, 1.5e-3), as(Motion::small));
  EXPECT_LT(first_contact_difference(fine, half), 1.1e-6);
}

TEST(FastVibration, HasNoPartInWhatTheFullEquationsGive) {
  const Rig rig = paper_rig();
  const Simulation few = simulate(rig, ancf(112, 16, 1e-4, 1e-3));
  ASSERT_THAT(few.taken, Contains(fast_vibration));
  const Simulation full = simulate(rig, ancf(112, 16, 1e-4, 1e-3), as(Motion::full));
  EXPECT_LT(first_contact_difference(few, full), 2e-4);
}

}  // namespace
