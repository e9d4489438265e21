// SPDX-License-Identifier: BSD-3-Clause
//
// What `import` does on the way to samples, and what `inspect` says of them.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>

#include "tests/app/command_line.hpp"

namespace {

using impactrig::tests::Outcome;
using impactrig::tests::rig;
using impactrig::tests::samples;
using impactrig::tests::text_of;
using nlohmann::json;
using testing::HasSubstr;

class InspectCommand : public impactrig::tests::CommandLine {};

/// 5 ms at 1 MHz: hum of 40 N, a pulse of 1500 N, a velocity that drops out for 60 samples.
std::string shot_to_condition() {
  std::string text = "Time [s],Ref1 [V],Vib [m/s]\n";
  for (int i = 0; i < 60000; ++i) {
    const double t = (i - 40000) * 1e-6;
    const double pulse =
        t > 0.0 && t < 200e-6 ? 1500.0 * std::sin(std::numbers::pi * t / 200e-6) : 0.0;
    const double hum = 40.0 * std::sin(2.0 * std::numbers::pi * 50.0 * t + 0.3);
    const double done = std::clamp(t / 200e-6, 0.0, 1.0);
    double speed = 0.44 - 0.3 * (1.0 - std::cos(std::numbers::pi * done));
    if (i >= 39500 && i < 39560) speed = 0.01;
    text += fmt::format("{:.6f},{:.7f},{:.7f}\n", t, (pulse + hum) * 4e-3,
                        speed + 1e-4 * ((i * 7919) % 13 - 6));
  }
  return text;
}

const std::string conditioning = R"(
[[conditioning]]
channel = "force"
step = "hum"
quiet = { from = "-40 ms", to = "-1 ms" }
[[conditioning]]
channel = "velocity"
step = "dropouts"
[[conditioning]]
channel = "velocity"
step = "integrate"
name = "Way"
)";

TEST_F(InspectCommand, ConditionsWhatAMapAsksFor) {
  const std::string file = write("shot.csv", shot_to_condition());
  const std::string map = write("map.toml", R"(
[[channels]]
match = "Ref*"
name = "Force"
role = "force"
sensitivity = "4 mV/N"
[[channels]]
match = "Vib"
role = "velocity"
)" + conditioning);
  Outcome o = run("import " + file + " --map " + map + " -o " + path("shot.h5"));
  ASSERT_EQ(o.code, 0) << o.err;
  const json read = json::parse(run("inspect --json " + path("shot.h5")).out);
  ASSERT_EQ(read["channels"].size(), 3U);
  EXPECT_EQ(read["channels"][1]["invalid"], 60);
  EXPECT_THAT(run("inspect " + path("shot.h5")).out,
              HasSubstr("\nsamples not valid:  60 of 'Vib'"));
  EXPECT_EQ(read["channels"][2]["name"], "Way");
  EXPECT_EQ(read["channels"][2]["quantity"], "displacement");
  ASSERT_EQ(read["impacts"].size(), 1U);
  EXPECT_NEAR(read["impacts"][0]["peak"].get<double>(), 1500.0, 1.0);
}

TEST_F(InspectCommand, AveragesRepeatedShots) {
  const std::string one = samples + "shen2007-1.uff", two = samples + "shen2007-2.uff";
  const std::string map = " --map " + write("map.toml", R"(
[[channels]]
match = "Force"
role = "force"
sensitivity = "4 mV/N"
[[channels]]
match = "Velocity"
role = "velocity"
sensitivity = "125 mm/s/V"
)") + " ";
  Outcome o = run("import " + one + " " + two + map + "--average -o " + path("mean.h5"));
  ASSERT_EQ(o.code, 0) << o.err;
  ASSERT_EQ(run("import " + one + map + "-o " + path("one.h5")).code, 0);
  const json mean = json::parse(run("inspect --json " + path("mean.h5")).out);
  const json first = json::parse(run("inspect --json " + path("one.h5")).out);
  ASSERT_EQ(mean["channels"].size(), 2 * first["channels"].size());
  EXPECT_EQ(mean["channels"][1]["name"], "Force, standard deviation");
  EXPECT_NEAR(mean["channels"][0]["max"].get<double>(), first["channels"][0]["max"], 200.0);
  o = run("import " + one + " " + one + map + "--average -o " + path("same.h5"));
  EXPECT_EQ(o.code, 3);
  EXPECT_THAT(o.err, HasSubstr("is the same recording as"));
  o = run("import " + one + map + "--average -o " + path("none.h5"));
  EXPECT_EQ(o.code, 3);
  EXPECT_THAT(o.err, HasSubstr("a mean needs two shots at least, and 1 of 1 can be used"));
}

TEST_F(InspectCommand, InspectsOnARig) {
  const std::string file = write("shot.csv", shot_to_condition());
  const auto on_rig = [&](const std::string& sensitivity, const std::string& more) {
    const std::string text = text_of(rig);
    const std::string sensors = "[sensors.force]\nchannel = \"Ref1\"\nsensitivity = \"" +
                                sensitivity + "\"\n[sensors.velocity]\nchannel = \"Vib\"\n";
    const std::string here =
        write("rig.toml", text.substr(0, text.find("[sensors.force]")) + sensors + more);
    const Outcome o = run("inspect --json " + file + " --rig " + here);
    EXPECT_EQ(o.code, 0) << o.err;
    return json::parse(o.out);
  };
  json read = on_rig("4 mV/N", conditioning);
  ASSERT_EQ(read["impacts"].size(), 1U);
  EXPECT_NEAR(read["impacts"][0]["peak"].get<double>(), 1500.0, 1.0);
  EXPECT_NEAR(read["impacts"][0]["approach_velocity_m_s"].get<double>(), 0.44, 1e-3);
  EXPECT_NEAR(read["impacts"][0]["impulse_ratio"].get<double>(), 0.6, 0.5);
  EXPECT_EQ(read["impacts"][0]["flags"], json::array({"dropout"}));
  read = on_rig("4 V/N", conditioning);
  EXPECT_EQ(read["impacts"][0]["flags"], json::array({"dropout", "implausible"}));
  EXPECT_THAT(read["warnings"].back().get<std::string>(),
              HasSubstr("times too small (nearly the factor of N for kN, or mV for V)"));
}

TEST_F(InspectCommand, TakesTheTriggerThatIsChosen) {
  const std::string file = write("shot.csv", shot_to_condition());
  const json by_velocity =
      json::parse(run("inspect --json " + file + " --trigger Vib").out)["impacts"];
  ASSERT_EQ(by_velocity.size(), 1U);
  EXPECT_EQ(by_velocity[0]["channel"], "Vib");
  EXPECT_EQ(by_velocity[0]["unit"], "m/s");
  EXPECT_EQ(run("inspect " + file + " --trigger Nothing").code, 3);
  for (const char* const wrong : {"-1", "nan", "inf", "0"})
    EXPECT_EQ(run(fmt::format("inspect {} --threshold {}", file, wrong)).code, 2) << wrong;
  EXPECT_EQ(run("fit " + samples + "shen2007-1.uff --rig " + rig + " --impact 2").code, 3);
}

// Where there is no force, the velocity shows impacts; of uneven times a sentence says why not.
// Without a rig or a trigger nobody has asked: most recordings have none.
TEST_F(InspectCommand, InspectSaysThatWhatItWasAskedForHasNoImpact) {
  const auto warnings = [&](const std::string& unit, const std::string& options) {
    std::string rows = fmt::format("time [s],Force [{0}],Velocity [{0}]\n", unit);
    for (int i = 0; i < 500; ++i) rows += fmt::format("{:.6f},{},{}\n", 1e-6 * i, i % 2, i % 3);
    const std::string file = write("noise.csv", rows);
    return json::parse(run("inspect --json " + file + options).out)["warnings"].dump();
  };
  EXPECT_THAT(warnings("V", " --rig " + rig),
              HasSubstr("there is no impact in the channels of the rig's sensors: nothing rises "
                        "clearly above the noise"));
  EXPECT_THAT(warnings("N", " --trigger Force"), HasSubstr("there is no impact in 'Force'"));
  EXPECT_THAT(warnings("N", " --threshold 50"),
              HasSubstr("there is no impact: no force or acceleration passes --threshold 50 from "
                        "a quiet level"));
  EXPECT_EQ(warnings("N", ""), "[]");
}

// Loggers number their channels from 1, the program its indices from 0.
TEST_F(InspectCommand, InspectTellsChannelsThatAreNumbersApart) {
  std::string rows = "time [s],A [N],B [N]\n";
  for (int i = 0; i < 1000; ++i) {
    const auto pulse = [i](int start) {
      const double x = (i - start) / 100.0;
      return x > 0.0 && x < 1.0 ? std::sin(std::numbers::pi * x) : 0.0;
    };
    rows += fmt::format("{:.6f},{:.6f},{:.6f}\n", 1e-6 * i, 900.0 * pulse(300) + i % 2,
                        70.0 * pulse(600) + 0.1 * (i % 3));
  }
  const std::string file = write("numbered.csv", rows);
  const std::string map = write("numbered.toml",
                                "[[channels]]\nmatch = \"A\"\nname = \"1\"\n"
                                "[[channels]]\nmatch = \"B\"\nname = \"2\"\n");
  const std::string numbered = write("numbered.h5", "");
  ASSERT_EQ(run("import -f " + file + " --map " + map + " -o " + numbered).code, 0);
  const json impacts = json::parse(run("inspect --json " + numbered).out)["impacts"];
  ASSERT_EQ(impacts.size(), 2U);
  EXPECT_EQ(impacts[1]["channel"], "2");
  EXPECT_NEAR(impacts[0]["peak"].get<double>(), 900.0, 2.0);
  EXPECT_NEAR(impacts[1]["peak"].get<double>(), 70.0, 1.0);
}

TEST_F(InspectCommand, InspectLooksForImpactsInVelocitiesAndSaysWhereItCannot) {
  std::string even = "time [s],Velocity [m/s]\n", uneven = "time [s],Force [N]\n";
  for (int i = 0; i < 3000; ++i) {
    const double t = 1e-6 * i - 1e-3;
    const double done = std::clamp(t / 200e-6, 0.0, 1.0);
    even += fmt::format("{:.9f},{}\n", t, 0.44 - 0.3 * (1.0 - std::cos(3.14159265 * done)));
    if (i < 2000 || i > 2050) uneven += fmt::format("{:.9f},{}\n", t, i % 7);
  }
  const json found = json::parse(run("inspect --json " + write("v.csv", even)).out);
  ASSERT_EQ(found["impacts"].size(), 1U);
  EXPECT_NEAR(found["impacts"][0]["width_s"].get<double>(), 133e-6, 70e-6);
  const json not_found = json::parse(run("inspect --json " + write("f.csv", uneven)).out);
  EXPECT_TRUE(not_found["impacts"].empty());
  EXPECT_THAT(not_found["warnings"].back().get<std::string>(),
              testing::StartsWith("impacts of 'Force' were not looked for: channel 'Force' is "
                                  "sampled at uneven times"));
}

TEST_F(InspectCommand, InspectSaysThatVoltsHaveNoImpacts) {
  const std::string file = write("volts.csv", "t [s],CH1 [V]\n0,0.1\n0.1,0.2\n0.2,0.1\n0.3,0.1\n");
  const Outcome o = run("inspect " + file);
  EXPECT_EQ(o.code, 0);
  EXPECT_THAT(o.out + o.err, HasSubstr("impacts were not looked for: no channel is a force"));
}

TEST_F(InspectCommand, InspectSaysWhenARecordingWasMade) {
  const std::string path =
      write("when.csv", "When,F [N]\n2024-03-01 12:00:00.5,1\n2024-03-01 12:00:00.6,2\n");
  EXPECT_THAT(run("inspect " + path).out,
              testing::StartsWith(path + ": csv, recorded 2024-03-01T12:00:00.5\n"));
}

TEST_F(InspectCommand, InspectsByTheHeadAndByParts) {
  std::string text = "Time [s],Force [N],Velocity [m/s]\n";
  for (int i = 0; i < 100; ++i) text += fmt::format("{}e-6,{},{}\n", i, i, -i);
  const std::string file = write("shot.csv", text);
  json j = json::parse(run("inspect --json --no-statistics " + file).out);
  EXPECT_EQ(j["channels"][1]["samples"], 100);
  EXPECT_FALSE(j["channels"][1].contains("sum"));
  EXPECT_FALSE(j.contains("sha256"));
  j = json::parse(run("inspect --json --channel Velocity --from 10e-6 --to 19e-6 " + file).out);
  ASSERT_EQ(j["channels"].size(), 1U);
  EXPECT_EQ(j["channels"][0]["samples"], 10);
  EXPECT_EQ(j["channels"][0]["sum"], -145.0);
  EXPECT_EQ(run("inspect --from 0 --to nan " + file).code, 2);
  EXPECT_EQ(run("inspect --from 2e-6 --to 1e-6 " + file).code, 2);
  EXPECT_EQ(run("import --channel Velocity " + file + " -o " + path("part.h5")).code, 0);
  EXPECT_EQ(json::parse(run("inspect --json " + path("part.h5")).out)["channels"].size(), 1U);
}

/// A sound of so many samples of 8 bits, none of which takes place on the disk.
std::string silence(const std::string& path, std::uint32_t count) {
  const auto number = [](std::uint32_t value, int bytes) {
    std::string text;
    for (int i = 0; i < bytes; ++i) text += static_cast<char>(value >> (8 * i) & 0xFF);
    return text;
  };
  std::ofstream(path, std::ios::binary)
      << "RIFF" + number(36 + count, 4) + "WAVEfmt " + number(16, 4) + number(1, 2) + number(1, 2) +
             number(1'000'000, 4) + number(1'000'000, 4) + number(1, 2) + number(8, 2) + "data" +
             number(count, 4);
  std::filesystem::resize_file(path, 44 + std::uintmax_t{count});
  return path;
}

// 65 s at 1 MHz.
TEST_F(InspectCommand, RefusesToConditionMoreThanMemoryHolds) {
  const std::string file = silence(path("long.wav"), 65'000'000);
  const std::string on_rig = " --rig " + rig;
  for (const auto& [command, remedy] : std::vector<std::pair<std::string, std::string>>{
           {"fit " + file + on_rig, "--from and --to say which, and the rig file's sensors name"},
           {"compare " + file + " " + file + on_rig, "`impactrig import` with --from and --to"}}) {
    const Outcome o = run(command);
    EXPECT_EQ(o.code, 3) << command;
    EXPECT_THAT(o.err,
                HasSubstr("long.wav: 65 million samples are too many to be conditioned or "
                          "averaged, which takes them into memory; 64 million are the most: " +
                          remedy));
  }
  EXPECT_THAT(run("fit " + file + on_rig + " --from 0 --to 1").err,
              HasSubstr("there is no single channel 'Force'"));
}

// 20 million samples, 160 MB for each copy that a step makes.
TEST_F(InspectCommand, ConditionsLongRecordingsInLittleMemory) {
  const std::string file = silence(path("long.wav"), 20'000'000);
  const std::string map = write(
      "map.toml",
      "[[channels]]\nmatch = \"ch1\"\n[[conditioning]]\nchannel = \"ch1\"\nstep = \"low-pass\"\n"
      "cutoff = \"10 kHz\"\n[[conditioning]]\nchannel = \"ch1\"\nstep = \"baseline\"\n"
      "quiet = { from = \"0 s\", to = \"15 s\" }\n");
  const std::string command = "import " + file + " --map " + map + " -o ";
  const Outcome o = run(command + path("long.h5"));
  ASSERT_EQ(o.code, 0) << o.err;
  rusage usage{};
  ::getrusage(RUSAGE_CHILDREN, &usage);
  EXPECT_LT(usage.ru_maxrss, 256 * 1024);  // kB
  const json j = json::parse(run("inspect --json " + path("long.h5")).out);
  EXPECT_EQ(j["channels"][0]["samples"], 20'000'000);
  EXPECT_NEAR(j["channels"][0]["max"], 0.0, 1e-9);
  ::setenv("TMPDIR", "/no/such/folder", 1);
  const Outcome refused = run(command + path("other.h5"));
  ::unsetenv("TMPDIR");
  EXPECT_EQ(refused.code, 4);
  EXPECT_THAT(refused.err, HasSubstr("other.h5: is too large for memory and cannot be kept in a "
                                     "temporary file in /no/such/folder"));
}

// Two segments of LabVIEW's, the second an hour later: the first MB has the first one only.
TEST_F(InspectCommand, InspectsLargeTextsByTheirFirstMegabyte) {
  std::string text =
      "LabVIEW Measurement\t\nSeparator\tTab\nDecimal_Separator\t.\nMulti_Headings\tYes\n"
      "X_Columns\tNo\nDate\t2020/01/01\nTime\t10:00:00\n***End_of_Header***\t\n\t\n";
  constexpr std::size_t n = 1'100'000;
  for (const char* const time : {"10:00:00", "11:00:00"}) {
    text += fmt::format("Channels\t1\nSamples\t{}\nDate\t2020/01/01\nTime\t{}\n", n, time);
    text += "Y_Unit_Label\tN\nX_Dimension\tTime\nDelta_X\t1e-6\n***End_of_Header***\t\n";
    text += "X_Value\tForce\tComment\n";
    for (std::size_t i = 0; i < n; ++i) text += "\t1.2345678901234\n";
    text += '\n';
  }
  const std::string file = write("shot.lvm", text);
  const std::string command = "inspect --no-statistics " + file;
  json j = json::parse(run(command + " --json").out);
  ASSERT_EQ(j["channels"].size(), 1U);
  EXPECT_TRUE(j["channels"][0]["samples_estimated"]);
  EXPECT_NEAR(j["channels"][0]["samples"].get<double>(), 2.0 * n, 100.0);
  EXPECT_THAT(j["warnings"][0].get<std::string>(), HasSubstr("declares 1100000 samples"));
  EXPECT_THAT(run(command).out, HasSubstr(" ~2200"));
  j = json::parse(run(command + " --json --channel 'Force (segment 2)'").out);
  ASSERT_EQ(j["channels"].size(), 1U);
  EXPECT_EQ(j["channels"][0]["samples"], n);
  EXPECT_FALSE(j["channels"][0].contains("samples_estimated"));
}

}  // namespace
