// SPDX-License-Identifier: BSD-3-Clause
// Coulomb friction in the hinge: closed forms of the rigid bar, an explicit method with a smoothed
// law for flexible ones, where it may be left out and where not.
#include <gmock/gmock.h>

#include <boost/math/tools/toms748_solve.hpp>
#include <boost/numeric/odeint.hpp>
#include <cmath>
#include <complex>
#include <memory>
#include <numbers>
#include <vector>

#include "models/hinge_friction.hpp"
#include "models/make_beam.hpp"
#include "models/rigid_swing.hpp"
#include "models/simulation.hpp"
#include "tests/models/scenes.hpp"

namespace {

using namespace impactrig::models;
using namespace impactrig::tests;
using testing::Contains;
using testing::HasSubstr;
using Vector = Eigen::VectorXd;

/// Without stop and gravity, thrown.
Rig thrown(double friction) {
  Rig rig = paper_rig();
  rig.contact.law = "none";
  rig.contact.position = rig.beam.length;
  rig.start.velocity = 1.0;
  rig.hinge.friction = friction;
  return rig;
}

Rig released(double angle, double friction) {
  Rig rig = thrown(friction);
  rig.gravity = 9.81;
  rig.start.release_angle = angle;
  return rig;
}

SimulationOptions full(double interval = 0.0) {
  SimulationOptions options;
  options.history.interval = interval;
  options.motion = Motion::full;
  return options;
}

// I φ̈ = −T until it stands, after I ω² / 2T.
TEST(HingeFriction, StopsARigidBarAsTheClosedFormSays) {
  const Rig rig = thrown(0.3);
  const double inertia = rig.beam.hinge_inertia(), length = rig.beam.length;
  const double rate = rig.start.velocity / length, stops = inertia * rate / 0.3;
  for (const double accuracy : {1e-3, 1e-6, 1e-10}) {
    Solver solver = rigid(accuracy);
    solver.duration = 2.0 * stops;
    const Simulation run = simulate(rig, solver, full(stops / 100.0));
    ASSERT_EQ(run.history.displacement.size(), 201U);
    for (std::size_t i = 0; i <= 200; ++i) {
      const double t = std::min(run.history.interval * static_cast<double>(i), stops);
      const double angle = rate * t - 0.15 / inertia * t * t;
      EXPECT_NEAR(run.history.displacement[i], length * std::sin(angle), 1e-12) << i;
      EXPECT_NEAR(run.history.velocity[i], length * std::cos(angle) * (rate - 0.3 / inertia * t),
                  1e-12)
          << i;
    }
    EXPECT_NEAR(run.energy.damped / run.energy.initial, 1.0, 1e-13);
    EXPECT_LT(run.energy.kinetic, 1e-30);
  }
}

// From turn to turn S g (cos φ' − cos φ) = T (|φ| + |φ'|), until S g sin φ < T holds it.
TEST(HingeFriction, TakesFromThePendulumWithEverySwing) {
  const double friction = 0.8;
  const Rig rig = released(1.2, friction);
  const double weight = rig.beam.first_moment() * rig.gravity;
  double angle = -1.2, way = 0.0;
  int swings = 0;
  for (; weight * std::abs(std::sin(angle)) > friction; ++swings) {
    const auto left = [&](double other) {
      return weight * (std::cos(other) - std::cos(angle)) - friction * (other + std::abs(angle));
    };
    const double top = std::abs(angle);
    ASSERT_GT(left(0.0), 0.0);  // it comes through
    std::uintmax_t most = 100;
    const auto found = boost::math::tools::toms748_solve(
        left, 0.0, top, boost::math::tools::eps_tolerance<double>(50), most);
    way += found.first + top;
    angle = std::copysign(found.first, -angle);
  }
  ASSERT_GE(swings, 4);
  for (const double accuracy : {1e-4, 1e-8, 1e-11}) {
    Solver solver = rigid(accuracy);
    solver.duration = 10.0;
    const Simulation run = simulate(rig, solver, full(0.5));
    const double rest = rig.beam.length * std::sin(angle);
    EXPECT_NEAR(run.history.displacement.back(), rest, 3.0 * accuracy);
    EXPECT_EQ(run.history.displacement.back(), run.history.displacement[19]);
    EXPECT_LT(run.energy.kinetic, 1e-30);
    EXPECT_NEAR(run.energy.damped / (friction * way), 1.0, accuracy);
    EXPECT_LT(std::abs(run.energy.imbalance), accuracy);
  }
}

TEST(HingeFriction, HoldsABarThatPullsLess) {
  const double moment = paper_rig().beam.first_moment() * 9.81 * std::sin(0.4);
  Solver solver = rigid(1e-8);
  solver.duration = 0.5;
  const Simulation held = simulate(released(0.4, 1.001 * moment), solver, full(0.1));
  for (const double displacement : held.history.displacement)
    EXPECT_EQ(displacement, held.history.displacement.front());
  EXPECT_EQ(held.energy.damped, 0.0);
  const Simulation slips = simulate(released(0.4, 0.999 * moment), solver, full(0.1));
  // I φ̈ is what is left, 0.001 of the moment, and grows little
  const double way = slips.history.displacement[1] - slips.history.displacement[0];
  const double acceleration = 0.001 * moment / paper_rig().beam.hinge_inertia();
  EXPECT_NEAR(way / (0.5 * acceleration * 0.01 * 0.8 * std::cos(0.4)), 1.0, 0.1);
}

/// The tip by an explicit method, with friction T φ̇ / √(φ̇² + ε²): the hinge's damper tells what a
/// moment on it does.
std::vector<double> smoothed_tip(const Rig& rig, const Solver& solver, double slow, double interval,
                                 int count) {
  Rig bare = rig;
  bare.hinge = {};
  Rig braked = bare;
  braked.hinge.viscous = 1.0;
  const std::unique_ptr<BeamDynamics> beam = make_beam(bare, solver);
  const std::unique_ptr<BeamDynamics> damper = make_beam(braked, solver);
  const int n = beam->size();
  using State = std::vector<double>;
  State y(static_cast<std::size_t>(2 * n));
  const double rate = rig.start.release_angle ? 0.0 : rig.start.velocity / rig.contact.position;
  beam->set_steady_motion(-rig.start.release_angle.value_or(0.0), rate,
                          Eigen::Map<Vector>(y.data(), n), Eigen::Map<Vector>(y.data() + n, n));
  Vector a(n), other(n);
  const auto slope = [&](const State& s, State& d, double) {
    const Eigen::Map<const Vector> q(s.data(), n), v(s.data() + n, n);
    std::copy(s.begin() + n, s.end(), d.begin());
    beam->acceleration(q, v, 0.0, a);
    damper->acceleration(q, v, 0.0, other);
    const double square = damper->damping_power(q, v);  // φ̇²
    Eigen::Map<Vector>(d.data() + n, n) =
        a + rig.hinge.friction / std::sqrt(square + slow * slow) * (other - a);
  };
  std::vector<double> tip;
  const auto look = [&](const State& s, double) {
    const Eigen::Map<const Vector> q(s.data(), n), v(s.data() + n, n);
    tip.push_back(beam->point(rig.beam.length, q, v).displacement);
  };
  namespace odeint = boost::numeric::odeint;
  odeint::integrate_const(odeint::make_controlled<odeint::runge_kutta_dopri5<State>>(1e-9, 1e-9),
                          slope, y, 0.0, interval * (count + 0.5), interval, look);
  return tip;
}

// A soft bar swings, sticks at its turns and breaks loose as it vibrates. What the smoothed law
// does differently lasts while the hinge turns slower than ε.
TEST(HingeFriction, OfAFlexibleBarIsTheLimitOfASmoothedLaw) {
  Rig rig = released(0.5, 0.4);
  rig.beam.youngs_modulus = 2e7;
  const double interval = 0.01;
  const auto expect_limit = [&](const Rig& bar, const Solver& solver) {
    const Simulation run = simulate(bar, solver, full(interval));
    SCOPED_TRACE(testing::Message() << name(solver.model) << ' ' << name(bar.beam.theory));
    ASSERT_EQ(run.history.displacement.size(), 81U);
    std::vector<double> errors;
    for (const double slow : {0.03, 0.003}) {  // [rad/s]
      const std::vector<double> tip = smoothed_tip(bar, solver, slow, interval, 80);
      double worst = 0.0;
      for (std::size_t i = 0; i <= 80; ++i)
        worst = std::max(worst, std::abs(run.history.displacement[i] - tip[i]));
      errors.push_back(worst);
    }
    EXPECT_LT(errors[1], 0.3 * errors[0]);
    EXPECT_LT(errors[1], 0.003 * bar.beam.length);
    EXPECT_LT(std::abs(run.energy.imbalance), 1e-6);
    EXPECT_GT(run.energy.damped, 0.2 * run.energy.initial);
  };
  expect_limit(rig, ancf(3, 0, 1e-6, 0.8));
  expect_limit(rig, hybrid(Basis::cantilever, 3, 1e-6, 0.8));
  expect_limit(rig, hybrid(Basis::pinned_free, 3, 1e-6, 0.8));
  Rig shearing = rig;
  shearing.beam.theory = BeamTheory::timoshenko;
  shearing.beam.shear_coefficient = 0.886;
  expect_limit(shearing, ancf(1, 0, 1e-6, 0.8));
}

TEST(HingeFriction, OfAnImpactConvergesWithTheAccuracy) {
  Rig rig = paper_rig();
  rig.contact.damping = "exact";
  rig.contact.restitution = 0.5;
  rig.hinge.friction = 1.0;
  for (Solver solver : {rigid(0.0), hybrid(Basis::cantilever, 5, 0.0, 1.0), ancf(6, 1, 0.0, 1.0)}) {
    const auto first = [&](double accuracy) {
      solver.accuracy = accuracy;
      solver.duration = 1e-3;
      const Simulation run = simulate(rig, solver, full());
      EXPECT_LT(std::abs(run.energy.imbalance), std::max(accuracy, 1e-9)) << accuracy;
      EXPECT_GT(run.energy.damped, 0.0);
      return run.episodes.at(0);
    };
    const Episode exact = first(1e-11);
    for (const double accuracy : {1e-3, 1e-5, 1e-7, 1e-9}) {
      const Episode found = first(accuracy);
      SCOPED_TRACE(testing::Message() << name(solver.model) << ' ' << accuracy);
      EXPECT_NEAR(found.peak_force / exact.peak_force, 1.0, accuracy);
      EXPECT_NEAR(found.end / exact.end, 1.0, accuracy);
      EXPECT_NEAR(found.impulse / exact.impulse, 1.0, accuracy);
      EXPECT_NEAR(found.separation_velocity / exact.separation_velocity, 1.0, 10.0 * accuracy);
    }
  }
}

// A spring that stops a rigid bar: friction takes T ∫|φ̇| dt, against the closing and then the
// opening hinge; the rebound's energy lacks it.
TEST(HingeFriction, TakesFromTheReboundOfARigidBar) {
  Rig rig = paper_rig();
  rig.contact.law = "linear";
  rig.contact.stiffness = 1e4;
  rig.hinge.friction = 2.0;
  const double inertia = rig.beam.hinge_inertia(), place = rig.contact.position;
  const double stiffness = rig.contact.stiffness * place * place;
  const double rate = rig.start.velocity / place;
  // ½ I ω² = T φ + ½ k φ² at the turn; half of it is lost on the way back
  const double turn = (std::sqrt(4.0 + stiffness * inertia * rate * rate) - 2.0) / stiffness;
  const double back = std::sqrt((stiffness * turn * turn - 4.0 * turn) / inertia);
  const Simulation run = simulate(rig, rigid(1e-10), full());
  EXPECT_NEAR(run.episodes.at(0).separation_velocity / (place * back), 1.0, 1e-6);
  EXPECT_NEAR(run.episodes.at(0).max_penetration / (place * turn), 1.0, 1e-6);
}

/// A rigid bar against a spring with a damper that acts in approach only: I φ̈ = −T − K φ − C φ̇
/// until the turn, then I φ̈ = T − K φ. The turn is an event of the contact's and of the hinge's at
/// once.
struct TurningWithTheContact {
  Rig rig = paper_rig();
  double place, inertia, rate, natural;
  double shift;  ///< T/K, from where the spring pulls to where it would rest [rad]
  double turn;   ///< [s]
  double deepest;

  /// Friction as a part of the largest moment that the spring would have without loss.
  TurningWithTheContact(double e, double friction) {
    rig.contact.law = "linear";
    rig.contact.stiffness = 1e8;  // (sin φ)/φ is 1 to 1e-10
    rig.contact.damping = "jankowski";
    rig.contact.restitution = e;
    inertia = rig.beam.hinge_inertia();
    place = rig.contact.position;
    rate = rig.start.velocity / place;
    natural = place * std::sqrt(rig.contact.stiffness / inertia);
    rig.hinge.friction = friction * inertia * natural * rate;
    const double factor =
        4.5 * std::sqrt(5.0) * (1.0 - e * e) / (e * (e * (9.0 * std::numbers::pi - 16.0) + 16.0));
    const std::complex<double> damped = natural * std::sqrt(std::complex(1.0 - factor * factor));
    shift = rig.hinge.friction / (natural * natural * inertia);
    // φ̇ = 0 where tan(ω't) = rate ω' / (ω² shift + ζω rate)
    const std::complex<double> tangent =
        rate * damped / (natural * natural * shift + factor * natural * rate);
    turn = (std::atan(tangent) / damped).real();
    // φ + shift = e^(-ζωt) (shift cos(ω't) + (rate + ζω shift)/ω' sin(ω't))
    const std::complex<double> swing =
        shift * std::cos(damped * turn) +
        (rate + factor * natural * shift) / damped * std::sin(damped * turn);
    deepest = std::exp(-factor * natural * turn) * swing.real() - shift;
  }
};

TEST(HingeFriction, TurnsWithTheContact) {
  for (const double friction : {0.003, 0.01, 0.03})
    for (const double e : {0.1, 0.3, 0.8}) {
      const TurningWithTheContact bar(e, friction);
      ASSERT_GT(bar.deepest, 2.0 * bar.shift);
      const double back = std::acos(-bar.shift / (bar.deepest - bar.shift)) / bar.natural;
      const double leaves =
          (bar.deepest - bar.shift) * std::sin(bar.natural * back) * bar.natural * bar.place;
      for (const double accuracy : {1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9}) {
        const Simulation run = simulate(bar.rig, rigid(accuracy), full());
        const Episode& episode = run.episodes.at(0);
        SCOPED_TRACE(testing::Message() << friction << ' ' << e << ' ' << accuracy);
        EXPECT_NEAR(episode.max_penetration / (bar.place * bar.deepest), 1.0, accuracy);
        EXPECT_NEAR((episode.end - episode.start) / (bar.turn + back), 1.0, accuracy);
        EXPECT_NEAR(episode.separation_velocity / leaves, 1.0, 10.0 * accuracy);
      }
    }
}

// The spring's moment breaks the hinge loose, and leaves it stuck half a period later as far beyond
// T/K. Until the turn ∫ f = I rate − T t, on the way back T t, then the rest.
TEST(HingeFriction, SticksBehindTheTurn) {
  for (const double friction : {0.15, 0.3, 0.4, 0.5})
    for (const double e : {0.2, 0.3, 0.5, 0.9}) {
      const TurningWithTheContact bar(e, friction);
      if (bar.deepest <= bar.shift || bar.deepest >= 2.0 * bar.shift) continue;
      const double torque = bar.rig.hinge.friction;
      const double half = std::numbers::pi / bar.natural;
      const double rests = 2.0 * bar.shift - bar.deepest, rests_for = 0.3 * half;
      const double moments = bar.inertia * bar.rate - torque * bar.turn + torque * half +
                             bar.natural * bar.natural * bar.inertia * rests * rests_for;
      for (const double accuracy : {1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9}) {
        Solver solver = rigid(accuracy);
        solver.duration = bar.turn + half + rests_for;
        const Simulation run = simulate(bar.rig, solver, full());
        SCOPED_TRACE(testing::Message() << friction << ' ' << e << ' ' << accuracy);
        EXPECT_EQ(run.episodes.size(), 1U);
        EXPECT_NEAR(run.episodes.at(0).impulse / (moments / bar.place), 1.0, accuracy);
      }
    }
}

TEST(HingeFriction, TakesFromTheSwingBeforeTheImpact) {
  Rig rig = paper_rig();
  rig.gravity = 9.81;
  rig.start.release_angle = 0.3;
  rig.hinge.friction = 0.4;
  const double weight = rig.beam.first_moment() * 9.81;
  const double energy = weight * (1.0 - std::cos(0.3)) - 0.4 * 0.3;
  const double expected = 0.69 * std::sqrt(2.0 * energy / rig.beam.hinge_inertia());
  EXPECT_NEAR(touch_velocity(rig) / expected, 1.0, 1e-14);
  Solver solver = rigid(1e-11);
  solver.duration = 1e-3;
  SimulationOptions exact;
  exact.exact = true;
  const Simulation swung = simulate(rig, solver, exact);
  EXPECT_NEAR(swung.episodes.at(0).approach_velocity / expected, 1.0, 1e-9);
  EXPECT_THAT(simulate(rig, solver).skipped,
              Contains(HasSubstr("the rigid bar's damped swing gives")));
  rig.hinge.viscous = 0.1;
  const Simulation braked = simulate(rig, solver, exact);
  EXPECT_NEAR(braked.episodes.at(0).approach_velocity / touch_velocity(rig), 1.0, 1e-9);
  EXPECT_LT(touch_velocity(rig), 0.95 * expected);
}

TEST(HingeFriction, MayKeepTheBarFromTheStop) {
  Rig rig = paper_rig();
  rig.gravity = 9.81;
  rig.start.release_angle = 0.3;
  const double weight = rig.beam.first_moment() * 9.81;
  const auto sentence = [&](double friction) -> std::string {
    rig.hinge.friction = friction;
    try {
      touch_velocity(rig);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  const double enough = weight * (1.0 - std::cos(0.3)) / 0.3;  // takes all on the way
  EXPECT_EQ(sentence(0.999 * enough), "");
  for (const double friction : {1.001 * enough, 1.001 * weight * std::sin(0.3)})
    EXPECT_THAT(sentence(friction),
                testing::HasSubstr("released at 17.1887 degrees the bar does not swing against the "
                                   "stop: weight and hinge.spring do not turn it there, "
                                   "hinge.friction holds it"));
  rig.hinge.friction = -1.0;
  EXPECT_THROW(validate(rig, rigid(1e-6)), std::invalid_argument);
}

TEST(HingeFriction, IsLeftOutOfSmallMotionOnlyWhereItCannotMatter) {
  Rig rig = paper_rig();
  rig.contact.damping = "exact";
  rig.contact.restitution = 0.5;
  rig.hinge.friction = 0.01;
  Solver solver = ancf(6, 1, 1e-3, 1e-3);
  const Simulation small = simulate(rig, solver);
  ASSERT_TRUE(small.small_motion);
  EXPECT_THAT(small.skipped, Contains(HasSubstr("friction in the hinge from first touch on")));
  EXPECT_EQ(small.energy.damped, 0.0);
  EXPECT_THAT(small.taken, Contains(Simplification::hinge_friction));
  SimulationOptions kept;
  kept.kept = {Simplification::hinge_friction};
  EXPECT_FALSE(simulate(rig, solver, kept).small_motion);
  rig.hinge.friction = 0.0;
  EXPECT_TRUE(simulate(rig, solver, kept).small_motion);
  EXPECT_THAT(simulate(rig, solver).skipped, Not(Contains(HasSubstr("friction"))));
  // the same scene with less, and more friction than the accuracy lets pass
  for (const double friction : {0.01, 0.1, 1.0, 10.0}) {
    rig.hinge.friction = friction;
    SimulationOptions options;
    options.motion = Motion::small;
    const Simulation without = simulate(rig, solver, options);
    solver.accuracy = 1e-8;
    const Simulation with = simulate(rig, solver, full());
    const Episode &a = without.episodes.at(0), &b = with.episodes.at(0);
    SCOPED_TRACE(friction);
    EXPECT_LT(std::abs(a.peak_force / b.peak_force - 1.0), without.neglected);
    EXPECT_LT(std::abs(a.end / b.end - 1.0), without.neglected);
    EXPECT_LT(std::abs(a.impulse / b.impulse - 1.0), without.neglected);
    solver.accuracy = 0.5 * without.neglected;
    if (solver.accuracy <= 0.1) {
      EXPECT_FALSE(simulate(rig, solver).small_motion);
    }
    solver.accuracy = 1e-3;
  }
}

TEST(HingeFriction, ActsBehindAStopThatGivesWay) {
  Rig rig = paper_rig();
  rig.stop = Stop{.mass = 0.05, .stiffness = 2e8, .viscous = 100.0};
  rig.hinge.friction = 5.0;
  const Solver solver = hybrid(Basis::pinned_free, 4, 1e-8, 2e-3);
  const Simulation run = simulate(rig, solver, full());
  EXPECT_LT(std::abs(run.energy.imbalance), 1e-8);
  rig.stop->viscous = 0.0;
  EXPECT_GT(simulate(rig, solver, full()).energy.damped, 0.01 * run.energy.initial);
}

// Before touch the bar was faster: φ̇ = ω + T |t| / I.
TEST(HingeFriction, LeadsToTouchWithADeceleration) {
  Rig rig = paper_rig();
  rig.hinge.friction = 3.0;
  SimulationOptions options = full(1e-4);
  options.history.lead = 1e-2;
  Solver solver = rigid(1e-6);
  solver.duration = 1e-3;
  const History history = simulate(rig, solver, options).history;
  const double speed = 0.441 + 0.69 * 3.0 / rig.beam.hinge_inertia() * 1e-2;
  EXPECT_NEAR(history.velocity.front(), speed, 1e-12);
  EXPECT_NEAR(history.displacement.front(), -0.5e-2 * (0.441 + speed), 1e-12);
  EXPECT_NEAR(history.penetration.front(), -0.5e-2 * (0.441 + speed), 1e-12);
}

// Over a step of unit length, values at its nodes.
TEST(HingeFriction, ChangesWhereTheHingeRestsOrBreaksLoose) {
  const Collocation& rule = Collocation::of(8, Collocation::Nodes::radau);
  const auto at_nodes = [&](auto&& f) -> NodeVector { return rule.points().unaryExpr(f); };
  HingeFriction friction(2.0);
  friction.start(1.0);
  EXPECT_EQ(friction.moment(), -2.0);
  const auto turning = at_nodes([](double x) { return 0.3 - x * x; });
  EXPECT_NEAR(friction.change(rule, turning).part, std::sqrt(0.3), 1e-14);
  EXPECT_EQ(friction.change(rule, turning).to, HingeFriction::State::sticks);
  EXPECT_GT(friction.change(rule, at_nodes([](double x) { return 1.1 - x; })).part, 1.0);
  friction.start(-1.0);
  EXPECT_EQ(friction.moment(), 2.0);
  EXPECT_NEAR(friction.change(rule, -turning).part, std::sqrt(0.3), 1e-14);
  friction.start(0.0);
  EXPECT_TRUE(friction.sticks());
  const auto held = at_nodes([](double x) { return 1.0 - 6.0 * x * x; });
  EXPECT_NEAR(friction.change(rule, held).part, std::sqrt(0.5), 1e-7);
  EXPECT_EQ(friction.change(rule, held).to, HingeFriction::State::closes);
  EXPECT_EQ(friction.change(rule, -held).to, HingeFriction::State::opens);
  const auto too_much = at_nodes([](double x) { return 2.1 - x; });
  EXPECT_EQ(friction.change(rule, too_much).part, 0.0);
  EXPECT_EQ(friction.change(rule, too_much).to, HingeFriction::State::opens);
  // a slide that is over at once makes one that way doubtful, and no other
  for (const auto slides : {HingeFriction::State::opens, HingeFriction::State::closes}) {
    friction.follow({.part = 0.0, .to = slides});
    friction.follow({.part = 1e-6, .to = HingeFriction::State::sticks});
    const double part = friction.change(rule, too_much).part;
    EXPECT_EQ(part > 0.0, slides == HingeFriction::State::opens) << part;
  }
}

}  // namespace
