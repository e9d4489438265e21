// SPDX-License-Identifier: BSD-3-Clause
//
// `impactrig laws` as a user or a script sees it, and that the documents know every law.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <string>
#include <vector>

#include "tests/app/command_line.hpp"
#include "tests/reports/markup.hpp"
#include "tests/support/places.hpp"

namespace {

using impactrig::tests::Outcome;
using impactrig::tests::rig;
using impactrig::tests::text_of;
using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

class Laws : public impactrig::tests::CommandLine {
 protected:
  json told(const std::string& arguments) {
    const Outcome o = run("laws --json " + arguments);
    EXPECT_EQ(o.code, 0) << arguments << ": " << o.err;
    return json::parse(o.out);
  }

  /// The shipped example with another line for the counterface.
  std::string against(const std::string& counterface) const {
    std::string text = text_of(rig);
    const std::string groove = "{ shape = \"groove\", radius = \"17.5 mm\" }";
    return write("rig.toml", text.replace(text.find(groove), groove.size(), counterface));
  }
};

double number(const json& value) {
  return value.get<double>();
}

/// Damping is in proportion to the elastic force: e_out is a function of d alone.
bool proportional(const std::string& law) {
  static const std::vector<std::string> laws = {
      "none",          "lankarani-nikravesh", "exact",
      "hunt-crossley", "herbert-mcwhannell",  "lee-wang",
      "gonthier",      "zhiying-qishao",      "flores",
      "hu-guo",        "carvalho-martins",    "safaeifar-farshidianfar",
      "marhefka-orin"};
  return std::ranges::find(laws, law) != laws.end();
}

TEST_F(Laws, AreListedWithTheirSource) {
  const Outcome o = run("laws");
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_THAT(o.out, HasSubstr("Elastic (contact.law)\n  goldsmith "));
  EXPECT_THAT(o.out, HasSubstr("  lankarani-nikravesh          the paper's"));
  EXPECT_THAT(o.out, HasSubstr("LankaraniNikravesh1990, ShenEtAl2007 (33)"));
  const json all = told("");
  EXPECT_EQ(all["elastic"][0]["name"], "goldsmith");
  EXPECT_GE(all["elastic"].size(), 15U);
  EXPECT_GE(all["damping"].size(), 23U);
  for (const char* kind : {"elastic", "damping"})
    for (const json& law : all[kind])
      for (const char* field : {"name", "description", "formula", "validity", "source"})
        EXPECT_NE(law[field].get<std::string>(), "") << law["name"] << ' ' << field;
}

// Check values of contact-laws.md for the paper's contact.
TEST_F(Laws, TellAnElasticLawAtAPenetrationOrAForce) {
  for (const char* place : {"--penetration \"7.535020663451824 um\"", "--force \"1 kN\""}) {
    const json law = told("goldsmith " + std::string(place));
    EXPECT_EQ(law["law"], "goldsmith");
    EXPECT_NEAR(number(law["force_n"]), 1000.0, 1e-9);
    EXPECT_NEAR(number(law["stiffness_n_m"]), 140549551.5, 0.1);
    EXPECT_NEAR(number(law["energy_j"]), 0.00366248727, 1e-11);
    EXPECT_NEAR(number(law["limit_force_n"]) / 22670758414.476566, 1.0, 1e-12);
    EXPECT_NEAR(number(law["penetration_m"]), 7.535020663451824e-06, 1e-18);
    // a = sqrt(4 f R_eq / (pi E* L)), R_eq = 0.105 m
    const double a = std::sqrt(4.0 * 1000.0 * 0.105 / (M_PI * 37.885714286e9 * 0.02));
    EXPECT_NEAR(number(law["half_width_m"]) / a, 1.0, 1e-9);
    EXPECT_NEAR(number(law["half_width_over_radius"]) / (a / 0.015), 1.0, 1e-9);
    EXPECT_EQ(law["warnings"], json::array());  // the example states its reference length
  }
}

TEST_F(Laws, TellHowALawChangesWithItsKeys) {
  const json law = told("hertz-point --penetration \"10 um\"");
  EXPECT_TRUE(law["limit_force_n"].is_null());
  std::map<std::string, json> by;
  for (const json& derivative : law["derivatives"]) by[derivative["key"]] = derivative;
  // f = 4/3 E* sqrt(R_eq) d^1.5: E* of two equal moduli goes half with each
  EXPECT_NEAR(number(by["contact.modulus"]["dlnf_dlnp"]), 0.5, 1e-12);
  EXPECT_NEAR(number(by["contact.stiffness_factor"]["dlnf_dlnp"]), 1.0, 1e-12);
  EXPECT_NEAR(number(by["contact.stiffness_factor"]["dlnd_dlnp"]), -1.0 / 1.5, 1e-12);
  // R_eq = R1 R2 / (R2 - R1): d ln sqrt(R_eq) / d ln R1 = R2 / (R2 - R1) / 2 = 3.5
  EXPECT_NEAR(number(by["contact.radius"]["dlnf_dlnp"]), 3.5, 1e-12);
  EXPECT_NEAR(number(by["contact.radius"]["dlnu_dlnp"]), 3.5, 1e-12);
  EXPECT_EQ(by.count("contact.length"), 0U);
}

TEST_F(Laws, AreAskedAsDeepAsAnElasticImpactOfTheRigGoes) {
  const json law = told("liu");
  // m v^2 / 2 with m = I / x^2 of the paper's bar
  EXPECT_NEAR(number(law["energy_j"]), 0.5 * 0.33376682 / (0.69 * 0.69) * 0.441 * 0.441, 1e-9);
  const json faster = told("liu --set start.velocity=\"0.882 m/s\"");
  EXPECT_NEAR(number(faster["energy_j"]) / number(law["energy_j"]), 4.0, 1e-9);
}

TEST_F(Laws, SayWhichStiffnessStandsIn) {
  const json linear = told("linear"), goldsmith = told("goldsmith");
  // the same energy at the same depth: f = 2 U / d
  EXPECT_NEAR(number(linear["penetration_m"]) / number(goldsmith["penetration_m"]), 1.0, 1e-12);
  EXPECT_NEAR(number(linear["force_n"]),
              2.0 * number(goldsmith["energy_j"]) / number(goldsmith["penetration_m"]), 1e-6);
  EXPECT_THAT(linear["stand_in"].get<std::string>(), HasSubstr("the rig states no stiffness"));
  EXPECT_THAT(run("laws linear").out, HasSubstr("stand-in"));
  const json stated = told("linear --set contact.stiffness=\"1e8 N/m\" --penetration \"10 um\"");
  EXPECT_DOUBLE_EQ(number(stated["force_n"]), 1000.0);
  EXPECT_FALSE(stated.contains("stand_in"));
}

TEST_F(Laws, WarnWhereTheUnitOfLengthIsLeftOpen) {
  std::string text = text_of(rig);
  const std::size_t at = text.find("reference_length");
  write("open.toml", text.erase(at, text.find('\n', at) - at));
  const json law = told("goldsmith --rig " + path("open.toml"));
  ASSERT_EQ(law["warnings"].size(), 1U);
  EXPECT_THAT(law["warnings"][0].get<std::string>(), HasSubstr("depends on the unit of length"));
}

TEST_F(Laws, TellADampingLaw) {
  const json law = told("lankarani-nikravesh --restitution 0.5");
  EXPECT_EQ(law["law"], "lankarani-nikravesh");
  EXPECT_EQ(law["restitution"], 0.5);
  EXPECT_DOUBLE_EQ(number(law["d"]), 0.5625);
  EXPECT_NEAR(number(law["rebound_ratio"]), 0.7252411140, 1e-10);
  EXPECT_TRUE(law["damping_ratio"].is_null());
  ASSERT_EQ(law["curve"].size(), 20U);
  EXPECT_DOUBLE_EQ(number(law["curve"][0]["restitution"]), 0.05);
  EXPECT_NEAR(number(law["curve"][1]["rebound_ratio"]), 0.6652654067551504, 1e-10);
  EXPECT_EQ(law["curve"][1]["rebound_ratio_tension"], law["curve"][1]["rebound_ratio"]);
  ASSERT_EQ(law["warnings"].size(), 1U);
  EXPECT_THAT(law["warnings"][0].get<std::string>(),
              HasSubstr("rebounds with 0.7252 where 0.5 was asked for"));
  EXPECT_EQ(told("exact --restitution 0.5")["warnings"], json::array());
}

// tsuji: zeta = -ln e / sqrt(pi^2 + ln^2 e); with tension e, without
// exp(-2 zeta acos(zeta) / sqrt(1 - zeta^2)), beside every elastic law.
TEST_F(Laws, TellWhatTensionChanges) {
  const json law = told("tsuji --restitution 0.5");
  const double log_e = std::log(0.5);
  const double zeta = -log_e / std::hypot(M_PI, log_e);
  EXPECT_TRUE(law["d"].is_null());
  EXPECT_NEAR(number(law["damping_ratio"]), zeta, 1e-14);
  const double clipped = std::exp(-2.0 * zeta * std::acos(zeta) / std::sqrt(1.0 - zeta * zeta));
  EXPECT_NEAR(number(law["rebound_ratio"]), clipped, 1e-7);
  EXPECT_NEAR(number(law["curve"][9]["rebound_ratio"]), clipped, 1e-7);
  EXPECT_NEAR(number(law["curve"][9]["rebound_ratio_tension"]), 0.5, 1e-7);
  EXPECT_THAT(run("laws tsuji").out, HasSubstr("e_out  with tension"));
  EXPECT_THAT(run("laws exact").out, Not(HasSubstr("with tension")));
  const json pulled = told("tsuji --set contact.tension=allow");
  EXPECT_NEAR(number(pulled["rebound_ratio"]), 0.5, 1e-7);
}

// A linear oscillator: with tension exp(-pi zeta / sqrt(1 - zeta^2)), zeta = c / (2 sqrt(m k)).
TEST_F(Laws, TellWhatAStatedDashpotDoes) {
  const std::string stated =
      "viscous --set contact.law=linear --set contact.stiffness=\"1e8 N/m\" --set "
      "contact.damping=viscous --set contact.viscous=\"2 kN.s/m\" --set contact.tension=allow";
  const json law = told(stated);
  const double mass = 0.33376682 / (0.69 * 0.69);
  const double zeta = 2e3 / (2.0 * std::sqrt(mass * 1e8));
  EXPECT_NEAR(number(law["rebound_ratio"]), std::exp(-M_PI * zeta / std::sqrt(1.0 - zeta * zeta)),
              1e-7);
  EXPECT_TRUE(law["restitution"].is_null());
  EXPECT_TRUE(law["damping_ratio"].is_null());
  EXPECT_EQ(law["warnings"], json::array());
  EXPECT_NEAR(number(law["curve"][9]["rebound_ratio_tension"]), 0.5, 1e-7);  // of e, not of c
  // asked for a restitution the dashpot is its
  EXPECT_NEAR(number(told(stated + " --restitution 0.3")["rebound_ratio"]), 0.3, 1e-7);
}

TEST_F(Laws, HonourTheSpeedAtWhichTheRestitutionIsMeant) {
  // half the speed's damping: d = 0.5625 * 0.441 / 0.882
  const json slow = told("lankarani-nikravesh --set contact.restitution_speed=\"0.882 m/s\"");
  const double d = 0.5 * 0.5625, e = number(slow["rebound_ratio"]);
  EXPECT_NEAR(d * (1.0 + e), std::log((1.0 + d) / (1.0 - e * d)), 1e-12);
  EXPECT_DOUBLE_EQ(number(slow["d"]), 0.5625);
}

TEST_F(Laws, ARestitutionTheLawCannotHaveIsADashOrAnError) {
  const json law = told("herbert-mcwhannell-implicit --restitution 0.6");
  EXPECT_TRUE(law["curve"][9]["rebound_ratio"].is_null());  // 0.5
  EXPECT_NEAR(number(law["curve"][11]["rebound_ratio"]), 0.6, 1e-6);
  EXPECT_THAT(run("laws herbert-mcwhannell-implicit --restitution 0.6").out,
              HasSubstr("0.50         -"));
  const Outcome o = run("laws herbert-mcwhannell-implicit --restitution 0.3");
  EXPECT_EQ(o.code, 3);
  EXPECT_EQ(o.out, "");
  EXPECT_THAT(o.err, HasSubstr("0.3 needs more damping than the law 'herbert-mcwhannell-implicit' "
                               "can give; use 0.52 or more"));
}

TEST_F(Laws, UnknownOnesAreToldWithTheNearest) {
  Outcome o = run("laws goldsmiht");
  EXPECT_EQ(o.code, 2);
  EXPECT_EQ(o.out, "");
  EXPECT_THAT(o.err, HasSubstr("there is no law 'goldsmiht'; did you mean 'goldsmith'?"));
  o = run("laws unheard-of");
  EXPECT_EQ(o.code, 2);
  EXPECT_THAT(o.err, HasSubstr("`impactrig laws` lists those there are"));
}

TEST_F(Laws, PlacesBeyondTheLawAreRefused) {
  // f* of the paper's contact with lengths in millimetres: 22.67 kN, used to 0.9 of it
  const std::string law = "goldsmith --set contact.reference_length=\"1 mm\"";
  Outcome o = run("laws " + law + " --force \"22 kN\"");
  EXPECT_EQ(o.code, 2);
  EXPECT_THAT(o.err, HasSubstr("--force: the law ends at 2.04e+04 N, found 22 kN"));
  o = run("laws " + law + " --penetration \"1 mm\"");
  EXPECT_EQ(o.code, 2);
  EXPECT_THAT(o.err, HasSubstr("--penetration: the law ends at"));
  o = run("laws goldsmith --penetration \"0 um\"");
  EXPECT_EQ(o.code, 2);
  EXPECT_THAT(o.err, HasSubstr("--penetration: must be greater than 0"));
  EXPECT_EQ(run("laws goldsmith --penetration \"1 kN\"").code, 3);
  EXPECT_EQ(run("laws --penetration \"1 um\"").code, 2);
  EXPECT_EQ(run("laws --table --compare " + rig).code, 2);
  EXPECT_EQ(run("laws esdu-78035 --rig " + against("{ shape = \"plane\" }")).code, 3);
}

TEST_F(Laws, OptionsThatSayNothingOfTheQuestionAreRefused) {
  const std::pair<const char*, const char*> refusals[] = {
      {"exact --penetration \"1 um\"", "--penetration: 'exact' is a damping law"},
      {"exact --force \"1 kN\"", "--force: 'exact' is a damping law"},
      {"--force \"1 kN\"", "--force: is for one elastic law; name it"},
      {"johnson --restitution 0.5", "--restitution: 'johnson' is an elastic law"},
      {"-o laws.svg", "-o: draws one law, or with --compare RIG all of them"},
      {"--compare goldsmith,johnson",
       "--compare: takes a rig file, for whose contact it compares all laws, not laws: "
       "'goldsmith,johnson'"},
      {"johnson -o laws.png", "-o: 'laws.png' is no picture that is drawn here; known is .svg"},
      {"johnson --penetration \"1 um\" --force \"1 kN\"", "--penetration excludes --force"},
  };
  for (const auto& [arguments, message] : refusals) {
    const Outcome o = run("laws " + std::string(arguments));
    EXPECT_EQ(o.code, 2) << arguments;
    EXPECT_EQ(o.out, "") << arguments;
    EXPECT_THAT(o.err, HasSubstr(message));
  }
}

TEST_F(Laws, TheTableIsTheSameBesideAllElasticLawsForProportionalDamping) {
  const json table = told("--table");
  std::map<std::string, std::vector<json>> rows;
  for (const json& row : table["rows"]) rows[row["damping"]].push_back(row);
  EXPECT_EQ(rows.size(), told("")["damping"].size());
  double apart = 0.0;  // the largest difference of the others
  for (const auto& [law, own] : rows) {
    ASSERT_EQ(own.size(), 3U) << law;
    for (std::size_t i = 0; i < 10; ++i)
      for (const json& row : own) {
        const json &value = row["rebound_ratio"][i], &first = own[0]["rebound_ratio"][i];
        ASSERT_EQ(value.is_null(), first.is_null());
        if (value.is_null()) continue;
        const double difference = std::abs(number(value) - number(first));
        if (proportional(law))
          EXPECT_LT(difference, 1e-6) << law << ' ' << row["elastic"] << ' ' << i;
        else
          apart = std::max(apart, difference);
      }
  }
  EXPECT_GT(apart, 0.1);  // hertz-hysteresis
  EXPECT_NEAR(number(rows["exact"][0]["rebound_ratio"][2]), 0.3, 1e-6);
  const Outcome o = run("laws --table");
  EXPECT_THAT(o.out, HasSubstr("lankarani-nikravesh, all three"));
  EXPECT_THAT(o.out, HasSubstr("hertz-hysteresis, goldsmith"));
}

TEST_F(Laws, ComparisonDrawsItsPictureUnaskedButKeepsAnOlderOne) {
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(path(""));
  const Outcome first = run("laws --compare " + rig), second = run("laws --compare " + rig);
  const Outcome third = run("laws -f --compare " + rig);
  std::filesystem::current_path(before);
  EXPECT_EQ(first.code + second.code + third.code, 0);
  EXPECT_THAT(first.err, HasSubstr("picture in laws.svg"));
  EXPECT_EQ(impactrig::tests::markup_problem(text_of(path("laws.svg"))), "");
  EXPECT_THAT(second.err, HasSubstr("laws.svg is kept; -o names another picture, -f overwrites"));
  EXPECT_THAT(third.err, HasSubstr("picture in laws.svg"));
}

TEST_F(Laws, AreComparedForTheShippedExampleWhereNoRigIsNamed) {
  const Outcome named = run("laws --compare " + rig + " -o " + path("a.svg"));
  const Outcome unnamed = run("laws -o " + path("b.svg") + " --compare");
  ASSERT_EQ(unnamed.code, 0) << unnamed.err;
  // but for the line that names the rig
  EXPECT_EQ(unnamed.out.substr(unnamed.out.find("\n\n")), named.out.substr(named.out.find("\n\n")));
  EXPECT_THAT(unnamed.out, HasSubstr("the shipped example"));
}

TEST_F(Laws, AreComparedInOnePicture) {
  const Outcome o = run("laws --compare " + rig + " -o " + path("laws.svg"));
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_THAT(o.err, HasSubstr("herbert-mcwhannell-implicit left out: contact.restitution"));
  const std::string svg = text_of(path("laws.svg"));
  EXPECT_EQ(impactrig::tests::markup_problem(svg), "");
  EXPECT_THAT(svg, HasSubstr("font-weight=\"600\">goldsmith</text>"));  // the rig's own, bold
  EXPECT_THAT(svg, HasSubstr("font-weight=\"600\">lankarani-nikravesh</text>"));
  EXPECT_THAT(svg, HasSubstr("Penetration [µm]"));
  EXPECT_EQ(run("laws -q --compare " + rig + " -o " + path("quiet.svg")).err, "");
  const json j = told("--compare " + rig + " -o " + path("told.svg"));
  EXPECT_EQ(j["elastic"].size(), told("")["elastic"].size());
  for (const json& law : j["elastic"]) EXPECT_NEAR(number(law["rebound_ratio"]), 1.0, 1e-9);
  double last = std::numeric_limits<double>::infinity();
  for (const json& law : j["damping"]) {
    EXPECT_THAT(svg, HasSubstr(law["law"].get<std::string>()));
    EXPECT_LE(number(law["peak_force_n"]), last);
    last = number(law["peak_force_n"]);
    if (law["law"] == "exact") {
      EXPECT_NEAR(number(law["rebound_ratio"]), 0.5, 1e-7);
    }
  }
}

TEST_F(Laws, ThatRefuseTheCounterfaceAreToldWhenCompared) {
  const Outcome o =
      run("laws --compare " + against("{ shape = \"plane\" }") + " -o " + path("laws.svg"));
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_THAT(o.err,
              HasSubstr("esdu-78035 left out: contact.counterface: the law 'esdu-78035' does "
                        "not know a plane"));
  EXPECT_THAT(o.err, HasSubstr("johnson left out: contact.counterface.depth: is missing"));
  EXPECT_THAT(o.out, Not(HasSubstr("esdu-78035")));
  EXPECT_THAT(o.out, HasSubstr("dubowsky-freudenstein"));
}

TEST_F(Laws, DrawOneLawAndKeepWhatExists) {
  for (const char* law : {"goldsmith", "persson", "viscous", "herbert-mcwhannell-implicit"}) {
    const std::string file = path(std::string(law) + ".svg");
    const std::string drawing = "laws " + std::string(law) + " --set contact.restitution=0.7 -o ";
    Outcome o = run(drawing + file);
    ASSERT_EQ(o.code, 0) << o.err;
    EXPECT_EQ(impactrig::tests::markup_problem(text_of(file)), "") << law;
    EXPECT_THAT(text_of(file), HasSubstr(law));
    o = run(drawing + file);
    EXPECT_EQ(o.code, 4);
    EXPECT_THAT(o.err, HasSubstr("exists already"));
    EXPECT_EQ(run(drawing + file + " -f").code, 0);
    EXPECT_EQ(run(drawing + file + " --force").code, 0);
  }
}

TEST_F(Laws, OnlyGoldsmithsHasAnExponentInASimulation) {
  const std::string quick = " --set solver.model=rigid --set solver.duration=\"0.4 ms\"";
  EXPECT_THAT(run("simulate " + rig + quick).out,
              HasSubstr("goldsmith (exponent 1), damping lankarani-nikravesh, e = 0.5"));
  EXPECT_THAT(run("simulate " + rig + quick + " --set contact.law=johnson").out,
              HasSubstr("contact           johnson, damping"));
}

TEST_F(Laws, WithoutAContactThereIsNone) {
  std::string text = text_of(rig);
  const std::size_t from = text.find("[contact]");
  text.erase(from, text.find("[start]") - from);
  write("free.toml", text.substr(0, text.find("[solver]")) + "[solver]\nduration = \"1 ms\"\n");
  const Outcome o = run("laws goldsmith --rig " + path("free.toml"));
  EXPECT_EQ(o.code, 3);
  EXPECT_THAT(o.err, HasSubstr("the rig has no [contact]"));
}

/// Words of a law's source that are keys of the bibliography: HuntCrossley1975, ESDU78035.
std::vector<std::string> keys_of(const std::string& source) {
  std::vector<std::string> keys;
  const std::regex key("[A-Z][A-Za-z]*[0-9]{4,5}");
  for (std::sregex_iterator it(source.begin(), source.end(), key), end; it != end; ++it)
    keys.push_back(it->str());
  return keys;
}

TEST_F(Laws, EachHasItsEntryInTheDocumentsAndItsSourceInTheBibliography) {
  const std::string entries = text_of(impactrig::tests::source_dir + "/docs/laws.md");
  const std::string bibliography = text_of(impactrig::tests::source_dir + "/docs/references.bib");
  const json all = told("");
  std::size_t keys = 0;
  for (const char* kind : {"elastic", "damping"})
    for (const json& law : all[kind]) {
      // not HasSubstr, which would print the document
      EXPECT_NE(entries.find("\n### `" + law["name"].get<std::string>() + "`\n"), std::string::npos)
          << law["name"];
      for (const std::string& key : keys_of(law["source"])) {
        EXPECT_NE(bibliography.find("{" + key + ", "), std::string::npos) << law["name"] << key;
        ++keys;
      }
    }
  EXPECT_GT(keys, 30U);
}

}  // namespace
