// SPDX-License-Identifier: BSD-3-Clause
//
// What `inspect` and `fit` say of a recording that has neither force nor velocity.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <string>

#include "tests/app/command_line.hpp"

namespace {

using impactrig::tests::Outcome;
using impactrig::tests::rig;
using impactrig::tests::text_of;
using nlohmann::json;
using testing::HasSubstr;

class DisplacementAlone : public impactrig::tests::CommandLine {};

/// A bar that comes at 0.441 m/s, is stopped by a half sine of deceleration over 200 us and leaves
/// with half of that, as a displacement alone; cut at `end`.
std::string displacement_alone(double end) {
  std::string text = "Time [s],Laser [m]\n";
  const double lasts = 200e-6, speed = 0.441, change = 1.5 * speed, pi = std::numbers::pi;
  for (int i = -500; i * 2e-6 < end; ++i) {
    const double t = i * 2e-6, in = std::clamp(t, 0.0, lasts);
    const double stopped = 0.5 * change * (in - lasts / pi * std::sin(pi * in / lasts));
    const double way = speed * t - stopped - change * (std::max(t, in) - in) * (t > 0.0);
    text += fmt::format("{:.6f},{:.10f}\n", t, way + 1e-8 * ((i * i * 7919) % 23 - 11));
  }
  return text;
}

TEST_F(DisplacementAlone, TellsTheReboundThatADisplacementShows) {
  const std::string file = write("way.csv", displacement_alone(1.2e-3));
  const json impacts = json::parse(run("inspect --json " + file).out)["impacts"];
  ASSERT_EQ(impacts.size(), 1U);
  const json& impact = impacts[0];
  EXPECT_EQ(impact["channel"], "Laser");
  EXPECT_EQ(impact["unit"], "m");
  EXPECT_EQ(impact["impulse_unit"], "m s");
  EXPECT_EQ(impact["flags"], json::array());
  const json& rebound = impact["rebound"];
  EXPECT_NEAR(impact["approach_velocity_m_s"].get<double>(), 0.441,
              3.0 * rebound["approach_std_error_m_s"].get<double>());
  EXPECT_NEAR(rebound["velocity_m_s"].get<double>(), 0.2205,
              3.0 * rebound["velocity_std_error_m_s"].get<double>());
  EXPECT_NEAR(rebound["restitution"].get<double>(), 0.5,
              3.0 * rebound["restitution_std_error"].get<double>());
  EXPECT_LT(rebound["restitution_ci95"][0].get<double>(), 0.5);
  EXPECT_GT(rebound["restitution_ci95"][1].get<double>(), 0.5);
  EXPECT_GT(rebound["from_s"].get<double>(), 200e-6);
  EXPECT_LT(rebound["to_s"].get<double>(), 1.2e-3);
  EXPECT_FALSE(rebound.contains("absent"));
  EXPECT_THAT(run("inspect " + file).out, HasSubstr("m/s, rebound 0.22"));
}

TEST_F(DisplacementAlone, SaysWhyADisplacementShowsNoRebound) {
  const std::string file = write("way.csv", displacement_alone(180e-6));
  const json impacts = json::parse(run("inspect --json " + file).out)["impacts"];
  ASSERT_EQ(impacts.size(), 1U);
  EXPECT_EQ(impacts[0]["flags"], json::array({"too-short", "truncated-tail"}));
  EXPECT_FALSE(impacts[0]["rebound"].contains("restitution"));
  const std::string why =
      "The record ends before the displacement is back at first touch; record more after the "
      "trigger.";
  EXPECT_EQ(impacts[0]["rebound"]["absent"], why);
  EXPECT_THAT(run("inspect " + file).out, HasSubstr("rebound not determined: " + why));
}

// A rigid bar's displacement alone: no force and no velocity tell its restitution.
TEST_F(DisplacementAlone, GivesItsRestitutionToAFit) {
  Outcome o = run("simulate " + rig + " --set solver.model=rigid --set solver.duration=\"1.5 ms\"" +
                  " --interval 2e-6 -o " + path("way.csv"));
  ASSERT_EQ(o.code, 0) << o.err;
  std::istringstream history(text_of(path("way.csv")));
  std::string text = "Time [s],Displacement [m]\n", line;
  for (int i = -400; i < 0; ++i)
    text += fmt::format("{:.6f},{:.10f}\n", i * 2e-6,
                        0.441 * i * 2e-6 + 1e-8 * ((i * i * 7919) % 23 - 11));
  std::getline(history, line);
  for (int i = 0; std::getline(history, line); ++i) {
    double values[4] = {};
    std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf", values, values + 1, values + 2, values + 3);
    text +=
        fmt::format("{:.6f},{:.10f}\n", values[0], values[3] + 1e-8 * ((i * i * 7919) % 23 - 11));
  }
  const std::string shot = write("shot.csv", text);
  const std::string all = text_of(rig);
  const std::string own =
      write("own.toml", all.substr(0, all.find("[sensors.force]")) +
                            "[sensors.displacement]\nchannel = \"Displacement\"\n");
  const auto fit = [&](const std::string& described) {
    return "fit " + shot + " --rig " + described + " --set solver.model=rigid" +
           " --set solver.duration=\"1.5 ms\" --set contact.restitution=0.7 --json ";
  };
  // a rig file that says nothing of sensors may have forgotten the force's, or its unit
  const std::string silent = write("silent.toml", all.substr(0, all.find("[sensors.force]")));
  o = run(fit(silent));
  EXPECT_EQ(o.code, 3);
  EXPECT_THAT(o.err, HasSubstr("or fit what there is with --channels velocity or --channels "
                               "displacement"));
  EXPECT_EQ(run(fit(own) + "--channels force,displacement").code, 3);
  o = run(fit(own));  // this one says that a displacement was measured
  ASSERT_EQ(o.code, 0) << o.err;
  const json result = json::parse(o.out);
  EXPECT_THAT(result["warnings"].dump(), HasSubstr("no channel is known to be a force"));
  EXPECT_EQ(result["termination"], "converged");
  EXPECT_TRUE(result["impacts"][0].contains("rebound"));
  for (const json& p : result["parameters"])
    if (p["name"] == "contact.restitution") {
      EXPECT_NEAR(p["value"].get<double>(), 0.5, 4.0 * p["std_error"].get<double>());
      EXPECT_LT(p["std_error"].get<double>(), 0.02);
    }

  // sensors of the rig file that the recording lacks are not asked for where they are not fitted
  const std::string whole =
      write("whole.toml", all + "\n[sensors.displacement]\nchannel = \"Displacement\"\n");
  o = run("validate " + shot + " --rig " + whole + " --set solver.model=rigid" +
          " --set solver.duration=\"1.5 ms\" --channels displacement -o " + path("page.html"));
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_THAT(text_of(path("page.html")), HasSubstr("Mean rebound over approach"));
  EXPECT_THAT(text_of(path("page.html")), HasSubstr("The rebound is the mean from"));
}

}  // namespace
