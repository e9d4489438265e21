// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/rig_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <numbers>
#include <string>

#include "tests/fitting/rig_text.hpp"

namespace impactrig::tests {
namespace {

using namespace fitting;

TEST(RigFile, RefusesElementsThatAreNone) {
  for (const char* elements : {"0", "-4", "[-4]"})
    EXPECT_THAT(
        message_of(tests::paper_rig, {{"solver.model", "ancf"}, {"solver.elements", elements}}),
        testing::HasSubstr("solver.elements: must be at least 1, found "))
        << elements;
}

TEST(RigFile, ReadsThePapersRigInSi) {
  const RigFile file = parse_rig_file(paper_rig, "rig.toml");
  const models::Rig& rig = file.rig;
  EXPECT_DOUBLE_EQ(rig.beam.length, 0.8);
  EXPECT_NEAR(rig.beam.area, std::numbers::pi * 0.015 * 0.015, 1e-18);
  EXPECT_NEAR(rig.beam.second_moment, std::numbers::pi / 4.0 * 5.0625e-8, 1e-20);
  EXPECT_DOUBLE_EQ(rig.beam.youngs_modulus, 68.952e9);
  EXPECT_DOUBLE_EQ(rig.contact.counter_radius, 0.0175);
  EXPECT_DOUBLE_EQ(rig.contact.radius, 0.015);  // of the section
  EXPECT_DOUBLE_EQ(rig.contact.modulus, 68.952e9);
  EXPECT_DOUBLE_EQ(rig.start.velocity, 0.441);
  EXPECT_EQ(file.solver.model, models::BeamModel::ancf);
  EXPECT_EQ(file.solver.elements, (std::array{14, 2}));
  EXPECT_DOUBLE_EQ(*file.solver.duration, 0.003);
  ASSERT_TRUE(file.force && file.velocity);
  EXPECT_EQ(file.force->recorded_unit, "V");
  EXPECT_NEAR(file.force->sensitivity->value, 4e-3, 1e-18);  // 4 pC/N times 1 mV/pC
  EXPECT_DOUBLE_EQ(file.force->low_cut->frequency, 0.3);
  EXPECT_DOUBLE_EQ(file.force->high_cut->frequency, 1e5);
  EXPECT_DOUBLE_EQ(file.force->resonance->quality, 20.0);
  EXPECT_NEAR(file.velocity->sensitivity->value, 8.0, 1e-14);  // 125 mm/s/V the other way round
  EXPECT_NEAR(file.velocity->delay.value, 2e-6, 1e-20);
  EXPECT_NEAR(file.velocity->delay.uncertainty, 1e-7, 1e-21);
}

TEST(RigFile, WorksWithoutSolverAndSensors) {
  const std::string text(paper_rig);
  const RigFile file = parse_rig_file(text.substr(0, text.find("[solver]")), "rig.toml");
  EXPECT_FALSE(file.mesh_stated);
  EXPECT_EQ(file.solver.elements[0] + file.solver.elements[1], 16);
  EXPECT_EQ(file.solver.accuracy, 1e-4);
  EXPECT_FALSE(file.solver.duration.has_value());
}

TEST(RigFile, SaysWhereWhatItRefusesWasStated) {
  EXPECT_THAT(message_of(paper_rig, {{"foo.bar", "1"}}),
              testing::StartsWith("--set foo.bar: foo: there is no such key here"));
  EXPECT_THAT(message_of(std::string(paper_rig) + "[contact]\n"),
              testing::HasSubstr("a table and a key stand once in a file"));
}

// Counted from 1, as in the names of what is fitted and in refusals.
TEST(RigFile, TakesOverridesOfTablesInLists) {
  const std::string text =
      std::string(paper_rig) +
      "[[contacts]]\nposition = \"0.5 m\"\ngap = \"1 mm\"\n[[beam.masses]]\nposition = \"0.3 m\"\n"
      "mass = \"0.1 kg\"\n[[beam.masses]]\nposition = \"0.4 m\"\nmass = \"0.2 kg\"\n";
  const RigFile file = parse_rig_file(
      text, "rig.toml", {{"contacts.1.gap", "\"2 mm\""}, {"beam.masses.2.mass", "\"0.3 kg\""}});
  EXPECT_DOUBLE_EQ(file.rig.further_stops.at(0).gap, 2e-3);
  EXPECT_DOUBLE_EQ(file.rig.beam.masses.at(0).mass, 0.1);
  EXPECT_DOUBLE_EQ(file.rig.beam.masses.at(1).mass, 0.3);
  const auto refused = [&](const char* key, const char* value) {
    return message_of(text, {{key, value}});
  };
  EXPECT_EQ(
      refused("contacts.2.gap", "\"2 mm\""),
      "--set contacts.2.gap: the rig file has 1 [[contacts]], counted from 1 here: there is no "
      "'2'");
  EXPECT_EQ(refused("beam.segments.1.length", "\"0.3 m\""),
            "--set beam.segments.1.length: the rig file has no [[beam.segments]]");
  EXPECT_EQ(
      refused("contacts.gap", "\"2 mm\""),
      "--set contacts.gap: names no key of one of the tables of a list, as contacts.1.gap does");
  EXPECT_EQ(
      refused("contacts.1.gap", "\"-2 mm\""),
      "--set contacts.1.gap: contacts.1.gap: must be finite and not negative, found -0.002 m");
  EXPECT_THAT(refused("beam.masses.1.mass", "\"-2 kg\""),
              testing::StartsWith("--set beam.masses.1.mass: beam.masses.1.mass: must be greater"));
}

TEST(RigFile, TakesOverridesWithAndWithoutQuotes) {
  const RigFile file = parse_rig_file(paper_rig, "rig.toml",
                                      {{"beam.length", "\"0.9 m\""},
                                       {"start.velocity", "1 m/s"},
                                       {"solver.elements", "[7, 1]"},
                                       {"solver.model", "ancf"},
                                       {"contact.exponent", "3"}});
  EXPECT_DOUBLE_EQ(file.rig.beam.length, 0.9);
  EXPECT_DOUBLE_EQ(file.rig.start.velocity, 1.0);
  EXPECT_EQ(file.solver.elements, (std::array{7, 1}));
  EXPECT_EQ(file.rig.contact.exponent, 3);
}

TEST(RigFile, OneNumberOfElementsIsSplitAtTheStruckPoint) {
  EXPECT_EQ(parse_rig_file(paper_rig, "rig.toml", {{"solver.elements", "8"}}).solver.elements,
            (std::array{7, 1}));
  EXPECT_EQ(parse_rig_file(paper_rig, "rig.toml",
                           {{"solver.elements", "8"}, {"contact.position", "0.8 m"}})
                .solver.elements,
            (std::array{8, 0}));
}

TEST(RigFile, ReadsEverySection) {
  const auto beam = [](const std::string& section) {
    return parse_rig_file(with("section = { shape = \"circle\", radius = \"15 mm\" }", section),
                          "rig.toml", {{"contact.radius", "15 mm"}})
        .rig.beam;
  };
  const models::Beam rectangle =
      beam(R"(section = { shape = "rectangle", width = "40 mm", height = "10 mm" })");
  EXPECT_NEAR(rectangle.area, 4e-4, 1e-18);
  EXPECT_NEAR(rectangle.second_moment, 0.04 * 1e-6 / 12.0, 1e-22);
  const models::Beam tube =
      beam(R"(section = { shape = "tube", radius = "15 mm", wall = "5 mm" })");
  EXPECT_NEAR(tube.area, std::numbers::pi * (225e-6 - 100e-6), 1e-17);
  const models::Beam plain = beam(R"(section = { area = "7 cm^2", second_moment = "4 cm^4" })");
  EXPECT_NEAR(plain.area, 7e-4, 1e-18);
  EXPECT_NEAR(plain.second_moment, 4e-8, 1e-22);
}

TEST(RigFile, ABareNumberIsRefusedWhereAUnitIsMeant) {
  EXPECT_EQ(message_of(with("length = \"0.8 m\"", "length = 0.8")),
            "rig.toml:3:10: beam.length: the bare number 0.8 has no unit; write it in quotes with "
            "its unit, for example \"0.8 m\"");
}

TEST(RigFile, AnUnknownKeyIsAnErrorWithTheNearestKnownOne) {
  EXPECT_EQ(message_of(with("density =", "densty =")),
            "rig.toml:7:10: beam.densty: there is no such key here; did you mean density?");
  EXPECT_EQ(message_of(with("density = \"2766.7 kg/m^3\"", "")),
            "rig.toml:2: beam.density: is missing; add density = \"2766.7 kg/m^3\"");
  EXPECT_EQ(
      message_of(with("restitution = 0.5", "restitution = 0.5\nrestitutoin = 0.4")),
      "rig.toml:14:15: contact.restitutoin: there is no such key here; did you mean restitution?");
}

// A delay is read only where there is one.
TEST(RigFile, KeysThatAreLookedForAreKnownToo) {
  const std::string sensor = "[sensors.displacement]\nchannel = \"F\"\n";
  EXPECT_THAT(
      message_of(paper_rig + sensor + "dely = \"2 us\"\n"),
      testing::EndsWith("sensors.displacement.dely: there is no such key here; did you mean "
                        "delay?"));
  EXPECT_THAT(message_of(paper_rig + sensor + "sensitivty = \"4 pC/N\"\n"),
              testing::EndsWith("did you mean sensitivity?"));
}

TEST(RigFile, SaysWhichValueMakesNoSense) {
  EXPECT_EQ(message_of(with("position = \"0.69 m\"", "position = \"0.9 m\"")),
            "rig.toml:9:12: contact.position: the struck point, 0.9 m from the hinge, lies beyond "
            "the bar's end at 0.8 m");
  EXPECT_EQ(message_of(with("restitution = 0.5", "restitution = 1.5")),
            "rig.toml:13:15: contact.restitution: must lie between 0 and 1, found 1.5");
  EXPECT_EQ(message_of(paper_rig, {{"contact.restitution", "-0.1"}}),
            "--set contact.restitution: contact.restitution: must lie between 0 and 1, found -0.1");
}

// The second number is of elements between the struck point and the tip.
TEST(RigFile, ElementsBeyondAStruckPointNeedAContact) {
  try {
    parse_rig_file(paper_rig, "rig.toml",
                   {{"solver.elements", "[56, 8]"}, {"solver.duration", "1 s"}}, {"contact"});
    ADD_FAILURE() << "taken";
  } catch (const datasets::InputError& error) {
    EXPECT_STREQ(error.what(),
                 "--set solver.elements: solver.elements: [contact] is missing: without it no "
                 "point of the bar is struck, and the second number must be 0, found 8");
  }
}

TEST(RigFile, AWrongDimensionShowsACorrectLine) {
  const std::string message = message_of(with("length = \"0.8 m\"", "length = \"0.8 kg\""));
  EXPECT_NE(message.find("rig.toml:3:10: beam.length: "), std::string::npos) << message;
}

TEST(RigFile, BrokenTomlHasAPlace) {
  const std::string message = message_of("[beam\nlength = 1");
  EXPECT_EQ(message.find("rig.toml:1:"), 0U) << message;
  EXPECT_NE(message.find("not a TOML file"), std::string::npos) << message;
}

TEST(RigFile, TwoStartsAreOneTooMany) {
  EXPECT_EQ(message_of(paper_rig, {{"start.release_angle", "12 deg"}}),
            "--set start.release_angle: start.release_angle: start.velocity is stated too; keep "
            "one of the two");
}

TEST(RigFile, ASensitivityThatIsNoneIsRefused) {
  EXPECT_EQ(message_of(paper_rig, {{"sensors.force.sensitivity", "4 kg"}}),
            "--set sensors.force.sensitivity: sensors.force.sensitivity: expected volts or "
            "coulombs a N, for example \"4 pC/N\", "
            "found \"4 kg\"");
}

TEST(RigFile, MainsAre50HertzUnlessStated) {
  const std::string text = paper_rig;
  EXPECT_EQ(parse_rig_file(text, "rig.toml").mains_frequency, 50.0);
  EXPECT_EQ(
      parse_rig_file(text, "rig.toml", {{"environment.mains_frequency", "60 Hz"}}).mains_frequency,
      60.0);
  EXPECT_THROW(parse_rig_file(text, "rig.toml", {{"environment.mains_frequency", "0 Hz"}}),
               datasets::InputError);
}

TEST(RigFile, WithoutAContactIsAFreeSwing) {
  const std::string free = R"(
[beam]
length = "0.8 m"
section = { shape = "circle", radius = "15 mm" }
youngs_modulus = "68.952 GPa"
density = "2766.7 kg/m^3"
[start]
release_angle = "60 deg"
)";
  const RigFile file = parse_rig_file(free, "rig.toml", {{"solver.duration", "2 s"}});
  EXPECT_FALSE(file.rig.has_stop());
  EXPECT_EQ(file.rig.contact.position, 0.8);
  EXPECT_EQ(file.solver.elements[1], 0);
  EXPECT_EQ(message_of(free),
            "rig.toml: solver.duration: is missing: without [contact] the bar swings for as long "
            "as stated");
}

TEST(RigFile, ReadsTheDirectionOfGravity) {
  EXPECT_EQ(parse_rig_file(paper_rig, "rig.toml").rig.gravity_direction, 0.0);
  const auto direction = [](const char* value) {
    return parse_rig_file(paper_rig, "rig.toml", {{"environment.gravity_direction", value}})
        .rig.gravity_direction;
  };
  EXPECT_NEAR(direction("30 deg"), std::numbers::pi / 6.0, 1e-15);
  EXPECT_NEAR(direction("180 deg"), std::numbers::pi, 1e-15);
  EXPECT_NEAR(direction("-180 deg"), -std::numbers::pi, 1e-15);
  EXPECT_EQ(message_of(paper_rig, {{"environment.gravity_direction", "4 rad"}}),
            "--set environment.gravity_direction: environment.gravity_direction: must lie between "
            "-180 and 180 degrees, found 229.183 degrees");
  EXPECT_NE(message_of(paper_rig, {{"environment.gravity_direction", "3 m"}})
                .find("--set environment.gravity_direction: "),
            std::string::npos);
}

TEST(RigFile, AMissingFileIsAFileError) {
  EXPECT_THROW(read_rig_file("/nowhere/rig.toml"), datasets::FileError);
}

}  // namespace
}  // namespace impactrig::tests
