// SPDX-License-Identifier: BSD-3-Clause
//
// What a user states of single parameters: priors, ties, bounds, shared, own, fixed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "fitting/fit.hpp"
#include "fitting/fit_problem.hpp"
#include "fitting/fit_report.hpp"
#include "tests/fitting/fast_fit.hpp"

namespace impactrig::fitting {
namespace {

using tests::hybrid_rig;
using tests::parameter;
using tests::pull;
using tests::synthetic_shot;

datasets::Impact shot(double restitution = 0.5, std::uint64_t seed = 1) {
  return synthetic_shot(hybrid_rig(),
                        {.restitution = restitution, .duration = 1.6e-3, .seed = seed});
}

bool has(const Fit& fit, const std::string& name) {
  for (const Parameter& p : fit.parameters)
    if (p.name == name) return true;
  return false;
}

TEST(FitSettings, ASearchEndsWhenItsTimeIsOver) {
  const RigFile rig = hybrid_rig();
  FitOptions options;
  options.time_limit = 1e-9;
  const Fit stopped = fit({shot()}, rig, options);
  EXPECT_THAT(stopped.termination, testing::HasSubstr("fit.time_limit"));
  EXPECT_EQ(stopped.iterations, 0);
  EXPECT_EQ(parameter(stopped, "contact.restitution").value, 0.5);  // where it began
  EXPECT_GT(parameter(stopped, "contact.restitution").std_error, 0.0);
  EXPECT_EQ(fit({shot()}, rig).termination, "converged");
}

TEST(FitSettings, WhatIsStatedOfAChannelThatIsNotFittedIsTold) {
  FitOptions options;
  options.setting("sensors.displacement.gain").prior = {1.0, 0.01};
  const auto unused =
      testing::Contains(testing::StartsWith("What is stated of sensors.displacement.gain"));
  EXPECT_THAT(fit({shot()}, hybrid_rig(), options).warnings, unused);
  options.setting("sensors.displacement.gain").fixed = true;
  EXPECT_THAT(fit({shot()}, hybrid_rig(), options).warnings, testing::Not(unused));
  FitOptions asked;
  asked.free = {"contact.restitution", "start.velocity", "sensors.displacement.gain"};
  EXPECT_THAT(fit({shot()}, hybrid_rig(), asked).warnings,
              testing::Contains(testing::StartsWith("sensors.displacement.gain was not fitted")));
}

// A force whose certificate, of 0.5 %, is wrong by 10 %.
TEST(FitSettings, ACalibrationThatTheDataContradictIsTold) {
  const RigFile rig = hybrid_rig();
  datasets::Impact impact = shot();
  impact.force->gain_uncertainty = 0.005;
  const auto told = testing::Contains(testing::StartsWith("sensors.force.gain ended"));
  EXPECT_THAT(fit({impact}, rig).warnings, testing::Not(told));
  EXPECT_FALSE(parameter(fit({impact}, rig), "sensors.force.gain").contradicts_prior);
  for (double& value : impact.force->values) value *= 1.1;
  const Fit found = fit({impact}, rig);
  EXPECT_THAT(found.warnings, told);
  EXPECT_TRUE(parameter(found, "sensors.force.gain").contradicts_prior);
}

// A laser 60 us late: the data tell how far the channels are apart, not which one is late.
TEST(FitSettings, DelaysThatTheDataMoveApartAreOneFact) {
  const RigFile rig = hybrid_rig();
  datasets::Impact impact = shot();
  impact.force->delay_uncertainty = 0.3e-6;
  impact.velocity->delay_uncertainty = 0.1e-6;
  const auto of_delay = testing::Contains(testing::HasSubstr(".delay"));
  EXPECT_THAT(fit({impact}, rig).warnings, testing::Not(of_delay));
  impact.velocity->start += 60e-6;
  const Fit found = fit({impact}, rig);
  EXPECT_THAT(found.warnings,
              testing::Contains(testing::MatchesRegex(
                  "The velocity shows the impact (59.9|60|60.1) us later than the "
                  "force does.*sensors.velocity.delay and sensors.force.delay\\..*")));
  EXPECT_THAT(found.warnings, testing::Not(testing::Contains(testing::HasSubstr(".delay ended"))));
  EXPECT_TRUE(parameter(found, "sensors.force.delay").contradicts_prior);
  EXPECT_TRUE(parameter(found, "sensors.velocity.delay").contradicts_prior);
}

// A force 60 us late beside velocity and displacement of one laser: both are told.
TEST(FitSettings, ADelayThatTwoOthersContradictIsToldOfBoth) {
  const RigFile rig = hybrid_rig();
  datasets::Impact impact = shot();
  impact.displacement = impact.velocity;
  impact.displacement->quantity = datasets::Quantity::displacement;
  impact.displacement->channel = "Displacement";
  double way = 0.0;
  for (double& value : impact.displacement->values)
    way += impact.displacement->interval * std::exchange(value, way);
  impact.displacement->noise = 1e-8;
  for (auto* signal : {&impact.force, &impact.velocity, &impact.displacement})
    (*signal)->delay_uncertainty = 0.2e-6;
  impact.force->start += 60e-6;
  FitOptions options;
  options.use_displacement = true;
  const Fit found = fit({impact}, rig, options);
  EXPECT_THAT(
      found.warnings,
      testing::Contains(testing::HasSubstr("sensors.force.delay and sensors.velocity.delay.")));
  EXPECT_THAT(
      found.warnings,
      testing::Contains(testing::HasSubstr("sensors.force.delay and sensors.displacement.delay.")));
}

// Gains of 0.5 % share what one is wrong by: each ends 2.5 of its standard uncertainties off, which
// is 3.5 / √2 times what right ones allow, the other way round.
TEST(FitSettings, CalibrationsThatContradictEachOtherAreTold) {
  const RigFile rig = hybrid_rig();
  datasets::Impact impact = shot();
  impact.force->gain_uncertainty = impact.velocity->gain_uncertainty = 0.005;
  const auto told =
      testing::Contains(testing::AllOf(testing::HasSubstr(".gain ended"),
                                       testing::HasSubstr("as right calibrations usually let it")));
  EXPECT_THAT(fit({impact}, rig).warnings, testing::Not(told));
  for (double& value : impact.force->values) value *= 1.025;
  const Fit found = fit({impact}, rig);
  const Parameter& gain = parameter(found, "sensors.force.gain");
  EXPECT_LT(std::abs(gain.value - 1.0), 4.0 * 0.005);
  EXPECT_THAT(found.warnings, told);
}

// Near its optimum a fit is linear: two independent sources, x ± s and m ± p, make
// (x/s² + m/p²) / (1/s² + 1/p²) ± 1/√(1/s² + 1/p²). Searches end within a hundredth of a standard
// error; curvature over two of them is as small.
TEST(FitSettings, APriorPullsByTheClosedForm) {
  const RigFile rig = hybrid_rig();
  const datasets::Impact impact = shot();
  const Parameter without = parameter(fit({impact}, rig), "contact.stiffness_factor");
  for (const double width : {0.5, 2.0}) {
    const double s = without.std_error, p = width * s, m = without.value + 2.0 * s;
    FitOptions options;
    options.setting("contact.stiffness_factor").prior = {m, p};
    const Parameter with = parameter(fit({impact}, rig, options), "contact.stiffness_factor");
    const double weight = 1.0 / (s * s) + 1.0 / (p * p);
    EXPECT_NEAR(with.value, (without.value / (s * s) + m / (p * p)) / weight, 0.03 * s);
    EXPECT_NEAR(with.std_error / std::sqrt(1.0 / weight), 1.0, 0.01);
    EXPECT_EQ(with.prior, (std::optional<std::array<double, 2>>{{m, p}}));
  }
}

// The same optimum, prior or not, and the interval as far by a factor as it was by a difference.
TEST(FitSettings, ByItsLogarithmAParameterHasTheSameOptimum) {
  const datasets::Impact impact = shot();
  for (const bool told : {false, true}) {
    FitOptions options;
    ParameterSetting& setting = options.setting("contact.stiffness_factor");
    if (told) setting.prior = {1.0005, 3e-4};
    const Parameter linear = parameter(fit({impact}, hybrid_rig(), options), setting.name);
    setting.by_logarithm = true;
    const Parameter log = parameter(fit({impact}, hybrid_rig(), options), setting.name);
    EXPECT_NEAR(log.value, linear.value, 0.02 * linear.std_error);
    EXPECT_NEAR(log.std_error / linear.std_error, 1.0, 1e-3);
    const double mesh = log.mesh_error;  // goes by no factor
    const double linear_mesh = linear.mesh_error;
    EXPECT_NEAR(std::log((log.ci95[1] - mesh) / log.value),
                (linear.ci95[1] - linear_mesh - linear.value) / linear.value,
                1e-2 * linear.std_error);
    EXPECT_NEAR(std::log(log.value / (log.ci95[0] + mesh)),
                std::log((log.ci95[1] - mesh) / log.value), 1e-12);
  }
}

/// ½ Σρ of data and priors with the rest fitted, as the whole fit has it.
double least_cost(const datasets::Impact& impact, const RigFile& rig, const FitOptions& options) {
  const std::vector<datasets::Impact> impacts = {impact};
  FitProblem problem(impacts, rig, options);
  problem.set_motion(models::Motion::small);
  problem.choose_samples(std::numeric_limits<double>::infinity());
  problem.search(last_search);
  return problem.search(last_search).cost;
}

// By hand: rig files of three moduli, both bodies alike; a parabola through their least costs has
// the best one at its vertex, and 1/s² is its curvature. One body alone would have twice the
// standard error.
TEST(FitSettings, ATieIsOneParameterByHand) {
  const datasets::Impact impact = shot();
  FitOptions options;
  options.free = {"contact.restitution", "start.velocity", "contact.modulus"};
  options.setting("contact.counter_modulus").tie = Tie{.to = "contact.modulus"};
  const Fit found = fit({impact}, hybrid_rig(), options);
  const Parameter& bar = parameter(found, "contact.modulus");
  const Parameter& stop = parameter(found, "contact.counter_modulus");
  EXPECT_EQ(stop.tied_to, "contact.modulus");
  EXPECT_EQ(stop.value, bar.value);
  EXPECT_NEAR(stop.std_error / bar.std_error, 1.0, 1e-12);

  FitOptions rest;
  rest.free = {"contact.restitution", "start.velocity"};
  std::array<double, 3> cost{};
  const double step = 2.0 * bar.std_error;
  for (int k = 0; k < 3; ++k) {
    RigFile rig = hybrid_rig();
    rig.rig.contact.modulus = rig.rig.contact.counter_modulus = bar.value + (k - 1) * step;
    cost[static_cast<std::size_t>(k)] = least_cost(impact, rig, rest);
  }
  const double curvature = (cost[0] - 2.0 * cost[1] + cost[2]) / (step * step);
  const double vertex = bar.value - 0.5 * (cost[2] - cost[0]) / step / curvature;
  EXPECT_NEAR((vertex - bar.value) / bar.std_error, 0.0, 0.03);
  EXPECT_NEAR(bar.std_error * std::sqrt(curvature), 1.0, 0.02);
}

// value = factor · other + offset, and its interval goes along; both are in the rig that is made.
TEST(FitSettings, ATieMayHaveAFactorAndAnOffset) {
  FitOptions options;
  options.setting("contact.modulus").tie =
      Tie{.to = "beam.youngs_modulus", .factor = 0.5, .offset = 30e9};
  options.free = {"contact.restitution", "start.velocity", "beam.youngs_modulus"};
  const Fit found = fit({shot()}, hybrid_rig(), options);
  const Parameter& to = parameter(found, "beam.youngs_modulus");
  const Parameter& tied = parameter(found, "contact.modulus");
  EXPECT_NEAR(tied.value / (0.5 * to.value + 30e9), 1.0, 1e-14);
  EXPECT_NEAR(tied.std_error / (0.5 * to.std_error), 1.0, 1e-12);
  EXPECT_EQ(found.rig.rig.contact.modulus, tied.value);
  EXPECT_EQ(found.rig.rig.beam.youngs_modulus, to.value);
}

TEST(FitSettings, OwnGivesEachShotItsNumber) {
  FitOptions options;
  options.setting("contact.restitution").shared = false;
  options.free = {"contact.restitution", "contact.stiffness_factor", "start.velocity"};
  const Fit found = fit({shot(0.4, 1), shot(0.6, 2)}, hybrid_rig(), options);
  EXPECT_LT(std::abs(pull(found, "contact.restitution[1]", 0.4)), 4.0);
  EXPECT_LT(std::abs(pull(found, "contact.restitution[2]", 0.6)), 4.0);
  EXPECT_LT(std::abs(pull(found, "contact.stiffness_factor", 1.0)), 4.0);
}

// Of a gain of 1.05 that both shots share, both tell.
TEST(FitSettings, SharedTakesOneNumberForAllShots) {
  const auto louder = [](datasets::Impact impact) {
    for (double& value : impact.force->values) value *= 1.05;
    impact.force->noise *= 1.05;
    return impact;
  };
  const std::vector<datasets::Impact> impacts = {louder(shot(0.5, 1)), louder(shot(0.5, 2))};
  FitOptions options;
  options.setting("sensors.force.gain").shared = true;
  const Fit shared = fit(impacts, hybrid_rig(), options);
  EXPECT_LT(std::abs(pull(shared, "sensors.force.gain", 1.05)), 4.0);
  options.setting("sensors.force.gain").shared = false;
  const Fit own = fit(impacts, hybrid_rig(), options);
  EXPECT_FALSE(has(own, "sensors.force.gain"));
  EXPECT_LT(std::abs(pull(own, "sensors.force.gain[1]", 1.05)), 4.0);
  EXPECT_LT(std::abs(pull(own, "sensors.force.gain[2]", 1.05)), 4.0);
  EXPECT_LT(parameter(shared, "sensors.force.gain").std_error,
            parameter(own, "sensors.force.gain[1]").std_error);
}

// A name with a number is one recording's own. What is stated of all goes for the rest of it.
TEST(FitSettings, OneRecordingsOwnMayBeNamed) {
  FitOptions options;
  options.free = {"contact.restitution", "start.velocity"};
  options.setting("start.velocity").upper = 0.9;
  options.setting("start.velocity[2]").prior = {0.45, 1e-9};
  options.setting("start.velocity[2]").lower = 0.2;
  options.setting("start.velocity[3]").fixed = true;
  options.setting("sensors.force.gain[2]").tie = Tie{.to = "sensors.force.gain[1]", .factor = 2.0};
  options.setting("sensors.force.gain[1]").initial = 0.9;
  const RigFile rig = hybrid_rig("0.4 ms");
  const Fit found = fit({shot(0.5, 1), shot(0.5, 2), shot(0.5, 3)}, rig, options);
  EXPECT_FALSE(parameter(found, "start.velocity[1]").prior);
  EXPECT_NEAR(parameter(found, "start.velocity[2]").value, 0.45, 1e-7);
  EXPECT_EQ(parameter(found, "start.velocity[1]").upper, 0.9);
  EXPECT_EQ(parameter(found, "start.velocity[2]").upper, 0.9);
  EXPECT_EQ(parameter(found, "start.velocity[2]").lower, 0.2);
  EXPECT_FALSE(has(found, "start.velocity[3]"));
  EXPECT_EQ(parameter(found, "sensors.force.gain[1]").initial, 0.9);
  EXPECT_EQ(parameter(found, "sensors.force.gain[2]").tied_to, "sensors.force.gain[1]");
  EXPECT_DOUBLE_EQ(parameter(found, "sensors.force.gain[2]").value,
                   2.0 * parameter(found, "sensors.force.gain[1]").value);
  EXPECT_FALSE(has(found, "sensors.force.gain[3]"));
  EXPECT_THAT(found.warnings, testing::Not(testing::Contains(testing::HasSubstr("was not used"))));
}

// All others may go with one of them; of one recording, the first is it.
TEST(FitSettings, OwnNumbersMayGoWithOneOfThem) {
  FitOptions options;
  options.free = {"contact.restitution", "start.velocity[2]"};
  options.setting("sensors.force.gain").tie = Tie{.to = "sensors.force.gain[2]"};
  const RigFile rig = hybrid_rig("0.4 ms");
  const Fit found = fit({shot(0.5, 1), shot(0.5, 2)}, rig, options);
  EXPECT_FALSE(has(found, "start.velocity[1]"));
  EXPECT_TRUE(has(found, "start.velocity[2]"));
  EXPECT_EQ(parameter(found, "sensors.force.gain[1]").tied_to, "sensors.force.gain[2]");
  EXPECT_EQ(parameter(found, "sensors.force.gain[2]").tied_to, "");
  options = {};
  options.setting("start.velocity[1]").prior = {0.45, 1e-9};
  const Fit alone = fit({shot()}, rig, options);
  EXPECT_NEAR(parameter(alone, "start.velocity").value, 0.45, 1e-7);
  EXPECT_THAT(alone.warnings, testing::Not(testing::Contains(testing::HasSubstr("was not used"))));
}

TEST(FitSettings, ARecordingsOwnThatThereIsNotIsRefused) {
  const auto message = [](const std::vector<datasets::Impact>& impacts, const FitOptions& options) {
    try {
      fit(impacts, hybrid_rig("0.4 ms"), options);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  FitOptions beyond;
  beyond.setting("start.velocity[3]").fixed = true;
  EXPECT_THAT(message({shot(0.5, 1), shot(0.5, 2)}, beyond),
              testing::StartsWith("there is no 'start.velocity[3]': there are 2 recordings; each "
                                  "recording's own are start.velocity, impact.time, "));
  EXPECT_THAT(message({shot()}, beyond), testing::HasSubstr("': there is one recording; "));
  FitOptions shared;
  shared.free = {"contact.restitution[2]", "start.velocity"};
  EXPECT_THAT(message({shot(0.5, 1), shot(0.5, 2)}, shared),
              testing::StartsWith(
                  "there is no 'contact.restitution[2]': contact.restitution is shared by all "
                  "recordings, unless --own contact.restitution (fit.contact.restitution.shared = "
                  "false) gives each its own; each recording's own are start.velocity, "));
  FitOptions tied;
  tied.setting("start.velocity").tie = Tie{.to = "contact.restitution[1]"};
  EXPECT_THAT(message({shot(0.5, 1), shot(0.5, 2)}, tied),
              testing::StartsWith("there is no 'contact.restitution[1]': "));
  FitOptions self;
  self.setting("start.velocity[2]").tie = Tie{.to = "start.velocity[2]"};
  EXPECT_EQ(message({shot(0.5, 1), shot(0.5, 2)}, self), "'start.velocity[2]' is tied to itself");
  FitOptions none;
  none.free = {"start.velocity[0]"};
  EXPECT_THAT(message({shot()}, none),
              testing::AllOf(testing::StartsWith("'start.velocity[0]' cannot be fitted; "),
                             testing::EndsWith("; NAME[K] is that of recording K, where each has "
                                               "its own")));
}

TEST(FitSettings, ABoundHoldsAndIsTold) {
  FitOptions options;
  options.setting("contact.restitution").lower = 0.6;
  options.setting("contact.restitution").upper = 0.9;
  const Fit found = fit({shot()}, hybrid_rig(), options);
  const Parameter& p = parameter(found, "contact.restitution");
  EXPECT_TRUE(p.at_bound);
  EXPECT_NEAR(p.value, 0.6, 1e-6);
  EXPECT_EQ(p.lower, 0.6);
  EXPECT_EQ(p.upper, 0.9);
  EXPECT_THAT(found.warnings,
              testing::Contains("contact.restitution ended at its bound 0.6; its interval means "
                                "little. Widen what the model can do, or fix it."));
  options.setting("contact.restitution").lower = 0.3;
  const Parameter free = parameter(fit({shot()}, hybrid_rig(), options), "contact.restitution");
  EXPECT_FALSE(free.at_bound);
  EXPECT_LT(std::abs((free.value - 0.5) / free.std_error), 4.0);
}

TEST(FitSettings, AFixedGainIsNotFitted) {
  datasets::Impact impact = shot();
  impact.force->gain_uncertainty = 0.02;
  ASSERT_TRUE(has(fit({impact}, hybrid_rig()), "sensors.force.gain"));
  FitOptions options;
  options.setting("sensors.force.gain").fixed = true;
  EXPECT_FALSE(has(fit({impact}, hybrid_rig(), options), "sensors.force.gain"));
}

TEST(FitSettings, AFixedParameterStaysWhereTheRigHasIt) {
  FitOptions options;
  options.setting("contact.stiffness_factor").fixed = true;
  const Fit found = fit({shot()}, hybrid_rig(), options);
  EXPECT_FALSE(has(found, "contact.stiffness_factor"));
  EXPECT_EQ(found.rig.rig.contact.stiffness_factor, 1.0);
  EXPECT_LT(std::abs(pull(found, "contact.restitution", 0.5)), 4.0);
}

TEST(FitSettings, BeginsWhereItIsTold) {
  FitOptions options;
  options.setting("contact.restitution").initial = 0.62;
  const Fit found = fit({shot()}, hybrid_rig(), options);
  EXPECT_EQ(parameter(found, "contact.restitution").initial, 0.62);
  EXPECT_LT(std::abs(pull(found, "contact.restitution", 0.5)), 4.0);
}

// The bar of the rig file has no damping: the search begins where it is told, and the bounds go
// with that. The shot is of a bar with it.
TEST(FitSettings, BeginsWhereItIsToldThoughTheRigHasNone) {
  const datasets::Impact impact =
      synthetic_shot(hybrid_rig("1.5 ms", {{"beam.damping.stiffness", "0.2 us"}}),
                     {.duration = 1.6e-3, .seed = 4});
  FitOptions options;
  options.setting("beam.damping.stiffness").initial = 1e-7;
  const Fit found = fit({impact}, hybrid_rig(), options);
  EXPECT_LT(std::abs(pull(found, "beam.damping.stiffness", 2e-7)), 4.0);
  EXPECT_LT(parameter(found, "beam.damping.stiffness").std_error, 1e-8);
  EXPECT_DOUBLE_EQ(parameter(found, "beam.damping.stiffness").upper, 1e-5);
}

// Two simulations of the search a parameter and step would be 10 for each of its Jacobians.
TEST(FitSettings, FitsStopsByTheirDerivatives) {
  RigFile rig = hybrid_rig("0.5 ms", {{"stop.mass", "50 g"}, {"stop.stiffness", "3e8 N/m"}});
  models::FurtherStop second{.contact = rig.rig.contact, .gap = 4e-6};
  second.contact.position = 0.5;
  rig.rig.further_stops = {second};
  const datasets::Impact impact = synthetic_shot(rig, {.duration = 0.6e-3, .seed = 7});
  RigFile other = rig;
  other.rig.stop->stiffness *= 1.15;
  other.rig.further_stops[0].gap *= 0.8;
  FitOptions options;
  options.free = {"contact.restitution", "start.velocity", "stop.stiffness", "contacts.1.gap",
                  "contacts.1.stiffness_factor"};
  const Fit found = fit({impact}, other, options);
  EXPECT_EQ(found.termination, "converged");
  EXPECT_LT(std::abs(pull(found, "contact.restitution", 0.5)), 4.0);
  EXPECT_LT(std::abs(pull(found, "stop.stiffness", 3e8)), 4.0);
  EXPECT_LT(std::abs(pull(found, "contacts.1.gap", 4e-6)), 4.0);
  EXPECT_LT(std::abs(pull(found, "contacts.1.stiffness_factor", 1.0)), 4.0);
  EXPECT_LT(parameter(found, "contacts.1.gap").std_error, 1e-7);
  EXPECT_LT(found.simulations, 60);
}

// A further stop that states no restitution of its own has that of the first, whatever it is found
// to be: held where the search began it would be another rig.
TEST(FitSettings, FurtherStopsGoWithTheFirst) {
  const auto rig = [](const char* e, const std::string& more) {
    return hybrid_rig("0.5 ms",
                      {{"contact.restitution", e},
                       {"contacts", "[{ gap = \"4 um\", position = \"0.5 m\"" + more + " }]"}});
  };
  const datasets::Impact impact = synthetic_shot(
      rig("0.4", ""), {.restitution = 0.4, .stiffness_factor = 1.0, .duration = 0.6e-3});
  const Fit found = fit({impact}, rig("0.8", ""));
  EXPECT_LT(found.goodness.chi2, 1.2 * static_cast<double>(found.goodness.dof));
  EXPECT_LT(std::abs(pull(found, "contact.restitution", 0.4)), 4.0);
  const Parameter& further = parameter(found, "contacts.1.restitution");
  EXPECT_EQ(further.tied_to, "contact.restitution");
  EXPECT_EQ(further.value, parameter(found, "contact.restitution").value);
  EXPECT_EQ(further.ci95, parameter(found, "contact.restitution").ci95);
  EXPECT_EQ(found.rig.rig.further_stops[0].contact.restitution, further.value);

  // one that states its own keeps it, as one that is held does
  const auto names = [&](const RigFile& file, const FitOptions& options) {
    std::vector<std::string> of_further;
    for (const Variable& v : make_variables({impact}, file, options))
      if (v.name.starts_with("contacts.")) of_further.push_back(v.name);
    return of_further;
  };
  EXPECT_EQ(names(rig("0.8", ""), {}),
            (std::vector<std::string>{"contacts.1.restitution", "contacts.1.stiffness_factor"}));
  EXPECT_EQ(names(rig("0.8", ", restitution = 0.4"), {}),
            (std::vector<std::string>{"contacts.1.stiffness_factor"}));
  EXPECT_EQ(names(rig("0.8", ", damping = \"none\""), {}),
            (std::vector<std::string>{"contacts.1.stiffness_factor"}));
  FitOptions held;
  held.setting("contacts.1.stiffness_factor").fixed = true;
  EXPECT_EQ(names(rig("0.8", ""), held), (std::vector<std::string>{"contacts.1.restitution"}));
  FitOptions own;
  own.free = {"contact.restitution", "contacts.1.restitution", "contact.modulus"};
  for (const Variable& v : make_variables({impact}, rig("0.8", ""), own))
    EXPECT_FALSE(v.tie.has_value()) << v.name;
  own.free = {"contact.counter_modulus", "contact.counterface.radius"};
  EXPECT_EQ(
      names(rig("0.8", ""), own),
      (std::vector<std::string>{"contacts.1.counter_modulus", "contacts.1.counterface.radius"}));
}

double chi2_of(const std::vector<datasets::Impact>& impacts, const FitOptions& options) {
  return fit(impacts, hybrid_rig(), options).goodness.chi2;
}

// With a bound in the way the minimum is that of the others with the parameter on it.
TEST(FitSettings, ABoundInTheWayIsNoFalseMinimum) {
  const std::vector<datasets::Impact> impacts = {shot()};
  for (const char* name : {"contact.restitution", "contact.stiffness_factor"}) {
    const double free = parameter(fit(impacts, hybrid_rig(), {}), name).value;
    for (const double part : {0.97, 0.9995, 1.0005, 1.03}) {
      SCOPED_TRACE(testing::Message() << name << " " << part);
      FitOptions bounded;
      ParameterSetting& setting = bounded.setting(name);
      setting.initial = part < 1.0 ? 0.9 * free : 1.1 * free;
      (part < 1.0 ? setting.upper : setting.lower) = part * free;
      (part < 1.0 ? setting.lower : setting.upper) = (part < 1.0 ? 0.5 : 2.0) * free;
      const Fit found = fit(impacts, hybrid_rig(), bounded);
      FitOptions held;
      held.setting(name).initial = part * free;
      held.setting(name).prior = {part * free, 1e-7 * free};
      const Fit there = fit(impacts, hybrid_rig(), held);
      EXPECT_EQ(found.termination, "converged");
      EXPECT_NEAR(parameter(found, name).value / (part * free), 1.0, 1e-9);
      EXPECT_NEAR(found.goodness.chi2 / there.goodness.chi2, 1.0, 1e-4);
    }
  }
}

// Of an undamped bar the data want less than no damping in every second shot: a parameter more
// never fits worse.
TEST(FitSettings, ADamperThatIsNotThereCostsNothing) {
  for (const char* name : {"beam.damping.stiffness", "beam.damping.mass", "hinge.viscous"})
    for (const std::uint64_t seed : {1, 2, 3, 4}) {
      SCOPED_TRACE(testing::Message() << name << " " << seed);
      const std::vector<datasets::Impact> impacts = {
          synthetic_shot(hybrid_rig(), {.duration = 1.6e-3, .seed = seed})};
      FitOptions damped;
      damped.setting(name).initial = std::string_view(name).ends_with("stiffness") ? 1e-8 : 1e-2;
      const Fit found = fit(impacts, hybrid_rig(), damped);
      EXPECT_LT(found.goodness.chi2, chi2_of(impacts, {}) + 0.02);
      for (const Parameter& p : found.parameters) {
        const double rounding = 1e-9 * std::abs(p.mesh_shift);
        EXPECT_GE(p.value + p.mesh_shift, p.lower - rounding) << p.name;
        EXPECT_LE(p.value + p.mesh_shift, p.upper + rounding) << p.name;
      }
    }
}

// The data want less than nothing of it: zero is out of a logarithm's reach.
TEST(FitSettings, ByItsLogarithmAParameterStaysAboveZero) {
  FitOptions options;
  ParameterSetting& damping = options.setting("beam.damping.stiffness");
  damping.initial = 1e-8;
  damping.prior = {-1e-7, 1e-10};
  damping.by_logarithm = true;
  const Parameter found = parameter(fit({shot()}, hybrid_rig(), options), damping.name);
  EXPECT_TRUE(found.at_bound);
  EXPECT_GT(found.value, 0.0);
  EXPECT_LT(found.value, 1e-12);
}

std::string message(const FitOptions& options) {
  try {
    fit({shot()}, hybrid_rig(), options);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "no error";
}

RigFile rigid_rig(const std::vector<Override>& more) {
  std::vector<Override> overrides = {{"solver.model", "rigid"}, {"solver.duration", "1.5 ms"}};
  overrides.insert(overrides.end(), more.begin(), more.end());
  return parse_rig_file(tests::paper_rig, "rig.toml", overrides);
}

// A law of a stated coefficient has no restitution to be fitted: its coefficient is in that place.
TEST(FitSettings, AStatedDamperIsFittedInTheRestitutionsPlace) {
  const RigFile rig = rigid_rig({{"contact.damping", "viscous"}, {"contact.viscous", "300 N.s/m"}});
  const auto impact = synthetic_shot(rig, {.duration = 1.6e-3, .seed = 4});
  const Fit found = fit({impact}, rig);
  EXPECT_TRUE(has(found, "contact.viscous"));
  EXPECT_FALSE(has(found, "contact.restitution"));
  EXPECT_FALSE(found.restitution.contains("law"));
  const RigFile kuwabara =
      rigid_rig({{"contact.damping", "kuwabara-kono"}, {"contact.relaxation_time", "5 us"}});
  EXPECT_TRUE(has(fit({impact}, kuwabara), "contact.relaxation_time"));
  FitOptions asked;
  asked.free = {"contact.restitution", "start.velocity"};
  try {
    fit({impact}, rig, asked);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(),
                 "'contact.restitution' cannot be fitted: the damping is that of contact.viscous, "
                 "which is stated or fitted, and no restitution changes it; fit contact.viscous "
                 "instead");
  }
  asked.free = {"contact.viscous", "start.velocity"};
  EXPECT_THROW(fit({impact}, rigid_rig({}), asked), std::invalid_argument);
}

// Rigid bars have a modulus that nothing depends on. It counts for nothing: neither as an unknown
// nor as ended at a bound.
TEST(FitSettings, WhatHasNoInfluenceIsNoUnknown) {
  const RigFile rig = rigid_rig({{"contact.law", "linear"}, {"contact.stiffness", "1e7 N/m"}});
  const auto impact = synthetic_shot(rig, {.duration = 1.6e-3, .seed = 4});
  FitOptions options;
  options.free = {"contact.restitution", "contact.stiffness", "start.velocity"};
  const Fit without = fit({impact}, rig, options);
  for (const char* idle : {"beam.youngs_modulus", "contact.counter_modulus", "contact.length"}) {
    FitOptions more = options;
    more.free.emplace_back(idle);
    const Fit with = fit({impact}, rig, more);
    EXPECT_FALSE(parameter(with, idle).identifiable) << idle;
    EXPECT_TRUE(std::isnan(parameter(with, idle).std_error));
    EXPECT_FALSE(parameter(with, idle).at_bound);
    EXPECT_EQ(with.goodness.unknowns, without.goodness.unknowns);
    EXPECT_EQ(with.goodness.dof, without.goodness.dof);
    // an unknown more would count 2; along what offset and hum of so short a record share searches
    // of one minimum end 0.0115 apart, and nowhere else
    EXPECT_NEAR(with.goodness.aicc, without.goodness.aicc, 2e-2);
    for (const std::string& name : options.free) {
      const Parameter& one = parameter(with, name);
      EXPECT_NEAR(one.value, parameter(without, name).value, 0.01 * one.std_error) << name;
    }
    EXPECT_NEAR(parameter(with, "contact.restitution").std_error /
                    parameter(without, "contact.restitution").std_error,
                1.0, 1e-3);
  }
}

// The groove of a fitted radius stays wider than the bar, and so does its interval.
TEST(FitSettings, AGroovesRadiusIsBoundedByTheBars) {
  const RigFile rig = rigid_rig({});
  FitOptions options;
  options.free = {"contact.counterface.radius", "start.velocity"};
  const auto impact = synthetic_shot(rig, {.force_noise = 200.0, .duration = 1.6e-3, .seed = 4});
  const Parameter groove = parameter(fit({impact}, rig, options), "contact.counterface.radius");
  EXPECT_NEAR(groove.lower, 15e-3, 1e-7);
  EXPECT_GE(groove.ci95[0], groove.lower);
  options.free = {"contact.radius", "start.velocity"};
  EXPECT_NEAR(parameter(fit({impact}, rig, options), "contact.radius").upper, 17.5e-3, 1e-7);
}

// The window ends at the deepest point; what the bar leaves with is predicted.
TEST(FitSettings, AWindowWithinTheContactLeavesRestitutionsToThePrediction) {
  const RigFile rig = hybrid_rig();
  FitOptions options;
  options.window = 80e-6;
  const Fit found = fit({shot()}, rig, options);
  EXPECT_THAT(found.warnings, testing::Contains(testing::StartsWith("The fitted window ends in")));
  EXPECT_THAT(found.warnings, testing::Not(testing::Contains(testing::HasSubstr("solver.dur"))));
  const Fit whole = fit({shot()}, rig);
  for (const char* name : {"kinematic", "kinetic", "energetic"}) {
    const Estimate& e = found.restitution.at(name);
    EXPECT_TRUE(std::isfinite(e.value)) << name;
    EXPECT_LT(e.ci95[0], whole.restitution.at(name).value) << name;
    EXPECT_GT(e.ci95[1], whole.restitution.at(name).value) << name;
  }
}

TEST(FitSettings, RefusesWhatMakesNoSense) {
  FitOptions bounds;
  bounds.setting("contact.restitution").lower = 0.9;
  bounds.setting("contact.restitution").upper = 0.3;
  EXPECT_EQ(message(bounds), "'contact.restitution' has no room between its bounds 0.9 and 0.3");
  FitOptions nowhere;
  nowhere.setting("contact.modulus").tie = Tie{.to = "beam.youngs_modulus"};
  EXPECT_EQ(message(nowhere),
            "'contact.modulus' is tied to 'beam.youngs_modulus', which is not among the free "
            "parameters");
  FitOptions chain;
  chain.free = {"contact.restitution", "start.velocity", "beam.youngs_modulus"};
  chain.setting("contact.modulus").tie = Tie{.to = "beam.youngs_modulus"};
  chain.setting("contact.counter_modulus").tie = Tie{.to = "contact.modulus"};
  EXPECT_EQ(message(chain),
            "'contact.counter_modulus' is tied to 'contact.modulus', which is tied itself; tie "
            "both to the same one");
  FitOptions itself;
  itself.setting("contact.restitution").tie = Tie{.to = "contact.restitution"};
  EXPECT_EQ(message(itself), "'contact.restitution' is tied to itself");
  const auto tied = [] {
    FitOptions options;
    options.setting("contact.modulus").tie = Tie{.to = "contact.stiffness_factor"};
    return options;
  };
  const auto idle = [](const std::string& what) {
    return "'contact.modulus' is tied to 'contact.stiffness_factor', so that its " + what +
           " would not be used; state it of 'contact.stiffness_factor'";
  };
  FitOptions prior = tied(), bound = tied(), start = tied();
  prior.setting("contact.modulus").prior = {68e9, 1e9};
  bound.setting("contact.modulus").upper = 70e9;
  start.setting("contact.modulus").initial = 69e9;
  EXPECT_EQ(message(prior), idle("prior"));
  EXPECT_EQ(message(bound), idle("bounds"));
  EXPECT_EQ(message(start), idle("initial value"));
  FitOptions log = tied();
  log.setting("contact.modulus").by_logarithm = true;
  EXPECT_EQ(message(log), idle("scale"));
  FitOptions outside;
  outside.setting("contact.restitution").initial = 0.2;
  outside.setting("contact.restitution").lower = 0.3;
  EXPECT_EQ(message(outside),
            "'contact.restitution' cannot begin at 0.2, outside its bounds 0.3 and 1");
  FitOptions delay;
  delay.setting("sensors.force.delay").by_logarithm = true;
  EXPECT_EQ(message(delay),
            "'sensors.force.delay' cannot be fitted by its logarithm: it, or its lower bound, may "
            "not be below zero");
  FitOptions hum;
  hum.setting("sensors.force.hum.sine").fixed = true;
  EXPECT_THAT(message(hum), testing::StartsWith("'sensors.force.hum.sine' cannot be fitted; "));
}

// One sensor, one calibration: eight shots with it know what leans on its gain no better than one
// does; gains of each shot's own would say √8 times better.
TEST(FitSettings, ACalibrationIsOneForAllShots) {
  const RigFile rig = hybrid_rig("1.5 ms", {{"solver.model", "rigid"}});  // mass from gains alone
  FitOptions options;
  options.free = {"contact.restitution", "contact.stiffness_factor", "start.velocity",
                  "beam.density"};
  options.setting("sensors.velocity.gain").fixed = true;
  std::vector<datasets::Impact> impacts;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    impacts.push_back(synthetic_shot(rig, {.duration = 1.6e-3, .seed = seed}));
    impacts.back().force->gain_uncertainty = 0.005;
  }
  const Fit one = fit({impacts.front()}, rig, options);
  const Fit all = fit(impacts, rig, options);
  EXPECT_TRUE(has(all, "sensors.force.gain"));
  EXPECT_TRUE(has(all, "impact.time[8]"));
  EXPECT_TRUE(has(all, "sensors.force.offset[8]"));
  const double from_one = parameter(one, "beam.density").std_error;
  EXPECT_NEAR(parameter(all, "beam.density").std_error / from_one, 1.0, 0.1);
  options.setting("sensors.force.gain").shared = false;
  const Fit own = fit(impacts, rig, options);
  EXPECT_LT(parameter(own, "beam.density").std_error, 0.5 * from_one);
  FitOptions named;
  named.setting("sensors.force.gain[2]").initial = 1.01;
  EXPECT_TRUE(has(fit({impacts[0], impacts[1]}, rig, named), "sensors.force.gain[1]"));
}

}  // namespace
}  // namespace impactrig::fitting
