// SPDX-License-Identifier: BSD-3-Clause
// Bars that meet no stop: Jacobi's pendulum, the beams' own equations integrated explicitly, the
// damped pendulum's energy.
#include <gmock/gmock.h>

#include <algorithm>
#include <boost/math/special_functions/ellint_1.hpp>
#include <boost/math/special_functions/jacobi_elliptic.hpp>
#include <boost/numeric/odeint.hpp>
#include <cmath>
#include <memory>
#include <vector>

#include "models/make_beam.hpp"
#include "models/rigid_swing.hpp"
#include "models/simulation.hpp"
#include "tests/models/scenes.hpp"

namespace {

using namespace impactrig::models;
using namespace impactrig::tests;
using testing::HasSubstr;
using Vector = Eigen::VectorXd;

Rig free_rig(double release) {
  Rig rig = paper_rig();
  rig.contact.law = "none";
  rig.contact.position = rig.beam.length;
  rig.gravity = 9.81;
  rig.start.release_angle = release;
  return rig;
}

SimulationOptions sampled(double interval) {
  SimulationOptions options;
  options.history.interval = interval;
  return options;
}

/// Sine of the angle of a pendulum let go at rest: sin(θ/2) = k cd(ω t, k), k² the energy as a part
/// of what carries it over the top. [DLMF2010, 22.19]
double swung(double square, double phase) {
  const double k = std::sqrt(square);
  return std::sin(-2.0 * std::asin(k * boost::math::jacobi_cd(k, phase)));
}

// Three periods, in which an error of the energy grows to one of the phase: no more than if all the
// energy had the error allowed.
TEST(FreeSwing, OfTheRigidBarIsJacobisPendulum) {
  for (const double release : {0.2, 1.5, 2.9})
    for (const double accuracy : {1e-4, 1e-7, 1e-10}) {
      const Rig rig = free_rig(release);
      const double square = std::pow(std::sin(0.5 * release), 2);
      const double omega = std::sqrt(1.5 * rig.gravity / rig.beam.length);
      Solver solver = rigid(accuracy);
      solver.duration = 12.0 * boost::math::ellint_1(std::sqrt(square)) / omega;
      const Simulation run = simulate(rig, solver, sampled(*solver.duration / 300.0));
      ASSERT_EQ(run.history.displacement.size(), 301U);
      EXPECT_TRUE(run.history.force.empty());
      EXPECT_TRUE(run.episodes.empty());
      double worst = 0.0, allowed = accuracy;
      for (std::size_t i = 0; i <= 300; ++i) {
        const double phase = omega * run.history.interval * static_cast<double>(i);
        const double exact = swung(square, phase);
        worst = std::max(worst, std::abs(run.history.displacement[i] / rig.beam.length - exact));
        allowed = std::max(allowed, std::abs(swung(square * (1.0 - accuracy), phase) - exact));
      }
      EXPECT_LT(worst, allowed) << release << ' ' << accuracy;
      EXPECT_LT(std::abs(run.energy.imbalance), accuracy);
      // let go at rest, it has only what the weight gives
      const double weight = rig.beam.first_moment() * rig.gravity;
      EXPECT_NEAR(run.energy.initial / (weight * (1.0 - std::cos(release))), 1.0, 1e-12);
    }
}

/// The tip of a beam by an explicit method of another family, at times k interval.
std::vector<double> explicit_tip(const Rig& rig, const Solver& solver, double interval, int count) {
  const std::unique_ptr<BeamDynamics> beam = make_beam(rig, solver);
  const int n = beam->size();
  using State = std::vector<double>;
  State y(static_cast<std::size_t>(2 * n));
  const double rate = rig.start.release_angle ? 0.0 : rig.start.velocity / rig.contact.position;
  beam->set_steady_motion(-rig.start.release_angle.value_or(0.0), rate,
                          Eigen::Map<Vector>(y.data(), n), Eigen::Map<Vector>(y.data() + n, n));
  const auto slope = [&](const State& s, State& d, double) {
    const Eigen::Map<const Vector> q(s.data(), n), v(s.data() + n, n);
    std::copy(s.begin() + n, s.end(), d.begin());
    beam->acceleration(q, v, 0.0, Eigen::Map<Vector>(d.data() + n, n));
  };
  std::vector<double> tip;
  const auto look = [&](const State& s, double) {
    const Eigen::Map<const Vector> q(s.data(), n), v(s.data() + n, n);
    tip.push_back(beam->point(rig.beam.length, q, v).displacement);
  };
  namespace odeint = boost::numeric::odeint;
  odeint::integrate_const(
      odeint::make_controlled<odeint::runge_kutta_fehlberg78<State>>(1e-11, 1e-11), slope, y, 0.0,
      interval * (count + 0.5), interval, look);
  return tip;
}

// Soft bars that bend by a tenth of their length while they swing through more than a right angle.
TEST(FreeSwing, OfAFlexibleBarMeetsItsExplicitSolution) {
  for (const double accuracy : {1e-4, 1e-7})
    for (const bool thrown : {false, true})
      for (Solver solver :
           {ancf(4, 0, accuracy, 0.6), hybrid(Basis::cantilever, 3, accuracy, 0.6)}) {
        Rig rig = free_rig(1.4);
        rig.beam.youngs_modulus = 3e6;
        if (thrown) {
          rig.start.release_angle.reset();
          rig.start.velocity = 3.0;
        }
        const double interval = 2e-3;
        const Simulation run = simulate(rig, solver, sampled(interval));
        const std::vector<double> tip = explicit_tip(rig, solver, interval, 300);
        SCOPED_TRACE(testing::Message() << name(solver.model) << ' ' << thrown << ' ' << accuracy);
        ASSERT_GE(tip.size(), 301U);
        ASSERT_EQ(run.history.displacement.size(), 301U);
        double worst = 0.0;
        for (std::size_t i = 0; i <= 300; ++i)
          worst = std::max(worst, std::abs(run.history.displacement[i] - tip[i]));
        EXPECT_LT(worst, accuracy * rig.beam.length);
        EXPECT_LT(std::abs(run.energy.imbalance), 10.0 * accuracy);
        EXPECT_GT(run.energy.vibration, 1e-4 * run.energy.initial);
      }
}

// A stiff bar let go straight vibrates by 1e-6 of its length, a thousand times in a swing: steps go
// over that where it is not asked for. Reference: eight stages instead of four, every period in
// steps.
TEST(FreeSwing, StepsOverVibrationThatCountsForNothing) {
  const Rig rig = free_rig(0.3);
  const auto swing = [&](double accuracy) {
    SimulationOptions options = sampled(1e-2);
    options.motion = Motion::full;
    return simulate(rig, ancf(8, 0, accuracy, 1.0), options);
  };
  const Simulation reference = swing(1e-9);
  for (const auto& [accuracy, most_steps] : {std::pair{1e-3, 600L}, {1e-4, 1000L}}) {
    const Simulation run = swing(accuracy);
    ASSERT_EQ(run.history.displacement.size(), reference.history.displacement.size());
    double worst = 0.0;
    for (std::size_t i = 0; i < run.history.displacement.size(); ++i)
      worst = std::max(worst,
                       std::abs(run.history.displacement[i] - reference.history.displacement[i]));
    EXPECT_LT(worst, accuracy * rig.beam.length) << accuracy;
    EXPECT_LT(std::abs(run.energy.imbalance), accuracy);
    EXPECT_LT(run.cost.steps, most_steps) << accuracy;
  }
  EXPECT_GT(reference.cost.steps, 10000);
}

// I φ̈ = −S g sin φ − c φ̇: what the hinge takes is what is missing.
TEST(FreeSwing, LosesWhatTheHingeTakes) {
  Rig rig = free_rig(1.0);
  rig.hinge.viscous = 0.05;
  Solver solver = rigid(1e-9);
  solver.duration = 5.0;
  const Simulation run = simulate(rig, solver, sampled(1e-4));
  double taken = 0.0;
  for (std::size_t i = 0; i + 1 < run.history.velocity.size(); ++i) {
    const auto rate_squared = [&](std::size_t k) {  // of the tip's way across, v = L φ̇ cos φ
      const double sine = run.history.displacement[k] / rig.beam.length;
      const double v = run.history.velocity[k] / rig.beam.length;
      return v * v / (1.0 - sine * sine);
    };
    taken += 0.5e-4 * rig.hinge.viscous * (rate_squared(i) + rate_squared(i + 1));
  }
  EXPECT_NEAR(run.energy.damped / taken, 1.0, 1e-6);
  EXPECT_GT(run.energy.damped, 0.2 * run.energy.initial);
  const double left = run.energy.initial - run.energy.damped;
  EXPECT_NEAR(run.energy.kinetic + RigidSwing(rig).potential(std::asin(
                                       run.history.displacement.back() / rig.beam.length)),
              left, 1e-6 * run.energy.initial);
}

// A bar that begins stretched by its turning has a little more energy than a straight one.
TEST(FreeSwing, EnergiesAddUpToThoseAtItsStart) {
  Rig rig = free_rig(0.0);
  rig.start = {};
  rig.start.velocity = 12.0;
  rig.beam.youngs_modulus = 2e7;
  Solver solver = ancf(8, 0, 1e-8, 0.2);
  SimulationOptions exact;
  exact.exact = true;
  const EnergyAudit energy = simulate(rig, solver, exact).energy;
  EXPECT_GT(energy.elastic_at_start, 1e-5 * energy.initial);
  EXPECT_NEAR((energy.kinetic + energy.elastic + energy.gravitational + energy.damped) /
                  (energy.initial + energy.elastic_at_start),
              1.0, 1e-7);
}

TEST(FreeSwing, SaysWhatItNeeds) {
  const auto sentence = [](const Rig& rig, const Solver& solver, Motion motion) -> std::string {
    SimulationOptions options;
    options.motion = motion;
    try {
      simulate(rig, solver, options);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  Solver solver = rigid(1e-6);
  EXPECT_EQ(sentence(free_rig(1.0), solver, Motion::full),
            "solver.duration: is missing: without [contact] the bar swings for as long as stated");
  solver.duration = 0.1;
  Rig sprung = free_rig(1.0);
  sprung.hinge.spring = 1.0;
  EXPECT_EQ(sentence(sprung, solver, Motion::small),
            "small motion was asked for, but it does not know hinge.spring without a stop; ask for "
            "the full equations");
  Rig rig = free_rig(1.0);
  rig.stop = Stop{.mass = 1.0, .stiffness = 1e8, .viscous = 0.0};
  EXPECT_EQ(sentence(rig, solver, Motion::full),
            "stop.mass: there is no [contact] that could press on the stop");
  rig = free_rig(1.0);
  rig.gravity_direction = -1.0;  // it hangs as it is let go
  EXPECT_EQ(sentence(rig, solver, Motion::full),
            "start.release_angle: neither weight nor spring would move the bar from there");
}

}  // namespace
