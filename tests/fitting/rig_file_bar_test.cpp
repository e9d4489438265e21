// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <string>
#include <vector>

#include "tests/fitting/rig_text.hpp"

namespace impactrig::tests {
namespace {

using namespace fitting;

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

// 0.35 m + 0.34 m is not the double of 69 cm, which is no place beyond the bar.
TEST(RigFile, APlaceMayBeTheEndButForRounding) {
  const RigFile file = parse_rig_file(R"([beam]
youngs_modulus = "69 GPa"
density = "2700 kg/m^3"
[[beam.segments]]
length = "35 cm"
section = { shape = "circle", radius = "15 mm" }
[[beam.segments]]
length = "34 cm"
section = { shape = "circle", radius = "12 mm" }
[[beam.masses]]
position = "690 mm"
mass = "0.1 kg"
[[beam.masses]]
position = "350 mm"
mass = "0.1 kg"
[contact]
position = "69 cm"
law = "linear"
stiffness = "1e7 N/m"
damping = "none"
[start]
velocity = "0.4 m/s"
[sensors.velocity]
channel = "v"
sensitivity = "125 mm/s/V"
position = "27.165354330708661 in"
)",
                                      "rig.toml");
  EXPECT_EQ(file.rig.contact.position, file.rig.beam.length);
  EXPECT_EQ(file.rig.beam.masses[0].position, file.rig.beam.length);
  EXPECT_EQ(file.rig.beam.masses[1].position, file.rig.beam.segments[0].length);
  EXPECT_EQ(file.velocity->position, file.rig.beam.length);
  EXPECT_THAT(message_of(with("position = \"0.69 m\"", "position = \"0.8000001 m\"")),
              testing::HasSubstr("lies beyond the bar's end"));
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
  EXPECT_NE(message_of(text + segments + "radius = \"1 mm\"\n").find("beam.segments.2.radius"),
            std::string::npos);
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

TEST(RigFile, AMassThatMakesNoSenseIsRefusedWithItsPlace) {
  const auto lump = [](const std::string& lines) {
    return message_of(std::string(paper_rig) + "\n[[beam.masses]]\n" + lines);
  };
  const std::string place =
      fmt::format("rig.toml:{}:", 2 + std::ranges::count(std::string(paper_rig), '\n') + 1);
  EXPECT_EQ(lump("position = \"0.9 m\"\nmass = \"1 g\""),
            place +
                "12: beam.masses.1.position: the mass, 0.9 m from the hinge, lies beyond the "
                "bar's end at 0.8 m");
  EXPECT_EQ(lump("position = 0.4\nmass = \"1 g\""),
            place +
                "12: beam.masses.1.position: the bare number 0.4 has no unit; write it in "
                "quotes with its unit, for example \"0.4 m\"");
  EXPECT_NE(
      lump("position = \"0.4 m\"").find("beam.masses.1.mass: is missing; add mass = \"0.1 kg\""),
      std::string::npos);
  EXPECT_NE(lump("position = \"0.4 m\"\nmass = \"1 g\"\ninertia = 3")
                .find("beam.masses.1.inertia: there is no such key here"),
            std::string::npos);
  EXPECT_EQ(message_of(paper_rig, {{"beam.masses", "0.1 kg"}}),
            "--set beam.masses: beam.masses: expected tables, for example [[beam.masses]]");
  EXPECT_EQ(
      message_of(paper_rig, {{"beam.masses", "[{ position = \"0.4 m\", mass = \"-20 g\" }]"}}),
      "--set beam.masses: beam.masses.1.mass: must be greater than zero, found -0.02 kg");
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

}  // namespace
}  // namespace impactrig::tests
