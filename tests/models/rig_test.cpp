// SPDX-License-Identifier: BSD-3-Clause
#include "models/rig.hpp"

#include <gmock/gmock.h>

#include <functional>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "models/contact/damping_law.hpp"
#include "models/contact/elastic_law.hpp"
#include "tests/models/law_names.hpp"
#include "tests/models/scenes.hpp"

namespace {

using namespace impactrig::models;
using impactrig::tests::names_of;
using impactrig::tests::paper_rig;
using testing::ThrowsMessage;

struct Refusal {
  std::function<void(Rig&, Solver&)> spoil;
  std::string message;
};

void expect_refusals(const std::vector<Refusal>& refusals) {
  for (const Refusal& refusal : refusals) {
    Rig rig = paper_rig();
    Solver solver;
    ASSERT_NO_THROW(validate(rig, solver));
    refusal.spoil(rig, solver);
    EXPECT_THAT([&] { validate(rig, solver); },
                ThrowsMessage<std::invalid_argument>(refusal.message));
    EXPECT_THAT([&] { simulate(rig, solver); },
                ThrowsMessage<std::invalid_argument>(refusal.message));
  }
}

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

TEST(Validate, RefusesBarsThatCannotBe) {
  expect_refusals({
      {[](Rig& r, Solver&) { r.beam.length = -0.8; },
       "beam.length: must be greater than zero, found -0.8 m"},
      {[](Rig& r, Solver&) { r.beam.length = nan; },
       "beam.length: must be greater than zero, found nan m"},
      {[](Rig& r, Solver&) { r.beam.area = 0.0; },
       "beam.section (area): must be greater than zero, found 0 m^2"},
      {[](Rig& r, Solver&) { r.beam.second_moment = -1.0; },
       "beam.section (second moment): must be greater than zero, found -1 m^4"},
      {[](Rig& r, Solver&) { r.beam.youngs_modulus = infinity; },
       "beam.youngs_modulus: must be finite, found inf Pa"},
      {[](Rig& r, Solver&) { r.beam.density = 0.0; },
       "beam.density: must be greater than zero, found 0 kg/m^3"},
  });
}

TEST(Validate, RefusesContactsThatCannotBe) {
  expect_refusals({
      {[](Rig& r, Solver&) { r.contact.position = 0.0; },
       "contact.position: must be greater than zero, found 0 m"},
      {[](Rig& r, Solver&) { r.contact.position = 0.9; },
       "contact.position: the struck point, 0.9 m from the hinge, lies beyond the bar's end at 0.8 "
       "m"},
      {[](Rig& r, Solver&) { r.contact.restitution = 1.01; },
       "contact.restitution: must lie between 0 and 1, found 1.01"},
      {[](Rig& r, Solver&) { r.contact.restitution = -0.1; },
       "contact.restitution: must lie between 0 and 1, found -0.1"},
      {[](Rig& r, Solver&) { r.contact.restitution = nan; },
       "contact.restitution: must lie between 0 and 1, found nan"},
      {[](Rig& r, Solver&) {
         r.contact.damping = "exact";
         r.contact.restitution = 0.004;
       },
       "contact.restitution: 0.004 needs more damping than the law 'exact' can give; use 0.005 or "
       "more"},
      {[](Rig& r, Solver&) { r.contact.damping = "dashpot"; },
       "contact.damping: there is no damping law 'dashpot'; known are " + names_of(damping_laws())},
      {[](Rig& r, Solver&) { r.contact.law = "hertz"; },
       "contact.law: there is no elastic law 'hertz'; known are " + names_of(elastic_laws())},
      {[](Rig& r, Solver&) { r.contact.stiffness_factor = 0.0; },
       "contact.stiffness_factor: must be greater than zero, found 0"},
      {[](Rig& r, Solver&) {
         r.contact.law = "linear";
         r.contact.stiffness = 0.0;
       },
       "contact.stiffness: must be greater than zero, found 0 N/m"},
      {[](Rig& r, Solver&) { r.contact.length = 0.0; },
       "contact.length: must be greater than zero, found 0 m"},
      {[](Rig& r, Solver&) { r.contact.radius = -0.01; },
       "contact.radius: must be greater than zero, found -0.01 m"},
      {[](Rig& r, Solver&) { r.contact.modulus = 0.0; },
       "contact.modulus: must be greater than zero, found 0 Pa"},
      {[](Rig& r, Solver&) { r.contact.counter_modulus = 0.0; },
       "contact.counter_modulus: must be greater than zero, found 0 Pa"},
      {[](Rig& r, Solver&) { r.beam.poisson_ratio = r.contact.poisson_ratio = 0.6; },
       "beam.poisson_ratio: must lie between -1 and 0.5, found 0.6"},
      {[](Rig& r, Solver&) { r.contact.poisson_ratio = 0.6; },
       "contact.poisson_ratio: must lie between -1 and 0.5, found 0.6"},
      {[](Rig& r, Solver&) { r.contact.counter_poisson_ratio = -1.0; },
       "contact.counter_poisson_ratio: must lie between -1 and 0.5, found -1"},
      {[](Rig& r, Solver&) {
         r.contact.law = "lankarani-nikravesh-cylinder";
         r.contact.stiffness = 1e9;
         r.contact.power = 7.0;
       },
       "contact.stiffness: the power of the penetration, in its unit, must lie between 1 and 5, "
       "found 7"},
      {[](Rig& r, Solver&) { r.contact.counter_depth = -1e-3; },
       "contact.counterface.depth: must be finite and not negative, found -0.001 m"},
      {[](Rig& r, Solver&) { r.contact.exponent = 2; },
       "contact.exponent: must be 1 (as the paper prints it) or 3 (consistent in units), found 2"},
      {[](Rig& r, Solver&) { r.contact.counter_radius = 0.0; },
       "contact.counterface.radius: must be greater than zero, found 0 m"},
      {[](Rig& r, Solver&) { r.contact.counter_radius = 0.015; },
       "contact.counterface.radius: a groove of radius 0.015 m cannot take a bar of radius 0.015 "
       "m; it must be wider"},
  });
}

TEST(Validate, RefusesHingesThatPush) {
  expect_refusals({
      {[](Rig& r, Solver&) { r.hinge.spring = -1.0; },
       "hinge.spring: must be finite and not negative, found -1 N.m/rad"},
      {[](Rig& r, Solver&) { r.hinge.spring = infinity; },
       "hinge.spring: must be finite and not negative, found inf N.m/rad"},
      {[](Rig& r, Solver&) { r.hinge.viscous = -0.1; },
       "hinge.viscous: must be finite and not negative, found -0.1 N.m.s/rad"},
      {[](Rig& r, Solver&) { r.hinge.viscous = nan; },
       "hinge.viscous: must be finite and not negative, found nan N.m.s/rad"},
  });
}

TEST(Validate, RefusesDampingThatFeedsTheBar) {
  expect_refusals({
      {[](Rig& r, Solver&) { r.beam.damping.mass = -2.0; },
       "beam.damping.mass: must be finite and not negative, found -2 1/s"},
      {[](Rig& r, Solver&) { r.beam.damping.stiffness = -1e-6; },
       "beam.damping.stiffness: must be finite and not negative, found -1e-06 s"},
      {[](Rig& r, Solver&) { r.beam.damping.stiffness = infinity; },
       "beam.damping.stiffness: must be finite and not negative, found inf s"},
  });
}

// What every release that comes to nothing is told.
const std::string no_way =
    "weight and hinge.spring do not turn it there, hinge.friction holds it, or damping stops it on "
    "the way; environment.gravity_direction says where down is";

TEST(Validate, RefusesGravityWithoutADirectionAndReleasesItLetsFallAway) {
  expect_refusals({
      {[](Rig& r, Solver&) { r.gravity_direction = 3.2; },
       "environment.gravity_direction: must lie between -180 and 180 degrees, found 183.346 "
       "degrees"},
      {[](Rig& r, Solver&) { r.gravity_direction = nan; },
       "environment.gravity_direction: must lie between -180 and 180 degrees, found nan degrees"},
      // upright it falls to the other side
      {[](Rig& r, Solver&) {
         r.gravity = 9.81;
         r.gravity_direction = std::numbers::pi;
         r.start.release_angle = 0.2;
       },
       "start.release_angle: released at 11.4592 degrees the bar does not swing against the "
       "stop: " +
           no_way},
      // from beyond the top
      {[](Rig& r, Solver&) {
         r.gravity = 9.81;
         r.gravity_direction = 2.0;
         r.start.release_angle = 1.2;
       },
       "start.release_angle: released at 68.7549 degrees the bar does not swing against the "
       "stop: " +
           no_way},
      // gravity holds it 0.4 rad away from the stop: it does not swing further than that beyond
      {[](Rig& r, Solver&) {
         r.gravity = 9.81;
         r.gravity_direction = -0.4;
         r.start.release_angle = 0.79;
       },
       "start.release_angle: released at 45.2637 degrees the bar does not swing against the "
       "stop: " +
           no_way},
      // nearly upright: the spring turns it and its energy would do, but for a hill on the way
      {[](Rig& r, Solver&) {
         r.gravity = 9.81;
         r.gravity_direction = 3.1;
         r.hinge.spring = 5.03;
         r.start.release_angle = 1.31;
       },
       "start.release_angle: released at 75.0575 degrees the bar does not swing against the "
       "stop: " +
           no_way},
  });
  Rig rig = paper_rig();
  rig.gravity = 9.81;
  rig.gravity_direction = -0.4;
  rig.start.release_angle = 0.81;
  EXPECT_NO_THROW(validate(rig, Solver{}));
  rig.gravity_direction = -std::numbers::pi;
  rig.start = {.velocity = 0.4, .release_angle = {}};
  EXPECT_NO_THROW(validate(rig, Solver{}));
}

TEST(Validate, RefusesMassesThatAreNoneOrNotOnTheBar) {
  expect_refusals({
      {[](Rig& r, Solver&) {
         r.beam.masses = {{0.4, 0.1}, {0.9, 0.1}};
       },
       "beam.masses.2.position: the mass, 0.9 m from the hinge, lies beyond the bar's end at 0.8 "
       "m"},
      {[](Rig& r, Solver&) {
         r.beam.masses = {{0.0, 0.1}};
       },
       "beam.masses.1.position: must be greater than zero, found 0 m"},
      {[](Rig& r, Solver&) {
         r.beam.masses = {{0.4, -0.1}};
       },
       "beam.masses.1.mass: must be greater than zero, found -0.1 kg"},
      {[](Rig& r, Solver&) {
         r.beam.masses = {{0.4, infinity}};
       },
       "beam.masses.1.mass: must be finite, found inf kg"},
  });
}

TEST(Validate, RefusesStartsThatNeverTouch) {
  expect_refusals({
      {[](Rig& r, Solver&) { r.start.velocity = 0.0; },
       "start.velocity: must be greater than zero, found 0 m/s"},
      {[](Rig& r, Solver&) { r.gravity = -9.81; },
       "environment.gravity: must be finite and not negative, found -9.81 m/s^2"},
      {[](Rig& r, Solver&) { r.start.release_angle = 0.2; },
       "start.release_angle: a release needs gravity or a spring; environment.gravity is zero and "
       "so is hinge.spring"},
      {[](Rig& r, Solver&) {
         r.start.release_angle = 0.2;
         r.hinge = {.spring = 1.0, .viscous = 20.0};
       },
       "start.release_angle: released at 11.4592 degrees the bar does not swing against the "
       "stop: " +
           no_way},
      {[](Rig& r, Solver&) { r.start.release_angle = 3.2; },
       "start.release_angle: must lie between 0 and 180 degrees, found 183.346 degrees"},
      {[](Rig& r, Solver&) { r.start.release_angle = -0.1; },
       "start.release_angle: must lie between 0 and 180 degrees, found -5.72958 degrees"},
  });
}

TEST(Validate, RefusesSolversThatCannotWork) {
  expect_refusals({
      {[](Rig&, Solver& s) { s.accuracy = 1e-14; },
       "solver.accuracy: must lie between 1e-13 and 0.1, found 1e-14"},
      {[](Rig&, Solver& s) { s.accuracy = nan; },
       "solver.accuracy: must lie between 1e-13 and 0.1, found nan"},
      {[](Rig&, Solver& s) { s.duration = 0.0; },
       "solver.duration: must be greater than zero, found 0 s"},
      {[](Rig&, Solver& s) { s.duration = infinity; },
       "solver.duration: must be finite, found inf s"},
      {[](Rig&, Solver& s) {
         s.elements = {0, 2};
       },
       "solver.elements: needs at least one element on each side of the struck point and 4096 in "
       "all, found [0, 2]"},
      {[](Rig&, Solver& s) {
         s.elements = {2, 0};
       },
       "solver.elements: needs at least one element on each side of the struck point and 4096 in "
       "all, found [2, 0]"},
      {[](Rig&, Solver& s) {
         s.elements = {4096, 1};
       },
       "solver.elements: needs at least one element on each side of the struck point and 4096 in "
       "all, found [4096, 1]"},
      {[](Rig&, Solver& s) {
         s.elements = {2147483647, 2147483647};
       },
       "solver.elements: needs at least one element on each side of the struck point and 4096 in "
       "all, found [2147483647, 2147483647]"},
      {[](Rig& r, Solver& s) {
         r.contact.position = r.beam.length;
         s.elements = {4, 1};
       },
       "solver.elements: the struck point is the bar's tip: the second number must be 0, found 1"},
      {[](Rig&, Solver& s) {
         s.model = BeamModel::hybrid;
         s.modes = 0;
       },
       "solver.modes: must lie between 1 and 240, found 0"},
      {[](Rig&, Solver& s) {
         s.model = BeamModel::hybrid;
         s.modes = 241;
       },
       "solver.modes: must lie between 1 and 240, found 241"},
      {[](Rig&, Solver& s) {
         s.model = BeamModel::hybrid;
         s.axial_modes = -1;
       },
       "solver.axial_modes: must lie between 0 and 240, found -1"},
  });
}

TEST(Validate, LooksOnlyAtWhatTheChosenLawAndModelUse) {
  Rig rig = paper_rig();
  Solver solver;
  solver.model = BeamModel::rigid;
  solver.elements = {0, 0};
  solver.modes = -3;
  rig.contact.law = "linear";
  rig.contact.stiffness = 1e7;
  rig.contact.radius = 0.0;
  EXPECT_NO_THROW(validate(rig, solver));
  rig = paper_rig();
  rig.contact.counterface = Counterface::plane;
  rig.contact.counter_radius = 0.0;
  EXPECT_NO_THROW(validate(rig, solver));
}

TEST(Names, OfModelsAndBasesAreThoseOfTheRigFile) {
  EXPECT_EQ(name(BeamModel::rigid), "rigid");
  EXPECT_EQ(name(BeamModel::hybrid), "hybrid");
  EXPECT_EQ(name(BeamModel::ancf), "ancf");
  EXPECT_EQ(name(Basis::cantilever), "cantilever");
  EXPECT_EQ(name(Basis::pinned_free), "pinned-free");
  EXPECT_THAT([] { name(static_cast<BeamModel>(7)); },
              ThrowsMessage<std::logic_error>("name: beam model out of range"));
}

}  // namespace
