// SPDX-License-Identifier: BSD-3-Clause
// A hinge that is turned as stated: closed forms, the linear theory of a spinning beam by
// Galerkin's method, the spin-up of [KaneEtAl1987] and [SimoVuQuoc1986].
#include <gmock/gmock.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <boost/numeric/odeint.hpp>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "models/simulation.hpp"
#include "tests/models/scenes.hpp"

namespace {

using namespace impactrig::models;
using namespace impactrig::tests;

/// Robot arm of [SimoVuQuoc1986]: EA 2.8e7 N, EI 1.4e4 N m², 1.2 kg/m, 10 m, up to 6 rad/s in 15 s;
/// `harder` times as stiff.
Rig arm(double harder = 1.0) {
  Rig rig;
  rig.beam = {.length = 10.0,
              .area = 0.01,
              .second_moment = 5e-6,
              .youngs_modulus = 2.8e9 * harder,
              .density = 120.0};
  rig.contact.law = rig.contact.damping = "none";
  rig.contact.position = rig.beam.length;
  rig.gravity = 0.0;
  rig.hinge.rotation = HingeRotation{.rate = 6.0, .time = 15.0};
  return rig;
}

Solver rigid_for(double duration) {
  Solver solver = rigid(1e-8);
  solver.duration = duration;
  return solver;
}

SimulationOptions sampled(double interval) {
  SimulationOptions options;
  options.history.interval = interval;
  return options;
}

/// Tip of ρA (ẅ + Ω̇ x − Ω² w) + EI w'''' − (N w')' = 0, N = ½ ρA Ω² (L² − x²), at times k
/// interval; w = Σ b_k (x/L)^{k+1}.
std::vector<double> linear_tip(const Rig& rig, double interval, int count) {
  constexpr int terms = 6;
  const Beam& beam = rig.beam;
  const double length = beam.length, line = beam.density * beam.area;
  const double bending = beam.youngs_modulus * beam.second_moment;
  Eigen::MatrixXd mass(terms, terms), stiffness(terms, terms), tension(terms, terms);
  Eigen::VectorXd load(terms);
  for (int i = 1; i <= terms; ++i) {
    load[i - 1] = line * length * length / (i + 3.0);
    for (int j = 1; j <= terms; ++j) {
      const double slopes = (i + 1.0) * (j + 1.0);
      mass(i - 1, j - 1) = line * length / (i + j + 3.0);
      stiffness(i - 1, j - 1) = bending / std::pow(length, 3) * slopes * i * j / (i + j - 1.0);
      tension(i - 1, j - 1) =
          0.5 * line * length * slopes * (1.0 / (i + j + 1.0) - 1.0 / (i + j + 3.0));
    }
  }
  const Eigen::MatrixXd inverse = mass.llt().solve(Eigen::MatrixXd::Identity(terms, terms));
  const Eigen::MatrixXd springs = inverse * stiffness;
  const Eigen::MatrixXd spinning = inverse * (tension - mass);
  const Eigen::VectorXd thrown = inverse * load;
  using State = std::vector<double>;
  const HingeRotation& rotation = *rig.hinge.rotation;
  const auto slope = [&](const State& y, State& d, double t) {
    const Eigen::Map<const Eigen::VectorXd> b(y.data(), terms);
    const double square = std::pow(rotation.rate_at(t), 2);
    std::copy(y.begin() + terms, y.end(), d.begin());
    Eigen::Map<Eigen::VectorXd>(d.data() + terms, terms) =
        -springs * b - square * (spinning * b) - rotation.acceleration_at(t) * thrown;
  };
  std::vector<double> tip;
  const auto look = [&](const State& y, double) {
    tip.push_back(Eigen::Map<const Eigen::VectorXd>(y.data(), terms).sum());
  };
  State y(2 * terms, 0.0);
  namespace odeint = boost::numeric::odeint;
  odeint::integrate_const(
      odeint::make_controlled<odeint::runge_kutta_fehlberg78<State>>(1e-10, 1e-10), slope, y, 0.0,
      interval * (count + 0.5), interval, look);
  return tip;
}

TEST(SpinUp, TurnsAsStated) {
  const HingeRotation rotation{.rate = 6.0, .time = 15.0};
  const double h = 1e-3;
  for (const double t : {0.5, 3.0, 7.5, 14.9, 15.0, 15.1, 20.0}) {
    const double wave = 15.0 / (2.0 * std::numbers::pi);
    const double stated =
        t <= 15.0 ? 6.0 / 15.0 * (0.5 * t * t + wave * wave * (std::cos(t / wave) - 1.0))
                  : 6.0 * (t - 7.5);
    EXPECT_NEAR(rotation.angle_at(t), stated, 1e-12);
    EXPECT_NEAR((rotation.angle_at(t + h) - rotation.angle_at(t - h)) / (2.0 * h),
                rotation.rate_at(t), 1e-7);
    EXPECT_NEAR((rotation.rate_at(t + h) - rotation.rate_at(t - h)) / (2.0 * h),
                rotation.acceleration_at(t), 1e-7);
  }
  EXPECT_EQ(rotation.angle_at(0.0), 0.0);
  const HingeRotation at_once{.rate = -2.0};
  EXPECT_EQ(at_once.angle_at(3.0), -6.0);
  EXPECT_EQ(at_once.rate_at(0.0), -2.0);
}

// The work that turns it is ½ I Ω², and what lifts it.
TEST(SpinUp, OfARigidBarTakesItsKineticEnergy) {
  Rig rig = arm();
  rig.gravity = 9.81;
  rig.start.release_angle = 0.4;
  const Simulation run = simulate(rig, rigid_for(17.3), sampled(0.1));
  for (std::size_t i = 0; i < run.history.displacement.size(); ++i) {
    const double t = 0.1 * static_cast<double>(i);
    const double angle = rig.hinge.rotation->angle_at(t) - 0.4;
    EXPECT_NEAR(run.history.displacement[i], 10.0 * std::sin(angle), 1e-6);
    EXPECT_NEAR(run.history.velocity[i], 10.0 * rig.hinge.rotation->rate_at(t) * std::cos(angle),
                1e-5);
    EXPECT_NEAR(run.history.deflection[i], 0.0, 1e-12);
    EXPECT_NEAR(run.history.extension[i], 0.0, 1e-12);
  }
  const double angle = rig.hinge.rotation->angle_at(17.3) - 0.4;
  const double lifted = rig.beam.first_moment() * 9.81 * (std::cos(-0.4) - std::cos(angle));
  const double kinetic = 0.5 * rig.beam.hinge_inertia() * 36.0;
  EXPECT_NEAR(run.energy.driven / (kinetic + lifted), 1.0, 1e-8);
  EXPECT_NEAR(run.energy.initial, kinetic, 1e-9);
  EXPECT_LT(std::abs(run.energy.imbalance), 1e-8);
}

// A hundred times as stiff it hardly bends: 6 mm, and linear theory holds.
TEST(SpinUp, OfAStiffArmIsThatOfLinearTheory) {
  const Rig rig = arm(100.0);
  const std::vector<double> tip = linear_tip(rig, 0.1, 80);
  const double largest = -*std::min_element(tip.begin(), tip.end());
  EXPECT_NEAR(largest, 0.0055, 0.001);
  const auto expect_linear = [&](const Rig& bar, const Solver& solver) {
    const Simulation run = simulate(bar, solver, sampled(0.1));
    SCOPED_TRACE(testing::Message() << name(solver.model) << ' ' << name(bar.beam.theory));
    ASSERT_EQ(run.history.deflection.size(), 81U);
    for (std::size_t i = 0; i <= 80; ++i)
      EXPECT_NEAR(run.history.deflection[i], tip[i], 1e-3 * largest) << i;
    EXPECT_LT(std::abs(run.energy.imbalance), 1e-5);
  };
  expect_linear(rig, hybrid(Basis::cantilever, 5, 1e-7, 8.0));
  expect_linear(rig, ancf(4, 0, 1e-6, 8.0));
  Rig shearing = rig;  // by 1.5e-5 of the length
  shearing.beam.theory = BeamTheory::timoshenko;
  shearing.beam.shear_coefficient = 0.85;
  expect_linear(shearing, ancf(2, 0, 1e-5, 8.0));
}

// As built it lags 0.57 m behind, six per cent of its length, and spins faster than its first mode
// vibrates (3.8 rad/s): without the tension of the centrifugal force it would fold. Linear theory
// leaves out squares of the slope.
TEST(SpinUp, OfTheArmAsBuiltIsThatOfLinearTheoryToSecondOrder) {
  const Rig rig = arm();
  const std::vector<double> tip = linear_tip(rig, 0.1, 200);
  const double largest = -*std::min_element(tip.begin(), tip.end());
  EXPECT_NEAR(largest, 0.575, 0.01);
  std::vector<std::vector<double>> deflections;
  for (Solver solver : {hybrid(Basis::cantilever, 5, 1e-6, 20.0), ancf(4, 0, 1e-4, 20.0)}) {
    const Simulation run = simulate(rig, solver, sampled(0.1));
    SCOPED_TRACE(name(solver.model));
    for (std::size_t i = 0; i <= 200; ++i)
      EXPECT_NEAR(run.history.deflection[i], tip[i], 0.02 * largest) << i;
    EXPECT_LT(std::abs(run.energy.imbalance), 1e-5);
    deflections.push_back(run.history.deflection);
  }
  for (std::size_t i = 0; i <= 200; ++i)
    EXPECT_NEAR(deflections[0][i], deflections[1][i], 0.01 * largest) << i;
}

// A bar that spins steadily: ρ Ω² (x + u) + E u'' = 0, u(L) = tan(kL) / k − L, k² = ρ Ω² / E.
// ANCF's stress EA ε of Green's strain differs by a part ε of that, axial modes by what they leave
// out.
TEST(SpinUp, StretchesTheBar) {
  Rig rig = arm();
  rig.beam.damping.stiffness = 2e-3;  // what vibrates dies
  rig.beam.youngs_modulus = 2.8e8;
  rig.beam.second_moment = 5e-4;
  const double length = rig.beam.length;
  const double k = std::sqrt(120.0 * 36.0 / 2.8e8);
  const double expected = std::tan(k * length) / k - length;
  EXPECT_NEAR(expected, 5.1e-3, 1e-4);
  Solver stretching = hybrid(Basis::cantilever, 2, 1e-7, 17.0);
  stretching.axial_modes = 6;
  for (const Solver& solver : {stretching, ancf(4, 0, 1e-5, 17.0)}) {
    const Simulation run = simulate(rig, solver, sampled(1.0));
    SCOPED_TRACE(name(solver.model));
    EXPECT_NEAR(run.history.extension.back() / expected, 1.0, 2e-3);
    EXPECT_NEAR(run.history.deflection.back(), 0.0, 1e-5 * length);
    EXPECT_LT(std::abs(run.energy.imbalance), 1e-5);
  }
}

// Without a spin-up it begins as it goes on: stretched, at the rate stated at the hinge.
TEST(SpinUp, AtOnceIsSteady) {
  Rig rig = arm();
  rig.hinge.rotation->time = 0.0;
  const double length = rig.beam.length;
  const double k = std::sqrt(120.0 * 36.0 / 2.8e9);
  const double expected = std::tan(k * length) / k - length;
  Solver stretching = hybrid(Basis::cantilever, 2, 1e-7, 1.0);
  stretching.axial_modes = 6;
  for (const Solver& solver : {stretching, ancf(4, 0, 1e-6, 1.0)}) {
    const Simulation run = simulate(rig, solver, sampled(0.1));
    SCOPED_TRACE(name(solver.model));
    for (std::size_t i = 0; i <= 10; ++i) {
      EXPECT_NEAR(run.history.extension.at(i) / expected, 1.0, 2e-3) << i;
      EXPECT_NEAR(run.history.deflection.at(i), 0.0, 1e-6 * length) << i;
    }
    const double begun = run.history.velocity.front() / (length + run.history.extension.front());
    EXPECT_NEAR(begun, 6.0, 1e-9);
    EXPECT_LT(std::abs(run.energy.driven), 1e-6 * run.energy.initial);
  }
}

TEST(SpinUp, TheOtherWayIsTheMirrorImage) {
  Rig rig = arm();
  const Solver solver = hybrid(Basis::pinned_free, 4, 1e-7, 8.0);
  const History forth = simulate(rig, solver, sampled(0.5)).history;
  rig.hinge.rotation->rate = -6.0;
  const History back = simulate(rig, solver, sampled(0.5)).history;
  ASSERT_EQ(back.deflection.size(), 17U);
  for (std::size_t i = 0; i < 17; ++i) {
    EXPECT_NEAR(back.deflection[i], -forth.deflection[i], 1e-9);
    EXPECT_NEAR(back.extension[i], forth.extension[i], 1e-9);
    EXPECT_NEAR(back.displacement[i], -forth.displacement[i], 1e-9);
  }
}

// Masses, segments, shear, damping, gravity from the side: the work of the drive is in the balance.
TEST(SpinUp, BalancesItsEnergy) {
  Rig rig = arm(10.0);
  rig.gravity = 9.81;
  rig.gravity_direction = 1.0;
  rig.hinge.rotation->time = 3.0;
  rig.beam.masses = {{6.0, 2.0}, {10.0, 1.0}};
  rig.beam.damping = {.mass = 0.1, .stiffness = 1e-3};
  for (const Solver& solver : {hybrid(Basis::cantilever, 4, 1e-7, 4.0),
                               hybrid(Basis::pinned_free, 4, 1e-7, 4.0), ancf(4, 0, 1e-5, 4.0)}) {
    const Simulation run = simulate(rig, solver);
    EXPECT_LT(std::abs(run.energy.imbalance), 10.0 * solver.accuracy) << name(solver.model);
    EXPECT_GT(run.energy.damped, 1e-3 * run.energy.initial);
  }
  rig.beam.theory = BeamTheory::timoshenko;
  rig.beam.shear_coefficient = 0.85;
  for (const Solver& solver : {hybrid(Basis::cantilever, 4, 1e-7, 4.0), ancf(4, 0, 1e-5, 4.0)})
    EXPECT_LT(std::abs(simulate(rig, solver).energy.imbalance), 10.0 * solver.accuracy)
        << name(solver.model);
}

TEST(SpinUp, RefusesWhatItDoesNotGoWith) {
  const auto sentence = [](const std::function<void(Rig&)>& change) -> std::string {
    Rig rig = arm();
    change(rig);
    try {
      simulate(rig, rigid_for(1.0));
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(sentence([](Rig&) {}), "");
  EXPECT_EQ(sentence([](Rig& r) { r.hinge.rotation->rate = 0.0; }),
            "hinge.rotation.rate: must be finite and not zero, found 0 rad/s");
  EXPECT_EQ(sentence([](Rig& r) { r.hinge.rotation->time = -1.0; }),
            "hinge.rotation.time: must be finite and not negative, found -1 s");
  const std::string nothing =
      ": changes nothing where hinge.rotation states how the hinge turns; leave it out";
  EXPECT_EQ(sentence([](Rig& r) { r.hinge.spring = 1.0; }), "hinge.spring" + nothing);
  EXPECT_EQ(sentence([](Rig& r) { r.hinge.viscous = 1.0; }), "hinge.viscous" + nothing);
  EXPECT_EQ(sentence([](Rig& r) { r.hinge.friction = 1.0; }), "hinge.friction" + nothing);
  EXPECT_EQ(sentence([](Rig& r) { r.start.velocity = 1.0; }),
            "start.velocity: hinge.rotation states how the bar starts; leave it out");
  EXPECT_EQ(sentence([](Rig& r) {
              r = paper_rig();
              r.start.velocity = 0.0;
              r.hinge.rotation = HingeRotation{.rate = 1.0};
            }),
            "hinge.rotation: a hinge that is turned as stated would press the bar against the stop "
            "without limit; leave [contact] out");
}

}  // namespace
