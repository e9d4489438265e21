// SPDX-License-Identifier: BSD-3-Clause
//
// Maps of channels as `import` uses and suggests them.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>

#include "tests/app/command_line.hpp"

namespace {

using impactrig::tests::Outcome;
using impactrig::tests::text_of;
using nlohmann::json;
using testing::HasSubstr;

class ImportMap : public impactrig::tests::CommandLine {};

TEST_F(ImportMap, ImportsByAMapThatItSuggests) {
  const std::string file =
      write("shot.csv", "Time [s],CH1 [V],CH2 [m/s]\n0,0.1,1\n1e-6,0.2,2\n2e-6,0.3,3\n");
  ASSERT_EQ(run("import --suggest-map " + file + " -o " + path("map.toml")).code, 0);
  std::string map = text_of(path("map.toml"));
  EXPECT_THAT(map, HasSubstr("[[channels]]\nmatch = \"CH1\"\nunit = \"V\"\n# role = \"force\"\n"));
  EXPECT_THAT(map, HasSubstr("match = \"CH2\"\nunit = \"m/s\"\nrole = \"velocity\"\n"));
  EXPECT_EQ(run("import " + file + " --map " + path("map.toml") + " -o " + path("a.h5")).code, 0);
  for (const std::string key : {"role = \"force\"", "sensitivity = \"4 pC/N\"", "gain"})
    map.replace(map.find("# " + key), 2, "");
  const std::string complete = write("complete.toml", map);
  Outcome o = run("import " + file + " --map " + complete + " -o " + path("b.h5"));
  ASSERT_EQ(o.code, 0) << o.err;
  const json channels = json::parse(run("inspect --json " + path("b.h5")).out)["channels"];
  ASSERT_EQ(channels.size(), 2U);
  EXPECT_EQ(channels[0]["quantity"], "force");
  EXPECT_EQ(channels[0]["unit"], "N");
  EXPECT_NEAR(channels[0]["last"].get<double>(), 75.0, 1e-12);  // 0.3 V by 4 pC/N and 1 mV/pC
  o = run("import " + file + " --map " + write("bad.toml", "[[channels]]\nmatch=\"CH1\"\nrol=1\n") +
          " -o " + path("c.h5"));
  EXPECT_EQ(o.code, 3);
  EXPECT_THAT(o.err, HasSubstr("bad.toml:3:5"));
  EXPECT_THAT(o.err, HasSubstr("role"));
  EXPECT_EQ(run("import " + file).code, 2);
  for (const char* const wrong : {"10", "V", "-1 V", ""}) {
    const std::string bad =
        write("scale.toml", fmt::format("[[channels]]\nindex = 0\nfull_scale = \"{}\"\n", wrong));
    o = run("import " + file + " --map " + bad + " -o " + path("d.h5"));
    EXPECT_EQ(o.code, 3);
    EXPECT_THAT(o.err, HasSubstr("expected a positive value with a unit, for example \"10 V\""));
  }
}

TEST_F(ImportMap, SuggestsMapsThatHoldAsTheyAre) {
  const std::string file = write(
      "hard.csv",
      "# quantity of column 1: force\n# quantity of column 2: velocity\n"
      "time [s],F [],V [counts],load [kg],accel [kg],CH1 [mV],q [pC],same [N],same [N],a*b [N],"
      "\"a, \\ b\" [m/s],x [%],  [V],s [strain],p [bar]\n"
      "0,1,1,1,1,1,1,1,1,1,1,1,1,1,1\n1,2,2,2,2,2,2,2,2,2,2,2,2,2,2\n");
  const std::string draft = path("draft.toml");
  ASSERT_EQ(run("import --suggest-map " + file + " -o " + draft).code, 0);
  Outcome o = run("import " + file + " --map " + draft + " -o " + path("a.h5"));
  ASSERT_EQ(o.code, 0) << o.err << text_of(draft);
  EXPECT_EQ(json::parse(run("inspect --json " + path("a.h5")).out)["channels"].size(), 14U);
  // whichever role is taken as the draft has it: what is missing is named, with the entry's line
  const std::string map = text_of(draft);
  std::string told;
  for (std::size_t at = map.find("# role = "); at != std::string::npos;
       at = map.find("# role = ", at + 1)) {
    std::string one = map;
    one.replace(at, 2, "");
    o = run("import " + file + " --map " + write("one.toml", one) + " -o " + path("b.h5"));
    EXPECT_EQ(o.code, 3);
    const std::string before = one.substr(0, one.rfind("[[channels]]", at));
    EXPECT_THAT(o.err, HasSubstr(fmt::format("one.toml:{}", 1 + std::ranges::count(before, '\n'))));
    told += o.err;
  }
  for (const char* const hint :
       {"'F' states no unit: as force it needs one, for example unit = \"N\"",
        "'V' is recorded in 'counts', which is no unit of velocity",
        "'load' is recorded in 'kg', a mass: as force it needs unit = \"kgf\"",
        "'CH1' is recorded in 'mV': as force it needs a sensitivity, for example sensitivity = "
        "\"2.25 mV/N\"",
        "'q' is recorded in 'pC': as force it needs a sensitivity, for example sensitivity = \"4 "
        "pC/N\""})
    EXPECT_THAT(told, HasSubstr(hint));
}

// What is upside down in the largest impact is turned by the draft; of volts it tells what it saw.
TEST_F(ImportMap, SuggestsPolarities) {
  std::string text = "Time [s],F [N],v [m/s],s [m],CH4 [V],CH5 [V],Speed [V]\n";
  for (int k = 0; k < 12000; ++k) {
    const double t = 1e-6 * k, x = (t - 9e-3) / 3e-4, before = std::min(t, 9e-3) - 9e-3;
    const double force = x > 0.0 && x < 1.0 ? 500.0 * std::sin(std::numbers::pi * x) : 0.0;
    const double velocity = 0.4 * std::cos(std::numbers::pi * std::clamp(x, 0.0, 1.0));
    const double way =
        0.4 * before +
        (x > 0.0 ? 0.4 * 3e-4 / std::numbers::pi * std::sin(std::numbers::pi * std::min(x, 1.0))
                 : 0.0) -
        0.4 * std::max(0.0, t - 9.3e-3);
    const double noise = 1e-3 * std::sin(1e3 * k * k);
    const double knock = k > 200 && k < 230 ? 60.0 : 0.0;  // 12 % the other way round
    text += fmt::format("{:.6g},{:.6g},{:.6g},{:.8g},{:.6g},{:.6g},{:.6g}\n", t,
                        -force + knock + noise, -velocity + 1e-3 * noise, way, 1e-3 * force + 0.2,
                        -1e-3 * force - 0.2, velocity);
  }
  const std::string file = write("shot.csv", text);
  const std::string draft = path("draft.toml");
  ASSERT_EQ(run("import --suggest-map " + file + " -o " + draft).code, 0);
  const std::string map = text_of(draft);
  const auto polarity_of = [&](const std::string& name) {
    const std::size_t at = map.find("polarity", map.find("match = \"" + name));
    const std::size_t line = map.rfind('\n', at) + 1;
    return map.substr(line, map.find('\n', line) - line);
  };
  EXPECT_THAT(polarity_of("F"),
              testing::MatchesRegex("polarity = -1  # in the impact at 0.00[89][0-9]* s it pulls; "
                                    "what presses counts positive"));
  EXPECT_THAT(polarity_of("v"), testing::MatchesRegex("polarity = -1  # in the impact at .* s the "
                                                      "bar moves away; closer counts positive"));
  EXPECT_THAT(polarity_of("s"),
              testing::MatchesRegex("# polarity = 1  # as the impact at .* s shows it"));
  EXPECT_EQ(polarity_of("CH4"), "# polarity = -1  # where it is upside down");
  EXPECT_EQ(polarity_of("CH5"), "# polarity = -1  # as a pulse would ask for that goes 0.5 V down");
  EXPECT_EQ(polarity_of("Speed"), "# polarity = -1  # where it is upside down");
  EXPECT_THAT(map, HasSubstr("match = \"Speed\"\nunit = \"V\"\n# role = \"velocity\"\n"
                             "# sensitivity = \"0.1 V/(m/s)\"\n# polarity"));
  const Outcome o = run("import " + file + " --map " + draft + " -o " + path("a.h5"));
  ASSERT_EQ(o.code, 0) << o.err;
  const json impacts = json::parse(run("inspect --json " + path("a.h5")).out)["impacts"];
  ASSERT_EQ(impacts.size(), 2U) << impacts;
  EXPECT_EQ(impacts.back()["flags"].dump().find("inverted"), std::string::npos);
}

// 3 V in the last sample, whatever the sensitivity is called; in SI.
TEST_F(ImportMap, ReadsSensitivitiesAsLaboratoriesSpellThem) {
  const std::string file = write("volts.csv", "Time [s],CH1 [V]\n0,1\n1e-6,2\n2e-6,3\n");
  const auto import_as = [&](const std::string& role, const std::string& keys) {
    const std::string map =
        write("map.toml", "[[channels]]\nindex = 0\nrole = \"" + role + "\"\n" + keys + "\n");
    return run("import " + file + " --map " + map + " -o " + path("a.h5") + " --force");
  };
  const auto last = [&](const std::string& role, const std::string& keys) {
    const Outcome o = import_as(role, keys);
    EXPECT_EQ(o.code, 0) << keys << o.err;
    return json::parse(run("inspect --json " + path("a.h5")).out)["channels"][0]["last"]
        .get<double>();
  };
  for (const char* const spelling :
       {"10 mV/(m/s^2)", "10 mV/(m/s²)", "10 mV/m/s^2", "10 mV/m/s²", "10 mV/ms-2", "10 mV/ms^-2",
        "10 mV/ms⁻²", "10 mV/m/s/s", "10 mV/m s^-2", "98.0665 mV/g", "98.0665mV/G", "100 m/s^2/V"})
    EXPECT_NEAR(last("acceleration", fmt::format("sensitivity = \"{}\"", spelling)), 300.0, 1e-9)
        << spelling;
  for (const char* const spelling :
       {"8 V/(m/s)", "8 V/m/s", "8 mV/mm/s", "8 Vs/m", "125 mm/s/V", "125 mm/(s V)"})
    EXPECT_NEAR(last("velocity", fmt::format("sensitivity = \"{}\"", spelling)), 0.375, 1e-12)
        << spelling;
  // IEPE behind an amplifier of 10
  for (const char* const gain : {"10", "10.0", "\"10\""})
    EXPECT_NEAR(
        last("acceleration", fmt::format("sensitivity = \"98.0665 mV/g\"\ngain = {}", gain)), 30.0,
        1e-9);
  for (const auto& [keys, problem] : {
           std::pair{"sensitivity = \"2,5 mV/N\"",
                     "found \"2,5 mV/N\", which has a comma in its number"},
           {"sensitivity = \"2.5 mV/N ± 0.01\"", "which has its uncertainty behind the unit"},
           {"sensitivity = \"2.5 MV/N\"", "\"2.5 MV/N\" is in megavolts: write mV for millivolts"},
           {"sensitivity = \"4 PC/N\"", "\"4 PC/N\" is in petacoulombs: write pC"},
           {"sensitivity = \"2.5 mV/kg\"",
            "expected volts or coulombs a N, for example \"4 pC/N\""},
           {"sensitivity = \"2.5 mV/N\"\ngain = \"20 dB\"",
            "\"20 dB\" is a level: state the factor, which for 20 dB is 10"},
           {"sensitivity = \"2.5 mV/N\"\ngain = \"1 mV/pC\"",
            "needs a sensitivity in coulombs, for example sensitivity = \"4 pC/N\"; of volts it is "
            "a "
            "factor, for example gain = 10"},
           {"sensitivity = \"4 pC/N\"\ngain = 10",
            "a sensor of charge needs the gain of its amplifier in volts a coulomb, for example "
            "gain "
            "= \"1 mV/pC\""},
           {"sensitivity = \"4 pC/N\"\ngain = \"0 mV/pC\"",
            "must be greater than zero; an amplifier that inverts has polarity = -1"},
           {"sensitivity = \"2.5 mV/N\"\ngain = -10", "must be greater than zero"},
           {"sensitivity = \"2.5 mV/N\"\nposition = \"-1 m\"",
            "is counted from the hinge and cannot be negative"},
       }) {
    const Outcome o = import_as("force", keys);
    EXPECT_EQ(o.code, 3) << keys;
    EXPECT_THAT(o.err, HasSubstr(problem));
  }
}

TEST_F(ImportMap, SuggestsNoMapOfNothing) {
  const std::string file = write("none.uff", "    -1\n   164\n         1\n    -1\n");
  const Outcome o = run("import --suggest-map " + file);
  EXPECT_EQ(o.code, 3);
  EXPECT_THAT(o.err, HasSubstr("none.uff: has no channels to map: no recordings in this file"));
}

}  // namespace
