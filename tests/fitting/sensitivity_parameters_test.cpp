// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/sensitivity_parameters.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "fitting/parameters.hpp"
#include "tests/fitting/synthetic_shot.hpp"

namespace impactrig::fitting {
namespace {

/// A bar of two segments on which a body sits, struck at the first; `{}` are sizes in mm.
std::string stepped(double radius, double wall, double height) {
  return fmt::format(R"(
[beam]
theory = "timoshenko"
youngs_modulus = "68.952 GPa"
density = "2766.7 kg/m^3"
[[beam.segments]]
length = "0.7 m"
section = {{ shape = "tube", radius = "{:.17g} mm", wall = "{:.17g} mm" }}
[[beam.segments]]
length = "0.1 m"
section = {{ shape = "rectangle", width = "40 mm", height = "{:.17g} mm" }}
shear_coefficient = 0.8
[[beam.masses]]
position = "0.75 m"
mass = "0.1 kg"
[contact]
position = "0.5 m"
counterface = {{ shape = "groove", radius = "17.5 mm" }}
length = "20 mm"
radius = "15 mm"
counter_modulus = "68.952 GPa"
restitution = 0.5
[start]
velocity = "0.4 m/s"
)",
                     radius, wall, height);
}

RigFile read(const std::string& text) {
  return parse_rig_file(text, "rig.toml");
}

SensitivityParameter named(const RigFile& file, const std::string& name) {
  return sensitivity_parameters(file, {name}).at(0);
}

std::vector<PhysicalParameter> numbers() {
  const auto fitted = physical_parameters(), stated = stated_parameters();
  std::vector<PhysicalParameter> all(fitted.begin(), fitted.end());
  all.insert(all.end(), stated.begin(), stated.end());
  return all;
}

/// Expects the parameter's parts to be what differs between files that state it less and more, by
/// so much.
void expect_parts(const RigFile& file, const std::string& name, const RigFile& less,
                  const RigFile& more, double by) {
  SCOPED_TRACE(name);
  const SensitivityParameter parameter = named(file, name);
  std::size_t found = 0;
  for (const PhysicalParameter& number : numbers()) {
    models::Rig low = less.rig, high = more.rig;
    const double slope = (number.of(high) - number.of(low)) / by;
    const auto part =
        std::ranges::find(parameter.parts, number.of, &SensitivityParameter::Part::of);
    if (part == parameter.parts.end()) {
      EXPECT_EQ(slope, 0.0) << number.name;
      continue;
    }
    ++found;
    EXPECT_NEAR(part->slope / slope, 1.0, 1e-7) << number.name;
  }
  EXPECT_EQ(found, parameter.parts.size());
}

TEST(SensitivityParameters, OfASectionAreWhatItsShapeMakes) {
  const RigFile file = read(stepped(15.0, 3.0, 30.0));
  const double h = 1e-3;  // [mm]
  expect_parts(file, "beam.segments.1.section.radius", read(stepped(15.0 - h, 3.0, 30.0)),
               read(stepped(15.0 + h, 3.0, 30.0)), 2e-3 * h);
  expect_parts(file, "beam.segments.1.section.wall", read(stepped(15.0, 3.0 - h, 30.0)),
               read(stepped(15.0, 3.0 + h, 30.0)), 2e-3 * h);
  expect_parts(file, "beam.segments.2.section.height", read(stepped(15.0, 3.0, 30.0 - h)),
               read(stepped(15.0, 3.0, 30.0 + h)), 2e-3 * h);
  EXPECT_EQ(named(file, "beam.segments.1.section.radius").parts.size(), 3U);
  EXPECT_EQ(named(file, "beam.segments.2.section.width").parts.size(), 2U);  // κ is stated
  EXPECT_DOUBLE_EQ(named(file, "beam.segments.1.section.wall").value, 3e-3);
  EXPECT_EQ(named(file, "beam.segments.1.section.wall").unit, "m");
}

TEST(SensitivityParameters, OfAUniformBarAreThoseOfItsSection) {
  const auto at = [](double mm, double nu) {
    return parse_rig_file(tests::paper_rig, "rig.toml",
                          {{"beam.section.radius", fmt::format("{:.17g} mm", mm)},
                           {"beam.poisson_ratio", fmt::format("{:.17g}", nu)},
                           {"contact.poisson_ratio", "0.3"},
                           {"contact.radius", "15 mm"},
                           {"beam.theory", "timoshenko"}});
  };
  expect_parts(at(15.0, 0.3), "beam.section.radius", at(15.0 - 1e-3, 0.3), at(15.0 + 1e-3, 0.3),
               2e-6);
  const SensitivityParameter by_ratio = named(at(15.0, 0.3), "beam.poisson_ratio");
  ASSERT_EQ(by_ratio.parts.size(), 2U);
  models::Rig low = at(15.0, 0.3 - 1e-4).rig, high = at(15.0, 0.3 + 1e-4).rig;
  for (const SensitivityParameter::Part& part : by_ratio.parts)
    EXPECT_NEAR(part.slope, (part.of(high) - part.of(low)) / 2e-4, 1e-7);
  const RigFile plain = parse_rig_file(tests::paper_rig, "rig.toml");
  const SensitivityParameter radius = named(plain, "beam.section.radius");
  EXPECT_EQ(radius.parts.size(), 2U);
  EXPECT_THROW(named(plain, "beam.poisson_ratio"), std::invalid_argument);  // it does not shear
}

TEST(SensitivityParameters, AllAreThoseThatTheRigHas) {
  std::set<std::string> names;
  for (const SensitivityParameter& parameter :
       sensitivity_parameters(read(stepped(15.0, 3.0, 30.0)), {"all"})) {
    names.insert(parameter.name);
    EXPECT_NE(parameter.value, 0.0) << parameter.name;
  }
  for (const char* has :
       {"beam.segments.1.length", "beam.segments.2.section.area", "beam.segments.1.section.wall",
        "beam.segments.2.section.width", "beam.segments.1.shear_coefficient", "beam.poisson_ratio",
        "beam.masses.1.position", "contact.poisson_ratio"})
    EXPECT_TRUE(names.contains(has)) << has;
  for (const char* has_not :
       {"beam.segments.1.section.width", "beam.segments.3.length", "beam.section.radius",
        "beam.segments.1.youngs_modulus", "contacts.1.modulus", "contact.effective_mass"})
    EXPECT_FALSE(names.contains(has_not)) << has_not;
}

TEST(SensitivityParameters, OfAFurtherStopHoldThePowerOfItsStiffness) {
  const RigFile file =
      parse_rig_file(tests::paper_rig +
                         std::string("\n[[contacts]]\nposition = \"0.5 m\"\ngap = \"1 um\"\n"
                                     "law = \"lankarani-nikravesh-cylinder\"\n"
                                     "stiffness = \"1.6e10 N/m^1.5\"\n"),
                     "rig.toml");
  EXPECT_EQ(named(file, "contacts.1.stiffness").unit, "N/m^1.5");
  const SensitivityParameter power = named(file, "contacts.1.power");
  EXPECT_EQ(power.value, 1.5);
  models::Rig rig = file.rig;
  ASSERT_EQ(power.parts.size(), 1U);
  EXPECT_EQ(&power.parts.front().of(rig), &rig.further_stops[0].contact.power);
}

TEST(SensitivityParameters, AreWhereLasersPoint) {
  const RigFile file =
      parse_rig_file(tests::paper_rig, "rig.toml", {{"sensors.velocity.position", "0.6 m"}});
  const SensitivityParameter spot = named(file, "sensors.velocity.position");
  EXPECT_EQ(spot.value, 0.6);
  EXPECT_EQ(spot.unit, "m");
  EXPECT_TRUE(spot.parts.empty());
  EXPECT_EQ(spot.spot, models::Laser::velocity);
  EXPECT_THROW(named(file, "sensors.displacement.position"), std::invalid_argument);
}

TEST(SensitivityParameters, SayWhatTheyKnow) {
  const RigFile file = read(stepped(15.0, 3.0, 30.0));
  const auto message = [&](const std::string& name) {
    try {
      named(file, name);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_EQ(message("beam.segments.1.section.width"),
            "'beam.segments.1.section.width' is nothing that this rig has");
  EXPECT_EQ(message("beam.masses.2.position"),
            "'beam.masses.2.position' is nothing that this rig has");
  EXPECT_THAT(message("beam.colour"),
              testing::MatchesRegex("'beam.colour' is no number of a rig to differentiate by; they "
                                    "are contact.restitution, .*beam.segments.1.length, .*"
                                    "beam.section.radius, .*the same of masses and segments 2 to 8 "
                                    "and of contacts 2 and 3, or all"));
}

}  // namespace
}  // namespace impactrig::fitting
