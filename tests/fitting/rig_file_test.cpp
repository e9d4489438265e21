// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/rig_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "datasets/input_error.hpp"
#include "tests/fitting/synthetic_shot.hpp"

namespace impactrig::fitting {
namespace {

using tests::paper_rig;

std::string message_of(const std::string& text, const std::vector<Override>& overrides = {}) {
  try {
    parse_rig_file(text, "rig.toml", overrides);
  } catch (const datasets::InputError& error) {
    return error.what();
  }
  return "no error";
}

/// The paper's rig with one line replaced.
std::string with(const std::string& line, const std::string& replacement) {
  std::string text = paper_rig;
  const std::size_t at = text.find(line);
  EXPECT_NE(at, std::string::npos) << line;
  return text.replace(at, line.size(), replacement);
}

/// The paper's rig with keys of its contact added or replaced by others.
std::string with_contact(const std::string& lines) {
  return with("restitution = 0.5\n", lines + "\n");
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

TEST(RigFile, ChoosesTheMeshItLeavesOpen) {
  const std::string text(paper_rig);
  const std::string silent = text.substr(0, text.find("[solver]"));
  RigFile coarse = parse_rig_file(silent, "rig.toml", {{"solver.accuracy", "0.05"}});
  RigFile fine = parse_rig_file(silent, "rig.toml", {{"solver.accuracy", "0.005"}});
  EXPECT_NE(choose_mesh(coarse).find("was taken"), std::string::npos);
  EXPECT_NE(choose_mesh(fine).find("for an accuracy of 0.005"), std::string::npos);
  EXPECT_LT(coarse.solver.elements[0], fine.solver.elements[0]);
  EXPECT_EQ(choose_mesh(fine), "");  // once chosen it is stated
  RigFile stated = parse_rig_file(silent, "rig.toml", {{"solver.elements", "[14, 2]"}});
  EXPECT_EQ(choose_mesh(stated), "");
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

// Cowper (1966): circle, rectangle; a tube between a circle and a thin tube.
TEST(RigFile, ATimoshenkoBarHasTheShearCoefficientOfItsShape) {
  const auto beam = [](const std::string& section) {
    return parse_rig_file(with("section = { shape = \"circle\", radius = \"15 mm\" }",
                               "theory = \"timoshenko\"\nsection = " + section),
                          "rig.toml", {{"contact.radius", "15 mm"}, {"beam.poisson_ratio", "0.25"}})
        .rig.beam;
  };
  const models::Beam circle = beam(R"({ shape = "circle", radius = "15 mm" })");
  EXPECT_EQ(circle.theory, models::BeamTheory::timoshenko);
  EXPECT_DOUBLE_EQ(circle.poisson_ratio, 0.25);
  EXPECT_DOUBLE_EQ(circle.shear_coefficient, 6.0 * 1.25 / (7.0 + 6.0 * 0.25));
  EXPECT_DOUBLE_EQ(
      beam(R"({ shape = "rectangle", width = "40 mm", height = "10 mm" })").shear_coefficient,
      12.5 / (12.0 + 11.0 * 0.25));
  const auto tube = [&](const std::string& wall) {
    return beam("{ shape = \"tube\", radius = \"15 mm\", wall = \"" + wall + "\" }")
        .shear_coefficient;
  };
  EXPECT_NEAR(tube("1 um"), 2.0 * 1.25 / (4.0 + 3.0 * 0.25), 1e-4);
  EXPECT_NEAR(tube("14.99 mm"), circle.shear_coefficient, 1e-4);
  EXPECT_DOUBLE_EQ(beam(R"({ area = "7 cm^2", second_moment = "4 cm^4" }
shear_coefficient = 0.7)")
                       .shear_coefficient,
                   0.7);
}

TEST(RigFile, AShearCoefficientIsStatedWhereItIsNeededOnly) {
  const std::string round = "section = { shape = \"circle\", radius = \"15 mm\" }";
  const std::string plain = R"(section = { area = "7 cm^2", second_moment = "4 cm^4" })";
  EXPECT_EQ(message_of(with(round, plain + "\ntheory = \"timoshenko\"")),
            "rig.toml:2: beam.shear_coefficient: is missing; area and second moment do not say how "
            "the section shears, state it, for example shear_coefficient = 0.85");
  EXPECT_EQ(message_of(with(round, round + "\nshear_coefficient = 0.9")),
            "rig.toml:5:21: beam.shear_coefficient: a bar of Euler-Bernoulli's theory does not "
            "shear; add theory = \"timoshenko\"");
}

TEST(RigFile, ABarOfSegments) {
  const std::string length = "length = \"0.8 m\"";
  const std::string section = "section = { shape = \"circle\", radius = \"15 mm\" }";
  std::string text = with(section, "");
  text.erase(text.find(length), length.size());
  const std::string segments = R"(
[[beam.segments]]
length = "0.1 m"
section = { shape = "circle", radius = "15 mm" }
[[beam.segments]]
length = "0.2 m"
section = { shape = "tube", radius = "12 mm", wall = "2 mm" }
youngs_modulus = "210 GPa"
density = "7850 kg/m^3"
)";
  const RigFile file =
      parse_rig_file(text + segments, "rig.toml",
                     {{"contact.position", "0.3 m"}, {"sensors", "{}"}, {"solver", "{}"}});
  const models::Beam& beam = file.rig.beam;
  EXPECT_EQ(beam.length, 0.3);
  ASSERT_EQ(beam.segments.size(), 2u);
  EXPECT_FALSE(beam.segments[0].youngs_modulus);
  EXPECT_DOUBLE_EQ(*beam.segments[1].youngs_modulus, 210e9);
  EXPECT_DOUBLE_EQ(*beam.segments[1].density, 7850.0);
  EXPECT_NEAR(beam.segments[1].area, std::numbers::pi * (144e-6 - 100e-6), 1e-17);
  EXPECT_EQ(file.solver.elements[1], 0);  // struck at the tip
  // the stop meets the segment it strikes
  EXPECT_DOUBLE_EQ(file.rig.contact.radius, 0.012);
  EXPECT_DOUBLE_EQ(file.rig.contact.modulus, 210e9);
  EXPECT_DOUBLE_EQ(parse_rig_file(text + segments, "rig.toml",
                                  {{"contact.position", "0.1 m"}, {"sensors", "{}"}})
                       .rig.contact.radius,
                   0.015);
  EXPECT_NE(message_of(with(section, "") + segments)
                .find("beam.length: beam.segments say this of each segment; keep one of the two"),
            std::string::npos);
  EXPECT_NE(message_of(text + segments + "radius = \"1 mm\"\n").find("beam.segments[1].radius"),
            std::string::npos);
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

TEST(RigFile, ReadsTheMassesOnTheBar) {
  const std::string text = std::string(paper_rig) +
                           "\n[[beam.masses]]\nposition = \"80 cm\"\nmass = \"100 g\"\n"
                           "[[beam.masses]]\nposition = \"0.4 m\"\nmass = \"0.02 kg\"\n";
  const std::vector<models::LumpedMass> expected = {{0.8, 0.1}, {0.4, 0.02}};
  const auto masses = parse_rig_file(text, "rig.toml").rig.beam.masses;
  ASSERT_EQ(masses.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_DOUBLE_EQ(masses[i].position, expected[i].position);
    EXPECT_DOUBLE_EQ(masses[i].mass, expected[i].mass);
  }
  EXPECT_EQ(parse_rig_file(paper_rig, "rig.toml",
                           {{"beam.masses", "[{ position = \"0.4 m\", mass = \"20 g\" }]"}})
                .rig.beam.masses.size(),
            1u);
}

TEST(RigFile, FurtherStopsInheritWhatTheyDoNotState) {
  const std::string text = std::string(paper_rig) +
                           "\n[[contacts]]\nside = \"far\"\ngap = \"0.1 mm\"\n"
                           "[[contacts]]\nposition = \"30 cm\"\ngap = \"0 m\"\n"
                           "counterface = { shape = \"plane\" }\nrestitution = 0.8\n"
                           "[[contacts]]\nposition = \"0.8 m\"\ngap = \"1 um\"\n"
                           "law = \"linear\"\nstiffness = \"2e7 N/m\"\ndamping = \"exact\"\n";
  const models::Rig rig = parse_rig_file(text, "rig.toml").rig;
  ASSERT_EQ(rig.further_stops.size(), 3u);
  EXPECT_EQ(rig.further_stops[0], (models::FurtherStop{rig.contact, models::StopSide::far, 1e-4}));
  models::FurtherStop second{rig.contact, models::StopSide::near, 0.0};
  second.contact.position = 0.3;
  second.contact.counterface = models::Counterface::plane;
  second.contact.counter_radius = 0.0;
  second.contact.restitution = 0.8;
  EXPECT_EQ(rig.further_stops[1], second);
  const models::FurtherStop& third = rig.further_stops[2];
  EXPECT_EQ(third.contact.law, "linear");
  EXPECT_EQ(third.contact.damping, "exact");
  EXPECT_DOUBLE_EQ(third.contact.stiffness, 2e7);
  EXPECT_EQ(third.contact.restitution, rig.contact.restitution);
  EXPECT_DOUBLE_EQ(third.gap, 1e-6);
  EXPECT_EQ(parse_rig_file(paper_rig, "rig.toml", {{"contacts", "[{ gap = \"1 mm\" }]"}})
                .rig.further_stops.size(),
            1u);
}

TEST(RigFile, AFurtherStopOfAnotherDampingDoesNotInheritTheDashpot) {
  const std::string text =
      with_contact("damping = \"viscous\"\nviscous = \"2 kN.s/m\"\nrestitution = 0.5") +
      "\n[[contacts]]\ngap = \"1 mm\"\nside = \"far\"\n";
  const auto second = [&](const std::string& lines) {
    return parse_rig_file(text + lines, "rig.toml").rig.further_stops.at(0).contact;
  };
  EXPECT_EQ(second("damping = \"exact\"\n").damping, "exact");
  EXPECT_FALSE(second("damping = \"exact\"\n").viscous.has_value());
  EXPECT_DOUBLE_EQ(*second("").viscous, 2e3);
}

TEST(RigFile, ABarOfSegmentsMeetsAFurtherStopWithTheSegmentThere) {
  const std::string text =
      with(
          "length = \"0.8 m\"\nsection = { shape = \"circle\", radius = \"15 mm\" }\n",
          "segments = [{ length = \"0.5 m\", section = { shape = \"circle\", radius = \"12 mm\" }, "
          "youngs_modulus = \"200 GPa\" }, "
          "{ length = \"0.3 m\", section = { shape = \"circle\", radius = \"15 mm\" } }]\n") +
      "\n[[contacts]]\nposition = \"0.2 m\"\ngap = \"1 um\"\n";
  const models::Rig rig = parse_rig_file(text, "rig.toml").rig;
  EXPECT_DOUBLE_EQ(rig.contact.radius, 0.015);
  EXPECT_DOUBLE_EQ(rig.further_stops[0].contact.radius, 0.012);
  EXPECT_DOUBLE_EQ(rig.further_stops[0].contact.modulus, 200e9);
}

TEST(RigFile, AFurtherStopThatMakesNoSenseIsRefusedWithItsPlace) {
  const auto stop = [](const std::string& lines) {
    return message_of(std::string(paper_rig) + "\n[[contacts]]\n" + lines);
  };
  const auto line = [](long after) {
    return fmt::format("rig.toml:{}:",
                       2 + std::ranges::count(std::string(paper_rig), '\n') + after);
  };
  EXPECT_EQ(stop("gap = \"1 um\"\nposition = \"0.9 m\""),
            line(2) +
                "12: contacts[0].position: the struck point, 0.9 m from the hinge, lies beyond the "
                "bar's end at 0.8 m");
  EXPECT_NE(stop("side = \"far\"").find("contacts[0].gap: is missing; add gap = \"0.1 mm\""),
            std::string::npos);
  EXPECT_EQ(stop("gap = \"1 um\"\nside = \"left\""),
            line(2) + "8: contacts[0].side: expected one of near, far, found \"left\"");
  EXPECT_EQ(stop("gap = \"-1 um\""),
            line(1) + "7: contacts[0].gap: must be finite and not negative, found -1e-06 m");
  EXPECT_NE(stop("gap = \"1 um\"\nplace = 3").find("contacts[0].place: there is no such key here"),
            std::string::npos);
  const std::string text(paper_rig);
  const std::size_t begin = text.find("[contact]"), end = text.find("[start]");
  EXPECT_NE(
      message_of(text.substr(0, begin) + text.substr(end) + "\n[[contacts]]\ngap = \"1 um\"\n")
          .find("contacts: there is no [contact]; state the stop that is struck first there"),
      std::string::npos);
}

TEST(RigFile, AMassThatMakesNoSenseIsRefusedWithItsPlace) {
  const auto lump = [](const std::string& lines) {
    return message_of(std::string(paper_rig) + "\n[[beam.masses]]\n" + lines);
  };
  const std::string place =
      fmt::format("rig.toml:{}:", 2 + std::ranges::count(std::string(paper_rig), '\n') + 1);
  EXPECT_EQ(lump("position = \"0.9 m\"\nmass = \"1 g\""),
            place +
                "12: beam.masses[0].position: the mass, 0.9 m from the hinge, lies beyond the "
                "bar's end at 0.8 m");
  EXPECT_EQ(lump("position = 0.4\nmass = \"1 g\""),
            place +
                "12: beam.masses[0].position: the bare number 0.4 has no unit; write it in "
                "quotes with its unit, for example \"0.4 m\"");
  EXPECT_NE(
      lump("position = \"0.4 m\"").find("beam.masses[0].mass: is missing; add mass = \"0.1 kg\""),
      std::string::npos);
  EXPECT_NE(lump("position = \"0.4 m\"\nmass = \"1 g\"\ninertia = 3")
                .find("beam.masses[0].inertia: there is no such key here"),
            std::string::npos);
  EXPECT_EQ(message_of(paper_rig, {{"beam.masses", "0.1 kg"}}),
            "--set beam.masses: beam.masses: expected tables, for example [[beam.masses]]");
  EXPECT_EQ(
      message_of(paper_rig, {{"beam.masses", "[{ position = \"0.4 m\", mass = \"-20 g\" }]"}}),
      "--set beam.masses: beam.masses[0].mass: must be greater than zero, found -0.02 kg");
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

TEST(RigFile, ReadsTheStop) {
  EXPECT_FALSE(parse_rig_file(paper_rig, "rig.toml").rig.stop);
  const models::Rig rig =
      parse_rig_file(
          paper_rig, "rig.toml",
          {{"stop.mass", "50 g"}, {"stop.stiffness", "0.2 kN/um"}, {"stop.viscous", "30 N.s/m"}})
          .rig;
  EXPECT_NEAR(rig.stop->mass, 0.05, 1e-15);
  EXPECT_NEAR(rig.stop->stiffness, 2e8, 1e-6);
  EXPECT_DOUBLE_EQ(rig.stop->viscous, 30.0);
  EXPECT_NE(message_of(paper_rig, {{"stop.mass", "50 g"}}).find("stop.stiffness: is missing"),
            std::string::npos);
  EXPECT_EQ(message_of(paper_rig, {{"stop.mass", "-1 kg"}, {"stop.stiffness", "1e8 N/m"}}),
            "--set stop.mass: stop.mass: must be greater than zero, found -1 kg");
}

TEST(RigFile, ReadsTheHinge) {
  const models::Rig plain = parse_rig_file(paper_rig, "rig.toml").rig;
  EXPECT_EQ(plain.hinge, models::Hinge{});
  const models::Rig rig = parse_rig_file(paper_rig, "rig.toml",
                                         {{"hinge.spring", "3.5 N.m/rad"},
                                          {"hinge.viscous", "20 mN.m.s/rad"},
                                          {"hinge.friction", "5 N.cm"}})
                              .rig;
  EXPECT_DOUBLE_EQ(rig.hinge.spring, 3.5);
  EXPECT_DOUBLE_EQ(rig.hinge.viscous, 0.02);
  EXPECT_DOUBLE_EQ(rig.hinge.friction, 0.05);
  EXPECT_NE(message_of(paper_rig, {{"hinge.spring", "3 N/m"}}).find("--set hinge.spring: "),
            std::string::npos);
  EXPECT_EQ(message_of(paper_rig, {{"hinge.spring", "-3 N.m/rad"}}),
            "--set hinge.spring: hinge.spring: must be finite and not negative, found -3 N.m/rad");
  EXPECT_EQ(message_of(paper_rig, {{"hinge.viscous", "-1 N.m.s/rad"}}),
            "--set hinge.viscous: hinge.viscous: must be finite and not negative, found -1 "
            "N.m.s/rad");
  EXPECT_EQ(message_of(paper_rig, {{"hinge.friction", "-1 N.m"}}),
            "--set hinge.friction: hinge.friction: must be finite and not negative, found -1 N.m");
  EXPECT_NE(message_of(paper_rig, {{"hinge.stiction", "1"}}).find("there is no such key here"),
            std::string::npos);
}

TEST(RigFile, ReadsAHingeThatIsTurned) {
  const std::string arm =
      "[beam]\nlength = \"10 m\"\nsection = { area = \"100 cm^2\", second_moment = \"5e-6 m^4\" }\n"
      "youngs_modulus = \"2.8 GPa\"\ndensity = \"120 kg/m^3\"\n"
      "[solver]\nduration = \"20 s\"\n"
      "[hinge]\nrotation = { rate = \"6 rad/s\", time = \"15 s\" }\n";
  const models::Rig rig = parse_rig_file(arm, "rig.toml").rig;
  ASSERT_TRUE(rig.hinge.rotation);
  EXPECT_DOUBLE_EQ(rig.hinge.rotation->rate, 6.0);
  EXPECT_DOUBLE_EQ(rig.hinge.rotation->time, 15.0);
  EXPECT_FALSE(rig.start.release_angle);
  const models::Rig turned = parse_rig_file(arm, "rig.toml",
                                            {{"hinge.rotation", "{ rate = \"-30 deg/s\" }"},
                                             {"start.release_angle", "0.2 rad"}})
                                 .rig;
  EXPECT_DOUBLE_EQ(turned.hinge.rotation->rate, -std::numbers::pi / 6.0);
  EXPECT_EQ(turned.hinge.rotation->time, 0.0);
  EXPECT_DOUBLE_EQ(*turned.start.release_angle, 0.2);
  EXPECT_NE(message_of(arm, {{"hinge.rotation", "{ time = \"1 s\" }"}}).find("hinge.rotation.rate"),
            std::string::npos);
  EXPECT_NE(message_of(arm, {{"hinge.friction", "1 N.m"}})
                .find("hinge.friction: changes nothing where hinge.rotation states"),
            std::string::npos);
}

TEST(RigFile, ReadsTheDampingOfTheBar) {
  EXPECT_EQ(parse_rig_file(paper_rig, "rig.toml").rig.beam.damping, models::BarDamping{});
  const models::BarDamping both =
      parse_rig_file(paper_rig, "rig.toml",
                     {{"beam.damping", "{ mass = \"2 1/s\", stiffness = \"1.5 us\" }"}})
          .rig.beam.damping;
  EXPECT_DOUBLE_EQ(both.mass, 2.0);
  EXPECT_DOUBLE_EQ(both.stiffness, 1.5e-6);
  const models::BarDamping kelvin_voigt =
      parse_rig_file(paper_rig, "rig.toml", {{"beam.damping.stiffness", "3 us"}}).rig.beam.damping;
  EXPECT_EQ(kelvin_voigt.mass, 0.0);
  EXPECT_DOUBLE_EQ(kelvin_voigt.stiffness, 3e-6);
  EXPECT_EQ(message_of(paper_rig, {{"beam.damping.stiffness", "-3 us"}}),
            "--set beam.damping.stiffness: beam.damping.stiffness: must be finite and not "
            "negative, found -3e-06 s");
  EXPECT_EQ(message_of(paper_rig, {{"beam.damping.mass", "-3 1/s"}}),
            "--set beam.damping.mass: beam.damping.mass: must be finite and not negative, found -3 "
            "1/s");
  EXPECT_NE(message_of(paper_rig, {{"beam.damping.mass", "3 kg"}})
                .find("--set beam.damping.mass: beam.damping.mass: "),
            std::string::npos);
  EXPECT_NE(message_of(paper_rig, {{"beam.damping.ratio", "0.1"}})
                .find("beam.damping.ratio: there is no such key here"),
            std::string::npos);
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
            "-180 and 180 degrees, found 4 rad");
  EXPECT_NE(message_of(paper_rig, {{"environment.gravity_direction", "3 m"}})
                .find("--set environment.gravity_direction: "),
            std::string::npos);
}

TEST(RigFile, ThePowerLawsUnitTellsItsPower) {
  const std::string law = "law = \"lankarani-nikravesh-cylinder\"\nrestitution = 0.5\n";
  const auto contact = [&](const std::string& stiffness) {
    return parse_rig_file(with_contact(law + "stiffness = \"" + stiffness + "\""), "rig.toml")
        .rig.contact;
  };
  const models::Contact metres = contact("1.6e10 N/m^1.5");
  EXPECT_DOUBLE_EQ(metres.stiffness, 1.6e10);
  EXPECT_DOUBLE_EQ(metres.power, 1.5);
  const models::Contact millimetres = contact("5e5 N/mm^1.5");
  EXPECT_NEAR(millimetres.stiffness / (5e5 * std::pow(1e3, 1.5)), 1.0, 1e-14);
  EXPECT_DOUBLE_EQ(millimetres.power, 1.5);
  const models::Contact kilonewtons = contact("3 kN/um^1.1");
  EXPECT_NEAR(kilonewtons.stiffness / (3e3 * std::pow(1e6, 1.1)), 1.0, 1e-14);
  EXPECT_DOUBLE_EQ(kilonewtons.power, 1.1);
  // an uncertainty may follow the value, as of any quantity
  for (const char* text : {"1.6e10(2e8) N/m^1.5", "1.60(2)e10 N/m^1.5", "1.6e10 ± 2e8 N/m^1.5",
                           "1.6e10 +/- 2e8 N/m^1.5"}) {
    EXPECT_DOUBLE_EQ(contact(text).stiffness, 1.6e10) << text;
    EXPECT_DOUBLE_EQ(contact(text).power, 1.5) << text;
  }
}

TEST(RigFile, AStiffnessWithoutItsPowerIsRefused) {
  const auto message = [](const std::string& law, const std::string& stiffness) {
    return message_of(
        with_contact("law = \"" + law + "\"\nrestitution = 0.5\nstiffness = " + stiffness));
  };
  const std::string cylinder = "lankarani-nikravesh-cylinder";
  EXPECT_NE(
      message(cylinder, "\"1.6e10 N/m\"")
          .find("contact.stiffness: expected a factor whose unit tells the power, for example "
                "\"1.6e10 N/m^1.5\", found \"1.6e10 N/m\""),
      std::string::npos)
      << message(cylinder, "\"1.6e10 N/m\"");
  EXPECT_NE(message(cylinder, "\"1.6e10 N/m^x\"").find("tells the power"), std::string::npos);
  EXPECT_NE(message(cylinder, "\"1.6e10 N/s^1.5\"").find("contact.stiffness"), std::string::npos);
  EXPECT_NE(message(cylinder, "\"1.6e10(2) N/m^1.5\"")
                .find("found \"1.6e10(2) N/m^1.5\": \"1.6e10(2) N\" leaves open how large its "
                      "uncertainty is"),
            std::string::npos);
  EXPECT_NE(message(cylinder, "\"1.6e10 N/m^0.5\"").find("must lie between 1 and 5, found 0.5"),
            std::string::npos);
  const std::string silent = "law = \"" + cylinder + "\"\nrestitution = 0.5\n";
  EXPECT_NE(message_of(with_contact(silent))
                .find("contact.stiffness: is missing; add stiffness = \"1.6e10 N/m^1.5\""),
            std::string::npos);
  EXPECT_NE(message_of(with_contact(silent + "stifness = \"1.6e10 N/m^1.5\""))
                .find("contact.stifness: there is no such key here; did you mean stiffness?"),
            std::string::npos);
  EXPECT_NE(message("goldsmith", "\"1e8 N/m\"")
                .find("contact.stiffness: the law \"goldsmith\" follows from geometry and moduli"),
            std::string::npos);
  EXPECT_NE(message("linear", "\"1e8 N/m^1.5\"").find("contact.stiffness"), std::string::npos);
}

TEST(RigFile, ReadsWhatDampingLawsTake) {
  const models::Contact silent = parse_rig_file(paper_rig, "rig.toml").rig.contact;
  EXPECT_EQ(silent.tension, models::Tension::clip);
  EXPECT_FALSE(silent.reference_length || silent.restitution_speed || silent.effective_mass);
  const models::Contact stated =
      parse_rig_file(with_contact("restitution = 0.5\ntension = \"allow\"\n"
                                  "reference_length = \"1 mm\"\n"
                                  "restitution_speed = \"20 cm/s\"\n"
                                  "effective_mass = \"350 g\""),
                     "rig.toml")
          .rig.contact;
  EXPECT_EQ(stated.tension, models::Tension::allow);
  EXPECT_DOUBLE_EQ(*stated.reference_length, 1e-3);
  EXPECT_DOUBLE_EQ(*stated.restitution_speed, 0.2);
  EXPECT_DOUBLE_EQ(*stated.effective_mass, 0.35);
  EXPECT_EQ(parse_rig_file(with_contact("restitution = 0.5\ntension = \"clip\""), "rig.toml")
                .rig.contact.tension,
            models::Tension::clip);
}

TEST(RigFile, AStatedDashpotOrRelaxationNeedsNoRestitution) {
  const models::Contact viscous =
      parse_rig_file(with_contact("damping = \"viscous\"\nviscous = \"2 kN.s/m\""), "rig.toml")
          .rig.contact;
  EXPECT_DOUBLE_EQ(*viscous.viscous, 2e3);
  EXPECT_DOUBLE_EQ(viscous.restitution, 1.0);
  const models::Contact relaxing =
      parse_rig_file(with_contact("damping = \"kuwabara-kono\"\nrelaxation_time = \"5 us\""),
                     "rig.toml")
          .rig.contact;
  EXPECT_DOUBLE_EQ(*relaxing.relaxation_time, 5e-6);
}

TEST(RigFile, WhatADampingLawDoesNotTakeIsRefused) {
  EXPECT_NE(
      message_of(with_contact("restitution = 0.5\nviscous = \"10 N.s/m\""))
          .find("contact.viscous: only the damping law \"viscous\" takes it, this contact has "
                "\"lankarani-nikravesh\""),
      std::string::npos);
  EXPECT_NE(message_of(with_contact("damping = \"viscous\"\nrestitution = 0.5\n"
                                    "relaxation_time = \"1 us\""))
                .find("contact.relaxation_time: only the damping law \"kuwabara-kono\" takes it, "
                      "this contact has \"viscous\""),
            std::string::npos);
  EXPECT_NE(message_of(with_contact("restitution = 0.5\ntension = \"some\""))
                .find("contact.tension: expected one of clip, allow, found \"some\""),
            std::string::npos);
  EXPECT_NE(message_of(with_contact("restitution = 0.5\nrestitution_speed = \"0 m/s\""))
                .find("contact.restitution_speed"),
            std::string::npos);
  EXPECT_NE(message_of(with_contact("damping = \"herbert-mcwhannell-implicit\"\nrestitution = 0.4"))
                .find("0.4 needs more damping than the law 'herbert-mcwhannell-implicit' can give; "
                      "use 0.52 or more"),
            std::string::npos);
}

TEST(RigFile, APlaneMayStateItsDepth) {
  const std::string groove = "counterface = { shape = \"groove\", radius = \"17.5 mm\" }";
  const std::string plane = with(groove,
                                 "counterface = { shape = \"plane\", depth = \"30 mm\" }\n"
                                 "law = \"johnson\"");
  EXPECT_DOUBLE_EQ(parse_rig_file(plane, "rig.toml").rig.contact.counter_depth, 0.03);
  const std::string bare = with(groove, "counterface = { shape = \"plane\" }\nlaw = \"johnson\"");
  EXPECT_NE(message_of(bare).find("the law 'johnson' needs the depth of a plane"),
            std::string::npos);
  const std::string refused = with(groove,
                                   "counterface = { shape = \"plane\", depth = \"30 mm\" }\n"
                                   "law = \"esdu-78035\"");
  EXPECT_NE(message_of(refused).find("the law 'esdu-78035' does not know a plane"),
            std::string::npos);
}

template <typename Action>
Action only_action(const std::string& lines) {
  const RigFile file =
      parse_rig_file(paper_rig + ("\n[[conditioning]]\nchannel = \"force\"\n" + lines), "rig.toml");
  EXPECT_EQ(file.conditioning.size(), 1U);
  EXPECT_EQ(file.conditioning.at(0).channel, "force");
  return std::get<Action>(file.conditioning.at(0).action);
}

TEST(RigFile, ReadsEveryConditioningStep) {
  using namespace datasets;
  EXPECT_FALSE(only_action<RemoveBaseline>("step = 'baseline'").quiet);
  const auto drift =
      only_action<RemoveDrift>("step = 'drift'\nquiet = { from = '-1 ms', to = '0 s' }");
  ASSERT_TRUE(drift.quiet);
  EXPECT_DOUBLE_EQ(drift.quiet->begin, -1e-3);
  EXPECT_DOUBLE_EQ(drift.quiet->end, 0.0);
  const auto decay = only_action<RemoveDecay>(
      "step = 'decay'\ntime_constant = '0.5 s'\n"
      "quiet = [{ from = '-1 ms', to = '0 s' }, { from = '5 ms', to = '9 ms' }]");
  EXPECT_DOUBLE_EQ(*decay.time_constant, 0.5);
  ASSERT_EQ(decay.quiet.size(), 2U);
  EXPECT_DOUBLE_EQ(decay.quiet[1].end, 9e-3);
  EXPECT_DOUBLE_EQ(only_action<UndoLowCut>("step = 'undo-low-cut'\nfrequency = '0.3 Hz'").frequency,
                   0.3);
  const auto low_pass = only_action<LowPass>("step = 'low-pass'\ncutoff = '100 kHz'\norder = 3");
  EXPECT_DOUBLE_EQ(low_pass.cutoff, 1e5);
  EXPECT_EQ(low_pass.order, 3);
  const auto hum = only_action<RemoveHum>("step = 'hum'\nharmonics = 7");
  EXPECT_DOUBLE_EQ(*hum.frequency, 50.0);  // the mains of [environment]
  EXPECT_EQ(hum.harmonics, 7);
  EXPECT_DOUBLE_EQ(only_action<RepairDropouts>("step = 'dropouts'").longest, 300e-6);
  const auto to = only_action<AlignTo>("step = 'align'\nto = 'velocity'\nrange = '20 us'");
  EXPECT_EQ(to.reference, "velocity");
  EXPECT_DOUBLE_EQ(to.range, 20e-6);
  EXPECT_DOUBLE_EQ(only_action<Resample>("step = 'resample'\nrate = '1 MHz'").rate, 1e6);
  const auto integral =
      only_action<Integrate>("step = 'integrate'\nname = 'impulse'\nzero_at = '1 ms'");
  EXPECT_EQ(integral.name, "impulse");
  EXPECT_DOUBLE_EQ(*integral.zero_at, 1e-3);
  EXPECT_EQ(only_action<Differentiate>("step = 'differentiate'\nname = 'a'").name, "a");
}

TEST(RigFile, HumIsOfTheMainsUnlessStated) {
  std::string text =
      paper_rig + std::string("\n[[conditioning]]\nchannel = 'force'\nstep = 'hum'\n");
  const RigFile american =
      parse_rig_file(text, "rig.toml", {{"environment.mains_frequency", "60 Hz"}});
  EXPECT_DOUBLE_EQ(*std::get<datasets::RemoveHum>(american.conditioning.at(0).action).frequency,
                   60.0);
  const RigFile stated = parse_rig_file(text + "frequency = '16.7 Hz'\n", "rig.toml");
  EXPECT_DOUBLE_EQ(*std::get<datasets::RemoveHum>(stated.conditioning.at(0).action).frequency,
                   16.7);
}

TEST(RigFile, AConditioningStepThatMakesNoSenseIsRefused) {
  const auto refused = [](const std::string& lines) {
    const std::string message =
        message_of(paper_rig + ("\n[[conditioning]]\nchannel = \"force\"\n" + lines));
    return message.substr(message.find(": ") + 2);
  };
  EXPECT_EQ(refused("step = 'low-pas'\ncutoff = '1 Hz'"),
            "conditioning[0].step: expected one of baseline, "
            "drift, decay, undo-low-cut, low-pass, hum, dropouts, align, resample, integrate, "
            "differentiate, found \"low-pas\"");
  EXPECT_EQ(refused("step = 'low-pass'"),
            "conditioning[0].cutoff: is missing; add cutoff = \"100 kHz\"");
  EXPECT_EQ(refused("step = 'low-pass'\ncutoff = '-1 Hz'"),
            "conditioning[0].cutoff: must be greater than zero");
  EXPECT_EQ(refused("step = 'low-pass'\ncutoff = '1 Hz'\norder = 9"),
            "conditioning[0].order: must be 1 to 8, found 9");
  EXPECT_EQ(refused("step = 'drift'\nquiet = { from = '1 ms', to = '0 s' }"),
            "conditioning[0].quiet.to: must be later than from");
  EXPECT_EQ(refused("step = 'drift'\nquiet = [{ from = '0 s', to = '1 s' }, { from = '2 s', to = "
                    "'3 s' }]"),
            "conditioning[0].quiet: names 2 stretches; this step takes one");
  EXPECT_EQ(refused("step = 'drift'\ncutoff = '1 Hz'"),
            "conditioning[0].cutoff: there is no such key here; known are channel, quiet, step");
  EXPECT_EQ(refused(""), "conditioning[0].step: is missing; add step = \"low-pass\"");
}

TEST(RigFile, AMissingFileIsAFileError) {
  EXPECT_THROW(read_rig_file("/nowhere/rig.toml"), datasets::FileError);
}

}  // namespace
}  // namespace impactrig::fitting
