// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <set>

#include "tests/app/command_line.hpp"

namespace impactrig::tests {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

class SensitivityOptions : public CommandLine {};

const std::string rigid = " --set solver.model=rigid --set solver.duration=\"0.5 ms\"";

// Of a linear contact without weight force and impulse go with the speed, and its duration with
// the root of the stiffness.
TEST_F(SensitivityOptions, TellsHowAPredictionChanges) {
  const std::string linear =
      "simulate " + rig + rigid +
      " --set environment.gravity=\"0 m/s^2\" --set contact.law=linear"
      " --set contact.stiffness=\"1e8 N/m\" --set contact.damping=none --set solver.accuracy=1e-9";
  const Outcome o =
      run(linear + " --sensitivities start.velocity,contact.stiffness,hinge.viscous --json");
  ASSERT_EQ(o.code, 0) << o.err;
  const json j = json::parse(o.out);
  ASSERT_EQ(j["sensitivities"].size(), 3U);
  const json& by_speed = j["sensitivities"][0];
  EXPECT_EQ(by_speed["parameter"], "start.velocity");
  EXPECT_EQ(by_speed["unit"], "m/s");
  EXPECT_EQ(by_speed["value"], 0.441);
  EXPECT_TRUE(by_speed["not_known"].is_null());
  EXPECT_NEAR(by_speed["relative"]["peak_force"].get<double>(), 1.0, 1e-7);
  EXPECT_NEAR(by_speed["relative"]["impulse"].get<double>(), 1.0, 1e-7);
  EXPECT_NEAR(by_speed["relative"]["duration"].get<double>(), 0.0, 1e-7);
  EXPECT_NEAR(by_speed["derivative"]["peak_force_n"].get<double>(),
              j["episodes"][0]["peak_force_n"].get<double>() / 0.441, 1e-3);
  const json& by_stiffness = j["sensitivities"][1]["relative"];
  EXPECT_NEAR(by_stiffness["duration"].get<double>(), -0.5, 1e-7);
  EXPECT_NEAR(by_stiffness["peak_force"].get<double>(), 0.5, 1e-7);
  EXPECT_NEAR(by_stiffness["restitution_kinematic"].get<double>(), 0.0, 1e-7);
  EXPECT_TRUE(j["sensitivities"][2]["relative"]["impulse"].is_null());  // there is no damper yet
  EXPECT_LT(j["sensitivities"][2]["derivative"]["impulse_ns"].get<double>(), 0.0);
  const Outcome text = run(linear + " --sensitivities start.velocity");
  EXPECT_THAT(text.out, HasSubstr("\nSensitivities of the first contact, full equations, "
                                  "d ln y / d ln p: percent of y a percent of p\n"));
  EXPECT_THAT(text.out, testing::ContainsRegex("\n  start.velocity +1 +1 "));
  EXPECT_THAT(text.out, HasSubstr("\nand d y / d p in SI units\n"));
  EXPECT_EQ(text.err, "");
  EXPECT_FALSE(json::parse(run(linear + " --json").out).contains("sensitivities"));
}

// One number that small motion does not know had it tell none.
TEST_F(SensitivityOptions, OfSmallMotionAreAllButThoseOfFriction) {
  const Outcome o = run("simulate " + rig + " --small-motion --sensitivities all --json" +
                        " --set solver.duration=\"0.5 ms\" --set hinge.friction=\"1e-3 N.m\"");
  ASSERT_EQ(o.code, 0) << o.err;
  const json j = json::parse(o.out);
  bool friction = false;
  for (const json& entry : j["sensitivities"]) {
    const bool is_friction = entry["parameter"] == "hinge.friction";
    friction = friction || is_friction;
    EXPECT_EQ(entry["not_known"].is_string(), is_friction) << entry;
  }
  EXPECT_TRUE(friction);
  EXPECT_GT(j["sensitivities"].size(), 10U);
}

TEST_F(SensitivityOptions, DifferentiatesByAllThatTheRigHas) {
  const auto names_of = [&](const std::string& more) {
    const Outcome o = run("simulate " + rig + rigid + " --sensitivities all --json" + more);
    EXPECT_EQ(o.code, 0) << o.err;
    std::set<std::string> names;
    const json j = json::parse(o.out);
    for (const json& entry : j["sensitivities"]) {
      EXPECT_TRUE(entry["relative"]["impulse"].is_number()) << entry["parameter"];
      EXPECT_EQ(entry["relative"].contains("sensor_peak_force"), j.contains("sensor"));
      names.insert(entry["parameter"]);
    }
    return names;
  };
  // a rigid bar has no modulus that matters, the contact's apart, and Goldsmith's law no stiffness
  const std::set<std::string> plain = {"contact.restitution",
                                       "contact.stiffness_factor",
                                       "start.velocity",
                                       "contact.length",
                                       "contact.modulus",
                                       "contact.counter_modulus",
                                       "contact.radius",
                                       "contact.counterface.radius",
                                       "contact.position",
                                       "beam.density",
                                       "beam.length",
                                       "environment.gravity",
                                       "beam.section.area",
                                       "beam.section.radius",
                                       "contact.reference_length",
                                       "contact.poisson_ratio",
                                       "contact.counter_poisson_ratio"};
  EXPECT_EQ(names_of(""), plain);
  std::set<std::string> more = plain;
  more.insert({"stop.mass", "stop.stiffness", "hinge.friction"});
  EXPECT_EQ(names_of(" --set stop.mass=\"0.2 kg\" --set stop.stiffness=\"1e9 N/m\""
                     " --set hinge.friction=\"0.1 N.m\""),
            more);
}

// Nothing else than what the laser shows, and that as differences of its place do.
TEST_F(SensitivityOptions, DifferentiatesByWhereALaserPoints) {
  const std::string name = "sensors.velocity.position";
  for (const std::string exact : {"", " --exact"}) {
    SCOPED_TRACE(exact);
    const auto last = [&](double x, const std::string& more, const std::string& channel) {
      const std::string file = path("history.h5");
      const Outcome o = run("simulate " + rig + exact +
                            " --set solver.model=hybrid --set solver.modes=4"
                            " --set solver.duration=\"0.5 ms\" --interval 1e-4 --json --force" +
                            fmt::format(" --set {}=\"{:.6f} m\"", name, x) + more + " -o " + file);
      EXPECT_EQ(o.code, 0) << o.err;
      if (!more.empty()) {
        const json entry = json::parse(o.out)["sensitivities"].back();
        EXPECT_EQ(entry["parameter"], name);
        EXPECT_EQ(entry["derivative"]["peak_force_n"], 0.0);
      }
      const json inspected = json::parse(run("inspect --json " + file).out);
      for (const json& shown : inspected["channels"])
        if (shown["name"] == channel) return shown["last"].get<double>();
      ADD_FAILURE() << "no " << channel;
      return 0.0;
    };
    const std::string all = " --sensitivities all";
    EXPECT_NEAR(last(0.6, all, "Velocity by " + name),
                (last(0.601, "", "Velocity") - last(0.599, "", "Velocity")) / 2e-3, 1e-3);
    EXPECT_EQ(last(0.6, all, "Displacement by " + name), 0.0);
  }
}

// By the numbers that a section's shape makes; against differences too, contact.radius held.
TEST_F(SensitivityOptions, DifferentiatesByASectionsDimensions) {
  const std::string bar = "simulate " + rig +
                          " --set contact.radius=\"15 mm\" --set solver.duration=\"0.5 ms\""
                          " --set solver.model=hybrid --set solver.modes=4"
                          " --set solver.accuracy=1e-10 --json";
  const std::string names =
      "beam.section.second_moment,beam.section.radius,beam.section.area,environment.gravity";
  const std::string file = path("history.csv");
  const json all = json::parse(
      run(bar + " --sensitivities " + names + " --interval 1e-4 -o " + file).out)["sensitivities"];
  ASSERT_EQ(all.size(), 4U);
  const auto near = [&](double radius) {
    const std::string set = fmt::format(" --set beam.section.radius=\"{:.17g} mm\"", radius);
    return json::parse(run(bar + set).out)["episodes"][0]["peak_force_n"].get<double>();
  };
  const double difference =
      (8.0 * (near(15.01) - near(14.99)) - (near(15.02) - near(14.98))) / 12e-5;
  EXPECT_NEAR(all[1]["derivative"]["peak_force_n"].get<double>() / difference, 1.0, 1e-6);
  for (const auto& [key, by_moment] : all[0]["relative"].items()) {
    const double by_area = all[2]["relative"][key].get<double>();
    EXPECT_NEAR(all[1]["relative"][key].get<double>(),
                4.0 * by_moment.get<double>() + 2.0 * by_area, 1e-9)
        << key;
  }
  const json channels = json::parse(run("inspect --json " + file).out)["channels"];
  ASSERT_EQ(channels.size(), 20U);
  EXPECT_EQ(channels[8]["name"], "Force by beam.section.radius");
  EXPECT_EQ(channels[16]["name"], "Force by environment.gravity");
}

TEST_F(SensitivityOptions, WritesDerivativesOfHistories) {
  for (const char* ending : {"h5", "csv", "uff", "mat"}) {
    const std::string file = path(std::string("history.") + ending);
    const Outcome o = run("simulate " + rig + rigid +
                          " --sensitivities contact.restitution,start.velocity -o " + file);
    ASSERT_EQ(o.code, 0) << o.err;
    const json channels = json::parse(run("inspect --json " + file).out)["channels"];
    ASSERT_EQ(channels.size(), 12U) << ending;
    EXPECT_EQ(channels[0]["name"], "Force");
    EXPECT_EQ(channels[4]["name"], "Force by contact.restitution");
    EXPECT_EQ(channels[5]["name"], "Velocity by contact.restitution");
    EXPECT_EQ(channels[11]["name"], "Penetration by start.velocity");
  }
}

TEST_F(SensitivityOptions, DifferentiatesASwingsHistories) {
  const std::string free = write("free.toml", R"(
[beam]
length = "0.8 m"
section = { shape = "circle", radius = "15 mm" }
youngs_modulus = "68.952 GPa"
density = "2766.7 kg/m^3"
[start]
release_angle = "60 deg"
[solver]
model = "rigid"
accuracy = 1e-6
duration = "0.1 s"
)");
  const Outcome o = run("simulate " + free + " --interval 1e-3 -o " + path("free.h5") +
                        " --sensitivities start.release_angle");
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_THAT(o.out, HasSubstr("-o writes these with their derivatives"));
  EXPECT_THAT(o.out, Not(HasSubstr("nan")));
  const json channels = json::parse(run("inspect --json " + path("free.h5")).out)["channels"];
  ASSERT_EQ(channels.size(), 4U);
  EXPECT_EQ(channels[3]["name"], "Displacement by start.release_angle");
  EXPECT_NEAR(channels[3]["first"].get<double>(), -0.8 * 0.5, 1e-7);  // of −L sin φ
}

TEST_F(SensitivityOptions, SaysWhichDerivativesItHasNot) {
  const std::string simulate = "simulate " + rig + rigid + " --sensitivities ";
  const auto refused = [&](const std::string& names) {
    const Outcome o = run(simulate + names);
    EXPECT_EQ(o.code, 2);
    EXPECT_EQ(o.out, "");
    return o.err;
  };
  EXPECT_THAT(refused("contact.colour"),
              HasSubstr("--sensitivities: 'contact.colour' is no number of a rig to differentiate "
                        "by; they are contact.restitution, "));
  for (const char* none : {"\"\"", "\" , \""})
    EXPECT_THAT(refused(none),
                HasSubstr("--sensitivities: expected names with commas, or all, found '"));
  EXPECT_THAT(refused("stop.mass"), HasSubstr("'stop.mass' is nothing that this rig has"));
  EXPECT_THAT(refused("contacts.1.gap"),
              HasSubstr("'contacts.1.gap' is nothing that this rig has"));
  EXPECT_THAT(refused("beam.density,beam.density"), HasSubstr("'beam.density' is named twice"));
  const std::string friction = "hinge.friction,contact.restitution";
  const Outcome o = run(simulate + friction);
  EXPECT_EQ(o.code, 0);
  EXPECT_THAT(o.out, HasSubstr("\nno derivatives by hinge.friction: there is no friction, "));
  EXPECT_THAT(o.out, testing::ContainsRegex("\n  contact.restitution +-?[0-9]"));
  const json j = json::parse(run(simulate + friction + " --json").out);
  EXPECT_TRUE(j["sensitivities"][0]["relative"].is_null());
  EXPECT_THAT(j["sensitivities"][0]["not_known"].get<std::string>(), HasSubstr("hinge.friction"));
  const Outcome steep = run(simulate +
                            "contact.restitution --set contact.damping=tsuji --set "
                            "contact.tension=allow");
  EXPECT_EQ(steep.code, 0);
  EXPECT_THAT(steep.out, HasSubstr("no derivatives by contact.restitution: with this damping law"));
  EXPECT_THAT(steep.out, Not(HasSubstr("d ln y")));
  const Outcome all = run(simulate + "all --set contact.damping=tsuji --set contact.tension=allow");
  EXPECT_THAT(all.out, HasSubstr("\nno derivatives by contact.restitution, "));
}

}  // namespace
}  // namespace impactrig::tests
