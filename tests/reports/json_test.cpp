// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <cstring>
#include <limits>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "datasets/input_error.hpp"
#include "reports/report_data.hpp"
#include "reports/text.hpp"
#include "tests/reports/example_report.hpp"

namespace impactrig {
namespace {

using Json = nlohmann::ordered_json;

std::set<std::string> members(const Json& object) {
  std::set<std::string> out;
  for (const auto& item : object.items()) out.insert(item.key());
  return out;
}

/// The example as JSON with one change made to it.
template <typename Change>
std::string changed(Change change) {
  Json json = Json::parse(reports::to_json(tests::example_report()));
  change(json);
  return json.dump();
}

std::string complaint(const std::string& json) {
  try {
    reports::report_from_json(json, "fit.json");
  } catch (const datasets::InputError& error) {
    return error.what();
  }
  return "accepted";
}

bool same_bits(double a, double b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

TEST(FitJson, HasTheNamesOfTheDesignPage) {
  const Json json = Json::parse(reports::to_json(tests::example_report()));
  for (const char* name : {"parameters", "correlations", "not_identifiable", "channels", "goodness",
                           "metrics", "restitution", "impacts", "termination", "warnings"})
    EXPECT_TRUE(json.contains(name)) << name;
  EXPECT_EQ(json["schema"], "impactrig/fit/1");
  const Json& parameter = json["parameters"][0];
  EXPECT_EQ(parameter["name"], "contact.restitution");
  EXPECT_EQ(parameter["value"], 0.512);
  EXPECT_EQ(parameter["unit"], "1");
  EXPECT_EQ(parameter["std_error"], 0.0113);
  EXPECT_EQ(parameter["ci95"].size(), 2u);
  EXPECT_EQ(parameter["initial"], 0.7);
  EXPECT_EQ(parameter["at_bound"], false);
  EXPECT_EQ(json["correlations"].size(), 8u);
  EXPECT_EQ(json["correlations"][3][3], 1.0);
  for (const char* name : {"name", "residual_rms", "unit", "noise"})
    EXPECT_TRUE(json["channels"][0].contains(name)) << name;
  EXPECT_EQ(json["channels"][0]["name"], "force");
  for (const char* name : {"chi2", "dof", "aicc", "bic", "reduced_chi2"})
    EXPECT_TRUE(json["goodness"].contains(name)) << name;
  EXPECT_DOUBLE_EQ(json["goodness"]["reduced_chi2"].get<double>(), 2811.4 / 2494.0);
  EXPECT_EQ(json["metrics"]["force"]["sprague_geers_phase"], 0.0061);
  EXPECT_EQ(members(json["restitution"]),
            (std::set<std::string>{"law", "kinematic", "kinetic", "energetic"}));
  EXPECT_EQ(json["restitution"]["law"]["value"], 0.512);
  EXPECT_EQ(json["restitution"]["law"]["ci95"][1], 0.5341);
  const Json& direct = json["direct_restitution"][0];
  EXPECT_EQ(direct["recording"], "shot 17.uff");
  for (const char* name : {"kinematic", "kinematic_smoothed", "kinetic", "energetic"}) {
    EXPECT_EQ(direct[name]["ci95"].size(), 2u) << name;
    EXPECT_TRUE(direct[name].contains("value") && direct[name].contains("std_error")) << name;
  }
  EXPECT_EQ(direct["kinetic"]["budget"][0]["source"], "force noise");
  EXPECT_EQ(direct["kinematic_smoothed"]["absent"], "The record is too short.");
  EXPECT_TRUE(direct["kinematic_smoothed"]["value"].is_null());
  EXPECT_FALSE(direct["kinetic"].contains("absent"));
  EXPECT_EQ(direct["hysteresis"]["force_n"].size(), direct["hysteresis"]["penetration_m"].size());
  EXPECT_EQ(json["impacts"][0]["recording"], "shot 17.uff");
  EXPECT_EQ(json["impacts"][0]["start_s"], 0.0005);
  EXPECT_EQ(json["impacts"][0]["flags"][0], "double-hit");
}

TEST(FitJson, NumbersTheChannelsOfSeveralRecordingsFromOne) {
  const Json json = Json::parse(reports::to_json(tests::example_report(2)));
  EXPECT_EQ(json["channels"][0]["name"], "force[1]");
  EXPECT_EQ(json["channels"][3]["name"], "velocity[2]");
  EXPECT_EQ(json["channels"][3]["recording"], 1);
  EXPECT_TRUE(json["metrics"].contains("velocity[2]"));
}

TEST(FitJson, ComesBackAsItWentOut) {
  for (const int recordings : {1, 3}) {
    reports::ReportData data = tests::example_report(recordings);
    data.fit.rig.solver.duration = 3e-3;
    data.fit.predictions[0].solver.model = models::BeamModel::ancf;
    data.fit.rig.rig.start.release_angle = 0.2;
    data.fit.rig.rig.stop = models::Stop{.mass = 0.05, .stiffness = 2e8, .viscous = 30.0};
    data.fit.predictions[0].energy.stop = 3.5e-3;
    data.fit.rig.rig.further_stops = {
        {.contact = data.fit.rig.rig.contact, .side = models::StopSide::far, .gap = 2e-4},
        {.contact = data.fit.rig.rig.contact, .gap = 1e-6}};
    data.fit.rig.rig.further_stops[1].contact.position = 0.4;
    data.fit.predictions[0].episodes.back().stop = 2;
    data.fit.predictions[0].stops = {{1700.0, 1e-4, 1e-5, 0.5, 0.01}, {}, {100.0, 2e-4, 1e-6, 0.1}};
    data.fit.predictions[0].history.further = {{{1.0, 0.0}, {1e-6, -1e-6}}, {{0.0}, {-2e-6}}};
    data.fit.predictions[0].sensor = models::SensorForce{1700.0, 1e-4, 0.5};
    data.fit.predictions[0].history.sensor_force = data.fit.predictions[0].history.force;
    data.fit.rig.rig.hinge = {.spring = 12.5,
                              .viscous = 0.02,
                              .friction = 0.3,
                              .rotation = models::HingeRotation{6.0, 15.0}};
    data.fit.predictions[0].energy.damped = 1.25e-3;
    data.fit.predictions[0].energy.spring = 2.5e-3;
    data.fit.rig.rig.beam.damping = {.mass = 2.0, .stiffness = 1e-6};
    data.fit.rig.rig.gravity_direction = -0.3;
    data.fit.rig.rig.beam.masses = {{0.8, 0.1}, {0.4, 0.02}};
    data.fit.rig.rig.beam.segments = {
        {.length = 0.3, .area = 7e-4, .second_moment = 4e-8, .shear_coefficient = 0.9},
        {.length = 0.5, .area = 3e-4, .second_moment = 1e-8, .density = 7850.0}};
    data.fit.rig.rig.beam.theory = models::BeamTheory::timoshenko;
    data.fit.rig.rig.beam.poisson_ratio = 0.33;
    data.fit.rig.rig.beam.shear_coefficient = 0.88;
    const std::string once = reports::to_json(data);
    const std::string twice = reports::to_json(reports::report_from_json(once, "fit.json"));
    EXPECT_TRUE(once == twice);  // half a megabyte: not printed
  }
}

// Of a recording that has been through a filter.
TEST(FitJson, TellsOfHowManySamplesOneIsFitted) {
  reports::ReportData data = tests::example_report();
  EXPECT_FALSE(Json::parse(reports::to_json(data))["curves"][0].contains("every"));
  data.fit.channels[0].every = 10;
  const std::string text = reports::to_json(data);
  EXPECT_EQ(Json::parse(text)["curves"][0]["every"], 10);
  EXPECT_EQ(reports::report_from_json(text, "fit.json").fit.channels[0].every, 10U);
}

TEST(FitJson, KeepsEveryBitOfADouble) {
  reports::ReportData data = tests::example_report();
  const std::vector<double> values = {0.1,
                                      -0.0,
                                      5e-324,
                                      std::numeric_limits<double>::max(),
                                      std::nextafter(1.0, 2.0),
                                      1.0 / 3.0,
                                      123456789012345680.0,
                                      2.2250738585072011e-308};
  fitting::ChannelFit& channel = data.fit.channels[0];
  channel.time = channel.measured = channel.model = values;
  channel.used.assign(values.size(), 1);
  const reports::ReportData back = reports::report_from_json(reports::to_json(data), "fit.json");
  for (std::size_t i = 0; i < values.size(); ++i)
    EXPECT_TRUE(same_bits(back.fit.channels[0].measured[i], values[i])) << values[i];
  for (std::size_t i = 0; i < 3000; ++i)
    ASSERT_TRUE(same_bits(back.fit.predictions[0].history.force[i],
                          data.fit.predictions[0].history.force[i]));
}

TEST(FitJson, WritesNullForWhatIsNotFiniteAndReadsItBack) {
  reports::ReportData data = tests::example_report();
  data.fit.parameters[0].lower = -std::numeric_limits<double>::infinity();
  data.fit.parameters[0].upper = std::numeric_limits<double>::infinity();
  data.fit.parameters[0].value = std::nan("");
  data.fit.parameters[0].mesh_shift = data.fit.parameters[0].mesh_error = std::nan("");
  data.fit.correlations(0, 1) = std::nan("");
  data.fit.goodness = {std::nan(""), 0, std::nan(""), std::nan("")};
  const std::string text = reports::to_json(data);
  const Json json = Json::parse(text);  // NaN and Infinity would not parse
  EXPECT_TRUE(json["parameters"][0]["value"].is_null());
  EXPECT_TRUE(json["parameters"][0]["lower"].is_null());
  EXPECT_TRUE(json["correlations"][0][1].is_null());
  EXPECT_TRUE(json["goodness"]["reduced_chi2"].is_null());
  const reports::ReportData back = reports::report_from_json(text, "fit.json");
  EXPECT_EQ(back.fit.parameters[0].lower, -std::numeric_limits<double>::infinity());
  EXPECT_EQ(back.fit.parameters[0].upper, std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isnan(back.fit.parameters[0].value));
  EXPECT_TRUE(std::isnan(back.fit.parameters[0].mesh_error));  // 0 would say that there is none
}

// Stored with zeros it would read as perfectly known.
TEST(FitJson, TellsNoErrorOfWhatIsNotIdentifiable) {
  const std::string stored = changed([](Json& json) {
    for (Json& p : json["parameters"])
      if (p["name"] == "contact.stiffness_factor") {
        p["identifiable"] = false;
        p["std_error"] = p["mesh_shift"] = 0.0;
        p["ci95"] = {p["value"], p["value"]};
      }
  });
  const reports::ReportData data = reports::report_from_json(stored, "fit.json");
  const Json parameter = Json::parse(reports::to_json(data))["parameters"][1];
  EXPECT_EQ(parameter["name"], "contact.stiffness_factor");
  EXPECT_TRUE(parameter["std_error"].is_null());
  EXPECT_TRUE(parameter["mesh_shift"].is_null());
  EXPECT_EQ(parameter["ci95"], Json::array({nullptr, nullptr}));
  EXPECT_EQ(parameter["value"], 0.8714);
  const std::string text = reports::to_text(data);
  EXPECT_THAT(text, testing::ContainsRegex("contact.stiffness_factor +0.8714   not identifiable"));
  EXPECT_THAT(text, testing::Not(testing::ContainsRegex("[^a-z]nan[^a-z]")));
}

TEST(FitJson, ReplacesBytesThatAreNoUtf8) {
  reports::ReportData data = tests::example_report();
  data.records[0].title = "Sch\xe4lkurve";  // Latin-1
  EXPECT_EQ(reports::report_from_json(reports::to_json(data), "").records[0].title,
            "Sch\xef\xbf\xbdlkurve");
}

TEST(FitJson, PutsOneMemberOnALine) {
  const std::string text = reports::to_json(tests::example_report());
  EXPECT_THAT(text, testing::StartsWith("{\n\"schema\": \"impactrig/fit/1\",\n\"title\": "));
  EXPECT_THAT(text, testing::HasSubstr("\n  {\"name\":\"contact.stiffness_factor\",\"value\":"));
}

TEST(FitJson, KeepsTheNumberOfSamplesOfARecord) {
  const reports::ReportData back =
      reports::report_from_json(reports::to_json(tests::example_report()), "fit.json");
  EXPECT_EQ(back.records[0].channels[0].size(), 0u);
  EXPECT_EQ(back.sample_counts, (std::vector<std::vector<std::size_t>>{{3000, 3000}}));
}

TEST(FitJson, NamesThePlaceInABrokenFile) {
  EXPECT_EQ(complaint("{\"schema\": \"impactrig/fit/1\",\n  \"title\": oops}"),
            "fit.json:2:12 (byte 41): this is not JSON; expected what impactrig fit --json writes");
  EXPECT_EQ(
      complaint("{\"schema\": "),
      "fit.json:1:12 (byte 11): the JSON ends before it is complete; was the file cut short?");
  EXPECT_EQ(complaint(changed([](Json& json) { json["parameters"][2]["value"] = "0.5"; })),
            "fit.json: /parameters/2/value: expected a number, found a string");
  EXPECT_EQ(complaint(changed([](Json& json) { json["curves"][1]["model"][7] = true; })),
            "fit.json: /curves/1/model/7: expected a number, found true or false");
  EXPECT_EQ(complaint("{\"schema\": \"impactrig/fit/1\", \"title\": \"\", \"x\": 1e999}"),
            "fit.json: a number does not fit a double");
}

TEST(FitJson, RefusesAForeignFile) {
  EXPECT_EQ(complaint("[1, 2]"), "fit.json: expected an object, found an array");
  EXPECT_EQ(complaint("{\"peak_force_n\": 1}"),
            "fit.json: not a fit of impactrig: the member \"schema\" is missing; expected "
            "\"impactrig/fit/1\", as impactrig fit --json writes it");
  EXPECT_EQ(complaint(changed([](Json& json) { json["schema"] = "impactrig/fit/2"; })),
            "fit.json: /schema: expected \"impactrig/fit/1\", found \"impactrig/fit/2\"");
  EXPECT_EQ(complaint(changed([](Json& json) { json.erase("impacts"); })),
            "fit.json: the member \"impacts\" is missing; write the file again with impactrig fit "
            "--json");
}

TEST(FitJson, RefusesPartsThatDoNotFitTogether) {
  EXPECT_EQ(complaint(changed([](Json& json) { json["correlations"].erase(0); })),
            "fit.json: /correlations: expected 8 rows, one a parameter, found 7");
  EXPECT_EQ(complaint(changed([](Json& json) { json["correlations"][1].erase(0); })),
            "fit.json: /correlations/1: expected 8 numbers, found 7");
  EXPECT_EQ(complaint(changed([](Json& json) { json["curves"][0]["used"].erase(0); })),
            "fit.json: /curves/0: time_s, measured, model and used must be of one length, found "
            "3000, 3000, 3000 and 2999");
  EXPECT_EQ(complaint(changed([](Json& json) { json["curves"].erase(0); })),
            "fit.json: /curves: expected 2 curves, one a channel, found 1");
  EXPECT_EQ(complaint(changed([](Json& json) { json["channels"][1]["recording"] = 1; })),
            "fit.json: /channels/1/recording: expected the index of one of 1 impacts, found 1");
  EXPECT_EQ(complaint(changed([](Json& json) { json["parameters"][0]["ci95"] = {0.5}; })),
            "fit.json: /parameters/0/ci95: expected an array of two numbers, found an array");
}

TEST(FitJson, RefusesValuesOfTheWrongKind) {
  EXPECT_EQ(complaint(changed([](Json& json) { json["title"] = 3; })),
            "fit.json: /title: expected a string, found the number 3");
  EXPECT_EQ(complaint(changed([](Json& json) { json["warnings"] = "none"; })),
            "fit.json: /warnings: expected an array, found a string");
  EXPECT_EQ(complaint(changed([](Json& json) { json["iterations"] = 1.5; })),
            "fit.json: /iterations: expected an integer, found the number 1.5");
  EXPECT_EQ(complaint(changed([](Json& json) { json["provenance"]["inputs"][0]["bytes"] = -1; })),
            "fit.json: /provenance/inputs/0/bytes: expected a count, found the number -1");
  EXPECT_EQ(complaint(changed([](Json& json) { json["parameters"][1]["nuisance"] = nullptr; })),
            "fit.json: /parameters/1/nuisance: expected true or false, found null");
  EXPECT_EQ(complaint(changed([](Json& json) { json["impacts"][0]["flags"] = {"loud"}; })),
            "fit.json: /impacts/0/flags/0: no flag of an impact is called \"loud\"");
  EXPECT_EQ(complaint(changed([](Json& json) { json["predictions"][0]["model"] = "shell"; })),
            "fit.json: /predictions/0/model: expected rigid, hybrid or ancf, found \"shell\"");
  EXPECT_EQ(complaint(changed([](Json& json) { json["predictions"][0]["basis"] = "free"; })),
            "fit.json: /predictions/0/basis: expected cantilever or pinned-free, found \"free\"");
  EXPECT_EQ(complaint(changed([](Json& json) {
              json["predictions"][0]["model"] = "ancf";
              json["predictions"][0]["elements"] = {14};
            })),
            "fit.json: /predictions/0/elements: expected two counts, hinge to contact and to the "
            "tip");
  EXPECT_EQ(
      complaint(changed([](Json& json) { json["rig"]["contact"]["counterface"] = "sea"; })),
      "fit.json: /rig/contact/counterface: expected groove, cylinder or plane, found \"sea\"");
  EXPECT_EQ(
      complaint(changed([](Json& json) { json["rig"]["sensors"]["force"]["quantity"] = "taste"; })),
      "fit.json: /rig/sensors/force/quantity: expected a quantity, found \"taste\"");
  EXPECT_EQ(complaint(changed(
                [](Json& json) { json["records"][0]["channels"][0]["quantity"] = "taste"; })),
            "fit.json: /records/0/channels/0/quantity: expected a quantity, found \"taste\"");
}

TEST(SimulationJson, HasTheNamesOfTheDesignPage) {
  const reports::ReportData data = tests::example_report();
  models::Simulation run = data.fit.predictions[0];
  run.solver.model = models::BeamModel::ancf;
  const Json json = Json::parse(reports::simulation_to_json(run, data.fit.rig.rig));
  EXPECT_EQ(json["model"], "ancf");
  EXPECT_EQ(json["elements"], (Json{14, 2}));
  EXPECT_EQ(json["elastic_law"], "goldsmith");
  EXPECT_EQ(json["damping_law"], "lankarani-nikravesh");
  for (const char* name : {"peak_force_n", "peak_time_s", "max_penetration_m", "impulse_ns"})
    EXPECT_TRUE(json[name].is_number()) << name;
  for (const char* name : {"start_s", "end_s", "peak_force_n", "impulse_ns", "max_penetration_m",
                           "approach_velocity_m_s", "separation_velocity_m_s", "dissipated_j"})
    EXPECT_TRUE(json["episodes"][0][name].is_number()) << name;
  EXPECT_EQ(members(json["restitution"]),
            (std::set<std::string>{"law", "kinematic", "kinetic", "energetic"}));
  for (const char* name : {"initial_j", "dissipated_j", "vibration_j", "imbalance"})
    EXPECT_TRUE(json["energy"][name].is_number()) << name;
  EXPECT_EQ(members(json["cost"]),
            (std::set<std::string>{"steps", "rejected", "evaluations", "solve_s"}));
  EXPECT_EQ(json["skipped"].size(), 2u);
  EXPECT_TRUE(json["warnings"].empty());
  EXPECT_FALSE(json.contains("history"));
}

TEST(SimulationJson, DescribesAHybridBeamByItsModes) {
  const reports::ReportData data = tests::example_report();
  models::Simulation run = data.fit.predictions[0];
  run.solver.basis = models::Basis::pinned_free;
  const Json json = Json::parse(reports::simulation_to_json(run, data.fit.rig.rig));
  EXPECT_EQ(json["model"], "hybrid");
  EXPECT_TRUE(json["elements"].empty());
  EXPECT_EQ(json["modes"], 7);
  EXPECT_EQ(json["axial_modes"], 0);
  EXPECT_EQ(json["basis"], "pinned-free");
}

// The writers' example must not contradict itself: its energies add up.
TEST(ExampleReport, AccountsForItsEnergy) {
  const reports::ReportData data = tests::example_report();
  const models::EnergyAudit& energy = data.fit.predictions[0].energy;
  EXPECT_NEAR((energy.dissipated + energy.vibration + energy.rigid_rotation) / energy.initial, 1.0,
              5e-3);  // semi-implicit Euler with 0.05 us
  EXPECT_GT(data.fit.predictions[0].peak_force, 500.0);
}

// Intervals of other kinds: an open side, draws to the last bit, the kind by its name.
TEST(FitJson, KeepsProfilesBootstrapAndTies) {
  reports::ReportData data = tests::example_report();
  const std::string name = data.fit.parameters[0].name;
  data.fit.parameters[1].tied_to = name;
  data.fit.parameters[0].by_logarithm = true;
  data.fit.profiles = {{.name = name,
                        .unit = "1",
                        .value = {0.48, 0.5, 0.512, 0.53},
                        .delta_chi2 = {6.1, 1.0 / 3.0, 0.0, 2.5},
                        .lower = 0.49,
                        .upper = {},
                        .found_better = true}};
  data.fit.bootstrap = fitting::Bootstrap{.kind = fitting::BootstrapKind::residual,
                                          .seed = 18446744073709551615ULL,
                                          .draws = 4,
                                          .failed = 1,
                                          .parameters = {{.name = name,
                                                          .bias = 1e-3 / 3.0,
                                                          .std_error = 0.01,
                                                          .ci95 = {0.49, 0.53},
                                                          .draws = {0.5, 0.1 + 0.2, 0.52}}},
                                          .seconds = 0.25};
  const std::string stored = reports::to_json(data);
  const reports::ReportData again = reports::report_from_json(stored, "fit.json");
  EXPECT_EQ(again.fit.parameters[1].tied_to, name);
  EXPECT_TRUE(again.fit.parameters[0].by_logarithm);
  EXPECT_FALSE(again.fit.parameters[1].by_logarithm);
  ASSERT_EQ(again.fit.profiles.size(), 1U);
  EXPECT_EQ(again.fit.profiles[0].delta_chi2, data.fit.profiles[0].delta_chi2);
  EXPECT_EQ(again.fit.profiles[0].lower, std::optional(0.49));
  EXPECT_FALSE(again.fit.profiles[0].upper);
  EXPECT_TRUE(again.fit.profiles[0].found_better);
  ASSERT_TRUE(again.fit.bootstrap);
  EXPECT_EQ(again.fit.bootstrap->kind, fitting::BootstrapKind::residual);
  EXPECT_EQ(again.fit.bootstrap->seed, 18446744073709551615ULL);
  EXPECT_EQ(again.fit.bootstrap->parameters[0].draws, data.fit.bootstrap->parameters[0].draws);
  EXPECT_EQ(reports::to_json(again), stored);
  EXPECT_EQ(reports::to_html(again), reports::to_html(data));
  EXPECT_EQ(reports::to_text(again), reports::to_text(data));
  EXPECT_THAT(reports::to_html(data), testing::HasSubstr("0.490 to no limit"));
}

TEST(FitJson, KeepsTheReboundOfADisplacement) {
  reports::ReportData data = tests::example_report();
  datasets::Impact& impact = data.fit.impacts[0];
  EXPECT_FALSE(Json::parse(reports::to_json(data))["impacts"][0].contains("rebound"));
  impact.rebound = {.approach_error = 1e-3,
                    .from = 2e-4,
                    .to = 8e-4,
                    .velocity = 0.2205,
                    .velocity_error = 2e-3,
                    .restitution = 0.5,
                    .restitution_error = 0.01,
                    .absent = ""};
  const std::string stored = reports::to_json(data);
  const Json rebound = Json::parse(stored)["impacts"][0]["rebound"];
  EXPECT_EQ(members(rebound),
            (std::set<std::string>{"approach_std_error_m_s", "from_s", "to_s", "velocity_m_s",
                                   "velocity_std_error_m_s", "restitution", "restitution_std_error",
                                   "restitution_ci95"}));
  EXPECT_EQ(rebound["restitution"], 0.5);
  const reports::ReportData again = reports::report_from_json(stored, "fit.json");
  ASSERT_TRUE(again.fit.impacts[0].rebound);
  EXPECT_EQ(again.fit.impacts[0].rebound->to, 8e-4);
  EXPECT_EQ(reports::to_json(again), stored);
}

TEST(FitJson, KeepsWhyThereIsNoRebound) {
  reports::ReportData data = tests::example_report();
  data.fit.impacts[0].rebound = {.approach_error = 1e-3, .absent = "The record ends."};
  const std::string stored = reports::to_json(data);
  const Json rebound = Json::parse(stored)["impacts"][0]["rebound"];
  EXPECT_EQ(members(rebound), (std::set<std::string>{"approach_std_error_m_s", "absent"}));
  const reports::ReportData again = reports::report_from_json(stored, "fit.json");
  ASSERT_TRUE(again.fit.impacts[0].rebound);
  EXPECT_EQ(again.fit.impacts[0].rebound->absent, "The record ends.");
  EXPECT_EQ(again.fit.impacts[0].rebound->approach_error, 1e-3);
}

TEST(FitJson, RefusesDamagedIntervals) {
  const auto with = [](const char* kind, std::size_t points) {
    return changed([&](Json& json) {
      json["profiles"] = {{{"name", "a"},
                           {"unit", "1"},
                           {"value", std::vector<double>(points, 1.0)},
                           {"delta_chi2", {0.0, 1.0}},
                           {"ci95", {nullptr, nullptr}},
                           {"found_better", false}}};
      json["bootstrap"] = {
          {"kind", kind},  {"seed", 1}, {"draws", 2}, {"failed", 0}, {"parameters", Json::array()},
          {"seconds", 0.0}};
    });
  };
  EXPECT_EQ(complaint(with("residual", 2)), "accepted");
  EXPECT_EQ(complaint(with("residual", 3)),
            "fit.json: /profiles/0: value and delta_chi2 must be of one length");
  EXPECT_EQ(
      complaint(with("jackknife", 2)),
      "fit.json: /bootstrap/kind: there is no bootstrap 'jackknife'; there are parametric and "
      "residual");
}

}  // namespace
}  // namespace impactrig
