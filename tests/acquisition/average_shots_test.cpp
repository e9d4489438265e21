// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/average_shots.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "datasets/input_error.hpp"
#include "tests/acquisition/scene.hpp"

namespace impactrig::acquisition {

namespace {

using datasets::Record;
using namespace tests;

double force_at(double t) {
  return sine_squared(t, 1500.0, 200e-6);
}

double velocity_at(double t) {
  return 0.44 - 0.3 * (1.0 - std::cos(std::numbers::pi * std::clamp(t / 200e-6, 0.0, 1.0)));
}

/// Shot number `k`: touch at its own time, a rate of its own, noise.
Record shot(int k, double noise, double scale = 1.0, const Sampling& at = {}) {
  const double touch = 37.3e-6 * k;
  auto force = sampled(at, [&](double t) { return scale * force_at(t - touch); });
  auto velocity = sampled(at, [&](double t) { return velocity_at(t - touch); });
  add_noise(force, noise, static_cast<std::uint64_t>(k + 1));
  add_noise(velocity, noise * 1e-4, static_cast<std::uint64_t>(k + 100));
  Record record = record_of({force_of(at, force), velocity_of(at, velocity)});
  record.provenance.source_file = "shot" + std::to_string(k) + ".csv";
  return record;
}

double rms_error(const datasets::Channel& channel, double (*truth)(double)) {
  double squares = 0.0;
  for (std::size_t i = 0; i < channel.size(); ++i) {
    const double error = channel.value(i) - truth(channel.clock.time(i));
    squares += error * error / static_cast<double>(channel.size());
  }
  return std::sqrt(squares);
}

// Noise falls with the root of the number; the standard deviation beside it is the noise.
TEST(AverageShots, TakesNoiseOff) {
  std::vector<Record> shots;
  for (int k = 0; k < 16; ++k) shots.push_back(shot(k, 8.0));
  const Record mean = average_shots(shots);
  ASSERT_EQ(mean.channels.size(), 4U);
  EXPECT_EQ(mean.channels[0].name, "Force");
  EXPECT_EQ(mean.channels[0].quantity, datasets::Quantity::force);
  EXPECT_EQ(mean.channels[1].name, "Force, standard deviation");
  EXPECT_EQ(mean.channels[1].quantity, datasets::Quantity::other);
  EXPECT_EQ(mean.channels[0].attributes.at("shots"), "16");
  // A sixteenth part of the variance, interpolation's 0.9 of the band and 0.3 us of alignment
  // aside.
  EXPECT_NEAR(rms_error(mean.channels[0], force_at), 8.0 / 4.0, 0.4);
  EXPECT_NEAR(rms_error(mean.channels[2], velocity_at), 8e-4 / 4.0, 0.4e-4);
  double spread = 0.0;
  for (const double value : mean.channels[1].values())
    spread += value / static_cast<double>(mean.channels[1].size());
  EXPECT_NEAR(spread, 8.0, 0.6);
}

// A spike in one shot is no part of the mean: the others are.
TEST(AverageShots, LeavesSpikesOut) {
  std::vector<Record> shots;
  for (int k = 0; k < 3; ++k) shots.push_back(shot(k, 2.0));
  std::vector<double> force = shots[1].channels[0].values();
  const Sampling at;
  const auto spike = static_cast<std::size_t>((-300e-6 + 37.3e-6 - at.start) / at.interval);
  for (std::size_t i = spike; i < spike + 4; ++i) force[i] += 3000.0;
  shots[1].channels[0] = force_of(at, force);
  const Record mean = average_shots(shots);
  for (std::size_t i = 0; i < mean.channels[0].size(); ++i) {
    const double t = mean.channels[0].clock.time(i);
    if (t < -50e-6) {
      ASSERT_LT(std::abs(mean.channels[0].value(i)), 12.0) << t;
    }
  }
  EXPECT_TRUE(mean.channels[0].valid.empty());
}

// Without noise the mean is each of them, to what interpolation costs.
TEST(AverageShots, OfOneShotManyTimesIsThatShot) {
  const Sampling slow{.start = -1.1e-3, .interval = 1.6e-6, .samples = 2600};
  const std::vector<Record> shots{shot(0, 0.0), shot(3, 0.0), shot(1, 0.0, 1.0, slow)};
  const Record mean = average_shots(shots);
  for (std::size_t i = 0; i < mean.channels[0].size(); ++i) {
    const double t = mean.channels[0].clock.time(i);
    ASSERT_NEAR(mean.channels[0].value(i), force_at(t), 1.5) << t;
    ASSERT_LT(mean.channels[1].value(i), 2.0) << t;
  }
  EXPECT_EQ(mean.provenance.source_file, "shot0.csv");
  ASSERT_EQ(mean.provenance.edits.size(), 3U);
  EXPECT_EQ(mean.provenance.edits[0].parameters.at("file"), "shot3.csv");
  EXPECT_NEAR(std::stod(mean.provenance.edits[0].parameters.at("shift")), 111.9e-6, 0.1e-6);
  EXPECT_EQ(mean.provenance.edits[2].parameters.at("shots"), "3");
}

/// By how much the mean of eight shots is off at its worst sample, of a peak of 1500.
double error_of_short_pulses(double samples_a_contact, double noise) {
  const double interval = 200e-6 / samples_a_contact;
  const Sampling at{.start = -400.0 * interval, .interval = interval, .samples = 800};
  std::vector<Record> shots;
  for (int k = 0; k < 8; ++k) shots.push_back(shot(k, noise, 1.0, at));
  const Record mean = average_shots(shots);
  EXPECT_THAT(mean.warnings, testing::Not(testing::Contains(testing::HasSubstr("first touch"))));
  double worst = 0.0;
  for (std::size_t i = 0; i < mean.channels[0].size(); ++i)
    worst = std::max(
        worst, std::abs(mean.channels[0].value(i) - force_at(mean.channels[0].clock.time(i))));
  return worst;
}

// First touch is known to a sample or three, which blurs a pulse of five to two thirds of its peak.
TEST(AverageShots, LaysPulsesOfAFewSamplesOnEachOther) {
  // What a pulse of five and seven samples has beyond half of the rate shows as such an error.
  EXPECT_LT(error_of_short_pulses(5.3, 0.75), 0.045 * 1500.0);
  EXPECT_LT(error_of_short_pulses(7.3, 0.75), 0.02 * 1500.0);
  for (const double samples : {9.3, 11.3, 13.3, 18.3}) {
    EXPECT_LT(error_of_short_pulses(samples, 0.75), 0.01 * 1500.0) << samples;
    EXPECT_LT(error_of_short_pulses(samples, 15.0), 0.025 * 1500.0) << samples;  // 7 sigma/sqrt(8)
  }
}

TEST(AverageShots, SaysWhichShotIsLaidByFirstTouchAlone) {
  const Sampling at;
  Record other = shot(1, 2.0);
  other.channels[0] =
      force_of(at, sampled(at, [](double t) {
                 const double u = std::clamp(t / 200e-6, 0.0, 1.0);
                 return 1500.0 * (1.0 - 0.55 * u) * std::sin(4.0 * std::numbers::pi * u);
               }));
  const Record mean = average_shots(std::vector<Record>{shot(0, 2.0), other, shot(2, 2.0)});
  EXPECT_THAT(
      mean.warnings,
      testing::Contains(testing::MatchesRegex(
          "shot1.csv is laid on shot0.csv by first touch alone, which blurs the mean: "
          "'Force' does not tell better \\(what is left over is .* of what follows\\)\\.")));
  EXPECT_EQ(mean.provenance.edits[0].parameters.at("shift uncertainty"),
            "not known: by first touch");
}

TEST(AverageShots, LeavesOutWhatIsNoGoodShot) {
  const Sampling at;
  Record clipped = shot(1, 2.0);
  for (double& value : std::get<std::vector<double>>(clipped.channels[0].raw))
    value = std::min(value, 1200.0);
  Record empty = shot(2, 2.0);
  std::ranges::fill(std::get<std::vector<double>>(empty.channels[0].raw), 0.0);
  const std::vector<Record> shots{shot(0, 2.0), clipped, empty, shot(3, 2.0)};
  const Record mean = average_shots(shots);
  EXPECT_THAT(mean.warnings,
              testing::ElementsAre("shot1.csv is not in the mean: its impact is clipped.",
                                   "shot2.csv is not in the mean: there is no impact in it."));
  EXPECT_EQ(mean.channels[0].attributes.at("shots"), "2");
  try {
    average_shots(std::vector<Record>{shot(0, 2.0), clipped});
    FAIL();
  } catch (const datasets::InputError& error) {
    EXPECT_STREQ(error.what(),
                 "shot0.csv: a mean needs two shots at least, and 1 of 2 can be used: shot1.csv is "
                 "not in the mean: its impact is clipped.");
  }
}

Record turned(Record record, std::size_t channel) {
  for (double& value : std::get<std::vector<double>>(record.channels[channel].raw)) value = -value;
  return record;
}

// A sensor with the wrong polarity would take a shot's share off the mean.
TEST(AverageShots, LeavesOutTheOppositePolarity) {
  for (const bool inverted_first : {false, true}) {
    std::vector<Record> shots{shot(0, 2.0), turned(shot(1, 2.0), 0), shot(2, 2.0),
                              turned(shot(3, 2.0), 1), shot(4, 2.0)};
    if (inverted_first) std::swap(shots[0], shots[1]);
    const Record mean = average_shots(shots);
    EXPECT_THAT(mean.warnings,
                testing::ElementsAre(
                    "shot1.csv is not in the mean: its peak has the opposite sign.",
                    "shot3.csv is not in the mean: its approach velocity has the opposite sign."));
    EXPECT_EQ(mean.channels[0].attributes.at("shots"), "3");
    EXPECT_LT(rms_error(mean.channels[0], force_at), 2.0);
  }
}

TEST(AverageShots, SaysThatShotsAreUnlike) {
  const std::vector<Record> shots{shot(0, 2.0), shot(1, 2.0, 1.2)};
  const Record mean = average_shots(shots);
  ASSERT_EQ(mean.warnings.size(), 1U);
  EXPECT_THAT(mean.warnings[0], testing::StartsWith("The peaks of the shots differ"));
}

// A force alone does not tell that a decoder was in another range, or off its zero.
TEST(AverageShots, SaysWhichShotWasFaster) {
  std::vector<Record> shots;
  for (int k = 0; k < 6; ++k) shots.push_back(shot(k, 2.0));
  for (double& value : std::get<std::vector<double>>(shots[3].channels[1].raw)) value += 0.22;
  const Record mean = average_shots(shots);
  EXPECT_THAT(mean.warnings,
              testing::ElementsAre(
                  "The approach velocities of the shots differ with a standard deviation of 19 %; "
                  "contact is not linear, so fit the shots one by one instead of their mean, or "
                  "leave out shot3.csv, which is 50 % above their median."));
  EXPECT_EQ(mean.provenance.edits.back().parameters.at("approach velocities"),
            "standard deviation 19 %");
  EXPECT_EQ(mean.provenance.edits.back().parameters.at("peaks").substr(0, 18),
            "standard deviation");
}

// Five samples of delay that one shot's velocity was recorded with, be it the first.
TEST(AverageShots, SaysInWhichShotADelayIsLeft) {
  for (const int late : {-1, 0, 2}) {
    std::vector<Record> shots;
    for (int k = 0; k < 4; ++k) shots.push_back(shot(k, 3.0, 1.0 + 0.01 * k));
    if (late >= 0) shots[static_cast<std::size_t>(late)].channels[1].clock.start += 5e-6;
    const Record mean = average_shots(shots);
    if (late < 0) {
      EXPECT_THAT(mean.warnings, testing::IsEmpty());
      continue;
    }
    ASSERT_EQ(mean.warnings.size(), 1U) << late;
    EXPECT_THAT(
        mean.warnings[0],
        testing::MatchesRegex("shot" + std::to_string(late) +
                              ".csv shows 'Velocity' (5|4\\.9.|5\\.0.)e-06 s later than most "
                              "shots do, beside 'Force': the mean is blurred by it\\. .*"));
  }
}

/// Four shots of which one shows the velocity late, and says so or not.
std::vector<Record> with_one_late(std::size_t late, const std::optional<datasets::Delay>& stated) {
  std::vector<Record> shots;
  for (int k = 0; k < 4; ++k) shots.push_back(shot(k, 3.0));
  shots[late].channels[1].clock.start += 30e-6;
  shots[late].channels[1].delay = stated;
  return shots;
}

// The warning's advice, followed.
TEST(AverageShots, TakesStatedDelaysOff) {
  for (const std::size_t late : {std::size_t{0}, std::size_t{2}}) {
    const Record mean = average_shots(with_one_late(late, datasets::Delay{30e-6, 0.2e-6, false}));
    EXPECT_THAT(mean.warnings, testing::IsEmpty());
    EXPECT_LT(rms_error(mean.channels[2], velocity_at), 3e-4);
    ASSERT_TRUE(mean.channels[2].delay);
    EXPECT_TRUE(mean.channels[2].delay->removed);
    EXPECT_NEAR(mean.channels[2].delay->value, 7.5e-6, 1e-12);
    EXPECT_NEAR(mean.channels[2].delay->uncertainty, 0.05e-6, 1e-12);
    EXPECT_FALSE(mean.channels[0].delay);
    const datasets::Edit& edit = mean.provenance.edits[late == 0 ? 0 : 1];
    EXPECT_EQ(edit.what, late == 0 ? "remove delay" : "average shots");
    EXPECT_EQ(edit.parameters.at(late == 0 ? "delay" : "delay taken off 'Velocity'"), "3e-05 s");
  }
}

// What has come off already does not do so again.
TEST(AverageShots, KeepsDelaysThatAreTakenOff) {
  std::vector<Record> shots;
  for (int k = 0; k < 3; ++k) {
    shots.push_back(shot(k, 3.0));
    shots.back().channels[1].delay = datasets::Delay{2e-6, 0.2e-6, true};
  }
  const Record mean = average_shots(shots);
  EXPECT_LT(rms_error(mean.channels[2], velocity_at), 3e-4);
  EXPECT_TRUE(mean.channels[2].delay->removed);
  EXPECT_NEAR(mean.channels[2].delay->value, 2e-6, 1e-12);
  EXPECT_NEAR(mean.channels[2].delay->uncertainty, 0.2e-6, 1e-12);
}

TEST(AverageShots, LeavesOutAShotWithoutTheTriggersQuantity) {
  Record without = shot(1, 2.0);
  without.channels.erase(without.channels.begin());
  const std::vector<Record> shots{without, shot(0, 2.0), shot(2, 2.0)};
  const Record mean = average_shots(shots);
  EXPECT_THAT(mean.warnings, testing::ElementsAre(
                                 "shot1.csv is not in the mean: its impact is found in "
                                 "'Velocity' (velocity), that of the others in 'Force' (force)."));
}

TEST(AverageShots, LeavesOutWhatIsNotFinite) {
  std::vector<Record> shots{shot(0, 0.0), shot(0, 0.0), shot(0, 0.0)};
  auto& samples = std::get<std::vector<double>>(shots[2].channels[1].raw);
  for (std::size_t i = 1050; i < 1150; ++i) samples[i] = NAN;
  const Record mean = average_shots(shots);
  for (std::size_t i = 1000; i < 1200; ++i) {
    ASSERT_NEAR(mean.channels[2].value(i), velocity_at(mean.channels[2].clock.time(i)), 1e-9) << i;
    ASSERT_LT(mean.channels[3].value(i), 1e-9) << i;
  }
  EXPECT_THAT(mean.warnings, testing::ElementsAre(testing::HasSubstr(
                                 "samples are the mean of fewer than all 3 shots, down to 2")));
}

// A laser without light for 50 us, as inspect flags it; be it the first shot's.
TEST(AverageShots, MarksUnmarkedDropouts) {
  for (const std::size_t lost : {std::size_t{0}, std::size_t{2}})
    for (const double from : {-300e-6, 60e-6}) {
      std::vector<Record> shots;
      for (int k = 0; k < 4; ++k) shots.push_back(shot(k, 3.0));
      const double touch = 37.3e-6 * static_cast<double>(lost);
      auto& samples = std::get<std::vector<double>>(shots[lost].channels[1].raw);
      const auto begin = static_cast<std::size_t>((from + touch + 1e-3) / 1e-6);
      std::fill_n(samples.begin() + static_cast<std::ptrdiff_t>(begin), 50, 0.0);
      const Record mean = average_shots(shots);
      ASSERT_THAT(mean.warnings,
                  testing::Contains(testing::MatchesRegex(
                      "shot" + std::to_string(lost) +
                      "\\.csv: 'Velocity' has dropouts that nobody marked, from .* s on: .*")))
          << lost << ' ' << from;
      EXPECT_LT(rms_error(mean.channels[2], velocity_at), 3e-4) << lost << ' ' << from;
      EXPECT_TRUE(mean.channels[0].valid.empty());
    }
}

TEST(AverageShots, ConvertsUnitsAndLeavesInvalidSamplesOut) {
  Record second = shot(0, 0.0);
  second.provenance.source_file = "second.csv";
  second.channels[1].unit = "mm/s";
  for (double& value : std::get<std::vector<double>>(second.channels[1].raw)) value *= 1e3;
  second.channels[1].valid.assign(second.channels[1].size(), 1);
  for (std::size_t i = 2000; i < 2100; ++i) second.channels[1].valid[i] = 0;
  const std::vector<Record> shots{shot(0, 0.0), second};
  const Record mean = average_shots(shots);
  EXPECT_EQ(mean.channels[2].unit, "m/s");
  EXPECT_NEAR(mean.channels[2].value(100), 0.44, 1e-9);
  EXPECT_EQ(mean.channels[2].valid[2050], 0);
  EXPECT_EQ(mean.channels[2].valid[1900], 1);
  EXPECT_TRUE(mean.channels[0].valid.empty());
  second.channels[1].unit = "N";
  EXPECT_THROW(average_shots(std::vector<Record>{shot(0, 0.0), second}), datasets::InputError);
}

datasets::Edit low_passed(const std::string& cutoff) {
  return {"low-pass, zero phase",
          "Force",
          {{"cutoff", cutoff}, {"order", "4, forwards and backwards"}, {"largest departure", "1"}}};
}

// The edits of the mean are the first shot's, and a fit filters its prediction by them.
// What a channel beside them went through, and what the channels were called then, is no matter.
TEST(AverageShots, ComparesTheConditioningOfItsOwnChannels) {
  std::vector<Record> shots{shot(0, 2.0), shot(1, 2.0)};
  datasets::Edit before = low_passed("50000 Hz");
  before.channel = "ch 1";
  shots[0].provenance.edits = {before, {"map channel", "Force", {{"name in file", "ch 1"}}}};
  shots[1].provenance.edits = {{"remove baseline", "Mic", {}}, low_passed("50000 Hz")};
  const Record mean = average_shots(shots);
  EXPECT_THAT(mean.warnings, testing::IsEmpty());
  EXPECT_EQ(mean.channels[0].attributes.at("shots"), "2");
}

TEST(AverageShots, LeavesOutWhatIsConditionedOtherwise) {
  for (const std::size_t other : {std::size_t{0}, std::size_t{3}}) {
    std::vector<Record> shots;
    for (int k = 0; k < 4; ++k) {
      shots.push_back(shot(k, 2.0));
      shots.back().provenance.edits = {low_passed("50000 Hz"), {"map channel", "Force", {}}};
    }
    const std::string usual = other == 0 ? "shot1.csv" : "shot0.csv";
    const std::string file = "shot" + std::to_string(other) + ".csv is not in the mean: 'Force' ";
    shots[other].provenance.edits.erase(shots[other].provenance.edits.begin());
    EXPECT_THAT(average_shots(shots).warnings,
                testing::ElementsAre(file +
                                     "has not been through low-pass, zero phase (cutoff "
                                     "50000 Hz, order 4, forwards and backwards) in it, but "
                                     "in " +
                                     usual + "."));
    shots[other].provenance.edits = {low_passed("4000 Hz")};
    EXPECT_THAT(average_shots(shots).warnings,
                testing::ElementsAre(file +
                                     "has been through low-pass, zero phase (cutoff 4000 "
                                     "Hz, order 4, forwards and backwards) in it, and not "
                                     "in " +
                                     usual + "."));
    shots[other].provenance.edits = {low_passed("50000 Hz"), low_passed("50000 Hz")};
    EXPECT_EQ(average_shots(shots).channels[0].attributes.at("shots"), "3");
  }
  std::vector<Record> two{shot(0, 2.0), shot(1, 2.0)};
  two[1].provenance.edits = {low_passed("4000 Hz")};
  EXPECT_THROW(average_shots(two), datasets::InputError);
}

// A delay is taken off, or a dropout repaired, in the one shot that has it.
TEST(AverageShots, LetsShotsHaveDelaysAndDropoutsOfTheirOwn) {
  std::vector<Record> shots{shot(0, 2.0), shot(1, 2.0)};
  shots[1].provenance.edits = {{"repair dropouts", "Velocity", {{"samples", "5 bridged"}}},
                               {"align", "Velocity", {{"delay", "2e-06 s"}}}};
  const Record mean = average_shots(shots);
  EXPECT_THAT(mean.warnings, testing::IsEmpty());
  EXPECT_EQ(mean.provenance.edits[0].parameters.at("dropouts of 'Velocity'"), "5 bridged");
  EXPECT_EQ(mean.provenance.edits[0].parameters.at("delay taken off 'Velocity'"), "2e-06 s");
}

TEST(AverageShots, KeepsWhatIsSaidOfTheShots) {
  std::vector<Record> shots;
  for (int k = 0; k < 6; ++k) {
    shots.push_back(shot(k, 2.0));
    shots.back().warnings = {"Resampling takes " + std::to_string(k + 1) + ".5 % off."};
  }
  shots[4].warnings.push_back("Its clock was set.");
  EXPECT_THAT(average_shots(shots).warnings,
              testing::ElementsAre("shot0.csv: Resampling takes 1.5 % off. (Likewise shot1.csv, "
                                   "shot2.csv, shot3.csv and 2 more.)",
                                   "shot4.csv: Its clock was set."));
}

datasets::Channel single(const std::string& name, double value) {
  return channel_of(name, datasets::Quantity::other, {0.0, 0.0, 1}, {value});
}

// Settings beside the histories, as MAT-files hold them.
TEST(AverageShots, KeepsSingleValuesThatAreEqual) {
  std::vector<Record> shots;
  for (int k = 0; k < 3; ++k) {
    shots.push_back(shot(k, 2.0));
    shots.back().channels.push_back(single("Fs", 1e6));
    shots.back().channels.push_back(single("number", k));
    // Of the trigger's quantity, and before it.
    shots.back().channels.insert(shots.back().channels.begin(), single("largest", 5000.0));
    shots.back().channels.front().quantity = datasets::Quantity::force;
    shots.back().channels.front().unit = "N";
  }
  const Record mean = average_shots(shots);
  ASSERT_EQ(mean.channels.size(), 6U);
  EXPECT_EQ(mean.channels[0].name, "largest");
  EXPECT_EQ(mean.channels[5].name, "Fs");
  EXPECT_EQ(mean.channels[5].value(0), 1e6);
  EXPECT_THAT(mean.warnings,
              testing::ElementsAre("Channel 'number' is not in the mean: it is a single value a "
                                   "shot, from 0 to 2."));
}

TEST(AverageShots, LeavesOutChannelsThatHaveNoMean) {
  std::vector<Record> shots;
  for (int k = 0; k < 3; ++k) {
    shots.push_back(shot(k, 2.0));
    datasets::Channel uneven =
        channel_of("Temperature", datasets::Quantity::other, {0.0, 0.1, 3}, {20.0, 20.1, 20.2});
    uneven.clock.times = {0.0, 0.1, 0.25};
    datasets::Channel lost = shots.back().channels[1];
    lost.name = "Lost";
    if (k == 2) lost.valid.assign(lost.size(), 0);
    datasets::Channel later = shots.back().channels[1];
    later.name = "Later";
    later.clock.start += 1.0 * k;
    for (datasets::Channel* const channel : {&uneven, &lost, &later})
      shots.back().channels.push_back(std::move(*channel));
  }
  const Record mean = average_shots(shots);
  EXPECT_EQ(mean.channels.size(), 4U);
  EXPECT_THAT(
      mean.warnings,
      testing::ElementsAre(
          "Channel 'Temperature' is not in the mean: shot0.csv: channel 'Temperature' is sampled "
          "at uneven times (steps from 0.1 s to 0.15 s); resample it (step = \"resample\" in a map "
          "for `impactrig import`), or state the sample rate when importing.",
          "Channel 'Lost' is not in the mean: it has no sound sample in shot2.csv.",
          "Channel 'Later' is not in the mean: the shots have no time of it in common."));
}

// A laser without a signal, and other units: they went into the mean, the first without a word.
TEST(AverageShots, LeavesOutShotsThatAreFarOff) {
  const auto mean_with = [](std::size_t channel, double factor) {
    std::vector<Record> shots;
    for (int k = 0; k < 4; ++k) shots.push_back(shot(k, 2.0));
    datasets::Channel& off = shots[2].channels.at(channel);
    std::vector<double> values = off.values();
    for (double& value : values) value *= factor;
    off.raw = std::move(values);
    return average_shots(shots).warnings;
  };
  EXPECT_THAT(mean_with(1, 0.0), testing::ElementsAre("shot2.csv is not in the mean: its approach "
                                                      "velocity is not to be seen."));
  EXPECT_THAT(mean_with(1, 1e3), testing::ElementsAre(testing::HasSubstr(
                                     "its approach velocity is 1e+03 times that of the usual")));
  EXPECT_THAT(mean_with(0, 1e-3),
              testing::Contains(testing::HasSubstr("its peak is 0.001 times that of the usual")));
}

// Be it the first shot that lacks it.
TEST(AverageShots, NamesTheShotsThatLackAChannel) {
  for (const std::size_t without : {std::size_t{0}, std::size_t{2}}) {
    std::vector<Record> shots;
    for (int k = 0; k < 3; ++k) shots.push_back(shot(k, 2.0));
    shots[without].channels.pop_back();
    const Record mean = average_shots(shots);
    EXPECT_EQ(mean.channels.size(), 2U);
    EXPECT_THAT(mean.warnings,
                testing::ElementsAre("Channel 'Velocity' is not in the mean: it is not in shot" +
                                     std::to_string(without) + ".csv."));
  }
}

TEST(AverageShots, EndsBeforeASecondImpact) {
  const Sampling at{.start = -1e-3, .interval = 1e-6, .samples = 12000};
  Record bounced = shot(1, 2.0, 1.0, at);
  auto& force = std::get<std::vector<double>>(bounced.channels[0].raw);
  for (std::size_t i = 0; i < force.size(); ++i) force[i] += force_at(at.time(i) - 37.3e-6 - 7e-3);
  const Record mean = average_shots(std::vector<Record>{shot(0, 2.0, 1.0, at), bounced});
  const datasets::Channel& channel = mean.channels[0];
  EXPECT_NEAR(channel.clock.time(channel.size() - 1), 7e-3, 10e-6);
  for (std::size_t i = 2000; i < channel.size(); ++i) ASSERT_LT(channel.value(i), 12.0);
}

TEST(AverageShots, NeedsChannelsOfDifferentNames) {
  Record twice = shot(1, 2.0);
  twice.channels.push_back(twice.channels[0]);
  try {
    average_shots(std::vector<Record>{shot(0, 2.0), twice});
    FAIL();
  } catch (const datasets::InputError& error) {
    EXPECT_STREQ(error.what(),
                 "shot1.csv: has several channels named 'Force'; give each a name of its own in a "
                 "map (--map)");
  }
}

}  // namespace

}  // namespace impactrig::acquisition
