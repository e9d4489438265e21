// SPDX-License-Identifier: BSD-3-Clause
//
// Options of `fit` that state more of single parameters, and other kinds of intervals.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "acquisition/importer.hpp"
#include "datasets/store.hpp"
#include "tests/app/command_line.hpp"

namespace {

using impactrig::tests::CommandLine;
using impactrig::tests::Outcome;
using impactrig::tests::rig;
using impactrig::tests::samples;
using impactrig::tests::text_of;
using nlohmann::json;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

// Few modes, no more of the record than the contact: fast, and no matter of what it finds.
const std::string fast = "fit " + samples + "shen2007-1.uff --rig " + rig +
                         " --quiet --json --set solver.model=hybrid --set solver.modes=3 --set "
                         "solver.duration=\"0.5 ms\" ";

class FitOptions : public CommandLine {
 protected:
  json fitted(const std::string& options) {
    const Outcome o = run(fast + options);
    EXPECT_EQ(o.code, 0) << o.err;
    return o.code == 0 ? json::parse(o.out) : json();
  }

  /// stderr of a call that is refused as wrong usage.
  std::string refused(const std::string& options) {
    const Outcome o = run(fast + options);
    EXPECT_EQ(o.code, 2) << options;
    EXPECT_EQ(o.out, "");
    return o.err;
  }
};

json parameter(const json& fit, const std::string& name) {
  for (const json& p : fit["parameters"])
    if (p["name"] == name) return p;
  return {};
}

// The measured force and the predicted one go through the same low-pass.
TEST_F(FitOptions, PredictsWhatALowPassLeaves) {
  const std::string filtering =
      write("filtering.toml", text_of(rig) +
                                  "\n[[conditioning]]\nchannel = \"force\"\nstep = \"low-pass\"\n"
                                  "cutoff = \"50 kHz\"\n");
  const std::string rest = " --quiet --json --set solver.duration=\"1 ms\"";
  const Outcome plain = run("fit " + samples + "shen2007-1.uff --rig " + rig + rest);
  const Outcome filtered = run("fit " + samples + "shen2007-1.uff --rig " + filtering + rest);
  ASSERT_EQ(filtered.code, 0) << filtered.err;
  const json e = parameter(json::parse(plain.out), "contact.restitution");
  const json j = json::parse(filtered.out), here = parameter(j, "contact.restitution");
  EXPECT_NEAR(here["value"].get<double>(), e["value"].get<double>(),
              3.0 * here["std_error"].get<double>());
  EXPECT_LT(here["std_error"].get<double>(), 2.0 * e["std_error"].get<double>());
  EXPECT_EQ(j["curves"][0]["every"], 10);
  EXPECT_FALSE(j["curves"][1].contains("every"));
  EXPECT_THAT(j["warnings"], Not(Contains(HasSubstr("intervals of the fit"))));
}

// Of uneven times a file does not tell what a prediction would have to go through.
TEST_F(FitOptions, WarnsOfWhatWasPutOnEvenTimes) {
  using namespace impactrig;
  datasets::Record record =
      acquisition::read_into_memory(*acquisition::open_recording(samples + "shen2007-1.uff"), {});
  for (const datasets::Channel& channel : record.channels)
    record.provenance.edits.push_back(
        {"resample", channel.name, {{"from", "uneven times, joined"}, {"to", "1000000 Hz"}}});
  const std::string file = path("even.h5");
  datasets::write_record(record, file);
  const Outcome o =
      run("fit " + file + " --rig " + rig + " --quiet --json --set solver.duration=\"1 ms\"");
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_THAT(json::parse(o.out)["warnings"],
              Contains(HasSubstr("was put on even times, which ties its samples in ways that a "
                                 "prediction cannot follow")));
}

TEST_F(FitOptions, SaysWhichForceItLeavesOut) {
  std::string all = text_of(rig);
  const std::size_t force = all.find("[sensors.force]");
  all.erase(force, all.find("[sensors.velocity]") - force);
  std::string newtons = text_of(samples + "shen2007-3.csv");
  newtons.replace(newtons.find("[V]"), 3, "[N]");
  const Outcome o = run("fit " + write("shot.csv", newtons) + " --rig " + write("laser.toml", all) +
                        " --set solver.model=rigid --json");
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_THAT(json::parse(o.out)["warnings"].dump(),
              HasSubstr("channel 'Force' is a force, but the rig file describes other sensors"));
}

TEST_F(FitOptions, FixBoundTieAndPriorReachTheFit) {
  const json j = fitted(
      "--fix contact.stiffness_factor --bounds contact.restitution=0.9:0.95 --prior "
      "'beam.density=2766.7 +- 1 kg/m^3' --free "
      "contact.restitution,start.velocity,contact.modulus --tie "
      "contact.counter_modulus=0.5*contact.modulus");
  EXPECT_TRUE(parameter(j, "contact.stiffness_factor").is_null());
  EXPECT_EQ(parameter(j, "contact.restitution")["lower"], 0.9);
  EXPECT_EQ(parameter(j, "contact.restitution")["upper"], 0.95);
  EXPECT_GE(parameter(j, "contact.restitution")["value"].get<double>(), 0.9);
  EXPECT_EQ(parameter(j, "beam.density")["prior"][0], 2766.7);
  EXPECT_EQ(parameter(j, "contact.counter_modulus")["tied_to"], "contact.modulus");
  EXPECT_DOUBLE_EQ(parameter(j, "contact.counter_modulus")["value"].get<double>(),
                   0.5 * parameter(j, "contact.modulus")["value"].get<double>());
}

TEST_F(FitOptions, SharedAndOwnNameTheirParameters) {
  const json j =
      fitted("--shared start.velocity --own contact.restitution " + samples + "shen2007-2.uff");
  EXPECT_FALSE(parameter(j, "start.velocity").is_null());
  EXPECT_FALSE(parameter(j, "contact.restitution[1]").is_null());
  EXPECT_FALSE(parameter(j, "contact.restitution[2]").is_null());
  EXPECT_EQ(j["restitution"]["law"]["value"], parameter(j, "contact.restitution[1]")["value"]);
  EXPECT_EQ(j["restitution"]["law"]["ci95"], parameter(j, "contact.restitution[1]")["ci95"]);
}

TEST_F(FitOptions, IntervalsOfOtherKindsAreInTheResult) {
  const json j = fitted("--profile --bootstrap 5 --bootstrap-kind residual --seed 9");
  EXPECT_EQ(j["profiles"].size(), 7U);  // and of two gains and delays
  EXPECT_EQ(j["bootstrap"]["kind"], "residual");
  EXPECT_EQ(j["bootstrap"]["draws"], 5);
  EXPECT_EQ(j["bootstrap"]["seed"], 9);
  EXPECT_EQ(
      j["bootstrap"]["parameters"][0]["draws"].size() + j["bootstrap"]["failed"].get<std::size_t>(),
      5U);
}

TEST_F(FitOptions, AnIntervalByTheLogarithmIsAsWideByAFactor) {
  const json p = parameter(fitted("--log contact.stiffness_factor"), "contact.stiffness_factor");
  const double value = p["value"], low = p["ci95"][0], high = p["ci95"][1];
  const double mesh = p["mesh_error"].get<double>();  // goes by no factor
  EXPECT_NEAR(std::log((high - mesh) / value), std::log(value / (low + mesh)), 1e-9);
  EXPECT_GT(high, value);
}

// The command line goes over the rig file's [fit].
TEST_F(FitOptions, TheRigFilesTableIsTheDefault) {
  const std::string with_table =
      write("rig.toml", text_of(rig) + "\n[fit]\nprofile = true\nloss = \"huber\"\n");
  const std::string call = "fit " + samples + "shen2007-1.uff --rig " + with_table +
                           " --quiet --json --set solver.model=hybrid --set solver.modes=3 --set "
                           "solver.duration=\"0.5 ms\"";
  const Outcome huber = run(call);
  ASSERT_EQ(huber.code, 0) << huber.err;
  EXPECT_THAT(huber.out, HasSubstr("No profile likelihood was made"));
  const Outcome squares = run(call + " --loss squares");
  ASSERT_EQ(squares.code, 0) << squares.err;
  EXPECT_EQ(json::parse(squares.out)["profiles"].size(), 7U);
}

const json& score(const json& fit, const std::string& label) {
  for (const json& one : fit["models"]["scores"])
    if (one["label"].get<std::string>().starts_with(label)) return one;
  throw std::out_of_range(label);
}

// The list that names all laws of interest has the rig's own in it (goldsmith).
TEST_F(FitOptions, TheRigsOwnModelIsComparedOnce) {
  const json j = fitted("--against contact.law=goldsmith,radzimovsky");
  ASSERT_EQ(j["models"]["scores"].size(), 2U);
  EXPECT_EQ(score(j, "the rig file's own")["label"],
            "the rig file's own (contact.law = goldsmith)");
  EXPECT_TRUE(score(j, "contact.law = radzimovsky")["failure"].is_null());
  EXPECT_THAT(j["models"]["sentence"].get<std::string>(), HasSubstr("explains the data best"));
}

// What was not fitted has no chi-square, and is not the least of all.
TEST_F(FitOptions, ACandidateThatFailedHasNoNumbers) {
  const std::string result = path("fit.json");
  const json j = fitted("--against contact.length='\"20 kg\"' -o " + result);
  const json& failed = score(j, "contact.length");
  EXPECT_THAT(failed["failure"].get<std::string>(), HasSubstr("contact.length"));
  for (const char* key : {"chi2", "dof", "unknowns", "aicc", "bic", "delta", "weight", "sound",
                          "sentence", "held_out"})
    EXPECT_TRUE(failed[key].is_null()) << key;
  EXPECT_THAT(j["models"]["sentence"].get<std::string>(),
              testing::StartsWith("the rig file's own could not be compared: the other candidate "
                                  "could not be fitted. It does not explain the data: "));
  const Outcome page = run("report " + result + " -o " + path("fit.html"));
  EXPECT_EQ(page.code, 0) << page.err;
  EXPECT_THAT(text_of(path("fit.html")), HasSubstr("could not be fitted: contact.length"));
}

TEST_F(FitOptions, AWindowThatEndsInContactIsToldAsTheCause) {
  const std::string call = "fit " + samples + "shen2007-1.uff --rig " + rig +
                           " --quiet --set solver.model=hybrid --set solver.modes=12 ";
  const Outcome o = run(call + "--window 3e-5");
  EXPECT_THAT(o.out, HasSubstr("warning: The fitted window ends in contact: "));
  EXPECT_THAT(o.out, testing::Not(HasSubstr("solver.duration")));
  EXPECT_THAT(o.out, testing::Not(HasSubstr("nan")));
  // where the run is cut off as well nothing is left but to say so
  const Outcome cut = run(call + "--set solver.duration=\"0.03 ms\"");
  EXPECT_THAT(cut.out, HasSubstr("state a longer solver.duration"));
  EXPECT_THAT(cut.out, testing::ContainsRegex("kinematic +-   not simulated: the run ends in "));
  EXPECT_THAT(cut.out, testing::Not(HasSubstr("nan")));
}

TEST_F(FitOptions, RefusesWithTheOptionsName) {
  EXPECT_THAT(refused("--prior contact.restitution=0.5"),
              HasSubstr("--prior: the prior of contact.restitution needs its standard uncertainty, "
                        "for example \"1.0 +- 0.1\""));
  EXPECT_THAT(refused("--bounds contact.restitution=0.5"),
              HasSubstr("--bounds: expected LOW:HIGH, found \"0.5\""));
  EXPECT_THAT(refused("--tie contact.modulus=half*beam.youngs_modulus"),
              HasSubstr("--tie: expected a number before the *, found \"half\""));
  EXPECT_THAT(refused("--fix contact.colour"),
              HasSubstr("--fix: 'contact.colour' cannot be fitted; parameters are"));
  EXPECT_THAT(refused("--own contact.colour"), HasSubstr("--own: 'contact.colour' cannot"));
  EXPECT_THAT(refused("--shared contact.colour"), HasSubstr("--shared: 'contact.colour' cannot"));
  EXPECT_THAT(refused("--loss absolute"), HasSubstr("--loss: absolute not in {"));
  EXPECT_THAT(refused("--bootstrap-kind jackknife"),
              HasSubstr("--bootstrap-kind: jackknife not in {"));
  EXPECT_THAT(refused("--bootstrap-kind residual"),
              HasSubstr("--bootstrap-kind: there is no bootstrap it is of; --bootstrap N asks"));
  EXPECT_THAT(refused("--against contact.law=hertz-point --loss huber"),
              HasSubstr("--against: models are compared by their likelihood"));
  EXPECT_THAT(refused("--prior sensors.force.gain=1+-0.1 --prior sensors.force.gain=1+-0.2"),
              HasSubstr("--prior: 'sensors.force.gain' is named twice"));
  EXPECT_THAT(refused("--seed 5"), HasSubstr("--seed: there is no bootstrap it is of"));
  for (const char* idle : {"--prior sensors.force.gain=1+-0.1", "--bounds sensors.force.gain=0:2",
                           "--log sensors.force.gain", "--free sensors.force.gain"})
    EXPECT_THAT(refused(std::string("--fix sensors.force.gain ") + idle),
                HasSubstr("'sensors.force.gain' is not fitted, by --fix"));
  EXPECT_THAT(refused("--bootstrap 1"), HasSubstr("--bootstrap: Value 1 not in range"));
  EXPECT_THAT(
      refused("--tie contact.length=1*start.velocity"),
      HasSubstr("--tie: 'contact.length' has the unit m and 'start.velocity' the unit m/s"));
  EXPECT_THAT(refused("--shared impact.time " + samples + "shen2007-2.uff"),
              HasSubstr("--shared: 'impact.time' cannot be shared"));
  EXPECT_THAT(refused("--shared start.velocity --own start.velocity"),
              HasSubstr("--own: 'start.velocity' is named by --shared too"));
  EXPECT_THAT(refused("--against foo=1"), HasSubstr("--against: foo: there is no such key here"));
  EXPECT_THAT(refused("--against contact.law=gold,johnson"),
              HasSubstr("--against: contact.law: there is no elastic law 'gold'"));
  EXPECT_THAT(refused("--against fit.loss=huber"), HasSubstr("fit.loss is no part of a model"));
  const std::string window = refused("--window 0");
  EXPECT_THAT(window, HasSubstr("--window: expected a number greater than zero, found 0"));
  EXPECT_LT(window.size(), 200U);
  // only the rig file knows the other bound
  const Outcome o = run(fast + "--bounds contact.restitution=0.9:0.3");
  EXPECT_EQ(o.code, 3);
  EXPECT_THAT(o.err, HasSubstr("'contact.restitution' has no room between its bounds 0.9 and 0.3"));
}

// It would simulate a thousand times as long as a contact takes, for every step of the search.
TEST_F(FitOptions, TimesInAnotherUnitAreRefused) {
  const Outcome o = run(fast + "--sample-rate 1000");
  EXPECT_EQ(o.code, 3);
  EXPECT_THAT(o.err, HasSubstr("the times seem to be 1000 times too long (ms taken for s). State "
                               "the unit of the times with --units, or --sample-rate."));
}

}  // namespace
