// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "models/contact/contact_force.hpp"
#include "models/contact/damping_law.hpp"
#include "models/sensitivities/derivative_refusal.hpp"
#include "models/sensitivities/element_layout.hpp"
#include "models/simulation.hpp"
#include "tests/models/differences.hpp"
#include "tests/models/scenes.hpp"

namespace impactrig::tests {
namespace {

using namespace models;

Simulation small(const Rig& rig, const Solver& solver, std::vector<RigParameter> by = {}) {
  return sharp(rig, solver, Motion::small, std::move(by));
}

TEST(Sensitivities, OfAncfAreThoseOfDifferences) {
  expect_equal_derivatives(damped_rig(), ancf(5, 1, 1e-12, 5e-4), 1e-8);
}

TEST(Sensitivities, OfHybridAreThoseOfDifferences) {
  expect_equal_derivatives(damped_rig(), hybrid(Basis::pinned_free, 5, 1e-12, 5e-4), 1e-8);
}

// Derivatives are less smooth than the force, and what a search needs of them is little.
TEST(Sensitivities, ShortenStepsNoMoreThanTheirOwnAccuracyAsksFor) {
  const Rig rig = damped_rig();
  const Solver solver = ancf(20, 4, 1e-10, 5e-4);
  SimulationOptions options;
  options.motion = Motion::small;
  options.sensitivities = {[](Rig& r) -> double& { return r.start.velocity; },
                           [](Rig& r) -> double& { return r.contact.stiffness_factor; }};
  const Simulation fine = simulate(rig, solver, options);
  options.sensitivity_accuracy = 1e-4;
  const Simulation rough = simulate(rig, solver, options);
  EXPECT_LT(rough.cost.steps, fine.cost.steps);
  EXPECT_NEAR(rough.peak_force / fine.peak_force, 1.0, 1e-9);
  EXPECT_NEAR(rough.impulse / fine.impulse, 1.0, 1e-9);
  for (std::size_t i = 0; i < options.sensitivities.size(); ++i) {
    EXPECT_NEAR(rough.sensitivities[i].peak_force / fine.sensitivities[i].peak_force, 1.0, 1e-4);
    EXPECT_NEAR(rough.sensitivities[i].impulse / fine.sensitivities[i].impulse, 1.0, 1e-4);
  }
}

// Of damping in bar and hinge, and of all that moves damped modes; the last scene has modes that
// creep.
TEST(Sensitivities, OfDampedBarsAreThoseOfDifferences) {
  Rig rig = damped_rig();
  rig.beam.damping = {.mass = 20.0, .stiffness = 2e-7};
  rig.hinge = {.spring = 50.0, .viscous = 0.01};
  expect_equal_derivatives(rig, ancf(4, 1, 1e-12, 5e-4), 1e-8, of_damped_bars);
  expect_equal_derivatives(rig, hybrid(Basis::pinned_free, 5, 1e-12, 5e-4), 1e-8, of_damped_bars);
  rig.beam.damping.stiffness = 5e-5;
  expect_equal_derivatives(rig, hybrid(Basis::cantilever, 5, 1e-12, 5e-4), 1e-8, of_damped_bars);
}

// Damping sees what the weight leaves of ω² in every mode: where fast ones had none the derivative
// by gravity was up to five times what it is.
TEST(Sensitivities, OfTheWeightOfADampedBarAreThoseOfDifferences) {
  constexpr std::array damping = {of_damped_bars[1]}, gravity = {parameters[9]};
  Rig rig = damped_rig();
  rig.contact.damping = "none";
  rig.beam.damping.stiffness = 2e-6;
  const Solver solver = ancf(3, 1, 1e-12, 5e-4);
  expect_equal_derivatives(rig, solver, 1e-10, damping, 2e-2);
  expect_equal_derivatives(rig, solver, 1e-10, gravity, 0.1);
}

TEST(Sensitivities, OfSectionsAndMassesAreThoseOfDifferences) {
  Rig rig = damped_rig();
  rig.beam.masses = {{0.4, 0.2}};
  expect_equal_derivatives(rig, ancf(4, 1, 1e-12, 4e-4), 1e-8, of_sections, 5e-4);
  expect_equal_derivatives(rig, hybrid(Basis::pinned_free, 4, 1e-12, 4e-4), 1e-8, of_sections);
}

// Shapes of a bar that shears come from a mesh, and are known to 1e-12 only.
TEST(Sensitivities, OfMeshedShapesAreThoseOfDifferences) {
  Rig rig = damped_rig();
  rig.beam.theory = BeamTheory::timoshenko;
  rig.beam.shear_coefficient = 0.886;
  for (const Basis basis : {Basis::cantilever, Basis::pinned_free})
    expect_equal_derivatives(rig, hybrid(basis, 3, 1e-12, 4e-4), 1e-8, parameters, 2e-3);
}

TEST(Sensitivities, OfAMassAtAnElementsEndAreThoseOfDifferences) {
  constexpr std::array of_place = {of_sections[3]}, of_length = {parameters[11]};
  const auto expect_equal = [](const Rig& rig, std::span<const Named> of, double spacing,
                               Side side) {
    expect_equal_derivatives(rig, ancf(2, 1, 1e-12, 5e-4), 1e-8, of, spacing, Motion::small, side);
  };
  Rig rig = damped_rig();
  rig.beam.masses = {{0.345, 0.05}};  // in the middle before the struck point
  for (const Side side : {Side::below, Side::above}) {
    expect_equal(rig, of_place, 1e-3, side);
    expect_equal(rig, std::span(parameters).last(2), 1e-3, side);
  }
  rig.beam.masses = {{0.8, 1e-3}};
  expect_equal(rig, of_place, 2e-4, Side::below);
  expect_equal(rig, of_length, 5e-4, Side::above);
}

TEST(Sensitivities, OfSegmentsAreThoseOfDifferences) {
  Rig rig = stepped_rig();
  expect_equal_derivatives(rig, ancf(3, 1, 1e-12, 5e-4), 1e-8, of_segments_that_bend, 5e-4);
  expect_equal_derivatives(rig, hybrid(Basis::pinned_free, 3, 1e-12, 5e-4), 1e-8,
                           of_segments_that_bend, 5e-4);
  rig.beam.theory = BeamTheory::timoshenko;
  expect_equal_derivatives(rig, ancf(3, 1, 1e-12, 4.4e-4), 1e-8, of_segments, 5e-4);
  expect_equal_derivatives(rig, hybrid(Basis::pinned_free, 3, 1e-12, 5e-4), 1e-8, of_segments,
                           5e-4);
}

constexpr std::array of_contacts = {
    Named{"poisson_ratio", [](Rig& r) -> double& { return r.contact.poisson_ratio; }},
    Named{"counter_poisson_ratio",
          [](Rig& r) -> double& { return r.contact.counter_poisson_ratio; }},
    Named{"counter_modulus", [](Rig& r) -> double& { return r.contact.counter_modulus; }},
    Named{"effective_mass", [](Rig& r) -> double& { return *r.contact.effective_mass; }},
    Named{"restitution_speed", [](Rig& r) -> double& { return *r.contact.restitution_speed; }},
    Named{"depth", [](Rig& r) -> double& { return r.contact.counter_depth; }},
    Named{"reference_length", [](Rig& r) -> double& { return *r.contact.reference_length; }},
    Named{"its modulus", [](Rig& r) -> double& { return r.further_stops[0].contact.modulus; }},
    Named{"its counter radius",
          [](Rig& r) -> double& { return r.further_stops[0].contact.counter_radius; }},
    Named{"its reference_length",
          [](Rig& r) -> double& { return *r.further_stops[0].contact.reference_length; }},
};

constexpr std::array of_places = {
    Named{"position", [](Rig& r) -> double& { return r.contact.position; }},
    Named{"first length", [](Rig& r) -> double& { return r.beam.segments[0].length; }}};

// The bar changes 1 mm behind the struck point: that element's stiffness goes by the third power of
// the 1 mm, and its own vibration is 10^4 times as fast as the bar's.
TEST(Sensitivities, BesideAShortElementAreThoseOfDifferences) {
  Rig rig = stepped_rig();
  rig.contact.position = rig.beam.segments[0].length - 1e-3;
  rig.hinge.spring = 20.0;
  const Solver solver = ancf(4, 2, 1e-12, 5e-4);
  for (const Motion motion : {Motion::small, Motion::full})  // were off by up to 36 %
    expect_equal_derivatives(rig, solver, 1e-3, of_places, 3e-8, motion);
  const std::array spring = {Named{"spring", [](Rig& r) -> double& { return r.hinge.spring; }}};
  expect_equal_derivatives(rig, solver, 1e-7, spring, 1e-2);
}

// What vibrates far faster than the bar is damped, so that differences see as little of it as the
// contact does.
TEST(Sensitivities, BesideAnElementAThousandTimesShorterAreThoseOfDifferences) {
  Rig rig = stepped_rig();
  rig.beam.damping.stiffness = 1e-7;
  rig.contact.position = rig.beam.segments[0].length - 1e-4;
  // those of the impulse were off by a hundredth
  expect_equal_derivatives(rig, ancf(4, 2, 1e-12, 5e-4), 2e-5, of_places, 1e-5);
}

// Of what a contact is made of besides what a fit frees: of a line on a plane whose damping is made
// of a damping ratio, and of one in a groove beside it.
TEST(Sensitivities, OfContactsAreThoseOfDifferences) {
  Rig rig = damped_rig();
  FurtherStop second{.contact = rig.contact, .side = StopSide::near, .gap = 2e-6};
  second.contact.position = 0.5;
  rig.further_stops = {second};
  rig.contact.law = "johnson";
  rig.contact.counterface = Counterface::plane;
  rig.contact.counter_depth = 0.03;
  rig.contact.damping = "jankowski";
  rig.contact.effective_mass = 0.3;
  rig.contact.restitution_speed = 0.5;
  rig.contact.stiffness_factor = 0.5;
  const Solver solver = hybrid(Basis::pinned_free, 3, 1e-12, 4e-4);
  ASSERT_GE(small(rig, solver).episodes.size(), 2u);
  expect_equal_derivatives(rig, solver, 1e-8, std::span(of_contacts).first(6), 5e-4);
  expect_equal_derivatives(rig, solver, 1e-8, std::span(of_contacts).last(3), 5e-4);
  rig.contact = second.contact;
  rig.contact.position = 0.69;
  rig.further_stops.clear();
  expect_equal_derivatives(rig, solver, 1e-8, std::span(of_contacts).subspan(6, 1), 5e-4);
}

// Of the power that a contact's law is stated with, in the unit of its stiffness.
TEST(Sensitivities, OfStatedPowersAreThoseOfDifferences) {
  constexpr std::array powers = {
      Named{"power", [](Rig& r) -> double& { return r.contact.power; }},
      Named{"its power", [](Rig& r) -> double& { return r.further_stops[0].contact.power; }}};
  Rig rig = damped_rig();
  rig.contact.law = "lankarani-nikravesh-cylinder";
  rig.contact.stiffness = 1.6e10;
  rig.contact.power = 1.5;
  FurtherStop second{.contact = rig.contact, .side = StopSide::near, .gap = 2e-6};
  second.contact.position = 0.5;
  second.contact.power = 1.4;
  rig.further_stops = {second};
  const Solver solver = hybrid(Basis::pinned_free, 3, 1e-12, 4e-4);
  ASSERT_GE(small(rig, solver).episodes.size(), 2u);
  expect_equal_derivatives(rig, solver, 1e-8, powers, 5e-4);
}

// What is largest at the run's end is so at a time that is held, though the second contact's
// touch, from which the last steps count, moves.
TEST(Sensitivities, OfARunThatEndsInItsContactsAreThoseOfDifferences) {
  Rig rig = damped_rig();
  FurtherStop second{.contact = rig.contact, .side = StopSide::near, .gap = 2e-6};
  second.contact.position = 0.5;
  rig.further_stops = {second};
  const Solver solver = hybrid(Basis::pinned_free, 3, 1e-12, 2e-5);
  const auto velocity = [](Rig& r) -> double& { return r.start.velocity; };
  const Simulation run = small(rig, solver, {velocity});
  ASSERT_EQ(run.episodes.size(), 2u);
  ASSERT_TRUE(run.episodes[0].open && run.episodes[1].open);
  ASSERT_EQ(run.episodes[0].peak_time, solver.duration);
  const double spacing = 1e-3 * rig.start.velocity;
  double peak = 0.0, depth = 0.0;
  for (const auto& [offset, weight] : {std::pair{1, 45.0}, {2, -9.0}, {3, 1.0}})
    for (const double side : {1.0, -1.0}) {
      Rig there = rig;
      there.start.velocity += side * offset * spacing;
      const Episode first = small(there, solver).episodes.front();
      peak += side * weight / (60.0 * spacing) * first.peak_force;
      depth += side * weight / (60.0 * spacing) * first.max_penetration;
    }
  EXPECT_NEAR(run.sensitivities[0].peak_force / peak, 1.0, 1e-8);
  EXPECT_NEAR(run.sensitivities[0].max_penetration / depth, 1.0, 1e-8);
}

// A weightless rigid bar has no frequency to measure changes against, without a damper no rate at
// all.
TEST(Sensitivities, OfARigidBarWithADamperAreThoseOfDifferences) {
  Rig rig = damped_rig();
  rig.gravity = 0.0;
  Solver solver = rigid(1e-12);
  solver.duration = 4e-3;
  const Named damper{"viscous hinge", [](Rig& r) -> double& { return r.hinge.viscous; }};
  rig.hinge.viscous = 20.0;
  expect_equal_derivatives(rig, solver, 1e-8, {&damper, 1});
  rig.hinge.viscous = 0.0;
  const Simulation without = small(rig, solver, {damper.of});
  rig.hinge.viscous = 1e-3;
  const Simulation with = small(rig, solver);
  const double change = 1e-3 * without.sensitivities.at(0).impulse;
  EXPECT_LT(change, 0.0);
  EXPECT_NEAR((with.impulse - without.impulse) / change, 1.0, 1e-4);
}

// Of gravity that pulls into the stop, away from it, or not yet from the side; bar, hinge and stop
// damped, or free.
TEST(Sensitivities, OfGravityFromTheSideAreThoseOfDifferences) {
  Rig rig = damped_rig();
  Solver stiff = rigid(1e-12);
  stiff.duration = 5e-4;
  const Solver chain = ancf(4, 1, 1e-12, 5e-4);
  const Solver frame = hybrid(Basis::pinned_free, 4, 1e-12, 5e-4);
  for (const double direction : {1.2, -0.7, 1e-3, 1e-8, 0.0}) {
    SCOPED_TRACE(direction);
    rig.gravity_direction = direction;
    for (const Solver& solver : {stiff, chain, frame})
      expect_equal_derivatives(rig, solver, 1e-8, of_gravity);
  }
  rig.gravity_direction = 1.2;
  rig.gravity = 60.0;
  expect_equal_derivatives(rig, chain, 1e-8, parameters, 4e-4);
  rig.beam.damping = {.mass = 20.0, .stiffness = 2e-7};
  rig.hinge = {.spring = 50.0, .viscous = 0.01};
  expect_equal_derivatives(rig, frame, 1e-8, of_damped_bars, 4e-4);
  rig.stop = Stop{.mass = 0.2, .stiffness = 1e9, .viscous = 5e3};
  expect_equal_derivatives(rig, frame, 1e-8, of_compliant_stops, 3e-4);
}

// A head that rings, one that is damped, one that creeps back.
TEST(Sensitivities, OfACompliantStopAreThoseOfDifferences) {
  for (const double viscous : {300.0, 5e3, 4e4}) {
    SCOPED_TRACE(viscous);
    Rig rig = damped_rig();
    rig.stop = Stop{.mass = 0.2, .stiffness = 1e9, .viscous = viscous};
    const Solver solver = hybrid(Basis::pinned_free, 4, 1e-12, 5e-4);
    ASSERT_TRUE(small(rig, solver).sensor);
    expect_equal_derivatives(rig, solver, 1e-8, of_compliant_stops, 5e-4);
  }
}

// The vibration passes many periods before it arrives: of its frequency differences are small.
TEST(Sensitivities, OfABarThatIsLetGoBeforeACompliantStopAreThoseOfDifferences) {
  constexpr auto of_stop = std::span(of_compliant_stops).first(5);
  constexpr std::array of_rest = {
      Named{"youngs_modulus", [](Rig& r) -> double& { return r.beam.youngs_modulus; }},
      Named{"release angle", [](Rig& r) -> double& { return *r.start.release_angle; }}};
  Rig rig = damped_rig();
  rig.start = {.release_angle = 0.05};
  rig.stop = Stop{.mass = 0.2, .stiffness = 1e9, .viscous = 5e3};
  Solver stiff = rigid(1e-12);
  stiff.duration = 5e-4;
  for (const Solver& solver : {stiff, hybrid(Basis::pinned_free, 2, 1e-12, 5e-4)}) {
    expect_equal_derivatives(rig, solver, 1e-8, of_stop);
    expect_equal_derivatives(rig, solver, 1e-8, of_rest, 1e-4);
  }
}

// Its swings are far shorter than the steps the bar alone would take in flight, and part bar and
// head at a speed whose rounding, 1e-11, is that over the spacing of differences.
TEST(Sensitivities, OfALightStiffHeadAreThoseOfDifferences) {
  Rig rig = damped_rig();
  rig.stop = Stop{.mass = 2e-3, .stiffness = 2e10, .viscous = 2e3};
  expect_equal_derivatives(rig, hybrid(Basis::pinned_free, 1, 1e-12, 1e-3), 1e-8,
                           of_compliant_stops, 4e-3);
}

// Stops that press together, in turn, and the first of them on its sensor.
TEST(Sensitivities, OfSeveralStopsAreThoseOfDifferences) {
  Rig rig = damped_rig();
  FurtherStop second{.contact = rig.contact, .side = StopSide::near, .gap = 2e-6};
  second.contact.position = 0.5;
  second.contact.restitution = 0.7;
  rig.further_stops = {second};
  const Solver solver = hybrid(Basis::pinned_free, 4, 1e-12, 4e-4);
  ASSERT_GE(small(rig, solver).episodes.size(), 2u);
  expect_equal_derivatives(rig, solver, 1e-8, of_further_stops);
  rig.further_stops[0].side = StopSide::far;
  rig.further_stops[0].gap = 1e-5;
  rig.contact.restitution = 0.8;
  Solver stiff = rigid(1e-12);
  stiff.duration = 5e-4;
  ASSERT_GE(small(rig, stiff).episodes.size(), 2u);
  expect_equal_derivatives(rig, stiff, 1e-8, of_further_stops);
  rig.stop = Stop{.mass = 0.2, .stiffness = 1e9, .viscous = 5e3};
  ASSERT_GE(small(rig, stiff).episodes.size(), 2u);
  expect_equal_derivatives(rig, stiff, 1e-8, of_further_stops);
  expect_equal_derivatives(rig, stiff, 1e-8, of_compliant_stops);
}

/// Several contacts, some of them grazing, and a run that ends in the middle of one.
TEST(Sensitivities, GoOnThroughContactsThatFollow) {
  Rig rig = damped_rig();
  rig.contact.position = 0.4;  // the free half swings on and pulls the bar back to the stop
  const Solver solver = hybrid(Basis::pinned_free, 3, 1e-12, 4e-3);
  ASSERT_GE(small(rig, solver).episodes.size(), 2u);
  expect_equal_derivatives(rig, solver, 1e-8, without_places);
}

TEST(Sensitivities, OfPullingContactsAreThoseOfDifferences) {
  Rig rig = damped_rig();
  rig.contact.position = 0.4;
  rig.contact.damping = "exact";
  rig.contact.restitution = 0.3;
  const Solver solver = hybrid(Basis::pinned_free, 9, 1e-12, 1e-3);
  const History history = small(rig, solver).history;
  int slack = 0;  // samples where 1 + μ rate is negative: the bar leaves too fast for the law
  for (std::size_t k = 0; k < history.force.size(); ++k)
    slack += history.penetration[k] > 0.0 && history.force[k] == 0.0 ? 1 : 0;
  ASSERT_GT(slack, 1);
  // the runs' own rounding, 1e-11 after several contacts, is that over the spacing of differences
  expect_equal_derivatives(rig, solver, 1e-8, without_places, 2e-3);
}

// One law of each form, through its end, its kink and its jumps.
TEST(Sensitivities, OfEveryFormOfDampingAreThoseOfDifferences) {
  for (const char* damping :
       {"hunt-crossley", "marhefka-orin", "lankarani-nikravesh-implicit", "viscous", "tsuji",
        "tangent", "jankowski", "kuwabara-kono", "hertz-hysteresis"})
    for (const Tension tension : {Tension::clip, Tension::allow}) {
      SCOPED_TRACE(testing::Message() << damping << (tension == Tension::clip ? "" : ", pulls"));
      Rig rig = damped_rig();
      rig.contact.law = "johnson";
      rig.contact.damping = damping;
      rig.contact.tension = tension;
      rig.contact.restitution = 0.75;
      const Solver solver = hybrid(Basis::pinned_free, 3, 1e-12, 4e-4);
      if (ContactForce(rig).ends_smoothly())
        expect_equal_derivatives(rig, solver, 1e-8, without_places);
      else  // nothing rather than numbers that do not converge
        EXPECT_TRUE(small(rig, solver, {parameters[0].of}).sensitivities.empty());
    }
}

TEST(Sensitivities, OfEveryFormOfElasticLawAreThoseOfDifferences) {
  for (const char* law : {"dubowsky-freudenstein", "hertz-point", "liu", "persson", "palmgren"}) {
    SCOPED_TRACE(law);
    Rig rig = damped_rig();
    rig.contact.law = law;
    rig.contact.stiffness_factor = 0.2;  // long enough for forces away from touch and separation
    expect_equal_derivatives(rig, hybrid(Basis::pinned_free, 3, 1e-12, 6e-4), 1e-8, without_places);
  }
}

// At the ends of a law's range, where differences have to keep to one side.
TEST(Sensitivities, OfRestitutionAreKnownUpToTheEndsOfEachLawsRange) {
  for (const DampingLaw& law : damping_laws()) {
    const std::string damping(law.text.name);
    const double smallest = law.text.smallest_restitution;
    for (const double e : {smallest, smallest + 1e-5, 0.9999, 1.0}) {
      if (e == 0.0) continue;
      SCOPED_TRACE(testing::Message() << damping << ", e = " << e);
      Rig rig = damped_rig();
      rig.contact.law = "linear";
      rig.contact.stiffness = 1e8;
      rig.contact.damping = damping;
      const auto kinematic = [&](double restitution, std::vector<RigParameter> by) {
        rig.contact.restitution = restitution;
        return sharp(rig, rigid(1e-12), Motion::small, std::move(by));
      };
      const Simulation run =
          kinematic(e, {[](Rig& r) -> double& { return r.contact.restitution; }});
      ASSERT_EQ(run.sensitivities.size(), 1u);
      const double h = e > 0.9 ? -2e-4 : 2e-3 * e;  // into the range
      const double one = kinematic(e + h, {}).restitution.kinematic;
      const double two = kinematic(e + 2.0 * h, {}).restitution.kinematic;
      const double slope = (-3.0 * run.restitution.kinematic + 4.0 * one - two) / (2.0 * h);
      EXPECT_NEAR(run.sensitivities[0].restitution.kinematic, slope,
                  1e-3 * std::max(1.0, std::abs(slope)));
    }
  }
}

TEST(Sensitivities, OfAFreeImpactFollowScaling) {
  // Linear contact without damping: force and impulse go with the speed, time does not.
  Rig rig = paper_rig();
  rig.contact.law = "linear";
  rig.contact.stiffness = 1e8;
  SimulationOptions options;
  options.motion = Motion::small;
  options.sensitivities = {[](Rig& r) -> double& { return r.start.velocity; },
                           [](Rig& r) -> double& { return r.contact.stiffness; }};
  const Simulation run = simulate(rig, hybrid(Basis::pinned_free, 4, 1e-6, 1e-3), options);
  const Sensitivity& by_speed = run.sensitivities.at(0);
  const Episode& e = run.episodes.front();
  EXPECT_NEAR(by_speed.peak_force, e.peak_force / 0.441, 1e-9 * e.peak_force);
  EXPECT_NEAR(by_speed.impulse, e.impulse / 0.441, 1e-9 * e.impulse);
  EXPECT_NEAR(by_speed.duration, 0.0, 1e-12 * e.end);
  EXPECT_NEAR(by_speed.restitution.kinematic, 0.0, 1e-9);
  EXPECT_GT(run.sensitivities.at(1).peak_force, 0.0);
}

// 0.69 m / 3 is a rounding less than 0.23 m.
TEST(ElementLayout, CountsWhatLiesAtAnElementsEndTowardsTheHinge) {
  Rig rig = damped_rig();
  rig.beam.masses = {{0.23, 0.1}, {0.46, 0.1}, {0.47, 0.1}, {0.8, 0.1}, {0.81, 0.1}};
  const ElementLayout layout = ElementLayout::of(rig, ancf(3, 1, 1e-6, 1e-3), {});
  EXPECT_EQ(layout.holds, (std::vector<std::size_t>{0, 1, 2, 3, 4}));
  EXPECT_EQ(layout.shares, (std::vector<int>{0, 3, 1, 0}));
  const Solver closed = hybrid(Basis::cantilever, 3, 1e-6, 1e-3);
  EXPECT_EQ(ElementLayout::of(rig, closed, {}), ElementLayout{});
}

TEST(DerivativeRefusal, SaysWhereOnlyOneSideExists) {
  constexpr RigParameter friction = [](Rig& r) -> double& { return r.hinge.friction; };
  constexpr RigParameter length = [](Rig& r) -> double& { return r.beam.length; };
  constexpr RigParameter position = [](Rig& r) -> double& { return r.contact.position; };
  constexpr RigParameter area = [](Rig& r) -> double& { return r.beam.area; };
  Rig rig = damped_rig();
  const Solver solver = ancf(4, 1, 1e-6, 1e-3);
  for (const RigParameter parameter : {length, position, area})
    EXPECT_EQ(derivative_refusal(rig, solver, parameter), "");
  EXPECT_THAT(derivative_refusal(rig, solver, friction),
              testing::StartsWith("there is no friction, "));
  rig.hinge.friction = 0.1;
  EXPECT_EQ(derivative_refusal(rig, solver, friction), "");
  constexpr RigParameter depth = [](Rig& r) -> double& { return r.contact.counter_depth; };
  EXPECT_THAT(derivative_refusal(rig, solver, depth), testing::StartsWith("without a depth "));
  rig.contact.counter_depth = 0.03;
  EXPECT_EQ(derivative_refusal(rig, solver, depth), "");
  rig.contact.position = rig.beam.length;
  for (const RigParameter parameter : {length, position})
    EXPECT_EQ(derivative_refusal(rig, solver, parameter),
              "the bar is struck at its tip, and cannot be struck beyond it: only one side exists");
  rig.contact.position = 0.69;
  rig.beam.segments = {
      BeamSegment{.length = 0.8, .area = rig.beam.area, .second_moment = rig.beam.second_moment}};
  EXPECT_EQ(derivative_refusal(rig, solver, area), "beam.segments state it, of each segment");
  EXPECT_EQ(derivative_refusal(rig, solver, position), "");
  constexpr RigParameter segment = [](Rig& r) -> double& { return r.beam.segments[0].length; };
  EXPECT_EQ(derivative_refusal(rig, solver, segment), "");
  rig.contact.position = rig.beam.length;
  EXPECT_THAT(derivative_refusal(rig, ancf(4, 0, 1e-6, 1e-3), segment),
              testing::StartsWith("the bar is struck at its tip, "));
  rig.contact.position = 0.69;
  const Rig uniform = rig;
  rig.beam.segments = {rig.beam.segments[0], rig.beam.segments[0]};
  rig.beam.segments[0].length = 0.69;
  rig.beam.segments[1].length = 0.11;
  for (const RigParameter parameter : {segment, position})
    EXPECT_THAT(derivative_refusal(rig, solver, parameter),
                testing::StartsWith("beside it the bar would be divided into its elements"));
  EXPECT_EQ(derivative_refusal(rig, hybrid(Basis::cantilever, 3, 1e-6, 1e-3), segment), "");
  EXPECT_TRUE(small(rig, solver, {segment}).sensitivities.empty());
  EXPECT_TRUE(sharp(rig, solver, Motion::full, {segment}).sensitivities.empty());
  rig = uniform;
  rig.contact.damping = "tsuji";
  rig.contact.tension = Tension::allow;
  EXPECT_THAT(derivative_refusal(rig, solver, position),
              testing::StartsWith("with this damping law "));
  rig.hinge.rotation = HingeRotation{.rate = 1.0, .time = 0.0};
  rig.contact.law = "none";
  constexpr RigParameter time = [](Rig& r) -> double& { return r.hinge.rotation->time; };
  EXPECT_THAT(derivative_refusal(rig, solver, time),
              testing::StartsWith("without a time the hinge "));
}

TEST(Sensitivities, LeaveTheRunAsItIs) {
  const Rig rig = damped_rig();
  const Simulation plain = small(rig, hybrid(Basis::pinned_free, 5, 1e-12, 5e-4));
  const Simulation followed =
      small(rig, hybrid(Basis::pinned_free, 5, 1e-12, 5e-4), {parameters[0].of});
  EXPECT_NEAR(followed.peak_force / plain.peak_force, 1.0, 1e-12);
  EXPECT_NEAR(followed.episodes.front().end / plain.episodes.front().end, 1.0, 1e-12);
}

}  // namespace
}  // namespace impactrig::tests
