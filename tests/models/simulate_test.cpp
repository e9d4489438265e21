// SPDX-License-Identifier: BSD-3-Clause
// Events, endings and starts of a run.
#include <gmock/gmock.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <string>
#include <thread>

#include "models/contact/contact_force.hpp"
#include "models/contact/damping/exact.hpp"
#include "models/contact/damping_law.hpp"
#include "models/contact_log.hpp"
#include "models/simulation.hpp"
#include "models/time_limit.hpp"
#include "tests/models/scenes.hpp"

namespace {

using namespace impactrig::models;
using namespace impactrig::tests;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(Simulate, EndsWhenTheBarHasLeftForGood) {
  const Simulation run = simulate(paper_rig(), rigid(1e-9));
  EXPECT_EQ(run.termination, "the bar has left the stop for good");
  EXPECT_THAT(run.warnings, IsEmpty());
  EXPECT_LT(run.duration, 0.001);
  EXPECT_FALSE(run.episodes.back().open);
}

TEST(Simulate, MissesNoContactByEndingEarly) {
  // the flexible bar comes back several times; whatever the longer run sees, the shorter saw too
  Rig rig = paper_rig();
  for (const char* damping : {"none", "exact"}) {
    rig.contact.damping = damping;
    rig.contact.restitution = 0.6;
    Solver solver = hybrid(Basis::pinned_free, 5, 1e-8, 1.0);
    solver.duration.reset();
    const Simulation own = simulate(rig, solver);
    ASSERT_EQ(own.termination, "the bar has left the stop for good");
    solver.duration = 5.0 * own.duration;
    const Simulation longer = simulate(rig, solver);
    EXPECT_GT(own.episodes.size(), 1u);
    EXPECT_EQ(own.episodes.size(), longer.episodes.size());
    EXPECT_EQ(longer.termination, "the duration asked for was reached");
  }
}

TEST(Simulate, SaysThatItEndedInAFlightTakenAtOnce) {
  Rig rig = paper_rig();
  rig.gravity = 9.81;
  Solver solver = rigid(1e-9);
  solver.duration = 0.2;
  SimulationOptions options;
  options.motion = Motion::small;
  const Simulation run = simulate(rig, solver, options);
  ASSERT_EQ(std::ranges::count(run.taken, Simplification::flight_at_once), 1);
  EXPECT_EQ(run.termination, "the duration asked for was reached");
}

TEST(Simulate, StopsAtTheDurationAskedForAndSaysWhenThatIsInContact) {
  Solver solver = rigid(1e-9);
  solver.duration = 1e-4;
  const Simulation run = simulate(paper_rig(), solver);
  EXPECT_EQ(run.termination, "the duration asked for was reached");
  EXPECT_NEAR(run.duration, 1e-4, 1e-19);
  ASSERT_EQ(run.episodes.size(), 1u);
  EXPECT_TRUE(run.episodes[0].open);
  EXPECT_EQ(run.episodes[0].end, run.duration);
  EXPECT_THAT(run.warnings,
              ElementsAre("the run ended in contact; state a longer solver.duration to see the "
                          "separation."));
  EXPECT_GT(run.energy.contact_stored, 0.5 * run.energy.initial);
  EXPECT_LT(std::abs(run.energy.imbalance), 1e-8);
  EXPECT_TRUE(std::isnan(run.restitution.kinematic));
}

TEST(Simulate, AnswersEvenForADurationShorterThanItsFirstStep) {
  Solver solver = rigid(1e-6);
  solver.duration = 1e-12;
  const Simulation run = simulate(paper_rig(), solver);
  EXPECT_EQ(run.duration, 1e-12);
  EXPECT_NEAR(run.max_penetration, 0.441e-12, 1e-20);
}

TEST(Simulate, TellsWhenABarIsStillWithinReachAfterItsLongestRun) {
  // no rebound: the bar stays, vibrating, near the stop
  Rig rig = paper_rig();
  rig.contact.damping = "exact";
  rig.contact.restitution = 0.005;
  const Simulation run = simulate(rig, rigid(1e-6));
  EXPECT_EQ(run.episodes.size(), 1u);
  rig.contact.law = "linear";
  rig.contact.stiffness = 50.0;  // contact lasts 0.4 s
  const Simulation slow = simulate(rig, rigid(1e-6));
  EXPECT_EQ(slow.termination, "0.1 s after first touch the bar was still within reach of the stop");
  EXPECT_THAT(
      slow.warnings,
      testing::Contains("0.1 s after first touch the bar was still within reach of the stop; "
                        "later contacts are not in the result. State solver.duration to go "
                        "on."));
  EXPECT_NEAR(slow.duration, 0.1, 1e-15);
}

TEST(Simulate, PendulumComesBackAfterHalfASwingWithItsReboundSpeed) {
  // second contact: half a period of small swings later, with e times the speed of the first
  Rig rig = paper_rig();
  rig.gravity = 9.81;
  rig.start.velocity = 0.02;  // swings of 0.4 degrees
  rig.contact.damping = "exact";
  rig.contact.restitution = 0.5;
  Solver solver = rigid(1e-10);
  solver.duration = 2.0;
  const Simulation run = simulate(rig, solver);
  ASSERT_GE(run.episodes.size(), 3u);
  const double half = std::numbers::pi / std::sqrt(1.5 * 9.81 / 0.8);
  for (std::size_t i = 1; i < 3; ++i) {
    EXPECT_NEAR(run.episodes[i].start - run.episodes[i - 1].end, half, 1e-4);
    EXPECT_NEAR(run.episodes[i].approach_velocity / run.episodes[i - 1].approach_velocity, 0.5,
                1e-3);  // the stop is struck with gravity pulling back a little
    // each contact has a damping factor of its own approach speed
    EXPECT_NEAR(run.episodes[i].separation_velocity / run.episodes[i].approach_velocity, 0.5, 2e-3);
  }
  EXPECT_LT(std::abs(run.energy.imbalance), 1e-8);
}

TEST(Simulate, WarnsOfGrazingTouches) {
  Rig rig = paper_rig();
  rig.gravity = 9.81;
  rig.start.velocity = 0.02;
  rig.contact.damping = "exact";
  rig.contact.restitution = 0.05;
  Solver solver = rigid(1e-8);
  solver.duration = 1.6;  // two swings: 1, 0.05 and 0.0025 of the first speed
  const Simulation run = simulate(rig, solver);
  ASSERT_EQ(run.episodes.size(), 3u);
  ASSERT_EQ(run.warnings.size(), 2u);
  EXPECT_THAT(run.warnings[0], HasSubstr("1 contact(s) began slower than 1 % of the first approach "
                                         "speed; their damping was taken at that speed, since the "
                                         "law divides by it. Forces after "));
  EXPECT_THAT(run.warnings[1], HasSubstr("the damping law would have pulled in "));
  EXPECT_THAT(run.warnings[1], HasSubstr("; the force was kept at zero while it would. "
                                         "contact.tension = \"allow\" lets it pull."));
}

TEST(Simulate, NeverPullsAlthoughTheLawWould) {
  // strong damping and a bar that springs back: 1 + μ v turns negative and the contact goes slack
  Rig rig = paper_rig();
  rig.contact.damping = "exact";
  rig.contact.position = 0.5;
  for (double e : {0.05, 0.1, 0.2}) {
    rig.contact.restitution = e;
    SimulationOptions options;
    options.history.interval = 2e-7;
    const Simulation run = simulate(rig, hybrid(Basis::pinned_free, 7, 1e-9, 2e-3), options);
    EXPECT_GT(run.episodes.size(), 1u);
    const double mu = exact_damping_factor(e) / 0.441;
    int slack = 0;
    double sum = 0.0;
    for (double force : run.history.force) sum += 2e-7 * force;
    // a pull hidden from the samples would show in the impulse, which is integrated along
    EXPECT_NEAR(sum / run.impulse, 1.0, 1e-4);
    for (std::size_t k = 0; k < run.history.force.size(); ++k) {
      EXPECT_GE(run.history.force[k], 0.0);
      const bool first = 2e-7 * static_cast<double>(k) < run.episodes[0].end;
      if (first && run.history.penetration[k] > 1e-9 &&
          1.0 + mu * run.history.velocity[k] < -1e-6) {
        EXPECT_EQ(run.history.force[k], 0.0);
        ++slack;
      }
    }
    EXPECT_GT(slack, 0) << "the scene does not show what it is for";
    EXPECT_LT(std::abs(run.energy.imbalance), 1e-7);
    for (const Episode& episode : run.episodes) EXPECT_GE(episode.dissipated, 0.0);
  }
}

TEST(Simulate, EpisodesFollowEachOtherAndAddUp) {
  Rig rig = paper_rig();
  rig.contact.damping = "lankarani-nikravesh";
  rig.contact.restitution = 0.5;
  for (const Solver& solver :
       {hybrid(Basis::pinned_free, 9, 1e-9, 4e-3), ancf(10, 2, 1e-9, 2e-3)}) {
    const Simulation run = simulate(rig, solver);
    ASSERT_GT(run.episodes.size(), 1u);
    double impulse = 0.0, dissipated = 0.0, peak = 0.0, depth = 0.0, before = -1.0;
    for (const Episode& e : run.episodes) {
      EXPECT_GT(e.start, before);
      EXPECT_GT(e.end, e.start);
      EXPECT_GT(e.peak_force, 0.0);
      EXPECT_GE(e.peak_time, e.start);
      EXPECT_LE(e.peak_time, e.end);
      EXPECT_GT(e.approach_velocity, 0.0);
      if (!e.open) {
        EXPECT_GT(e.separation_velocity, 0.0);
      }
      // a mean force below the peak
      EXPECT_LT(e.impulse, e.peak_force * (e.end - e.start));
      impulse += e.impulse;
      dissipated += e.dissipated;
      peak = std::max(peak, e.peak_force);
      depth = std::max(depth, e.max_penetration);
      before = e.end;
    }
    EXPECT_NEAR(impulse / run.impulse, 1.0, 1e-12);
    EXPECT_NEAR(dissipated / run.energy.dissipated, 1.0, 1e-12);
    EXPECT_EQ(peak, run.peak_force);
    EXPECT_EQ(depth, run.max_penetration);
  }
}

TEST(Simulate, ReleaseTurnsTheDropIntoSpeed) {
  Rig rig = paper_rig();
  rig.gravity = 9.81;
  rig.start.velocity = 0.0;
  rig.start.release_angle = 0.25;
  const double rate = std::sqrt(3.0 * 9.81 / 0.8 * (1.0 - std::cos(0.25)));
  const Simulation run = simulate(rig, rigid(1e-10));
  EXPECT_NEAR(run.episodes.at(0).approach_velocity, 0.69 * rate, 1e-14);
  ASSERT_EQ(run.skipped.size(), 1u);
  EXPECT_EQ(run.skipped[0],
            "the swing from 0.25 rad to first touch: the rigid bar's energy gives 0.737892 m/s at "
            "the struck point");
  SimulationOptions exact;
  exact.exact = true;
  const Simulation swung = simulate(rig, rigid(1e-10), exact);
  EXPECT_THAT(swung.skipped, IsEmpty());
  EXPECT_NEAR(swung.episodes.at(0).approach_velocity / (0.69 * rate), 1.0, 1e-9);
  EXPECT_NEAR(swung.peak_force / run.peak_force, 1.0, 1e-9);
  EXPECT_NEAR(swung.duration / run.duration, 1.0, 0.05);
  EXPECT_LT(std::abs(swung.energy.imbalance), 1e-9);
}

TEST(Simulate, HasNoRestitutionOfALawThatTakesNone) {
  Rig rig = paper_rig();
  rig.contact.damping = "lankarani-nikravesh";
  rig.contact.restitution = 0.5;
  EXPECT_EQ(simulate(rig, rigid(1e-4)).restitution.law, 0.5);
  rig.contact.damping = "none";
  EXPECT_TRUE(std::isnan(simulate(rig, rigid(1e-4)).restitution.law));
}

TEST(Simulate, RefusesAPenetrationBeyondTheElasticLaw) {
  Rig rig = paper_rig();
  rig.contact.exponent = 3;
  rig.contact.length = 1e-6;
  rig.start.velocity = 5.0;
  EXPECT_THAT([&] { simulate(rig, rigid(1e-6)); },
              testing::ThrowsMessage<std::runtime_error>(testing::MatchesRegex(
                  "the penetration of [0-9.e+-]+ m is beyond the range of the elastic law, "
                  "[0-9.e+-]+ m; the contact is too soft or the impact too hard for it")));
}

TEST(Simulate, RefusesItAsSoonAsItIsReached) {
  // A thousand seconds of a bar that turns over and over: without the refusal no end.
  Rig rig = paper_rig();
  rig.contact.exponent = 3;
  rig.contact.length = 1e-6;
  rig.start.velocity = 50.0;
  Solver solver = hybrid(Basis::pinned_free, 8, 1e-9, 1000.0);
  solver.time_limit = 1e9;
  EXPECT_THAT([&] { simulate(rig, solver); },
              testing::ThrowsMessage<std::runtime_error>(
                  testing::HasSubstr("beyond the range of the elastic law")));
}

TEST(Simulate, SaysWhatTakesSoLongWhenItsTimeIsOver) {
  Solver solver = ancf(14, 2, 1e-6, 3e-3);
  solver.time_limit = 1e-12;
  EXPECT_THAT([&] { simulate(paper_rig(), solver); },
              testing::ThrowsMessage<std::runtime_error>(
                  testing::AllOf(testing::HasSubstr("solver.time_limit, took the simulation to"),
                                 testing::HasSubstr("before the first contact was over"),
                                 testing::HasSubstr("fewer elements"))));
}

/// A bar that hangs at its stop, and bounces.
Rig bouncing_rig() {
  Rig rig = paper_rig();
  rig.gravity = 9.81;
  rig.contact.damping = "none";
  return rig;
}

/// Rigid, for ten years: no machine gets there in a fraction of a second.
Solver for_ten_years(double accuracy, double time_limit) {
  Solver solver = rigid(accuracy);
  solver.duration = 3e8;
  solver.time_limit = time_limit;
  return solver;
}

/// What the solution that ran out of time had of it [s].
double time_it_had(const Simulation& run) {
  EXPECT_THAT(run.termination,
              HasSubstr("s of processor time, what was left of solver.time_limit"));
  return std::stod(run.termination);
}

// Shares of processor time on whatever machine: small motion gives up after half of it at the
// soonest, and full equations that had all of it would tell more than half.
TEST(Simulate, HasOneTimeLimitForSmallMotionAndFullEquations) {
  const Simulation run = simulate(bouncing_rig(), for_ten_years(1e-10, 0.2));
  ASSERT_FALSE(run.small_motion);  // it leaves out 2e-9
  EXPECT_LE(time_it_had(run), 0.1);
  EXPECT_EQ(run.solver.time_limit, 0.2);
  SimulationOptions full;
  full.motion = Motion::full;
  EXPECT_GT(time_it_had(simulate(bouncing_rig(), for_ten_years(1e-10, 0.2), full)), 0.15);
}

TEST(Simulate, LeavesAllItsTimeToSmallMotionThatWillDo) {
  const Simulation run = simulate(bouncing_rig(), for_ten_years(1e-3, 0.2));
  ASSERT_TRUE(run.small_motion);
  EXPECT_GT(time_it_had(run), 0.15);
  EXPECT_GT(run.cost.seconds, 0.15);
}

// However long attempts take, no more than one passes between two looks.
TEST(Looks, AreDueAfterEachLongAttempt) {
  Looks looks;
  for (int attempt = 0; attempt < 4; ++attempt) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    EXPECT_TRUE(looks.due()) << attempt;
  }
}

TEST(Looks, AreSeldomDueAfterShortAttempts) {
  Looks looks;
  int due = 0;
  for (int attempt = 0; attempt < 16'000; ++attempt) due += looks.due() ? 1 : 0;
  EXPECT_GE(due, 1000);  // after sixteen at the latest
  EXPECT_LT(due, 8000);  // though other work should make some of them long
}

TEST(Simulate, EndsWithTheContactsItHasWhenItsTimeIsOver) {
  const Simulation run = simulate(bouncing_rig(), for_ten_years(1e-3, 0.05));
  ASSERT_FALSE(run.episodes.empty());
  EXPECT_FALSE(run.episodes.front().open);
  EXPECT_LT(run.duration, 3e8);
  EXPECT_THAT(run.termination, testing::HasSubstr("solver.time_limit"));
  EXPECT_THAT(run.warnings, testing::Contains(testing::HasSubstr("what comes later is not")));
}

TEST(Simulate, ReportsItsSolverAndItsCost) {
  const Solver solver = hybrid(Basis::cantilever, 4, 1e-6, 5e-4);
  const Simulation run = simulate(paper_rig(), solver);
  EXPECT_EQ(run.solver.modes, 4);
  EXPECT_EQ(run.solver.basis, Basis::cantilever);
  EXPECT_GT(run.cost.steps, 10);
  EXPECT_GT(run.cost.evaluations, 100);
  EXPECT_LT(run.cost.evaluations, 16 * run.cost.steps);
  EXPECT_GT(run.cost.seconds, 0.0);
  EXPECT_LT(run.cost.seconds, 10.0);
}

TEST(Simulate, IsRepeatable) {
  const Simulation a = simulate(paper_rig(), ancf(6, 2, 1e-6, 3e-4));
  const Simulation b = simulate(paper_rig(), ancf(6, 2, 1e-6, 3e-4));
  EXPECT_EQ(a.peak_force, b.peak_force);
  EXPECT_EQ(a.energy.imbalance, b.energy.imbalance);
}

TEST(Simulate, DoesNotFeedTheFastestVibrationAtLooseAccuracy) {
  // a contact near the hinge lasts many periods of the bar's fastest vibration; steps that danced
  // around the limit of stability had gained 85 % of the energy here
  Rig rig = paper_rig();
  rig.contact.position = 0.08;
  rig.start.velocity = 0.02;
  rig.contact.damping = "lankarani-nikravesh";
  rig.contact.restitution = 0.33;
  for (double accuracy : {1e-2, 1e-3, 1e-4}) {
    const Simulation run = simulate(rig, ancf(8, 2, accuracy, 6e-3));
    EXPECT_LT(std::abs(run.energy.imbalance), 1e-4);
    EXPECT_LT(run.cost.rejected, run.cost.steps / 20);
    EXPECT_THAT(run.warnings, testing::Not(testing::Contains(HasSubstr("energy"))));
  }
}

// 6 m of rubber at 10 µm/s: gravity moves far more energy than there was at first touch, and the
// accuracy is relative to that.
TEST(Simulate, BalancesTheEnergyOfABarThatIsHardlyMoved) {
  Rig rig = paper_rig();
  const double radius = 0.116;
  rig.beam = {.length = 6.12,
              .area = std::numbers::pi * radius * radius,
              .second_moment = std::numbers::pi * std::pow(radius, 4) / 4.0,
              .youngs_modulus = 2.1e7,
              .density = 2000.0};
  rig.contact.position = 3.81;
  rig.contact.radius = radius;
  rig.contact.counter_radius = 2.0 * radius;
  rig.contact.length = radius;
  rig.contact.modulus = 2.1e7;
  rig.contact.exponent = 3;
  rig.gravity = 9.81;
  rig.start.velocity = 1e-5;
  SimulationOptions full;
  full.motion = Motion::full;
  const Simulation run = simulate(rig, hybrid(Basis::pinned_free, 2, 1e-6, 1.5), full);
  EXPECT_LT(std::abs(run.energy.imbalance), 1e-6);
  EXPECT_THAT(run.warnings, testing::Not(testing::Contains(HasSubstr("energy"))));
}

TEST(Simulate, WarnsWhenTheEnergyDoesNotBalance) {
  Simulation run;
  run.energy.initial = run.energy.kinetic = 1.0;
  run.energy.imbalance = 9e-6;
  warn_of_imbalance(1e-6, run);
  EXPECT_TRUE(run.warnings.empty());
  run.energy.imbalance = -1.1e-5;
  warn_of_imbalance(1e-6, run);
  EXPECT_THAT(run.warnings,
              testing::ElementsAre(
                  HasSubstr("the energy does not balance: -1.1e-05 of it is missing or too much")));
}

TEST(Simulate, FindsThePeakOfALargeRotationWithinTheContact) {
  // struck near the hinge the bar turns by 0.2 rad while it touches: centripetal terms matter
  Rig rig = paper_rig();
  rig.contact.position = 0.05;
  rig.contact.law = "linear";
  rig.contact.stiffness = 3e6;
  rig.contact.damping = "exact";
  rig.contact.restitution = 0.5;
  rig.start.velocity = 4.0;
  for (double accuracy : {1e-4, 1e-8}) {
    Solver solver = rigid(accuracy);
    solver.duration = 0.02;
    SimulationOptions options;
    options.history.interval = 1e-6;
    const Simulation run = simulate(rig, solver, options);
    EXPECT_GT(run.max_penetration, 0.005);
    EXPECT_NEAR(*std::ranges::max_element(run.history.force) / run.peak_force, 1.0,
                accuracy + 1e-7);
  }
}

TEST(ContactForce, KnowsItsPhases) {
  Rig rig = paper_rig();
  rig.contact.law = "linear";
  rig.contact.stiffness = 1e6;
  rig.contact.damping = "lankarani-nikravesh";
  rig.contact.restitution = 0.5;
  ContactForce contact(rig);
  EXPECT_EQ(contact.damping_factor(), 0.5625);
  contact.begin_episode(0.5);
  EXPECT_EQ(contact.strength(), 1.125);
  EXPECT_EQ(contact.force(1e-6, 0.1), 0.0);  // free
  EXPECT_EQ(contact.dissipation(1e-6, 0.1), 0.0);
  contact.set_phase(ContactForce::Phase::pressed);
  EXPECT_NEAR(contact.force(1e-6, 0.1), 1.1125, 1e-15);
  EXPECT_NEAR(contact.dissipation(1e-6, 0.1), 0.01125, 1e-15);  // f_0 μ v²
  EXPECT_NEAR(contact.pressed(1e-6, 0.1).to_depth, 1e6 * 1.1125, 1e-9);
  EXPECT_NEAR(contact.pressed(1e-6, 0.1).to_rate, 1.125, 1e-15);
  EXPECT_GT(contact.switching(1e-6, -0.8).value, 0.0);
  EXPECT_LT(contact.switching(1e-6, -0.9).value, 0.0);
  EXPECT_EQ(contact.elastic(-1e-6), -1.0);  // continued for trial steps
  contact.set_phase(ContactForce::Phase::slack);
  EXPECT_EQ(contact.force(1e-6, -2.0), 0.0);
  EXPECT_NEAR(contact.dissipation(1e-6, -2.0), 2.0, 1e-15);  // the spring's energy is lost
  EXPECT_NEAR(contact.switching(1e-6, -2.0).value, 1.25, 1e-15);
  EXPECT_EQ(contact.stored(2e-6), 2e-6);
}

TEST(ContactForce, FindsThePenetrationThatStoresAnEnergyOnEveryScale) {
  const ContactForce contact(paper_rig());
  for (double energy = 1e-40; energy < 1e3; energy *= 37.0)
    EXPECT_NEAR(contact.stored(penetration_storing(contact, energy)) / energy, 1.0, 1e-12)
        << energy;
}

}  // namespace
