// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "models/contact/contact_force.hpp"
#include "models/simulation.hpp"
#include "tests/models/scenes.hpp"

namespace {

using namespace impactrig::models;
using namespace impactrig::tests;

struct Scene {
  const char* name;
  Solver solver;
};

class Histories : public testing::TestWithParam<Scene> {
 protected:
  Simulation sampled(double interval, double lead = 0.0, double laser = 0.0) const {
    Rig rig = paper_rig();
    rig.contact.damping = "lankarani-nikravesh";
    rig.contact.restitution = 0.5;
    rig.gravity = 9.81;
    SimulationOptions options;
    options.history = {.interval = interval,
                       .lead = lead,
                       .velocity_position = laser,
                       .displacement_position = laser};
    return simulate(rig, GetParam().solver, options);
  }
};

TEST_P(Histories, CoverTheLeadAndTheRunUniformly) {
  const Simulation run = sampled(1e-6, 20.3e-6);
  const History& history = run.history;
  EXPECT_EQ(history.interval, 1e-6);
  EXPECT_NEAR(history.start, -21e-6, 1e-18);  // the lead is rounded up to whole intervals
  const std::size_t n = history.force.size();
  EXPECT_EQ(history.velocity.size(), n);
  EXPECT_EQ(history.displacement.size(), n);
  EXPECT_EQ(history.penetration.size(), n);
  const double last = history.start + 1e-6 * static_cast<double>(n - 1);
  EXPECT_LE(last, run.duration + 1e-15);
  EXPECT_GT(last, run.duration - 1.000001e-6);
  EXPECT_EQ(history.force[21], 0.0);  // first touch
  EXPECT_EQ(history.displacement[21], 0.0);
  EXPECT_NEAR(history.velocity[21], 0.441, 1e-12);
  for (std::size_t k = 0; k < 21; ++k) {
    EXPECT_EQ(history.force[k], 0.0);
    EXPECT_NEAR(history.displacement[k], -0.441 * 1e-6 * static_cast<double>(21 - k), 1e-12);
    EXPECT_NEAR(history.velocity[k], 0.441, 1e-8);
  }
}

TEST_P(Histories, ForceIsZeroOutsideContactAndNeverNegative) {
  const Simulation run = sampled(2.5e-7);
  const auto touching = [&](double t) {
    return std::ranges::any_of(run.episodes,
                               [&](const Episode& e) { return t > e.start && t < e.end; });
  };
  double largest = 0.0;
  for (std::size_t k = 0; k < run.history.force.size(); ++k) {
    const double t = run.history.start + 2.5e-7 * static_cast<double>(k);
    EXPECT_GE(run.history.force[k], 0.0) << t;
    if (!touching(t)) {
      EXPECT_EQ(run.history.force[k], 0.0) << t;
    }
    EXPECT_EQ(touching(t) && run.history.penetration[k] < -1e-12, false) << t;
    largest = std::max(largest, run.history.force[k]);
  }
  EXPECT_LE(largest, run.peak_force * (1.0 + 1e-7));
  EXPECT_GT(largest, run.peak_force * (1.0 - 1e-3));
}

TEST_P(Histories, VelocityIsTheDerivativeOfDisplacement) {
  for (double laser : {0.0, 0.4}) {
    const double interval = 1e-7;
    const History history = sampled(interval, 0.0, laser).history;
    for (std::size_t k = 2; k + 2 < history.velocity.size(); ++k) {
      const auto& x = history.displacement;
      const double slope =
          (8.0 * (x[k + 1] - x[k - 1]) - (x[k + 2] - x[k - 2])) / (12.0 * interval);
      // rounding of x over the interval, and the kink of the acceleration at touch and separation
      EXPECT_NEAR(slope, history.velocity[k], 2e-6) << "sample " << k;
    }
  }
}

TEST_P(Histories, IntegrateToTheImpulse) {
  const Simulation run = sampled(1e-7);
  double sum = 0.0;
  for (double force : run.history.force) sum += 1e-7 * force;
  EXPECT_NEAR(sum / run.impulse, 1.0, 1e-6);
}

TEST_P(Histories, DoNotChangeTheRun) {
  const Simulation with = sampled(1e-6);
  const Simulation without = sampled(0.0);
  EXPECT_EQ(with.peak_force, without.peak_force);
  EXPECT_EQ(with.impulse, without.impulse);
  EXPECT_EQ(with.cost.steps, without.cost.steps);
  EXPECT_TRUE(without.history.force.empty());
}

INSTANTIATE_TEST_SUITE_P(EveryModel, Histories,
                         testing::Values(Scene{"Rigid",
                                               [] {
                                                 Solver s = rigid(1e-9);
                                                 s.duration = 6e-4;
                                                 return s;
                                               }()},
                                         Scene{"Hybrid", hybrid(Basis::pinned_free, 5, 1e-9, 6e-4)},
                                         Scene{"Ancf", ancf(6, 2, 1e-9, 6e-4)}),
                         [](const auto& instance) { return std::string(instance.param.name); });

TEST(History, OfAPointFurtherInMovesInProportionForARigidBar) {
  SimulationOptions options;
  options.history = {.interval = 1e-5, .velocity_position = 0.23, .displacement_position = 0.46};
  const Simulation run = simulate(paper_rig(), rigid(1e-9), options);
  for (std::size_t k = 0; k < run.history.force.size(); ++k)
    EXPECT_NEAR(run.history.displacement[k], run.history.penetration[k] * 0.46 / 0.69, 1e-12);
  EXPECT_NEAR(run.history.velocity[0], 0.441 / 3.0, 1e-14);
}

// By differences of what lasers beside the spot show: in the lead, in contact, stepped and flown at
// once, before a stop that gives way.
TEST(History, TellsHowMotionChangesAlongTheBar) {
  for (const bool gives_way : {false, true})
    for (const bool flies : {true, false}) {
      SCOPED_TRACE(testing::Message() << gives_way << flies);
      Rig rig = paper_rig();
      rig.gravity = 9.81;
      if (gives_way) rig.stop = Stop{.mass = 0.1, .stiffness = 5e8, .viscous = 1e3};
      const auto shown = [&](double velocity, double displacement) {
        SimulationOptions options;
        options.motion = Motion::small;
        options.history = {.interval = 1e-5,
                           .lead = 5e-5,
                           .velocity_position = velocity,
                           .displacement_position = displacement,
                           .spot_slopes = true};
        if (!flies) options.kept = {Simplification::flight_at_once};
        return simulate(rig, ancf(5, 1, 1e-9, 3e-3), options).history;
      };
      const double step = 1e-4;
      const History here = shown(0.6, 0.35);
      const History beyond = shown(0.6 + step, 0.35 + step),
                    before = shown(0.6 - step, 0.35 - step);
      ASSERT_EQ(here.velocity_slope.size(), here.velocity.size());
      ASSERT_EQ(here.displacement_slope.size(), here.velocity.size());
      for (std::size_t k = 0; k < here.velocity.size(); ++k) {
        EXPECT_NEAR(here.velocity_slope[k],
                    (beyond.velocity[k] - before.velocity[k]) / (2.0 * step), 1e-5)
            << k;
        EXPECT_NEAR(here.displacement_slope[k],
                    (beyond.displacement[k] - before.displacement[k]) / (2.0 * step), 1e-9)
            << k;
      }
    }
}

/// Lasers at two places, and how what they see changes along the bar.
History with_slopes(const Rig& rig, const Solver& solver, double beyond) {
  SimulationOptions options;
  options.motion = Motion::full;
  options.history = {.interval = 1e-5,
                     .lead = rig.has_stop() ? 5e-5 : 0.0,
                     .velocity_position = 0.6 + beyond,
                     .displacement_position = 0.35 + beyond,
                     .spot_slopes = true};
  return simulate(rig, solver, options).history;
}

using Values = std::vector<double> History::*;

/// By differences, as parts of the largest.
void expect_slopes(const Rig& rig, const Solver& solver,
                   const std::vector<std::pair<Values, Values>>& channels) {
  constexpr double step = 1e-4;
  const History here = with_slopes(rig, solver, 0.0), above = with_slopes(rig, solver, step),
                below = with_slopes(rig, solver, -step);
  for (std::size_t i = 0; i < channels.size(); ++i) {
    SCOPED_TRACE(i);
    const auto& [channel, slope] = channels[i];
    ASSERT_EQ((here.*slope).size(), (here.*channel).size());
    double largest = 0.0;
    for (const double each : here.*slope) largest = std::max(largest, std::abs(each));
    ASSERT_GT(largest, 0.0);
    for (std::size_t k = 0; k < (here.*slope).size(); ++k)
      EXPECT_NEAR((here.*slope)[k], ((above.*channel)[k] - (below.*channel)[k]) / (2.0 * step),
                  1e-5 * largest)
          << k;
  }
}

const std::vector<std::pair<Values, Values>> of_lasers = {
    {&History::velocity, &History::velocity_slope},
    {&History::displacement, &History::displacement_slope}};

TEST(History, TellsHowLargeMotionChangesAlongTheBar) {
  Rig rig = paper_rig();
  rig.gravity = 9.81;
  Solver solver = hybrid(Basis::cantilever, 4, 1e-9, 6e-4);
  solver.axial_modes = 2;
  expect_slopes(rig, solver, of_lasers);
  expect_slopes(rig, rigid(1e-9), of_lasers);
  expect_slopes(rig, ancf(5, 1, 1e-6, 6e-4), of_lasers);
  rig.stop = Stop{.mass = 0.1, .stiffness = 5e8, .viscous = 1e3};
  expect_slopes(rig, ancf(5, 1, 1e-6, 6e-4), of_lasers);
  rig.stop.reset();
  rig.beam.theory = BeamTheory::timoshenko;
  rig.beam.shear_coefficient = 0.9;
  rig.beam.poisson_ratio = 0.3;
  expect_slopes(rig, ancf(5, 1, 1e-6, 6e-4), of_lasers);
  expect_slopes(rig, hybrid(Basis::pinned_free, 4, 1e-9, 6e-4), of_lasers);
}

TEST(History, TellsHowATurnedBarsChangesAlongIt) {
  Rig rig = paper_rig();
  rig.contact.law = "none";
  rig.start = {};
  rig.beam.youngs_modulus *= 1e-3;
  rig.hinge.rotation = HingeRotation{.rate = 6.0, .time = 5e-3};
  auto channels = of_lasers;
  channels.emplace_back(&History::deflection, &History::deflection_slope);
  channels.emplace_back(&History::extension, &History::extension_slope);
  Solver solver = hybrid(Basis::cantilever, 4, 1e-9, 1e-2);
  solver.axial_modes = 2;
  expect_slopes(rig, solver, channels);
  expect_slopes(rig, ancf(5, 1, 1e-6, 1e-2), channels);
  rig.beam.theory = BeamTheory::timoshenko;
  rig.beam.shear_coefficient = 0.9;
  rig.beam.poisson_ratio = 0.3;
  expect_slopes(rig, ancf(5, 1, 1e-6, 1e-2), channels);
}

TEST(History, WithALeadInAFieldOfGravityIsASwing) {
  // backwards from touch as the small oscillation of the rigid bar, ω² = 3 g / 2 L
  Rig rig = paper_rig();
  rig.gravity = 9.81;
  SimulationOptions options;
  options.history = {.interval = 1e-3, .lead = 0.05};
  const History history = simulate(rig, rigid(1e-9), options).history;
  const double omega = std::sqrt(1.5 * 9.81 / 0.8);
  for (std::size_t k = 0; k <= 50; ++k) {
    const double t = history.start + 1e-3 * static_cast<double>(k);
    EXPECT_NEAR(history.velocity[k], 0.441 * std::cos(omega * t), 1e-14);
    EXPECT_NEAR(history.displacement[k], 0.441 / omega * std::sin(omega * t), 1e-15);
    EXPECT_NEAR(history.penetration[k], history.displacement[k], 1e-15);
  }
}

/// A rigid bar on a linear spring and damper: m x'' + c x' + k x = 0 from (0, v).
struct SpringAndDamper {
  double mass, stiffness, viscous, speed;

  double omega() const { return std::sqrt(stiffness / mass); }

  double damping() const { return viscous / (2.0 * mass); }

  double damped_omega() const { return std::sqrt(omega() * omega() - damping() * damping()); }

  double velocity(double t) const {
    const double w = damped_omega();
    return speed * std::exp(-damping() * t) * (std::cos(w * t) - damping() / w * std::sin(w * t));
  }
};

Rig sprung_rig(Tension tension) {
  Rig rig = paper_rig();
  rig.gravity = 0.0;
  rig.contact.law = "linear";
  rig.contact.stiffness = 1e7;
  rig.contact.damping = "viscous";
  rig.contact.viscous = 200.0;
  rig.contact.tension = tension;
  return rig;
}

Simulation at_once(const Rig& rig, double interval) {
  SimulationOptions options;
  options.history.interval = interval;
  return simulate(rig, rigid(1e-10), options);
}

TEST(ForceJumps, OfADamperAreItsForceAtTouchAndAtSeparation) {
  const Rig clipped = sprung_rig(Tension::clip);
  const SpringAndDamper body{clipped.effective_mass(0), 1e7, 200.0, clipped.start.velocity};
  const History clips = at_once(clipped, 1e-6).history;
  ASSERT_EQ(clips.jumps.size(), 1u);  // the force is let go where it is zero
  EXPECT_EQ(clips.jumps[0].time, 0.0);
  EXPECT_EQ(clips.jumps[0].before, 0.0);
  EXPECT_NEAR(clips.jumps[0].after, 200.0 * body.speed, 1e-9);
  const History pulls = at_once(sprung_rig(Tension::allow), 1e-6).history;
  ASSERT_EQ(pulls.jumps.size(), 2u);
  const double end = std::numbers::pi / body.damped_omega();
  EXPECT_NEAR(pulls.jumps[1].time, end, 1e-8 * end);
  EXPECT_NEAR(pulls.jumps[1].before, 200.0 * body.velocity(end), 1e-5);
  EXPECT_EQ(pulls.jumps[1].after, 0.0);
}

TEST(ForceJumps, OfDampingThatClosesOnlyAreAtTouch) {
  Rig rig = sprung_rig(Tension::clip);
  rig.contact.viscous.reset();
  rig.contact.damping = "jankowski";
  rig.contact.restitution = 0.6;
  const ContactForce contact(rig);
  const History history = at_once(rig, 1e-6).history;
  ASSERT_EQ(history.jumps.size(), 1u);  // at the deepest point the damping ends, but at no speed
  EXPECT_NEAR(
      history.jumps[0].after,
      2.0 * contact.damping_factor() * std::sqrt(rig.effective_mass(0) * 1e7) * rig.start.velocity,
      1e-9);
}

TEST(ForceJumps, AreNoneOfAForceThatIsContinuousNorOfASensorThatGivesWay) {
  Rig rig = sprung_rig(Tension::clip);
  rig.stop = Stop{.mass = 0.2, .stiffness = 1e9, .viscous = 5e3};
  EXPECT_TRUE(at_once(rig, 1e-6).history.jumps.empty());
  rig = paper_rig();
  rig.contact.damping = "hunt-crossley";
  rig.contact.restitution = 0.5;
  EXPECT_TRUE(at_once(rig, 1e-6).history.jumps.empty());
}

}  // namespace
