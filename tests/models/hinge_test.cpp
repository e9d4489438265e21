// SPDX-License-Identifier: BSD-3-Clause
// Spring and damper in the hinge: closed forms of the pendulum, the frequency equation of the
// spring-hinged bar, virtual work.
#include <gmock/gmock.h>

#include <cmath>

#include "models/beams/ancf.hpp"
#include "models/beams/floating_frame.hpp"
#include "models/mesh_error.hpp"
#include "models/modal/bar_cache.hpp"
#include "models/modal/modal_beam.hpp"
#include "models/rigid_swing.hpp"
#include "models/simulation.hpp"
#include "tests/models/scenes.hpp"
#include "tests/models/virtual_work.hpp"
#include "tests/support/frequency_root.hpp"

namespace {

using namespace impactrig::models;
using namespace impactrig::tests;
using testing::HasSubstr;

Rig held(double spring, double viscous) {
  Rig rig = paper_rig();
  rig.hinge = {.spring = spring, .viscous = viscous};
  return rig;
}

/// −(k φ + c φ̇) δφ along w, the hinge's angle φ(q) given: its derivatives by differences.
template <typename Angle>
double hinge_power(const Rig& rig, const RandomState& s, const Angle& angle) {
  const auto rate = [&](const Vector& along) {
    const auto central = [&](double h) {
      return (angle(s.q + h * along) - angle(s.q - h * along)) / (2.0 * h);
    };
    return (4.0 * central(5e-4) - central(1e-3)) / 3.0;
  };
  return -(rig.hinge.spring * angle(s.q) + rig.hinge.viscous * rate(s.v)) * rate(s.w);
}

TEST(Hinge, TurnsTheSlopeOfTheAncfBar) {
  Rig rig = held(7.0, 0.4);
  rig.beam.youngs_modulus = 1e6;
  Rig loose = rig;
  loose.hinge = {};
  AncfBeam beam(rig, {3, 2}), free(loose, {3, 2});
  const int n = beam.size() / 2;
  for (double angle : {0.0, 1.3, -2.5}) {
    const RandomState s = random_state(beam, 31, angle, 0.03);
    // the direction of the tangent, from −π to π
    const auto turned = [&](const Vector& q) { return std::atan2(-q[0], 1.0 - q[n]); };
    const double expected = hinge_power(rig, s, turned);
    EXPECT_NEAR(power_of_difference(beam, free, s.q, s.v, s.w) / expected, 1.0, 1e-8) << angle;
    EXPECT_NEAR(beam.energy(s.q, s.v).spring, 3.5 * std::pow(turned(s.q), 2), 1e-13);
    EXPECT_EQ(free.energy(s.q, s.v).spring, 0.0);
    Rig viscous = rig;
    viscous.hinge.spring = 0.0;
    AncfBeam damper(viscous, {3, 2});
    EXPECT_NEAR(damper.damping_power(s.q, s.v) / -power_of_difference(damper, free, s.q, s.v, s.v),
                1.0, 1e-9);
  }
}

TEST(Hinge, TurnsTheFrameAndTheSlopeInIt) {
  Rig rig = held(7.0, 0.4);
  rig.beam.youngs_modulus = 1e6;
  Rig loose = rig;
  loose.hinge = {};
  for (Basis basis : {Basis::cantilever, Basis::pinned_free}) {
    FloatingFrameBeam beam(rig, basis, 3, 1), free(loose, basis, 3, 1);
    const RandomState s = random_state(beam, 32, 0.8, 0.03);
    // direction of the axis just beside the hinge, small: the slope of a chord of 10 nm
    const auto turned = [&](const Vector& q) {
      Vector deformed = q;
      deformed[0] = 0.0;
      return -(q[0] - beam.point(1e-8, deformed, s.v).displacement / 1e-8);
    };
    const double expected = hinge_power(rig, s, turned);
    EXPECT_NEAR(power_of_difference(beam, free, s.q, s.v, s.w) / expected, 1.0, 1e-5);
    EXPECT_NEAR(beam.energy(s.q, s.v).spring / (3.5 * std::pow(turned(s.q), 2)), 1.0, 1e-5);
  }
}

// Hinged with a spring at one end, free at the other [Blevins1979]:
// κ (1 + cos z cosh z) = z (sin z cosh z − cos z sinh z), κ = k L / EI, z = βL.
double spring_hinged_root(double kappa, int number) {
  const double pi = std::numbers::pi;
  const auto equation = [&](double z) {
    return kappa * (1.0 / std::cosh(z) + std::cos(z)) -
           z * (std::sin(z) - std::cos(z) * std::tanh(z));
  };
  // between the cantilever's root of this number and the pinned bar's one before
  if (number == 1) return frequency_root(equation, 1e-3, 0.5 * pi + 0.31);
  return frequency_root(equation, (number - 0.75) * pi - 0.01, (number - 0.5) * pi + 0.02);
}

TEST(Hinge, WithASpringGivesTheBarItsFrequencies) {
  const double length = 0.8;
  for (double kappa : {1e-3, 0.5, 20.0}) {
    Rig rig = paper_rig();
    const double bending = rig.beam.youngs_modulus * rig.beam.second_moment;
    rig.hinge.spring = kappa * bending / length;
    const double unit = std::sqrt(bending / (rig.beam.density * rig.beam.area)) / (length * length);
    const AncfBeam chain(rig, {28, 4});
    const FloatingFrameBeam clamped(rig, Basis::cantilever, 20, 0);
    const FloatingFrameBeam pinned(rig, Basis::pinned_free, 40, 0);
    const ModalBeam a(chain, rig), b(clamped, rig), c(pinned, rig);
    const auto sorted = [](const ModalBeam& beam) {
      Vector omega = beam.omega();
      std::sort(omega.begin(), omega.end());
      return omega;
    };
    for (int k = 1; k <= 3; ++k) {
      const double exact = unit * std::pow(spring_hinged_root(kappa, k), 2);
      const double error = sorted(a)[k - 1] / exact - 1.0;
      EXPECT_GT(error, -1e-8) << kappa << ' ' << k;
      EXPECT_LT(error, 3e-6) << kappa << ' ' << k;
      // shapes that know no spring, or no moment at the hinge: from above, slowly
      EXPECT_GT(sorted(b)[k - 1] / exact - 1.0, -1e-8) << kappa << ' ' << k;
      EXPECT_LT(sorted(b)[k - 1] / exact - 1.0, 2e-3) << kappa << ' ' << k;
      EXPECT_GT(sorted(c)[k - 1] / exact - 1.0, -1e-8) << kappa << ' ' << k;
      EXPECT_LT(sorted(c)[k - 1] / exact - 1.0, 0.02) << kappa << ' ' << k;
    }
  }
}

TEST(RigidSwing, ArrivesAsTheClosedFormSays) {
  const double inertia = paper_rig().beam.hinge_inertia();
  // a spring alone: φ = −α cos ω t
  Rig rig = held(5.0, 0.0);
  const double omega = std::sqrt(5.0 / inertia);
  EXPECT_NEAR(*RigidSwing(rig).rate_after_release(0.3), 0.3 * omega, 1e-14);
  // with a damper: at touch α ω e^{−σ t}, tan(ν t) = −ν / σ, ν² = ω² − σ²
  for (double part : {1e-3, 0.3, 0.95}) {
    const double decay = part * omega;
    rig.hinge.viscous = 2.0 * decay * inertia;
    const double damped_omega = std::sqrt(omega * omega - decay * decay);
    const double time = (std::numbers::pi - std::atan(damped_omega / decay)) / damped_omega;
    const double expected = 0.3 * omega * std::exp(-decay * time);
    EXPECT_NEAR(*RigidSwing(rig).rate_after_release(0.3) / expected, 1.0, 1e-11) << part;
    rig.start.release_angle = 0.3;
    EXPECT_NEAR(touch_velocity(rig), 0.69 * expected, 1e-11);
  }
  rig.hinge.viscous = 2.0 * omega * inertia * 1.01;  // over-critical: it creeps up to the stop
  EXPECT_FALSE(RigidSwing(rig).rate_after_release(0.3).has_value());
}

TEST(RigidSwing, LeadsToTouchAsTheDampedOscillator) {
  Rig rig = held(5.0, 0.03);
  rig.gravity = 9.81;
  rig.beam.masses = {{0.8, 0.2}};
  const RigidSwing swing(rig);
  for (double viscous : {0.0, 0.03, 50.0}) {
    rig.hinge.viscous = viscous;
    const RigidSwing with(rig);
    EXPECT_EQ(with.near_touch(0.0, 2.0).angle, 0.0);
    EXPECT_EQ(with.near_touch(0.0, 2.0).rate, 2.0);
    const double h = 1e-4;
    for (double t : {-0.01, -0.001, 0.02}) {
      const auto s = with.near_touch(t, 1e-4);
      const double rate =
          (with.near_touch(t + h, 1e-4).angle - with.near_touch(t - h, 1e-4).angle) / (2.0 * h);
      const double bend =
          (with.near_touch(t + h, 1e-4).rate - with.near_touch(t - h, 1e-4).rate) / (2.0 * h);
      // differences of second order in h over the fastest time
      const double scale = std::abs(s.rate) * std::pow(h * (10.0 + viscous / 0.4), 2);
      EXPECT_NEAR(s.rate, rate, 1e-9 + scale);
      EXPECT_NEAR(bend, with.acceleration(s.angle, s.rate), 1e-7 + scale * (10.0 + viscous / 0.4));
    }
  }
}

TEST(Hinge, SpringBringsTheBarBackAfterHalfAPeriod) {
  Rig rig = paper_rig();
  rig.contact.damping = "exact";
  rig.contact.restitution = 0.5;
  EXPECT_EQ(simulate(rig, rigid(1e-9)).episodes.size(), 1u);
  const double half = 0.02;  // [s], of the swing
  rig.hinge.spring = rig.beam.hinge_inertia() * std::pow(std::numbers::pi / half, 2);
  for (Motion motion : {Motion::full, Motion::small}) {
    SimulationOptions options;
    options.motion = motion;
    const Simulation run = simulate(rig, rigid(1e-9), options);
    ASSERT_GE(run.episodes.size(), 3u);
    for (std::size_t i = 1; i < 3; ++i) {
      EXPECT_NEAR(run.episodes[i].start - run.episodes[i - 1].end, half, 1e-6);
      EXPECT_NEAR(run.episodes[i].approach_velocity / run.episodes[i - 1].separation_velocity, 1.0,
                  1e-6);
    }
    EXPECT_LT(std::abs(run.energy.imbalance), 1e-8);
    EXPECT_EQ(run.energy.damped, 0.0);
  }
}

TEST(Hinge, DamperTakesWhatTheSwingLoses) {
  // free after a short contact without loss, no gravity: I φ̇ decays as e^{−c t / I}
  Rig rig = held(0.0, 0.5);
  const double inertia = rig.beam.hinge_inertia();
  Solver solver = rigid(1e-11);
  solver.duration = 0.3;
  const Simulation run = simulate(rig, solver);
  EXPECT_EQ(run.energy.dissipated, 0.0);
  EXPECT_LT(std::abs(run.energy.imbalance), 1e-9);
  // damping acts in the contact too: as long as it lasts the rate is below that of the approach
  const double lost = 1.0 - std::exp(-2.0 * 0.5 / inertia * 0.3);
  EXPECT_NEAR(run.energy.damped / run.energy.initial, lost, 1e-3);
  const double flight = 0.3 - run.episodes[0].end;
  EXPECT_NEAR(run.energy.rigid_rotation,
              0.5 * inertia * std::pow(run.episodes[0].separation_velocity / 0.69, 2) *
                  std::exp(-2.0 * 0.5 / inertia * flight),
              1e-10);
}

TEST(Hinge, DampedSwingOfTheBarItselfArrivesAsTheRigidOne) {
  Rig rig = held(5.0, 0.2);
  rig.start.release_angle = 0.2;
  Solver solver = rigid(1e-11);
  solver.duration = 0.05;
  SimulationOptions exact;
  exact.exact = true;
  const Simulation swung = simulate(rig, solver, exact);
  const Simulation skipped = simulate(rig, solver);
  EXPECT_THAT(skipped.skipped, testing::Contains(HasSubstr("the rigid bar's damped swing gives")));
  EXPECT_NEAR(swung.episodes.at(0).approach_velocity / touch_velocity(rig), 1.0, 1e-9);
  // what the swing took before touch is not in the balance of the impact
  EXPECT_NEAR(swung.energy.damped / skipped.energy.damped, 1.0, 1e-8);
  EXPECT_LT(std::abs(swung.energy.imbalance), 1e-9);
}

TEST(Hinge, ChangesTheImpactAlikeInBothModels) {
  Rig rig = paper_rig();
  rig.contact.damping = "exact";
  rig.contact.restitution = 0.5;
  rig.contact.position = 0.2;  // where the hinge is near
  const Solver many = hybrid(Basis::cantilever, 30, 1e-7, 2e-3);
  const double bare = simulate(rig, many).impulse;
  rig.hinge = {.spring = 3e4, .viscous = 3.0};
  const Simulation limit = simulate(rig, many);
  EXPECT_GT(std::abs(limit.impulse / bare - 1.0), 0.02);
  const Simulation chain = simulate(rig, ancf(12, 24, 1e-7, 2e-3));
  EXPECT_NEAR(chain.impulse / limit.impulse, 1.0, 2e-3);
  EXPECT_NEAR(chain.energy.damped / limit.energy.damped, 1.0, 0.02);
  EXPECT_GT(limit.energy.damped, 0.01 * limit.energy.initial);
}

TEST(Hinge, ClosesTheEnergyBalanceInEveryModel) {
  Rig rig = held(2e3, 0.8);
  rig.gravity = 9.81;
  rig.beam.masses = {{0.8, 0.2}};
  rig.contact.damping = "lankarani-nikravesh";
  rig.contact.restitution = 0.5;
  Solver stiff = rigid(1e-11);
  stiff.duration = 2e-3;
  for (const Solver& solver :
       {stiff, hybrid(Basis::pinned_free, 6, 1e-11, 2e-3),
        hybrid(Basis::cantilever, 6, 1e-11, 2e-3), ancf(6, 2, 1e-11, 2e-3)}) {
    const Simulation run = simulate(rig, solver);
    EXPECT_LT(std::abs(run.energy.imbalance), 1e-9) << name(solver.model);
    EXPECT_GT(run.energy.damped, 1e-3 * run.energy.initial);
    EXPECT_GT(run.energy.spring, 0.0);
  }
}

// A damper in the hinge couples the modes, which small motion leaves out and tells.
TEST(Hinge, SpringAndDamperAreInSmallMotion) {
  SimulationOptions full, small;
  full.motion = Motion::full;
  small.motion = Motion::small;
  double neglected = 0.0;
  for (const double viscous : {0.0, 1e-3, 0.05})
    for (Solver solver : {ancf(10, 2, 1e-10, 2e-3), hybrid(Basis::cantilever, 8, 1e-10, 2e-3)}) {
      Rig rig = held(2e3, viscous);
      rig.gravity = 9.81;
      SCOPED_TRACE(testing::Message() << viscous << " " << name(solver.model));
      const Simulation a = simulate(rig, solver, full);
      const Simulation b = simulate(rig, solver, small);
      EXPECT_LT(std::abs(b.energy.imbalance), 1e-9);
      EXPECT_LT(b.neglected, 1e-5 + 0.05 * viscous);
      EXPECT_NEAR(b.peak_force / a.peak_force, 1.0, b.neglected);
      EXPECT_NEAR(b.episodes.at(0).impulse / a.episodes.at(0).impulse, 1.0, b.neglected);
      EXPECT_NEAR(b.episodes.at(0).end / a.episodes.at(0).end, 1.0, b.neglected);
      // the estimate speaks of the time until the last contact ends
      Solver until = solver;
      until.duration = b.episodes.back().end;
      const double spring = simulate(rig, until, full).energy.spring;
      EXPECT_NEAR(simulate(rig, until, small).energy.spring / a.energy.initial,
                  spring / a.energy.initial, b.neglected);
      if (solver.model != BeamModel::hybrid) continue;
      EXPECT_GT(b.neglected, 2.0 * neglected);
      neglected = b.neglected;
    }
}

TEST(Hinge, IsAnotherBarToTheCache) {
  Rig rig = paper_rig();
  BarCache cache;
  SimulationOptions options;
  options.motion = Motion::small;
  options.bars = &cache;
  const Solver solver = ancf(6, 2, 1e-6, 1e-3);
  const double loose = simulate(rig, solver, options).impulse;
  rig.hinge.spring = 1e5;
  const double sprung = simulate(rig, solver, options).impulse;
  EXPECT_NE(sprung, loose);
  options.bars = nullptr;
  EXPECT_EQ(simulate(rig, solver, options).impulse, sprung);
}

TEST(Hinge, ASpringThatBendsTheBarIsSwungWithTheBar) {
  Rig rig = held(1.0, 0.0);
  rig.start.release_angle = 0.05;
  Solver solver = hybrid(Basis::cantilever, 2, 1e-8, 3e-4);
  solver.accuracy = 1e-3;
  EXPECT_THAT(simulate(rig, solver).skipped, testing::Contains(HasSubstr("the swing from")));
  // k L / 3 EI = 0.002, which moves the peak by 8e-3
  rig.hinge.spring = 20.0;
  EXPECT_THAT(simulate(rig, solver).skipped, testing::IsEmpty());
  solver.accuracy = 1e-8;
  rig.hinge.spring = 2e3;  // k L / 3 EI = 0.2
  const Simulation swung = simulate(rig, solver);
  EXPECT_THAT(swung.skipped, testing::IsEmpty());
  EXPECT_GT(std::abs(swung.episodes.at(0).approach_velocity / touch_velocity(rig) - 1.0), 0.02);
  EXPECT_LT(std::abs(swung.energy.imbalance), 1e-7);
}

}  // namespace
