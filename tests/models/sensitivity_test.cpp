// SPDX-License-Identifier: BSD-3-Clause
//
// Oracle: differences of simulations at accuracy 1e-12, of the sixth order in the parameter, which
// know nothing of sensitivities.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "models/contact/contact_force.hpp"
#include "models/modal/bar_cache.hpp"
#include "models/simulation.hpp"
#include "tests/models/scenes.hpp"

namespace impactrig::tests {
namespace {

using namespace models;

struct Named {
  const char* name;
  RigParameter of;
};

constexpr std::array parameters = {
    Named{"restitution", [](Rig& r) -> double& { return r.contact.restitution; }},
    Named{"stiffness_factor", [](Rig& r) -> double& { return r.contact.stiffness_factor; }},
    Named{"velocity", [](Rig& r) -> double& { return r.start.velocity; }},
    Named{"length", [](Rig& r) -> double& { return r.contact.length; }},
    Named{"modulus", [](Rig& r) -> double& { return r.contact.modulus; }},
    Named{"radius", [](Rig& r) -> double& { return r.contact.radius; }},
    Named{"counter_radius", [](Rig& r) -> double& { return r.contact.counter_radius; }},
    Named{"youngs_modulus", [](Rig& r) -> double& { return r.beam.youngs_modulus; }},
    Named{"density", [](Rig& r) -> double& { return r.beam.density; }},
    Named{"gravity", [](Rig& r) -> double& { return r.gravity; }},
    // moving places shift vibrations: differences need scenes where they shift little
    Named{"position", [](Rig& r) -> double& { return r.contact.position; }},
    Named{"beam length", [](Rig& r) -> double& { return r.beam.length; }},
};

constexpr std::span<const Named> without_places =
    std::span(parameters).first(parameters.size() - 2);

constexpr std::array of_damped_bars = {
    Named{"mass damping", [](Rig& r) -> double& { return r.beam.damping.mass; }},
    Named{"stiffness damping", [](Rig& r) -> double& { return r.beam.damping.stiffness; }},
    Named{"viscous hinge", [](Rig& r) -> double& { return r.hinge.viscous; }},
    Named{"spring", [](Rig& r) -> double& { return r.hinge.spring; }},
    Named{"restitution", [](Rig& r) -> double& { return r.contact.restitution; }},
    Named{"velocity", [](Rig& r) -> double& { return r.start.velocity; }},
    Named{"youngs_modulus", [](Rig& r) -> double& { return r.beam.youngs_modulus; }},
    Named{"density", [](Rig& r) -> double& { return r.beam.density; }},
    Named{"position", [](Rig& r) -> double& { return r.contact.position; }},
    Named{"beam length", [](Rig& r) -> double& { return r.beam.length; }},
};

constexpr std::array of_compliant_stops = {
    Named{"stop mass", [](Rig& r) -> double& { return r.stop->mass; }},
    Named{"stop stiffness", [](Rig& r) -> double& { return r.stop->stiffness; }},
    Named{"stop viscous", [](Rig& r) -> double& { return r.stop->viscous; }},
    Named{"restitution", [](Rig& r) -> double& { return r.contact.restitution; }},
    Named{"stiffness_factor", [](Rig& r) -> double& { return r.contact.stiffness_factor; }},
    Named{"velocity", [](Rig& r) -> double& { return r.start.velocity; }},
    Named{"youngs_modulus", [](Rig& r) -> double& { return r.beam.youngs_modulus; }},
    Named{"position", [](Rig& r) -> double& { return r.contact.position; }},
};

constexpr std::array of_further_stops = {
    Named{"gap", [](Rig& r) -> double& { return r.further_stops[0].gap; }},
    Named{"its factor",
          [](Rig& r) -> double& { return r.further_stops[0].contact.stiffness_factor; }},
    Named{"its restitution",
          [](Rig& r) -> double& { return r.further_stops[0].contact.restitution; }},
    Named{"its position", [](Rig& r) -> double& { return r.further_stops[0].contact.position; }},
    Named{"restitution", [](Rig& r) -> double& { return r.contact.restitution; }},
    Named{"stiffness_factor", [](Rig& r) -> double& { return r.contact.stiffness_factor; }},
    Named{"velocity", [](Rig& r) -> double& { return r.start.velocity; }},
    Named{"youngs_modulus", [](Rig& r) -> double& { return r.beam.youngs_modulus; }},
    Named{"density", [](Rig& r) -> double& { return r.beam.density; }},
    Named{"position", [](Rig& r) -> double& { return r.contact.position; }},
};

Rig damped_rig() {
  Rig rig = paper_rig();
  rig.gravity = 9.81;
  rig.contact.damping = "lankarani-nikravesh";
  rig.contact.restitution = 0.5;
  return rig;
}

Simulation small(const Rig& rig, Solver solver, std::vector<RigParameter> by = {}) {
  solver.accuracy = 1e-12;
  SimulationOptions options;
  options.motion = Motion::small;
  options.history = {.interval = 5e-6, .lead = 2e-5, .velocity_position = 0.6};
  options.sensitivities = std::move(by);
  return simulate(rig, solver, options);
}

/// What is differentiated, one number after the other.
std::vector<double> numbers(const Simulation& run) {
  const Episode& e = run.episodes.front();
  return {e.peak_force,
          e.max_penetration,
          e.end,
          e.impulse,
          e.separation_velocity,
          run.restitution.kinematic,
          run.restitution.kinetic,
          run.restitution.energetic,
          run.sensor ? run.sensor->peak_force : 1.0};
}

std::vector<double> numbers(const Sensitivity& s) {
  return {s.peak_force,
          s.max_penetration,
          s.duration,
          s.impulse,
          s.separation_velocity,
          s.restitution.kinematic,
          s.restitution.kinetic,
          s.restitution.energetic,
          s.sensor_peak_force};
}

/// What a history shows, one channel after the other.
std::vector<std::vector<double>> channels(const History& history) {
  std::vector<std::vector<double>> all = {history.force, history.penetration, history.velocity,
                                          history.displacement};
  if (!history.sensor_force.empty()) all.push_back(history.sensor_force);
  for (const StopHistory& stop : history.further) {
    all.push_back(stop.force);
    all.push_back(stop.penetration);
  }
  return all;
}

double size_for(const Rig& rig, const Named& parameter) {
  Rig copy = rig;
  const std::string name = parameter.name;
  if (name == "position" || name == "beam length") return copy.beam.length - copy.contact.position;
  if (name == "its position") return copy.beam.length - parameter.of(copy);
  return name.ends_with("radius") ? copy.contact.counter_radius - copy.contact.radius
                                  : parameter.of(copy);
}

/// Differences of simulations by a parameter.
struct Differences {
  std::vector<double> numbers;
  std::vector<std::vector<double>> channels;
};

Differences differences(const Rig& rig, const Solver& solver, const Named& parameter, double step) {
  // central, of the sixth order
  constexpr std::array offsets = {-3.0, -2.0, -1.0, 1.0, 2.0, 3.0};
  constexpr std::array weights = {-1.0, 9.0, -45.0, 45.0, -9.0, 1.0};
  const double spacing = step * size_for(rig, parameter);
  Differences sum;
  for (std::size_t j = 0; j < weights.size(); ++j) {
    Rig there = rig;
    parameter.of(there) += offsets[j] * spacing;
    const Simulation run = small(there, solver);
    const double weight = weights[j] / (60.0 * spacing);
    const std::vector<double> values = numbers(run);
    sum.numbers.resize(values.size(), 0.0);
    for (std::size_t k = 0; k < values.size(); ++k) sum.numbers[k] += weight * values[k];
    const std::vector<std::vector<double>> parts = channels(run.history);
    sum.channels.resize(parts.size());
    for (std::size_t c = 0; c < parts.size(); ++c) {
      sum.channels[c].resize(parts[c].size(), 0.0);
      for (std::size_t k = 0; k < parts[c].size(); ++k) sum.channels[c][k] += weight * parts[c][k];
    }
  }
  return sum;
}

/// Whether the force begins or ends within ten samples: the differences straddle the corner.
bool beside_event(const std::vector<double>& force, std::size_t sample) {
  const std::size_t first = sample < 10 ? 0 : sample - 10;
  const std::size_t last = std::min(sample + 11, force.size());
  const auto pressed = std::count_if(force.begin() + static_cast<std::ptrdiff_t>(first),
                                     force.begin() + static_cast<std::ptrdiff_t>(last),
                                     [](double f) { return f > 0.0; });
  return pressed > 0 && pressed < static_cast<std::ptrdiff_t>(last - first);
}

/// At any stop.
bool beside_event(const Simulation& run, std::size_t sample) {
  return beside_event(run.history.force, sample) ||
         std::ranges::any_of(run.history.further, [&](const StopHistory& stop) {
           return beside_event(stop.force, sample);
         });
}

/// Relative to the value's own size over that of the parameter: where a derivative is nearly zero
/// the differences have nothing more exact to offer.
void expect_equal_derivatives(const Rig& rig, const Solver& solver, double tolerance,
                              std::span<const Named> of = parameters, double spacing = 1e-3) {
  std::vector<RigParameter> by;
  for (const Named& parameter : of) by.push_back(parameter.of);
  const Simulation run = small(rig, solver, by);
  ASSERT_EQ(run.sensitivities.size(), of.size());
  const std::vector<double> values = numbers(run);
  for (std::size_t i = 0; i < of.size(); ++i) {
    SCOPED_TRACE(of[i].name);
    const double size = size_for(rig, of[i]);
    const Differences d = differences(rig, solver, of[i], spacing);
    const std::vector<double> slopes = numbers(run.sensitivities[i]);
    for (std::size_t k = 0; k < slopes.size(); ++k)
      EXPECT_NEAR(slopes[k] * size / values[k], d.numbers[k] * size / values[k], tolerance) << k;
    const std::vector<std::vector<double>> mine = channels(run.sensitivities[i].history);
    const std::vector<std::vector<double>> shown = channels(run.history);
    ASSERT_EQ(mine.size(), shown.size());
    for (std::size_t c = 0; c < mine.size(); ++c) {
      ASSERT_EQ(mine[c].size(), shown[c].size()) << c;
      double scale = 0.0, worst = 0.0;
      std::size_t at = 0;
      for (std::size_t k = 0; k < mine[c].size(); ++k) {
        if (beside_event(run, k)) continue;
        scale = std::max(scale, std::abs(shown[c][k]));
        if (const double off = std::abs(mine[c][k] - d.channels[c][k]); off > worst) {
          worst = off;
          at = k;
        }
      }
      // fast vibration after the contact: a change of its frequency is a large one of its phase
      EXPECT_LT(worst * size / scale, 30.0 * tolerance) << "channel " << c << ", sample " << at;
    }
  }
}

TEST(Sensitivities, OfAncfAreThoseOfDifferences) {
  expect_equal_derivatives(damped_rig(), ancf(5, 1, 1e-12, 5e-4), 1e-8);
}

TEST(Sensitivities, OfHybridAreThoseOfDifferences) {
  expect_equal_derivatives(damped_rig(), hybrid(Basis::pinned_free, 5, 1e-12, 5e-4), 1e-8);
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

TEST(Sensitivities, AreOfSmallMotionOnly) {
  SimulationOptions options;
  options.exact = true;
  options.sensitivities = {[](Rig& r) -> double& { return r.contact.restitution; }};
  const Simulation run = simulate(damped_rig(), hybrid(Basis::pinned_free, 2, 1e-4, 5e-4), options);
  EXPECT_TRUE(run.sensitivities.empty());
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
