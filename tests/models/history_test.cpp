// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

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

}  // namespace
