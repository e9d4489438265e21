// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "models/contact/contact_force.hpp"
#include "models/contact/damping_law.hpp"
#include "models/ensemble.hpp"
#include "models/modal/bar_cache.hpp"
#include "tests/models/law_names.hpp"
#include "tests/models/scenes.hpp"

namespace impactrig::tests {
namespace {

using namespace models;

/// The paper's bar against a spring.
Rig spring_rig(double restitution = 1.0) {
  Rig rig = paper_rig();
  rig.contact.law = "linear";
  rig.contact.stiffness = 3e7;
  rig.contact.damping = restitution < 1.0 ? "exact" : "none";
  rig.contact.restitution = restitution;
  return rig;
}

/// The rig with a further stop like the first.
Rig with_stop(Rig rig, StopSide side, double position, double gap) {
  FurtherStop stop{.contact = rig.contact, .side = side, .gap = gap};
  stop.contact.position = position;
  rig.further_stops.push_back(stop);
  return rig;
}

Solver rigid(double accuracy, double duration) {
  Solver solver = tests::rigid(accuracy);
  solver.duration = duration;
  return solver;
}

SimulationOptions in(Motion motion) {
  SimulationOptions options;
  options.motion = motion;
  return options;
}

/// Angular impulse about the hinge of all stops [N m s].
double angular_impulse(const Rig& rig, const Simulation& run) {
  double sum = rig.contact.position * run.stops[0].impulse;
  for (std::size_t i = 0; i < rig.further_stops.size(); ++i)
    sum += rig.further_stops[i].direction() * rig.further_stops[i].contact.position *
           run.stops[i + 1].impulse;
  return sum;
}

// A rigid bar between two stops: each rebounds it with its e, and what a linear law with damping
// proportional to force / approach speed makes of a contact lasts equally long at every speed.
TEST(SeveralStops, ARigidBarBouncesBetweenTwoAsBetweenWalls) {
  const double e_near = 0.8, e_far = 0.6, gap = 1e-4;
  Rig rig = with_stop(spring_rig(e_near), StopSide::far, 0.69, gap);
  rig.further_stops[0].contact.restitution = e_far;
  const Simulation run = simulate(rig, rigid(1e-11, 0.05), in(Motion::small));
  ASSERT_GE(run.episodes.size(), 10u);
  const double stay_near = run.episodes[0].end,
               stay_far = run.episodes[1].end - run.episodes[1].start;
  double t = 0.0, speed = rig.start.velocity;
  for (std::size_t k = 0; k < 10; ++k) {
    const Episode& episode = run.episodes[k];
    EXPECT_EQ(episode.stop, k % 2);
    EXPECT_NEAR(episode.start, t, 1e-9 * (t + stay_near)) << k;
    EXPECT_NEAR(episode.approach_velocity / speed, 1.0, 1e-9) << k;
    speed *= k % 2 == 0 ? e_near : e_far;
    EXPECT_NEAR(episode.separation_velocity / speed, 1.0, 1e-9) << k;
    t += (k % 2 == 0 ? stay_near : stay_far) + gap / speed;
  }
  EXPECT_LT(std::abs(run.energy.imbalance), 1e-9);
}

// With full equations the way between the stops is an angle.
TEST(SeveralStops, ARigidBarTurnsFromStopToStop) {
  const double gap = 0.05, position = 0.3;
  const Rig rig = with_stop(spring_rig(), StopSide::far, position, gap);
  const Simulation run = simulate(rig, rigid(1e-10, 0.6), in(Motion::full));
  ASSERT_GE(run.episodes.size(), 3u);
  const double rate = run.episodes[0].separation_velocity / rig.contact.position;
  EXPECT_NEAR(run.episodes[1].start - run.episodes[0].end, std::asin(gap / position) / rate, 1e-8);
  EXPECT_NEAR(run.episodes[1].approach_velocity,
              rate * position * std::cos(std::asin(gap / position)), 1e-8);
  EXPECT_EQ(run.episodes[1].stop, 1);
  EXPECT_EQ(run.episodes[2].stop, 0);
}

TEST(SeveralStops, OneThatIsNeverTouchedChangesNothing) {
  Rig one = paper_rig();
  one.gravity = 9.81;
  one.contact.damping = "lankarani-nikravesh";
  one.contact.restitution = 0.5;
  SimulationOptions options;
  options.history.interval = 1e-6;
  for (const Solver& solver :
       {rigid(1e-6, 3e-3), hybrid(Basis::cantilever, 7, 1e-5, 3e-3), ancf(14, 2, 1e-4, 3e-3)})
    for (const Motion motion : {Motion::small, Motion::full})
      for (const StopSide side : {StopSide::near, StopSide::far}) {
        options.motion = motion;
        const Simulation a = simulate(one, solver, options);
        const Simulation b = simulate(with_stop(one, side, 0.69, 0.3), solver, options);
        EXPECT_EQ(a.peak_force, b.peak_force);
        EXPECT_EQ(a.impulse, b.impulse);
        EXPECT_EQ(a.episodes.back().end, b.episodes.back().end);
        EXPECT_EQ(a.energy.imbalance, b.energy.imbalance);
        EXPECT_EQ(a.cost.evaluations, b.cost.evaluations);
        EXPECT_EQ(a.cost.steps, b.cost.steps);
        EXPECT_EQ(a.history.force, b.history.force);
        EXPECT_EQ(a.history.velocity, b.history.velocity);
        EXPECT_EQ(b.stops[1].impulse, 0.0);
      }
}

TEST(SeveralStops, OneOutOfReachDoesNotProlongTheRun) {
  Rig rig = paper_rig();
  const Solver solver = tests::rigid(1e-6);
  const double alone = simulate(rig, solver).duration;
  EXPECT_EQ(simulate(with_stop(rig, StopSide::far, 0.69, 0.3), solver).duration, alone);
  // 0.441 m/s and 10 mm: 23 ms away
  const Simulation back = simulate(with_stop(rig, StopSide::far, 0.69, 0.01), solver);
  EXPECT_GT(back.duration, 0.09);
  ASSERT_GE(back.episodes.size(), 3u);
  EXPECT_EQ(back.episodes[2].stop, 0);
}

// With exponent 1 Goldsmith's force is proportional to the length of the line, like a spring's to
// its stiffness.
TEST(SeveralStops, TwoHalvesAreOne) {
  for (const bool linear : {true, false}) {
    Rig whole = linear ? spring_rig() : paper_rig();
    whole.contact.damping = "lankarani-nikravesh";
    whole.contact.restitution = 0.3;  // the law pulls for a while
    Rig half = whole;
    half.contact.length *= 0.5;
    half.contact.stiffness *= 0.5;
    half = with_stop(half, StopSide::near, 0.69, 0.0);
    for (const Solver& solver :
         {rigid(1e-9, 3e-3), hybrid(Basis::pinned_free, 7, 1e-9, 1e-3), ancf(14, 2, 1e-8, 1e-3)})
      for (const Motion motion : {Motion::small, Motion::full}) {
        const Simulation a = simulate(whole, solver, in(motion));
        const Simulation b = simulate(half, solver, in(motion));
        const double share = 20.0 * solver.accuracy;
        ASSERT_EQ(b.episodes.size(), 2 * a.episodes.size());
        const Episode& expected = a.episodes.front();
        for (std::size_t stop : {0u, 1u}) {
          EXPECT_EQ(b.episodes[stop].stop, stop);
          EXPECT_NEAR(2.0 * b.episodes[stop].peak_force / expected.peak_force, 1.0, share);
          EXPECT_NEAR(2.0 * b.episodes[stop].impulse / expected.impulse, 1.0, share);
          EXPECT_NEAR(b.episodes[stop].end / expected.end, 1.0, share);
          EXPECT_NEAR(2.0 * b.stops[stop].impulse / a.impulse, 1.0, 1e3 * solver.accuracy);
        }
        EXPECT_NEAR(b.energy.dissipated / a.energy.dissipated, 1.0, 1e3 * solver.accuracy);
      }
  }
}

/// Several stops that press one after the other and at a time.
Rig crowded_rig() {
  Rig rig = spring_rig(0.7);
  rig = with_stop(rig, StopSide::near, 0.4, 3e-6);
  rig = with_stop(rig, StopSide::far, 0.8, 2e-5);
  rig = with_stop(rig, StopSide::far, 0.15, 1e-6);
  rig.further_stops[0].contact.stiffness = 8e7;
  rig.further_stops[1].contact.restitution = 0.4;
  return rig;
}

// Nothing but the stops turns the bar: ω from angular momentum.
TEST(SeveralStops, TakeTheMomentOfMomentumTheyGive) {
  Rig rig = crowded_rig();
  const double inertia = rig.beam.hinge_inertia();
  const double before = rig.start.velocity / rig.contact.position;
  for (const bool compliant : {false, true}) {
    if (compliant) rig.stop = Stop{.mass = 0.05, .stiffness = 2e8, .viscous = 100.0};
    for (const Solver& solver :
         {rigid(1e-9, 4e-3), hybrid(Basis::pinned_free, 9, 1e-8, 4e-3), ancf(14, 2, 1e-7, 4e-3)}) {
      const Simulation run = simulate(rig, solver, in(Motion::small));
      for (const StopTotals& stop : run.stops) EXPECT_GT(stop.impulse, 0.0);
      const double after = before - angular_impulse(rig, run) / inertia;
      EXPECT_NEAR(0.5 * inertia * after * after / run.energy.rigid_rotation, 1.0,
                  1e3 * solver.accuracy);
      EXPECT_LT(std::abs(run.energy.imbalance), 10.0 * solver.accuracy);
    }
  }
}

/// The bar's modes under the springs of all stops, by the classical Runge-Kutta method in steps so
/// small that touches within them do not matter. Elastic, and small motion.
class SpringBound {
 public:
  SpringBound(const Rig& rig, const Solver& solver) : rig_(rig), bar_(make_modal_bar(rig, solver)) {
    a_ = Eigen::VectorXd::Zero(beam().modes());
    v_ = beam().rigid() * (rig.start.velocity / rig.contact.position);
    impulse_.resize(static_cast<std::size_t>(rig.stops()), 0.0);
    peak_ = impulse_;
  }

  void run(double duration, double step) {
    const auto steps = static_cast<long>(std::lround(duration / step));
    for (long k = 0; k < steps; ++k) {
      const Slope s1 = slope(a_, v_);
      const Slope s2 = slope(a_ + 0.5 * step * s1.a, v_ + 0.5 * step * s1.v);
      const Slope s3 = slope(a_ + 0.5 * step * s2.a, v_ + 0.5 * step * s2.v);
      const Slope s4 = slope(a_ + step * s3.a, v_ + step * s3.v);
      a_ += step / 6.0 * (s1.a + 2.0 * s2.a + 2.0 * s3.a + s4.a);
      v_ += step / 6.0 * (s1.v + 2.0 * s2.v + 2.0 * s3.v + s4.v);
      for (std::size_t i = 0; i < impulse_.size(); ++i) {
        impulse_[i] +=
            step / 6.0 * (s1.force[i] + 2.0 * s2.force[i] + 2.0 * s3.force[i] + s4.force[i]);
        peak_[i] = std::max(peak_[i], s1.force[i]);
      }
    }
  }

  const std::vector<double>& impulse() const { return impulse_; }

  const std::vector<double>& peak() const { return peak_; }

 private:
  struct Slope {
    Eigen::VectorXd a, v;
    std::array<double, 8> force = {};
  };

  const ModalBeam& beam() const { return bar_->modes(); }

  Slope slope(const Eigen::VectorXd& a, const Eigen::VectorXd& v) const {
    Slope s{v, -beam().omega().cwiseAbs2().cwiseProduct(a)};
    for (int i = 0; i < rig_.stops(); ++i) {
      const double sign =
          i == 0 ? 1.0 : rig_.further_stops[static_cast<std::size_t>(i - 1)].direction();
      const double gap = i == 0 ? 0.0 : rig_.further_stops[static_cast<std::size_t>(i - 1)].gap;
      const Eigen::VectorXd row = sign * beam().point(rig_.contact_of(i).position);
      const double force = rig_.contact_of(i).stiffness * std::max(row.dot(a) - gap, 0.0);
      s.v -= force * row;
      s.force[static_cast<std::size_t>(i)] = force;
    }
    return s;
  }

  const Rig& rig_;
  std::shared_ptr<const ModalBar> bar_;
  Eigen::VectorXd a_, v_;
  std::vector<double> impulse_, peak_;
};

TEST(SeveralStops, AgreeWithAnExplicitMethod) {
  Rig rig = crowded_rig();
  rig.contact.damping = "none";
  for (FurtherStop& stop : rig.further_stops) stop.contact.damping = "none";
  const Solver solver = hybrid(Basis::pinned_free, 4, 1e-9, 1e-3);
  SpringBound expected(rig, solver);
  expected.run(1e-3, 2e-8);
  for (const Motion motion : {Motion::small, Motion::full}) {
    const Simulation run = simulate(rig, solver, in(motion));
    // full equations differ by foreshortening
    const double share = motion == Motion::small ? 1e-6 : 1e-3;
    for (std::size_t i = 0; i < run.stops.size(); ++i) {
      EXPECT_NEAR(run.stops[i].impulse / expected.impulse()[i], 1.0, share) << i;
      EXPECT_NEAR(run.stops[i].peak_force / expected.peak()[i], 1.0, share + 1e-5) << i;
    }
  }
}

TEST(SeveralStops, ConvergeWithTheAccuracyAskedFor) {
  Rig rig = crowded_rig();
  rig.gravity = 9.81;
  for (const Motion motion : {Motion::small, Motion::full})
    for (const Solver& solver :
         {hybrid(Basis::cantilever, 5, 1e-10, 6e-4), ancf(5, 2, 1e-9, 6e-4)}) {
      const Simulation fine = simulate(rig, solver, in(motion));
      Solver coarse = solver;
      for (const double accuracy : {1e-3, 1e-5, 1e-7}) {
        coarse.accuracy = accuracy;
        const Simulation run = simulate(rig, coarse, in(motion));
        ASSERT_EQ(run.episodes.size(), fine.episodes.size());
        EXPECT_NEAR(run.episodes[0].impulse / fine.episodes[0].impulse, 1.0, accuracy);
        EXPECT_NEAR(run.peak_force / fine.peak_force, 1.0, accuracy);
        for (std::size_t i = 0; i < run.stops.size(); ++i)
          EXPECT_NEAR(run.stops[i].impulse, fine.stops[i].impulse, 10.0 * accuracy * fine.impulse);
        EXPECT_LT(std::abs(run.energy.imbalance), 10.0 * accuracy);
      }
    }
}

TEST(SeveralStops, HybridAndAncfBarsMeetThemAlike) {
  const Rig rig = crowded_rig();
  const Simulation a = simulate(rig, hybrid(Basis::pinned_free, 50, 1e-6, 6e-4), in(Motion::small));
  const Simulation b = simulate(rig, ancf(45, 7, 1e-6, 6e-4), in(Motion::small));
  // no node of this mesh is before the stops at 0.4 m and 0.15 m
  for (std::size_t i = 0; i < a.stops.size(); ++i)
    EXPECT_NEAR(b.stops[i].impulse, a.stops[i].impulse, 3e-3 * a.stops[0].impulse) << i;
}

TEST(SeveralStops, FullEquationsAgreeWithSmallMotion) {
  const Rig rig = crowded_rig();
  for (const Solver& solver : {hybrid(Basis::pinned_free, 7, 1e-7, 1e-3), ancf(14, 2, 1e-7, 1e-3),
                               ancf(4, 2, 1e-7, 1e-3)}) {  // a stop before the first element
    const Simulation small = simulate(rig, solver, in(Motion::small));
    const Simulation full = simulate(rig, solver, in(Motion::full));
    ASSERT_EQ(small.episodes.size(), full.episodes.size());
    for (std::size_t k = 0; k < small.episodes.size(); ++k)
      EXPECT_EQ(small.episodes[k].stop, full.episodes[k].stop);
    EXPECT_NEAR(full.peak_force / small.peak_force, 1.0, small.neglected);
    for (std::size_t i = 0; i < small.stops.size(); ++i)
      EXPECT_NEAR(full.stops[i].impulse, small.stops[i].impulse,
                  30.0 * small.neglected * small.impulse);
  }
}

TEST(SeveralStops, HistoriesShowEach) {
  const Rig rig = crowded_rig();
  SimulationOptions options;
  options.history.interval = 1e-7;
  options.history.lead = 1e-6;
  for (const Motion motion : {Motion::small, Motion::full}) {
    options.motion = motion;
    const Simulation run = simulate(rig, hybrid(Basis::cantilever, 5, 1e-7, 2e-3), options);
    const History& history = run.history;
    ASSERT_EQ(history.further.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) {
      const StopHistory& stop = history.further[i];
      ASSERT_EQ(stop.force.size(), history.force.size());
      ASSERT_EQ(stop.penetration.size(), history.force.size());
      double impulse = 0.0, peak = 0.0;
      for (const double force : stop.force) {
        EXPECT_GE(force, 0.0);
        impulse += 1e-7 * force;
        peak = std::max(peak, force);
      }
      EXPECT_NEAR(impulse / run.stops[i + 1].impulse, 1.0, 1e-3);
      EXPECT_NEAR(peak / run.stops[i + 1].peak_force, 1.0, 1e-3);
      // where the bar touches
      EXPECT_NEAR(stop.penetration[10], -rig.further_stops[i].gap, 1e-12);
      const double speed = rig.further_stops[i].direction() * rig.start.velocity / 0.69 *
                           rig.further_stops[i].contact.position;
      EXPECT_NEAR(stop.penetration[0] - stop.penetration[10], -speed * 1e-6, 1e-10);
    }
  }
}

TEST(SeveralStops, AnEnsembleSolvesThemToo) {
  std::vector<Rig> rigs(5, crowded_rig());
  for (std::size_t k = 0; k < rigs.size(); ++k) {
    rigs[k].start.velocity *= 1.0 + 0.1 * static_cast<double>(k);
    rigs[k].further_stops[0].contact.position -= k < 3 ? 0.0 : 0.1;
  }
  rigs[1].further_stops.clear();
  const Solver solver = hybrid(Basis::cantilever, 7, 1e-4, 5e-4);
  const std::vector<EnsembleMember> members = simulate_ensemble(rigs, solver, {});
  for (std::size_t k = 0; k < rigs.size(); ++k) {
    const Simulation alone = simulate(rigs[k], solver);
    ASSERT_EQ(members[k].failure, "");
    EXPECT_EQ(members[k].simulation.stops.size(), alone.stops.size());
    EXPECT_NEAR(members[k].simulation.peak_force / alone.peak_force, 1.0, 1e-4);
  }
}

// What is asked for with derivatives is not flown at once.
TEST(SeveralStops, FlightsEndBeforeTheNextStop) {
  Rig rig = with_stop(spring_rig(0.8), StopSide::far, 0.4, 5e-3);
  rig = with_stop(rig, StopSide::near, 0.8, 1e-4);
  rig.gravity = 9.81;
  SimulationOptions flown = in(Motion::small), stepped = flown;
  flown.history.interval = stepped.history.interval = 1e-4;
  stepped.sensitivities = {[](Rig& r) -> double& { return r.start.velocity; }};
  for (const Solver& solver : {rigid(1e-8, 0.2), hybrid(Basis::pinned_free, 2, 1e-8, 0.2)}) {
    const Simulation a = simulate(rig, solver, flown);
    const Simulation b = simulate(rig, solver, stepped);
    EXPECT_LT(a.cost.steps, b.cost.steps);
    EXPECT_EQ(b.sensitivities.size(), 1u);
    const bool vibrates = solver.model == BeamModel::hybrid;
    const std::size_t count = vibrates ? 3 : 5;
    ASSERT_GE(a.episodes.size(), count) << a.termination;
    for (std::size_t k = 0; k < count; ++k) {
      EXPECT_EQ(a.episodes[k].stop, b.episodes[k].stop);
      // the pendulum's sine, at the widest: gap / position
      EXPECT_NEAR(a.episodes[k].start, b.episodes[k].start, 1e-4 * b.episodes[k].start + 1e-9);
      EXPECT_NEAR(a.episodes[k].impulse / b.episodes[k].impulse, 1.0, 1e-3);
    }
    ASSERT_EQ(a.history.further[0].penetration.size(), b.history.further[0].penetration.size());
    for (std::size_t i = 0; i < 100; ++i)
      EXPECT_NEAR(a.history.further[0].penetration[i], b.history.further[0].penetration[i], 5e-6);
    EXPECT_LT(std::abs(a.energy.imbalance), 1e-3);
  }
}

std::string refusal(const Rig& rig, const Solver& solver, const SimulationOptions& options = {}) {
  try {
    simulate(rig, solver, options);
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

TEST(SeveralStops, AreRefusedWhereTheyCannotBe) {
  const Solver solver = tests::rigid(1e-6);
  EXPECT_EQ(
      refusal(with_stop(spring_rig(), StopSide::far, 0.9, 0.1), solver),
      "contacts.1.position: the struck point, 0.9 m from the hinge, lies beyond the bar's end "
      "at 0.8 m");
  EXPECT_EQ(refusal(with_stop(spring_rig(), StopSide::far, 0.5, -1e-3), solver),
            "contacts.1.gap: must be finite and not negative, found -0.001 m");
  Rig unknown = with_stop(spring_rig(), StopSide::far, 0.5, 1e-3);
  unknown.further_stops[0].contact.law = "hertz";
  EXPECT_EQ(refusal(unknown, solver),
            "contacts.1.law: there is no elastic law 'hertz'; known are " +
                tests::names_of(elastic_laws()));
  Rig released = with_stop(spring_rig(), StopSide::far, 0.5, 0.01);
  released.gravity = 9.81;
  released.start.release_angle = 0.1;
  EXPECT_EQ(refusal(released, solver),
            "contacts.1.gap: 0.01 m on the far side: the bar is released from behind this stop, "
            "whose gap must be more than 0.0499167 m");
  released.further_stops[0].gap = 0.06;
  EXPECT_EQ(refusal(released, solver), "");
}

// A bar that swings against a stop under its weight is not quite straight.
TEST(SeveralStops, OneThatIsStruckBeforeTheFirstIsAskedToBeTheFirst) {
  Rig rig = paper_rig();
  rig.beam.youngs_modulus = 1e8;
  rig.gravity = 9.81;
  rig.start.release_angle = 0.1;
  SimulationOptions exact;
  exact.exact = true;
  const Solver solver = hybrid(Basis::cantilever, 4, 1e-4, 1e-3);
  rig.contact.position = 0.4;
  const std::string one = refusal(with_stop(rig, StopSide::near, 0.8, 0.0), solver, exact);
  rig.contact.position = 0.8;
  const std::string other = refusal(with_stop(rig, StopSide::near, 0.4, 0.0), solver, exact);
  EXPECT_NE(one.empty(), other.empty());
  EXPECT_EQ(one + other,
            "the bar met stop 1 of [[contacts]] before that of [contact], which has to be struck "
            "first; name that stop there, or leave it a gap");
}

}  // namespace
}  // namespace impactrig::tests
