// SPDX-License-Identifier: BSD-3-Clause
//
// Derivatives of swings and of turned hinges against differences of runs at accuracy 1e-12, of the
// sixth order in the parameter, which know nothing of sensitivities.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "models/rigid_swing.hpp"
#include "models/simulation.hpp"
#include "tests/models/differences.hpp"
#include "tests/models/scenes.hpp"

namespace impactrig::tests {
namespace {

using namespace models;

/// A soft bar hanging from its hinge, let go 0.8 rad from there.
Rig swinging_rig() {
  Rig rig = paper_rig();
  rig.contact.law = rig.contact.damping = "none";
  rig.contact.position = rig.beam.length;
  rig.beam.youngs_modulus = 2e9;
  rig.start = {.release_angle = 0.8};
  rig.gravity = 9.81;
  return rig;
}

/// Arm of [SimoVuQuoc1986], ten times as stiff and turned up sooner.
Rig turned_rig() {
  Rig rig;
  rig.beam = {.length = 10.0,
              .area = 0.01,
              .second_moment = 5e-6,
              .youngs_modulus = 2.8e10,
              .density = 120.0};
  rig.contact.law = rig.contact.damping = "none";
  rig.contact.position = rig.beam.length;
  rig.gravity = 9.81;
  rig.start.release_angle = 0.4;
  rig.hinge.rotation = HingeRotation{.rate = 3.0, .time = 1.0};
  return rig;
}

Simulation swing(const Rig& rig, const Solver& solver, double interval,
                 std::vector<RigParameter> by = {}) {
  SimulationOptions options;
  options.exact = true;
  options.motion = Motion::full;
  options.history.interval = interval;
  options.history.velocity_position = 0.5;
  options.sensitivities = std::move(by);
  return simulate(rig, solver, options);
}

using Channel = std::vector<double> History::*;

constexpr std::array shown = {&History::velocity, &History::displacement, &History::deflection,
                              &History::extension};

/// Without a stop the struck point is the tip.
Rig moved(const Rig& rig, const Named& parameter, double by) {
  Rig there = rig;
  parameter.of(there) += by;
  there.contact.position = there.beam.length;
  return there;
}

/// Expects the derivatives of all that a history shows, relative to the larger of the channel's own
/// size over the parameter's and of the derivative. Of velocity and extension, which vibration
/// along the axis rounds to some 1e-12, differences are three times less exact. `spacing`: theirs,
/// a part of the parameter.
void expect_equal_swings(const Rig& rig, const Solver& solver, double interval,
                         std::span<const Named> of, double spacing) {
  std::vector<RigParameter> by;
  for (const Named& parameter : of) by.push_back(parameter.of);
  const Simulation run = swing(rig, solver, interval, by);
  ASSERT_EQ(run.sensitivities.size(), of.size());
  constexpr std::array offsets = {-3.0, -2.0, -1.0, 1.0, 2.0, 3.0};
  constexpr std::array weights = {-1.0, 9.0, -45.0, 45.0, -9.0, 1.0};
  for (std::size_t i = 0; i < of.size(); ++i) {
    SCOPED_TRACE(of[i].name);
    Rig copy = rig;
    const double size = std::abs(of[i].of(copy));
    ASSERT_GT(size, 0.0);
    std::array<History, 6> runs;
    for (std::size_t j = 0; j < runs.size(); ++j)
      runs[j] = swing(moved(rig, of[i], offsets[j] * spacing * size), solver, interval).history;
    for (std::size_t c = 0; c < shown.size(); ++c) {
      const std::vector<double>& values = run.history.*shown[c];
      const std::vector<double>& slopes = run.sensitivities[i].history.*shown[c];
      ASSERT_EQ(slopes.size(), values.size());
      double scale = 0.0, worst = 0.0;
      std::size_t at = 0;
      for (std::size_t k = 0; k < values.size(); ++k) {
        double difference = 0.0;
        for (std::size_t j = 0; j < runs.size(); ++j)
          difference += weights[j] * (runs[j].*shown[c])[k] / (60.0 * spacing);
        scale = std::max({scale, std::abs(values[k]), std::abs(slopes[k]) * size});
        const double off = std::abs(slopes[k] * size - difference);
        if (off > worst) {
          worst = off;
          at = k;
        }
      }
      if (values.empty() || scale == 0.0) continue;
      EXPECT_LT(worst / scale, c == 0 || c == 3 ? 3e-8 : 1e-8)
          << "channel " << c << ", sample " << at;
    }
  }
}

constexpr std::array of_swing = {
    Named{"release angle", [](Rig& r) -> double& { return *r.start.release_angle; }},
    Named{"gravity", [](Rig& r) -> double& { return r.gravity; }},
    Named{"density", [](Rig& r) -> double& { return r.beam.density; }},
    Named{"beam length", [](Rig& r) -> double& { return r.beam.length; }},
    Named{"area", [](Rig& r) -> double& { return r.beam.area; }},
    Named{"spring", [](Rig& r) -> double& { return r.hinge.spring; }},
    Named{"viscous hinge", [](Rig& r) -> double& { return r.hinge.viscous; }},
    Named{"mass", [](Rig& r) -> double& { return r.beam.masses[0].mass; }},
    Named{"mass damping", [](Rig& r) -> double& { return r.beam.damping.mass; }},
    Named{"youngs_modulus", [](Rig& r) -> double& { return r.beam.youngs_modulus; }},
    Named{"second moment", [](Rig& r) -> double& { return r.beam.second_moment; }},
    Named{"stiffness damping", [](Rig& r) -> double& { return r.beam.damping.stiffness; }},
};

// What a rigid bar does not know are the last three.
constexpr std::size_t of_rigid_swing = of_swing.size() - 3;

Rig damped_swinging_rig() {
  Rig rig = swinging_rig();
  rig.hinge = {.spring = 3.0, .viscous = 0.05};
  rig.beam.damping = {.mass = 0.3, .stiffness = 1e-4};
  rig.beam.masses = {{0.3, 0.3}};
  return rig;
}

TEST(FreeSensitivities, OfARigidSwingAreThoseOfDifferences) {
  Solver solver = rigid(1e-12);
  solver.duration = 1.5;
  expect_equal_swings(damped_swinging_rig(), solver, 0.05,
                      std::span(of_swing).first(of_rigid_swing), 1e-3);
}

TEST(FreeSensitivities, OfASwingingBarAreThoseOfDifferences) {
  const Rig rig = damped_swinging_rig();
  expect_equal_swings(rig, ancf(3, 0, 1e-12, 0.1), 0.005, of_swing, 8e-4);
  expect_equal_swings(rig, hybrid(Basis::pinned_free, 3, 1e-12, 0.1), 0.005, of_swing, 8e-4);
}

TEST(FreeSensitivities, OfASwingingBarThatShearsAreThoseOfDifferences) {
  Rig rig = damped_swinging_rig();
  rig.beam.theory = BeamTheory::timoshenko;
  rig.beam.shear_coefficient = 0.9;
  expect_equal_swings(rig, ancf(2, 0, 1e-12, 0.1), 0.005, of_swing, 8e-4);
  constexpr std::array of = {
      Named{"shear_coefficient", [](Rig& r) -> double& { return r.beam.shear_coefficient; }}};
  expect_equal_swings(rig, ancf(2, 0, 1e-12, 0.1), 0.005, of, 3e-4);
}

TEST(FreeSensitivities, OfAThrownBarAreThoseOfDifferences) {
  Rig rig = swinging_rig();
  rig.start = {.velocity = 2.0, .release_angle = {}};
  constexpr std::array of = {
      Named{"velocity", [](Rig& r) -> double& { return r.start.velocity; }},
      Named{"beam length", [](Rig& r) -> double& { return r.beam.length; }},
      Named{"density", [](Rig& r) -> double& { return r.beam.density; }},
  };
  expect_equal_swings(rig, ancf(3, 0, 1e-12, 0.1), 0.005, of, 3e-4);
  expect_equal_swings(rig, hybrid(Basis::cantilever, 3, 1e-12, 0.1), 0.005, of, 3e-4);
}

constexpr std::array of_friction = {
    Named{"friction", [](Rig& r) -> double& { return r.hinge.friction; }},
    Named{"release angle", [](Rig& r) -> double& { return *r.start.release_angle; }},
    Named{"gravity", [](Rig& r) -> double& { return r.gravity; }},
    Named{"density", [](Rig& r) -> double& { return r.beam.density; }},
};

// The rigid bar turns back until it stays where it comes to rest; the soft bar's hinge sticks and
// breaks loose while it vibrates.
TEST(FreeSensitivities, OfARubbingHingeAreThoseOfDifferences) {
  Rig rig = swinging_rig();
  rig.hinge.friction = 1.5;
  Solver solver = rigid(1e-12);
  solver.duration = 3.0;
  expect_equal_swings(rig, solver, 0.05, of_friction, 1e-4);
  rig.beam.damping.stiffness = 1e-4;
  expect_equal_swings(rig, ancf(2, 0, 1e-12, 0.3), 0.01, of_friction, 1e-3);
  expect_equal_swings(rig, hybrid(Basis::pinned_free, 2, 1e-12, 0.3), 0.01, of_friction, 1e-3);
}

constexpr std::array of_turned_hinge = {
    Named{"rate", [](Rig& r) -> double& { return r.hinge.rotation->rate; }},
    Named{"time", [](Rig& r) -> double& { return r.hinge.rotation->time; }},
    Named{"release angle", [](Rig& r) -> double& { return *r.start.release_angle; }},
    Named{"beam length", [](Rig& r) -> double& { return r.beam.length; }},
    Named{"gravity", [](Rig& r) -> double& { return r.gravity; }},
    Named{"youngs_modulus", [](Rig& r) -> double& { return r.beam.youngs_modulus; }},
    Named{"second moment", [](Rig& r) -> double& { return r.beam.second_moment; }},
    Named{"density", [](Rig& r) -> double& { return r.beam.density; }},
    Named{"stiffness damping", [](Rig& r) -> double& { return r.beam.damping.stiffness; }},
};

TEST(FreeSensitivities, OfATurnedHingeAreThoseOfDifferences) {
  Rig rig = turned_rig();
  rig.beam.damping.stiffness = 1e-3;
  Solver solver = rigid(1e-12);
  solver.duration = 1.5;
  expect_equal_swings(rig, solver, 0.1, std::span(of_turned_hinge).first(4), 1e-3);
  expect_equal_swings(rig, hybrid(Basis::cantilever, 3, 1e-12, 1.5), 0.1, of_turned_hinge, 3e-4);
  expect_equal_swings(rig, ancf(2, 0, 1e-12, 1.5), 0.1, of_turned_hinge, 3e-4);
  rig.beam.theory = BeamTheory::timoshenko;
  rig.beam.shear_coefficient = 0.85;
  expect_equal_swings(rig, ancf(2, 0, 1e-12, 1.5), 0.1, of_turned_hinge, 3e-4);
}

// At the full rate from the beginning: stretched by that.
TEST(FreeSensitivities, OfABarThatSpinsFromTheBeginningAreThoseOfDifferences) {
  Rig rig = turned_rig();
  rig.hinge.rotation->time = 0.0;
  rig.beam.damping.stiffness = 1e-3;
  constexpr std::array of = {
      Named{"rate", [](Rig& r) -> double& { return r.hinge.rotation->rate; }},
      Named{"density", [](Rig& r) -> double& { return r.beam.density; }},
  };
  Solver stretching = hybrid(Basis::cantilever, 2, 1e-12, 0.5);
  stretching.axial_modes = 2;
  expect_equal_swings(rig, stretching, 0.05, of, 6e-4);
  expect_equal_swings(rig, ancf(2, 0, 1e-12, 0.5), 0.05, of, 6e-4);
  const std::vector<RigParameter> time = {of_turned_hinge[1].of};
  EXPECT_TRUE(swing(rig, ancf(2, 0, 1e-6, 0.5), 0.05, time).sensitivities.empty());
}

// Two places of a stencil would find the bar pulled by straight ways through its turn.
TEST(FreeSensitivities, AreAsAccurateAsTheRun) {
  Rig shearing = turned_rig();
  shearing.beam.theory = BeamTheory::timoshenko;
  shearing.beam.shear_coefficient = 0.85;
  for (const Rig& rig : {swinging_rig(), turned_rig(), shearing}) {
    const double duration = rig.hinge.rotation ? 1.0 : 0.2;
    const auto displacement = [&](double accuracy, const Named& by) {
      return swing(rig, ancf(2, 0, accuracy, duration), duration / 5.0, {by.of})
          .sensitivities.at(0)
          .history.displacement;
    };
    for (const Named& by : {of_swing[0], of_swing[1]}) {
      SCOPED_TRACE(by.name);
      const std::vector<double> exact = displacement(1e-9, by), plain = displacement(1e-6, by);
      const double largest = std::abs(
          *std::ranges::max_element(exact, {}, [](double value) { return std::abs(value); }));
      for (std::size_t k = 0; k < exact.size(); ++k)
        EXPECT_NEAR(plain[k] / largest, exact[k] / largest, 1e-5) << k;
    }
  }
}

// x of a rigid pendulum let go from a small angle: φ(t) = φ0 cos ωt.
TEST(FreeSensitivities, OfASmallSwingAreThoseOfAPendulum) {
  Rig rig = swinging_rig();
  rig.start.release_angle = 1e-4;
  Solver solver = rigid(1e-12);
  solver.duration = 1.0;
  const Simulation run = swing(rig, solver, 0.1, {of_swing[0].of, of_swing[1].of});
  const double omega = std::sqrt(rig.beam.first_moment() * rig.gravity / rig.beam.hinge_inertia());
  for (std::size_t k = 0; k <= 10; ++k) {
    const double t = 0.1 * static_cast<double>(k), length = rig.beam.length;
    EXPECT_NEAR(run.sensitivities[0].history.displacement[k], -length * std::cos(omega * t), 1e-7);
    EXPECT_NEAR(run.sensitivities[1].history.displacement[k] * rig.gravity,
                1e-4 * length * 0.5 * omega * t * std::sin(omega * t), 1e-11);
  }
}

// Small motion of a swing has none: the full equations are solved for them.
TEST(FreeSensitivities, AreTakenFromTheFullEquations) {
  const Rig rig = swinging_rig();
  Solver solver = rigid(1e-2);
  solver.duration = 0.5;
  Rig slow = rig;
  slow.start.release_angle = 1e-3;
  SimulationOptions options;
  options.history.interval = 0.1;
  EXPECT_TRUE(simulate(slow, solver, options).small_motion);
  options.sensitivities = {of_swing[0].of};
  const Simulation run = simulate(slow, solver, options);
  EXPECT_FALSE(run.small_motion);
  EXPECT_EQ(run.sensitivities.at(0).history.displacement.size(), 6U);
  EXPECT_TRUE(std::isnan(run.sensitivities[0].peak_force));
  options.motion = Motion::small;
  EXPECT_TRUE(simulate(slow, solver, options).sensitivities.empty());
}

}  // namespace
}  // namespace impactrig::tests
