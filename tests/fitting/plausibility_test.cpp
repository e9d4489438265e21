// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/plausibility.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "models/simulation.hpp"
#include "tests/fitting/synthetic_shot.hpp"

namespace impactrig::fitting {
namespace {

using datasets::Impact;
using datasets::ImpactSignal;
using testing::HasSubstr;

/// What the finer model of the paper's rig shows at another restitution and speed, the force in
/// units of `force_unit` and the velocity in units of `velocity_unit`.
Impact shot(double restitution, double speed, double force_unit = 1.0, double velocity_unit = 1.0) {
  RigFile file = parse_rig_file(tests::paper_rig, "rig.toml");
  file.rig.contact.restitution = restitution;
  file.rig.start.velocity = speed;
  file.solver.elements = {14, 2};
  file.solver.accuracy = 1e-4;
  models::SimulationOptions options;
  options.history.interval = 1e-6;
  const models::Simulation run = models::simulate(file.rig, file.solver, options);
  Impact impact;
  impact.start = 0.0;
  impact.end = run.episodes.front().end;
  impact.approach_velocity = speed / velocity_unit;
  ImpactSignal force;
  force.start = run.history.start;
  force.interval = run.history.interval;
  for (const double value : run.history.force) force.values.push_back(value / force_unit);
  impact.force = force;
  impact.velocity = ImpactSignal{};
  return impact;
}

const RigFile& paper() {
  static const RigFile file = parse_rig_file(tests::paper_rig, "rig.toml");
  return file;
}

// Where it must not fire: any restitution, and a speed of which the rig file knows nothing.
TEST(MomentumBalance, IsPlausibleAtAnyRestitutionAndSpeed) {
  for (const double restitution : {0.05, 0.3, 0.7, 1.0})
    for (const double speed : {0.05, 0.441, 4.0}) {
      const auto balance = momentum_balance(shot(restitution, speed), paper());
      ASSERT_TRUE(balance);
      EXPECT_TRUE(balance->plausible) << restitution << " " << speed << " " << balance->ratio;
      EXPECT_EQ(balance->sentence, "");
      EXPECT_GT(balance->ratio, 0.6) << restitution << " " << speed;
      EXPECT_LT(balance->ratio, 1.6) << restitution << " " << speed;
    }
}

TEST(MomentumBalance, NamesTheFactorOfAWrongForceUnit) {
  struct Case {
    double unit;
    const char* words;
  };

  for (const Case& c :
       {Case{1e-3, "times too large (nearly the factor of N for kN, or mV for V)"},
        Case{1e3, "times too small (nearly the factor of N for kN, or mV for V)"},
        Case{4.448, "times too small (nearly the factor of lbf (4.448 N))"},
        Case{9.81, "times too small (nearly the factor of kgf (9.81 N), or a gain or range of 10)"},
        Case{0.1, "times too large (nearly the factor of kgf (9.81 N), or a gain or range of 10)"}})
    for (const double restitution : {0.3, 0.8}) {
      const auto balance = momentum_balance(shot(restitution, 0.441, c.unit), paper());
      ASSERT_TRUE(balance);
      EXPECT_FALSE(balance->plausible) << c.unit;
      EXPECT_THAT(balance->sentence, testing::HasSubstr(c.words));
      EXPECT_THAT(balance->sentence,
                  testing::HasSubstr("Against the approach speed that the rig file states the "
                                     "force is "));
      EXPECT_THAT(balance->sentence, testing::Not(testing::HasSubstr("The measured approach")));
    }
}

TEST(MomentumBalance, NamesAWrongVelocityUnit) {
  const auto balance = momentum_balance(shot(0.5, 0.441, 1.0, 1e-3), paper());
  ASSERT_TRUE(balance);
  EXPECT_FALSE(balance->plausible);
  EXPECT_THAT(balance->sentence,
              testing::HasSubstr("The measured approach speed is 1000 times too large (nearly the "
                                 "factor of mm/s for m/s) against the rig file's."));
  EXPECT_THAT(balance->sentence, testing::Not(testing::HasSubstr("states the force is")));
  EXPECT_THAT(balance->sentence, testing::Not(testing::HasSubstr("N for kN")));
}

// A recorder in mV for V on all channels: 441 m/s for 0.441 was silent.
TEST(MomentumBalance, NamesASpeedThatNoShotOfTheRigHas) {
  const auto balance = momentum_balance(shot(0.5, 0.441, 1e-3, 1e-3), paper());
  ASSERT_TRUE(balance);
  EXPECT_FALSE(balance->plausible);
  EXPECT_THAT(balance->sentence, HasSubstr("the measured approach speed, 441 m/s, is 1000 times"));
}

TEST(MomentumBalance, NamesAVelocityThatShowsNothing) {
  Impact silent = shot(0.5, 0.441);
  silent.approach_velocity = 2e-4;
  silent.velocity->noise = 1e-3;
  const auto balance = momentum_balance(silent, paper());
  ASSERT_TRUE(balance);
  EXPECT_FALSE(balance->plausible);
  EXPECT_THAT(balance->sentence, HasSubstr("The velocity shows nothing before touch"));
  silent.velocity->noise = 0.05;  // it might hide there
  EXPECT_TRUE(momentum_balance(silent, paper())->plausible);
  silent.velocity.reset();
  EXPECT_TRUE(momentum_balance(silent, paper())->plausible);
}

/// The same shot with times in another unit.
Impact retimed(Impact impact, double factor) {
  impact.start *= factor;
  impact.end *= factor;
  impact.force->start *= factor;
  impact.force->interval *= factor;
  return impact;
}

TEST(MomentumBalance, NamesTimesInAnotherUnit) {
  for (const auto& [factor, words] : {std::pair{1e3, "1000 times too long (ms taken for s)"},
                                      std::pair{1e6, "1000000 times too long (us taken for s)"},
                                      std::pair{1e-3, "1000 times too short (s taken for ms)"},
                                      std::pair{1e-6, "1000000 times too short (s taken for us)"}})
    for (const double restitution : {0.1, 0.5, 0.9})
      for (const double speed : {0.1, 0.441, 2.0}) {
        const auto balance = momentum_balance(retimed(shot(restitution, speed), factor), paper());
        ASSERT_TRUE(balance);
        EXPECT_FALSE(balance->plausible);
        EXPECT_TRUE(balance->times);
        EXPECT_THAT(balance->sentence, HasSubstr(words)) << restitution << ' ' << speed;
        EXPECT_THAT(balance->sentence, HasSubstr("The contact lasts"));
      }
}

// A window for contacts of milliseconds ends within one that seems to last seconds.
TEST(MomentumBalance, TakesTheWholeContactsImpulseWhereTheSignalEndsWithinIt) {
  Impact impact = retimed(shot(0.5, 0.441), 1e3);
  double sum = 0.0;
  for (const double force : impact.force->values) sum += force * impact.force->interval;
  impact.force->channel = impact.trigger = "Force";
  impact.impulse = sum;
  impact.force->values.resize(100);
  const auto balance = momentum_balance(impact, paper());
  ASSERT_TRUE(balance);
  EXPECT_THAT(balance->sentence, HasSubstr("1000 times too long"));
  EXPECT_DOUBLE_EQ(balance->measured, sum);
}

TEST(MomentumBalance, TakesTheRigsSpeedWhereNoneWasMeasured) {
  Impact impact = shot(0.5, 2.0);
  impact.velocity.reset();
  auto balance = momentum_balance(impact, paper());
  ASSERT_TRUE(balance);
  EXPECT_TRUE(balance->plausible);  // 4.5 times: the speed in the rig file may be a guess
  impact = shot(0.5, 0.441, 1e-3);
  impact.velocity.reset();
  balance = momentum_balance(impact, paper());
  ASSERT_TRUE(balance);
  EXPECT_FALSE(balance->plausible);
  EXPECT_THAT(balance->sentence, testing::HasSubstr("(as the rig file says)"));
}

// The bar turns as a whole before touch: a spot at 0.1 m goes at 0.1/0.69 of the struck point.
TEST(MomentumBalance, KnowsWhereTheLaserLooks) {
  RigFile file = paper();
  file.velocity->position = 0.1;
  Impact impact = shot(0.5, 0.441);
  impact.approach_velocity *= 0.1 / 0.69;
  const auto balance = momentum_balance(impact, file);
  ASSERT_TRUE(balance);
  EXPECT_TRUE(balance->plausible) << balance->ratio;
  EXPECT_NEAR(balance->ratio, 1.0, 0.1);
}

// A decoder that does not go down to 0 Hz shows no approach speed, whatever its offset.
TEST(MomentumBalance, DoesNotTrustASpeedThatIsFilteredAway) {
  RigFile file = paper();
  file.velocity->low_cut = datasets::BandLimit{100.0, 1};
  Impact impact = shot(0.5, 0.441);
  impact.approach_velocity = 2e-3;
  EXPECT_TRUE(momentum_balance(impact, file)->plausible);
  impact.velocity->noise = 1e-3;
  EXPECT_TRUE(momentum_balance(impact, file)->plausible);
  EXPECT_THAT(momentum_balance(impact, paper())->sentence, HasSubstr("sensors.velocity.low_cut"));
}

TEST(MomentumBalance, IsNoneWithoutForceOrContact) {
  Impact impact = shot(0.5, 0.441);
  impact.force.reset();
  EXPECT_FALSE(momentum_balance(impact, paper()));
  RigFile swing = paper();
  swing.rig.contact.law = "none";
  EXPECT_FALSE(momentum_balance(shot(0.5, 0.441), swing));
  Impact inverted = shot(0.5, 0.441, -1.0);
  EXPECT_FALSE(momentum_balance(inverted, paper()));  // ImpactFlag::inverted says it
}

}  // namespace
}  // namespace impactrig::fitting
