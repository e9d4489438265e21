// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/fitting/rig_text.hpp"

namespace impactrig::tests {
namespace {

using namespace fitting;

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
                "12: contacts.1.position: the struck point, 0.9 m from the hinge, lies beyond the "
                "bar's end at 0.8 m");
  EXPECT_NE(stop("side = \"far\"").find("contacts.1.gap: is missing; add gap = \"0.1 mm\""),
            std::string::npos);
  EXPECT_EQ(stop("gap = \"1 um\"\nside = \"left\""),
            line(2) + "8: contacts.1.side: expected one of near, far, found \"left\"");
  EXPECT_EQ(stop("gap = \"-1 um\""),
            line(1) + "7: contacts.1.gap: must be finite and not negative, found -1e-06 m");
  EXPECT_NE(stop("gap = \"1 um\"\nplace = 3").find("contacts.1.place: there is no such key here"),
            std::string::npos);
  const std::string text(paper_rig);
  const std::size_t begin = text.find("[contact]"), end = text.find("[start]");
  EXPECT_NE(
      message_of(text.substr(0, begin) + text.substr(end) + "\n[[contacts]]\ngap = \"1 um\"\n")
          .find("contacts: there is no [contact]; state the stop that is struck first there"),
      std::string::npos);
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

TEST(RigFileRemarks, AreOfWhatIsStatedInVain) {
  const auto remarks = [](const std::vector<Override>& overrides) {
    return parse_rig_file(tests::paper_rig, "rig.toml", overrides).remarks;
  };
  EXPECT_THAT(remarks({}), testing::IsEmpty());
  EXPECT_THAT(remarks({{"contact.damping", "none"}}),
              testing::ElementsAre("contact.restitution has no effect: its damping is \"none\""));
  EXPECT_THAT(
      remarks({{"contact.damping", "viscous"}, {"contact.viscous", "100 N.s/m"}}),
      testing::ElementsAre("contact.restitution has no effect: its damping is that of `viscous`"));
  EXPECT_THAT(remarks({{"contact.damping", "kuwabara-kono"},
                       {"contact.relaxation_time", "5 us"},
                       {"contact.restitution_speed", "0.1 m/s"}}),
              testing::ElementsAre(testing::HasSubstr("contact.restitution has no effect"),
                                   testing::HasSubstr("contact.restitution_speed has no effect")));
  EXPECT_THAT(remarks({{"contact.law", "johnson"}, {"contact.exponent", "3"}}),
              testing::ElementsAre("contact.exponent has no effect: the law \"johnson\" has none"));
  EXPECT_THAT(remarks({{"stop", "{ mass = \"50 g\", stiffness = \"2e8 N/m\" }"}}),
              testing::ElementsAre(testing::HasSubstr("counts besides [stop]")));
}

}  // namespace
}  // namespace impactrig::tests
