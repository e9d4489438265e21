// SPDX-License-Identifier: BSD-3-Clause
// Free flight at once: the pendulum against its own equation integrated, flights against steps.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <boost/numeric/odeint.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "models/make_beam.hpp"
#include "models/modal/bar_cache.hpp"
#include "models/modal/modal_flight.hpp"
#include "models/simulation.hpp"
#include "tests/models/scenes.hpp"

namespace {

using namespace impactrig::models;
using namespace impactrig::tests;

using Swing = std::array<double, 2>;

/// θ̈ = −ω² sin θ by an explicit method.
Swing swung(double omega, Swing state, double time) {
  namespace odeint = boost::numeric::odeint;
  const auto rate = [omega](const Swing& x, Swing& dx, double) {
    dx = {x[1], -omega * omega * std::sin(x[0])};
  };
  odeint::integrate_adaptive(
      odeint::make_controlled(1e-13, 1e-13, odeint::runge_kutta_dopri5<Swing>()), rate, state, 0.0,
      time, 1e-3);
  return state;
}

TEST(PendulumSwing, FollowsItsEquation) {
  const double omega = 4.3;
  for (const Swing& from : {Swing{-0.3, -1.0},
                            {-0.3, 1.0},
                            {0.2, -1.0},
                            {0.2, 1.0},
                            {-1.4, 0.0},
                            {-1e-5, 3.0},
                            {-1e-5, -3.0},
                            {-2.9, -0.3}})
    for (const double time : {1e-4, 0.1, 0.7, 3.1}) {
      const PendulumSwing::State there = PendulumSwing(omega, {from[0], from[1]}).after(time);
      const Swing expected = swung(omega, from, time);
      const double size = std::hypot(from[0], from[1] / omega);
      EXPECT_NEAR(there.angle, expected[0], 1e-10 * size);
      EXPECT_NEAR(there.rate, expected[1], 1e-9 * omega * size);
    }
}

TEST(PendulumSwing, IsSteppedOverShortTimesAsExactly) {
  for (const double omega : {4.3, 0.0})
    for (const Swing& from : {Swing{-0.3, -1.0}, {1.4, 0.5}, {-1e-5, 3.0}}) {
      const PendulumSwing swing(omega, {from[0], from[1]});
      const double spacing = omega > 0.0 ? 9.9e-4 / omega : 1e-3;
      ASSERT_TRUE(swing.is_short(spacing));
      PendulumSwing::State state = swing.start();
      for (int i = 1; i <= 1000; ++i) {
        state = PendulumSwing::stepped(omega, state, spacing);
        const PendulumSwing::State exact = swing.after(i * spacing);
        ASSERT_NEAR(state.angle, exact.angle, 3e-13) << i;
        ASSERT_NEAR(state.rate, exact.rate, 3e-12) << i;
      }
    }
}

// All five derivatives are right: the angle's error is of the sixth order, the rate's of the fifth.
TEST(PendulumSwing, IsSteppedByFiveDerivatives) {
  const double omega = 4.3;
  const PendulumSwing swing(omega, {0.7, -1.9});
  const auto errors = [&](double time) {
    const PendulumSwing::State found = PendulumSwing::stepped(omega, swing.start(), time);
    const PendulumSwing::State exact = swing.after(time);
    return std::array{std::abs(found.angle - exact.angle), std::abs(found.rate - exact.rate)};
  };
  const auto whole = errors(0.02), half = errors(0.01);
  EXPECT_NEAR(std::log2(whole[0] / half[0]), 6.0, 0.1);
  EXPECT_NEAR(std::log2(whole[1] / half[1]), 5.0, 0.1);
}

TEST(PendulumSwing, ComesUpThroughAnAngleWhenItSaysSo) {
  for (const double omega : {4.3, 0.0})
    for (const Swing& from : {Swing{-0.3, -1.0}, {-0.3, 1.0}, {-1.2, 0.0}, {-0.1, -4.0}})
      for (const double low : {-0.05, -1e-6}) {
        const PendulumSwing swing(omega, {from[0], from[1]});
        const double time = swing.time_up_to(low);
        if (omega == 0.0 && from[1] <= 0.0) {
          EXPECT_EQ(time, std::numeric_limits<double>::infinity());
          continue;
        }
        EXPECT_NEAR(swing.after(time).angle, low, 1e-13);
        EXPECT_GT(swing.after(time).rate, 0.0);
        for (int i = 1; i < 100; ++i) EXPECT_LT(swing.after(0.01 * i * time).angle, low);
      }
}

// Where rounding had it just beyond the angle it was just below, it was told to come by a period
// later: a bar that swung towards its stop then went through it.
TEST(PendulumSwing, IsNoPeriodAwayFromAnAngleItHasAllButReached) {
  const double omega = 4.3;
  std::mt19937 generator(7);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (int trial = 0; trial < 2000; ++trial) {
    const PendulumSwing swing(omega, {-0.1 - uniform(generator), -2.0 * uniform(generator)});
    const double angle = swing.start().angle + 0.1 * uniform(generator);
    PendulumSwing::State there = swing.after(swing.time_up_to(angle));
    there.angle = std::min(there.angle, std::nextafter(angle, -2.0));
    EXPECT_LT(PendulumSwing(omega, there).time_up_to(angle), 1e-9) << trial;
  }
}

TEST(PendulumSwing, KnowsThatItTurnsOver) {
  EXPECT_TRUE(PendulumSwing(2.0, {-1.0, 5.0}).turns_over());
  EXPECT_FALSE(PendulumSwing(2.0, {-1.0, 2.0}).turns_over());
  EXPECT_NEAR(PendulumSwing(2.0, {-1.0, 0.0}).widest(), 1.0, 1e-14);
}

// Pulled towards its stop, the bar bounces until it rests on it.
TEST(ModalFlight, LeadsThroughNoStop) {
  Rig rig = paper_rig();
  rig.contact.damping = "lankarani-nikravesh";
  rig.gravity = 9.81;
  SimulationOptions options;
  options.motion = Motion::small;
  options.history.interval = 1e-4;
  for (const double degrees : {20.0, 45.0, 60.0, 80.0})
    for (const double restitution : {0.5, 0.8, 1.0}) {
      rig.gravity_direction = degrees * std::numbers::pi / 180.0;
      rig.contact.restitution = restitution;
      const Simulation run = simulate(rig, ancf(14, 2, 1e-4, 1.0), options);
      EXPECT_LE(std::ranges::max(run.history.penetration), 1.01 * run.max_penetration)
          << degrees << ' ' << restitution;
      EXPECT_GT(run.episodes.back().end, 0.9) << degrees << ' ' << restitution;
    }
}

// However a bar swings and vibrates, the struck point stays away for as long as is said.
TEST(ModalFlight, StaysClearOfTheStop) {
  Rig rig = paper_rig();
  rig.gravity = 9.81;
  std::mt19937 generator(4);
  std::normal_distribution<double> normal;
  int flights = 0, near = 0;
  for (int trial = 0; trial < 400; ++trial) {
    rig.gravity_direction = trial < 200 ? 0.0 : 0.4 * normal(generator);
    const auto bar = make_modal_bar(rig, hybrid(Basis::pinned_free, 8, 1e-6, 1.0));
    const ModalBeam& beam = bar->modes();
    const ModalLoad load(beam);
    const double held = beam.struck().dot(load.held());
    ModalState state{-0.02 * std::abs(normal(generator)) * beam.rigid(),
                     0.5 * normal(generator) * beam.rigid()};
    for (int k = 1; k < beam.modes(); ++k) {
      state.a[k] += 3e-4 * normal(generator) * beam.omega()[1] / beam.omega()[k];
      state.rate[k] += 3e-4 * normal(generator) * beam.omega()[1];
    }
    const ModalFlight flight(beam, load, state);
    // gravity may pull it away for good
    const double time = std::min(flight.clear_time(std::array{0.0}), 5.0);
    EXPECT_TRUE(time == 0.0 || !ModalFlight::may_reach(beam, load, state, std::array{0.0}));
    near += ModalFlight::may_reach(beam, load, state, std::array{0.0});
    if (time == 0.0) continue;
    ++flights;
    ModalState there = state;
    for (int i = 0; i <= 2000; ++i) {
      flight.state_after(time * i / 2000.0, there);
      ASSERT_LT(beam.struck().dot(there.a) + held, 0.0) << trial << ' ' << i;
    }
  }
  EXPECT_GT(flights, 100);
  EXPECT_GT(near, 0);
}

// Where the vibration might bring the point back, it is known to stay away nearly until it comes.
TEST(ModalFlight, WatchesABarThatVibratesBeforeTheStop) {
  Rig rig = paper_rig();
  std::mt19937 generator(5);
  std::normal_distribution<double> normal;
  for (const auto& [gravity, direction] :
       {std::pair{0.0, 0.0}, {9.81, 0.0}, {9.81, 1.5}, {9.81, -0.5}}) {
    rig.gravity = gravity;
    rig.gravity_direction = direction;
    const auto bar = make_modal_bar(rig, hybrid(Basis::pinned_free, 8, 1e-6, 1.0));
    const ModalBeam& beam = bar->modes();
    const ModalLoad load(beam);
    const auto place = [&](const ModalState& at) {
      return beam.struck().dot(at.a) + beam.struck().dot(load.held());
    };
    int watched = 0, closed = 0;
    for (int trial = 0; trial < 150; ++trial) {
      ModalState state{-1e-4 * std::abs(normal(generator)) * beam.rigid(),
                       0.02 * normal(generator) * beam.rigid()};
      for (int k = 1; k < beam.modes(); ++k) {
        state.a[k] += 3e-5 * normal(generator) * beam.omega()[1] / beam.omega()[k];
        state.rate[k] += 3e-5 * normal(generator) * beam.omega()[1];
      }
      const double most = 0.01, least = 1e-9;
      const double time =
          ModalFlight::watched_time(beam, load, state, std::array{0.0}, least, most);
      const bool near = ModalFlight::may_reach(beam, load, state, std::array{0.0});
      if (place(state) >= 0.0 || !near) continue;
      ++watched;
      ModalState there = state;
      for (int i = 0; i <= 4000; ++i) {
        load.advance_freely(beam, time * i / 4000.0, state, there);
        ASSERT_LT(place(there), 0.0) << trial << ' ' << i;
      }
      EXPECT_GT(time, 0.0);
      if (time == most || !ModalFlight::may_reach(beam, load, there, std::array{0.0})) continue;
      ++closed;  // within the little that is left of its way
      const double speed = beam.struck().dot(there.rate);
      EXPECT_LT(-place(there), 1e-6 * speed * most + 1e-9) << trial;
    }
    EXPECT_GT(watched, 20);
    EXPECT_GT(closed, 10);
    EXPECT_GT(watched - closed, 1);
  }
}

// A rigid bar is as exact at once as in steps: many bounces over seconds, as wide as they go.
TEST(ModalFlight, OfTheRigidBarLosesNothing) {
  Rig rig = paper_rig();
  rig.gravity = 9.81;
  rig.contact.damping = "exact";
  rig.contact.restitution = 0.8;
  rig.start.velocity = 2.5;
  Solver solver = rigid(1e-9);
  solver.duration = 6.0;
  SimulationOptions full, small;
  full.motion = Motion::full;
  small.motion = Motion::small;
  small.history.interval = full.history.interval = 0.01;
  for (const double direction : {0.0, 0.3, -0.2}) {  // not where the bar hangs at the stop
    SCOPED_TRACE(direction);
    rig.gravity_direction = direction;
    solver.duration = direction > 0.0 ? 3.0 : 6.0;
    const Simulation a = simulate(rig, solver, full);
    const Simulation b = simulate(rig, solver, small);
    ASSERT_EQ(a.episodes.size(), b.episodes.size());
    ASSERT_GT(a.episodes.size(), 6U);
    for (std::size_t i = 0; i < a.episodes.size(); ++i) {
      EXPECT_NEAR(b.episodes[i].start, a.episodes[i].start, 1e-7) << i;
      EXPECT_NEAR(b.episodes[i].impulse / a.episodes[i].impulse, 1.0, 1e-7) << i;
    }
    ASSERT_EQ(a.history.velocity.size(), b.history.velocity.size());
    for (std::size_t i = 0; i < a.history.velocity.size(); ++i) {
      EXPECT_NEAR(b.history.displacement[i], a.history.displacement[i], 1e-6) << i;
      // a few samples fall into a contact, where the velocity changes within 0.1 ms
      EXPECT_NEAR(b.history.velocity[i], a.history.velocity[i], 1e-3) << i;
    }
    EXPECT_LT(std::abs(b.energy.imbalance), 1e-8);
    EXPECT_LT(b.cost.steps, 60L * static_cast<long>(b.episodes.size()));
  }
}

// Nor does one that bends where it leans, in its first flight of a good part of its swing.
TEST(ModalFlight, OfALeaningBarIsThatOfTheFullEquations) {
  Rig rig = paper_rig();
  rig.gravity = 9.81;
  rig.contact.damping = "exact";
  rig.contact.restitution = 0.8;
  rig.start.velocity = 1.2;
  for (const double direction : {0.25, -0.1}) {
    SCOPED_TRACE(direction);
    rig.gravity_direction = direction;
    const Solver solver = hybrid(Basis::pinned_free, 2, 1e-9, 0.25);
    SimulationOptions full, small;
    full.motion = Motion::full;
    small.motion = Motion::small;
    small.history.interval = full.history.interval = 1e-3;
    small.history.displacement_position = full.history.displacement_position = 0.4;
    const Simulation a = simulate(rig, solver, full), b = simulate(rig, solver, small);
    ASSERT_EQ(a.episodes.size(), b.episodes.size());
    double farthest = 0.0;
    for (const double x : a.history.displacement) farthest = std::max(farthest, std::abs(x));
    ASSERT_GT(farthest, 0.01);
    const auto again = std::ranges::find_if(
        a.episodes, [](const Episode& episode) { return episode.start > 0.02; });
    const double end = again == a.episodes.end() ? 0.25 : again->start;
    ASSERT_GT(end, 0.1);
    for (std::size_t i = 0; static_cast<double>(i) * 1e-3 < end - 1e-3; ++i)
      EXPECT_NEAR(b.history.displacement[i], a.history.displacement[i], 1e-3 * farthest) << i;
  }
}

// Cost goes with the contacts, not with the time between them.
TEST(ModalFlight, CostsNoMoreForBeingLonger) {
  Rig rig = paper_rig();
  rig.contact.damping = "lankarani-nikravesh";
  rig.contact.restitution = 0.5;
  SimulationOptions small;
  small.motion = Motion::small;
  const auto run = [&](double gravity) {
    rig.gravity = gravity;
    return simulate(rig, ancf(7, 1, 1e-4, 9.0 / gravity), small);
  };
  const Simulation slow = run(1.0), quick = run(9.81);
  ASSERT_GT(slow.episodes.back().start, 5.0);
  const auto steps_a_contact = [](const Simulation& of) {
    return static_cast<double>(of.cost.steps) / static_cast<double>(of.episodes.size());
  };
  EXPECT_LT(steps_a_contact(slow), 1.5 * steps_a_contact(quick));
}

TEST(ModalFlight, IsNotTakenFromAStopThatGivesWayNorOnASpring) {
  Rig rig = paper_rig();
  rig.gravity = 9.81;
  SimulationOptions small;
  small.motion = Motion::small;
  const Solver solver = ancf(6, 1, 1e-3, 0.05);
  const long steps = simulate(rig, solver, small).cost.steps;
  Rig soft = rig;
  soft.stop = Stop{.mass = 0.05, .stiffness = 2e8};
  EXPECT_GT(simulate(soft, solver, small).cost.steps, 2 * steps);
  Rig sprung = rig;
  sprung.hinge.spring = 10.0;
  EXPECT_GT(simulate(sprung, solver, small).cost.steps, 2 * steps);
}

/// A bar let go without a stop to meet.
Rig let_go(double release, double slenderness) {
  Rig rig = paper_rig();
  rig.beam.area *= slenderness * slenderness;
  rig.beam.second_moment *= std::pow(slenderness, 4);
  rig.contact.law = "none";
  rig.contact.position = rig.beam.length;
  rig.gravity = 9.81;
  rig.start.release_angle = release;
  return rig;
}

TEST(ModalFlight, SwingsWithoutAStopAsItSays) {
  SimulationOptions full, small;
  full.motion = Motion::full;
  small.motion = Motion::small;
  full.history.interval = small.history.interval = 5e-3;
  for (const double release : {0.1, 0.6, 1.2})
    for (const double slenderness : {1.0, 0.2}) {
      const Rig rig = let_go(release, slenderness);
      for (const Solver& solver :
           {hybrid(Basis::pinned_free, 3, 1e-6, 0.8), ancf(4, 0, 1e-6, 0.8)}) {
        const Simulation a = simulate(rig, solver, full);
        const Simulation b = simulate(rig, solver, small);
        ASSERT_EQ(a.history.displacement.size(), b.history.displacement.size());
        double worst = 0.0;
        for (std::size_t i = 0; i < a.history.displacement.size(); ++i)
          worst = std::max(worst, std::abs(b.history.displacement[i] - a.history.displacement[i]));
        EXPECT_LE(worst / rig.beam.length, b.neglected) << release << ' ' << slenderness;
        EXPECT_LT(b.neglected, 1e-2);
        EXPECT_LT(std::abs(b.energy.imbalance), 1e-9);
      }
    }
}

TEST(ModalFlight, IsTakenForASwingOnlyWhereItMayBe) {
  const Solver solver = ancf(8, 0, 1e-4, 0.2);
  EXPECT_TRUE(simulate(let_go(0.5, 1.0), solver).small_motion);
  EXPECT_FALSE(simulate(let_go(0.5, 0.02), solver).small_motion);
  Rig over = let_go(3.0, 1.0);
  EXPECT_FALSE(simulate(over, solver).small_motion);
  SimulationOptions exact;
  exact.exact = true;
  EXPECT_FALSE(simulate(let_go(0.5, 1.0), solver, exact).small_motion);
}

}  // namespace
