// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/fit_keys.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>
#include <string>

#include "datasets/input_error.hpp"
#include "fitting/rig_file.hpp"
#include "tests/fitting/synthetic_shot.hpp"

namespace impactrig::fitting {
namespace {

using tests::paper_rig;

/// The paper's rig and, from line 30 on, a [fit] table.
std::string with_fit(const std::string& lines) {
  std::string text = paper_rig;
  const auto count = std::ranges::count(text, '\n');
  return text + std::string(static_cast<std::size_t>(29 - count), '\n') + "[fit]\n" + lines;
}

FitOptions options_of(const std::string& lines) {
  return parse_rig_file(with_fit(lines), "rig.toml").fit;
}

std::string message_of(const std::string& lines) {
  try {
    options_of(lines);
  } catch (const datasets::InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(FitKeys, ReadsOneRecordingsOwn) {
  const FitOptions options = options_of(R"(
free = ["contact.restitution", "start.velocity[2]"]
[fit."start.velocity[2]"]
prior = "0.44 +- 0.01 m/s"
[fit.sensors.force."gain[1]"]
tied_to = "sensors.force.gain[2]"
)");
  EXPECT_THAT(options.free, testing::ElementsAre("contact.restitution", "start.velocity[2]"));
  ASSERT_NE(options.setting_of("start.velocity[2]"), nullptr);
  EXPECT_TRUE(options.setting_of("start.velocity[2]")->prior);
  ASSERT_NE(options.setting_of("sensors.force.gain[1]"), nullptr);
  EXPECT_EQ(options.setting_of("sensors.force.gain[1]")->tie->to, "sensors.force.gain[2]");
  EXPECT_THAT(message_of("[fit.\"start.velocity[2]\"]\nshared = true\n"),
              testing::EndsWith("'start.velocity[2]' is one recording's; whether all share it is "
                                "said of start.velocity"));
  FitOptions of_line;
  read_prior("start.velocity[2]=0.44 +- 0.01 m/s", of_line);
  read_bounds("start.velocity[1]=0.3 m/s:0.5 m/s", of_line);
  read_tie("sensors.force.gain[1]=0.5*sensors.force.gain[2]", of_line);
  EXPECT_EQ(of_line.settings.size(), 3U);
  EXPECT_EQ(of_line.setting_of("sensors.force.gain[1]")->tie->factor, 0.5);
  EXPECT_THROW(choose_shared("start.velocity[2]", true, of_line), std::invalid_argument);
}

TEST(FitKeys, ReadsWhatIsFitted) {
  const FitOptions options = options_of(R"(
free = ["contact.restitution", "start.velocity"]
channels = ["force"]
window = "0.5 ms"
loss = "tukey"
profile = true
bootstrap = 500
bootstrap_kind = "residual"
seed = 7
)");
  EXPECT_THAT(options.free, testing::ElementsAre("contact.restitution", "start.velocity"));
  EXPECT_TRUE(options.use_force);
  EXPECT_FALSE(options.use_velocity);
  EXPECT_FALSE(options.use_displacement);
  EXPECT_DOUBLE_EQ(options.window, 0.5e-3);
  EXPECT_EQ(options.loss, Loss::tukey);
  EXPECT_TRUE(options.profile);
  EXPECT_EQ(options.bootstrap, 500);
  EXPECT_EQ(options.bootstrap_kind, BootstrapKind::residual);
  EXPECT_EQ(options.seed, 7U);
  EXPECT_TRUE(options.settings.empty());
}

TEST(FitKeys, ReadsWhatIsStatedOfAParameter) {
  const FitOptions options = options_of(R"(
[fit.contact.restitution]
initial = 0.4
lower = 0.3
upper = 0.9
shared = false
[fit.beam.density]
prior = "2.77(1) g/cm^3"
scale = "log"
[fit.contact.modulus]
tied_to = "beam.youngs_modulus"
factor = 0.9
offset = "1 GPa"
[fit.sensors.force.gain]
fixed = true
[fit.sensors.force.amplifier.high_cut]
prior = "100(5) kHz"
)");
  ASSERT_EQ(options.settings.size(), 5U);
  EXPECT_EQ(*options.setting_of("contact.restitution"),
            (ParameterSetting{.name = "contact.restitution",
                              .initial = 0.4,
                              .lower = 0.3,
                              .upper = 0.9,
                              .shared = false}));
  const auto& density = *options.setting_of("beam.density")->prior;
  EXPECT_NEAR(density[0], 2770.0, 1e-9);
  EXPECT_NEAR(density[1], 10.0, 1e-9);
  EXPECT_TRUE(options.setting_of("beam.density")->by_logarithm);
  EXPECT_EQ(*options.setting_of("contact.modulus")->tie,
            (Tie{.to = "beam.youngs_modulus", .factor = 0.9, .offset = 1e9}));
  EXPECT_TRUE(options.setting_of("sensors.force.gain")->fixed);
  EXPECT_NEAR((*options.setting_of("sensors.force.amplifier.high_cut")->prior)[1], 5e3, 1e-6);
}

TEST(FitKeys, WithoutTheTableIsAsTheFitHasItByItself) {
  const FitOptions options = parse_rig_file(paper_rig, "rig.toml").fit;
  EXPECT_TRUE(options.free.empty());
  EXPECT_TRUE(options.settings.empty());
  EXPECT_EQ(options.loss, Loss::squares);
  EXPECT_TRUE(options.use_force && options.use_velocity && !options.use_displacement);
}

TEST(FitKeys, ErrorsNameTheirPlace) {
  EXPECT_EQ(message_of("loss = \"absolute\"\n"),
            "rig.toml:31:8: fit.loss: expected one of squares, huber, cauchy, tukey, found "
            "\"absolute\"");
  EXPECT_EQ(message_of("bootstrap = 1\n"),
            "rig.toml:31:13: fit.bootstrap: must be 0, or 2 and more");
  EXPECT_EQ(message_of("seed = -1\n"), "rig.toml:31:8: fit.seed: must not be negative");
  EXPECT_EQ(message_of("window = \"0 ms\"\n"),
            "rig.toml:31:10: fit.window: must be greater than zero");
  EXPECT_EQ(message_of("channels = [\"sound\"]\n"),
            "rig.toml:31:12: fit.channels: expected force, velocity or displacement, found sound");
  EXPECT_THAT(message_of("free = [\"contact.colour\"]\n"),
              testing::StartsWith("rig.toml:31:8: fit.free: 'contact.colour' cannot be fitted; "
                                  "parameters are contact.restitution, "));
  EXPECT_EQ(message_of("bootstrap_knd = \"residual\"\n"),
            "rig.toml:31:17: fit.bootstrap_knd: there is no such key here; did you mean "
            "bootstrap_kind?");
  EXPECT_EQ(message_of("[fit.contact.restitution]\nprior = 0.5\n"),
            "rig.toml:32:9: fit.contact.restitution.prior: needs its standard uncertainty, for "
            "example \"1.0 +- 0.1\"");
  EXPECT_EQ(message_of("[fit.beam.density]\nprior = \"2766 kg/m^3\"\n"),
            "rig.toml:32:9: fit.beam.density.prior: needs its standard uncertainty, for example "
            "\"1.0 +- 0.1 kg/m^3\"");
  EXPECT_EQ(message_of("[fit.contact.modulus]\nfactor = 2.0\n"),
            "rig.toml:32:10: fit.contact.modulus.factor: needs tied_to");
  EXPECT_EQ(message_of("[fit.contact.modulus]\noffset = \"1 GPa\"\n"),
            "rig.toml:32:10: fit.contact.modulus.offset: needs tied_to");
  EXPECT_EQ(message_of("[fit.contact.modulus]\nlowr = \"1 GPa\"\n"),
            "rig.toml:32:8: fit.contact.modulus.lowr: there is no such key here; did you mean "
            "lower?");
  EXPECT_EQ(message_of("[fit.contact.modulus]\nlower = 1e9\n"),
            "rig.toml:32:9: fit.contact.modulus.lower: the bare number 1e+09 has no unit; write it "
            "in quotes with its unit, for example \"1e+09 Pa\"");
  EXPECT_EQ(message_of("[fit.contact.modulus]\ntied_to = \"beam.modulus\"\n").substr(0, 73),
            "rig.toml:32:11: fit.contact.modulus.tied_to: 'beam.modulus' cannot be fit");
  EXPECT_EQ(message_of("[fit.contact.length]\ntied_to = \"start.velocity\"\n"),
            "rig.toml:32:11: fit.contact.length.tied_to: 'contact.length' has the unit m and "
            "'start.velocity' the unit m/s; a tie is between numbers of one unit");
  EXPECT_EQ(message_of("[fit.impact.time]\nshared = true\n"),
            "rig.toml:32:10: fit.impact.time.shared: 'impact.time' cannot be shared: each "
            "recording has a time axis of its own");
  EXPECT_THAT(message_of("[fit.contact.colour]\nfixed = true\n"),
              testing::StartsWith("rig.toml:31:1: fit.contact.colour: 'contact.colour' cannot be "
                                  "fitted; parameters are "));
}

template <typename Read>
std::string refusal(Read read, const std::string& text) {
  FitOptions options;
  try {
    read(text, options);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "no error";
}

TEST(FitKeys, ReadsLinesOfTheCommandLine) {
  FitOptions options;
  read_prior("beam.density=2766(5) kg/m^3", options);
  read_prior("contact.restitution=0.5 +- 0.1", options);
  read_bounds("contact.restitution=0.3:0.9", options);
  read_bounds("contact.modulus=:80 GPa", options);
  read_tie("contact.counter_modulus=0.9*contact.modulus", options);
  read_tie("contact.radius=contact.counterface.radius", options);
  EXPECT_EQ((*options.setting_of("beam.density")->prior)[1], 5.0);
  EXPECT_EQ((*options.setting_of("contact.restitution")->prior)[1], 0.1);
  EXPECT_EQ(options.setting_of("contact.restitution")->lower, 0.3);
  EXPECT_EQ(options.setting_of("contact.restitution")->upper, 0.9);
  EXPECT_FALSE(options.setting_of("contact.modulus")->lower);
  EXPECT_EQ(options.setting_of("contact.modulus")->upper, 80e9);
  EXPECT_EQ(options.setting_of("contact.counter_modulus")->tie,
            (Tie{.to = "contact.modulus", .factor = 0.9}));
  EXPECT_EQ(options.setting_of("contact.radius")->tie, (Tie{.to = "contact.counterface.radius"}));
}

TEST(FitKeys, RefusesOtherLinesOfTheCommandLine) {
  EXPECT_EQ(refusal(read_prior, "contact.restitution"),
            "expected NAME=VALUE +- UNCERTAINTY, found \"contact.restitution\"");
  EXPECT_EQ(refusal(read_prior, "contact.restitution=0.5"),
            "the prior of contact.restitution needs its standard uncertainty, for example \"1.0 +- "
            "0.1\"");
  EXPECT_THAT(refusal(read_prior, "contact.colour=1 +- 1"),
              testing::StartsWith("'contact.colour' cannot be fitted; "));
  EXPECT_EQ(refusal(read_bounds, "contact.restitution=0.3"), "expected LOW:HIGH, found \"0.3\"");
  EXPECT_EQ(refusal(read_bounds, "=0.3:0.4"), "expected NAME=LOW:HIGH, found \"=0.3:0.4\"");
  EXPECT_EQ(refusal(read_bounds, "contact.restitution=:"), "expected LOW:HIGH, found \":\"");
  EXPECT_EQ(refusal(read_tie, "contact.modulus=half*beam.youngs_modulus"),
            "expected a number before the *, found \"half\"");
  EXPECT_EQ(refusal(read_tie, "contact.modulus=nan*beam.youngs_modulus"),
            "expected a number before the *, found \"nan\"");
  EXPECT_EQ(refusal(read_tie, "contact.length=1*start.velocity"),
            "'contact.length' has the unit m and 'start.velocity' the unit m/s; a tie is between "
            "numbers of one unit");
  EXPECT_EQ(refusal(read_tie, "sensors.force.gain[2]=sensors.force.delay"),
            "'sensors.force.gain[2]' has no unit and 'sensors.force.delay' the unit s; a tie is "
            "between numbers of one unit");
  const auto share = [](const std::string& name, FitOptions& options) {
    choose_shared(name, true, options);
  };
  EXPECT_EQ(refusal(share, "impact.time"),
            "'impact.time' cannot be shared: each recording has a time axis of its own");
  EXPECT_THAT(refusal(read_tie, "contact.modulus=beam.modulus"),
              testing::StartsWith("'beam.modulus' cannot be fitted; "));
}

}  // namespace
}  // namespace impactrig::fitting
