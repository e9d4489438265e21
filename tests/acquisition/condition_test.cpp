// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/condition.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "datasets/input_error.hpp"
#include "tests/acquisition/scene.hpp"

namespace impactrig::acquisition {

namespace {

using datasets::Channel;
using datasets::Edit;
using datasets::Quantity;
using datasets::Record;
using datasets::Sensor;
using namespace tests;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

Channel channel_in(const std::string& name, Quantity quantity, const std::string& unit,
                   std::vector<double> values = {0.0, 1.0, 2.0}) {
  Channel channel = channel_of(name, quantity, {}, std::move(values));
  channel.unit = unit;
  return channel;
}

Sensor sensor_of(Quantity quantity, const std::string& channel = "") {
  Sensor sensor;
  sensor.quantity = quantity;
  sensor.channel = channel;
  return sensor;
}

/// In volts, 4 mV/N, 2 % uncertain.
Sensor force_in_volts(const std::string& channel = "") {
  Sensor sensor = sensor_of(Quantity::force, channel);
  sensor.sensitivity = {4e-3, 8e-5};
  sensor.recorded_unit = "V";
  return sensor;
}

const Edit* edit_of(const Record& record, const std::string& what) {
  const auto found = std::ranges::find(record.provenance.edits, what, &Edit::what);
  return found == record.provenance.edits.end() ? nullptr : &*found;
}

std::string message_of(const Record& record, const SensorSet& sensors) {
  try {
    condition(record, sensors);
  } catch (const datasets::InputError& error) {
    EXPECT_EQ(error.where().file, "shot.csv");
    return error.what();
  }
  return "no error";
}

TEST(Condition, ConvertsUnitsToSi) {
  const Record result = condition(record_of({channel_in("F", Quantity::force, "kN"),
                                             channel_in("v", Quantity::velocity, "mm/s"),
                                             channel_in("x", Quantity::displacement, "um")}),
                                  {.force = sensor_of(Quantity::force),
                                   .velocity = sensor_of(Quantity::velocity),
                                   .displacement = sensor_of(Quantity::displacement)});
  ASSERT_EQ(result.channels.size(), 3u);
  EXPECT_EQ(result.channels[0].unit, "N");
  EXPECT_EQ(result.channels[1].unit, "m/s");
  EXPECT_EQ(result.channels[2].unit, "m");
  EXPECT_DOUBLE_EQ(result.channels[0].value(2), 2000.0);
  EXPECT_DOUBLE_EQ(result.channels[1].value(2), 2e-3);
  EXPECT_DOUBLE_EQ(result.channels[2].value(2), 2e-6);
  const Edit* const edit = edit_of(result, "convert unit");
  ASSERT_NE(edit, nullptr);
  EXPECT_EQ(edit->channel, "F");
  EXPECT_EQ(edit->parameters.at("from"), "kN");
  EXPECT_EQ(edit->parameters.at("to"), "N");
  EXPECT_EQ(edit->parameters.at("factor"), "1000");
}

TEST(Condition, DividesByTheSensitivity) {
  const Record result = condition(record_of({channel_in("CH1", Quantity::voltage, "mV")}),
                                  {.force = force_in_volts("CH1")});
  ASSERT_EQ(result.channels.size(), 1u);
  EXPECT_NEAR(result.channels[0].value(2), 2e-3 / 4e-3, 1e-15);
  EXPECT_EQ(result.channels[0].quantity, Quantity::force);
  EXPECT_EQ(result.channels[0].unit, "N");
  EXPECT_EQ(result.channels[0].name, "CH1");
  const Edit* const edit = edit_of(result, "apply sensitivity");
  ASSERT_NE(edit, nullptr);
  EXPECT_EQ(edit->parameters.at("sensitivity"), "0.004 V/(N)");
  EXPECT_EQ(edit->parameters.at("recorded"), "mV");
}

TEST(Condition, HandlesPicocoulombs) {
  Sensor sensor = force_in_volts();
  sensor.sensitivity = {4.0, 0.0};
  sensor.recorded_unit = "pC";
  const Record result =
      condition(record_of({channel_in("Q", Quantity::charge, "pC")}), {.force = sensor});
  EXPECT_DOUBLE_EQ(result.channels[0].value(2), 0.5);
}

// Every step is affine, so the codes of the digitiser stay what they are.
TEST(Condition, KeepsRawCodes) {
  Channel channel = channel_in("CH1", Quantity::voltage, "V");
  channel.raw = std::vector<std::int16_t>{-100, 0, 32000};
  channel.scale = 1e-3;
  channel.offset = 0.5;
  Sensor sensor = force_in_volts("CH1");
  sensor.polarity = -1.0;
  const Record result = condition(record_of({channel}), {.force = sensor});
  EXPECT_EQ(std::get<std::vector<std::int16_t>>(result.channels[0].raw),
            (std::vector<std::int16_t>{-100, 0, 32000}));
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(result.channels[0].value(i), -channel.value(i) / 4e-3, 1e-9);
}

TEST(Condition, TurnsPolarityRound) {
  Sensor sensor = sensor_of(Quantity::velocity);
  sensor.polarity = -1.0;
  const Record result =
      condition(record_of({channel_in("v", Quantity::velocity, "m/s")}), {.velocity = sensor});
  EXPECT_EQ(result.channels[0].value(2), -2.0);
  EXPECT_EQ(edit_of(result, "apply polarity")->parameters.at("polarity"), "-1");
}

TEST(Condition, TakesTheKnownDelayOffTheClock) {
  Sensor sensor = sensor_of(Quantity::force);
  sensor.delay = {2e-6, 1e-7, false};
  const Record once =
      condition(record_of({channel_in("F", Quantity::force, "N")}), {.force = sensor});
  EXPECT_DOUBLE_EQ(once.channels[0].clock.start, -1e-3 - 2e-6);
  ASSERT_TRUE(once.channels[0].delay);
  EXPECT_TRUE(once.channels[0].delay->removed);
  EXPECT_EQ(once.channels[0].delay->value, 2e-6);
  EXPECT_EQ(once.channels[0].delay->uncertainty, 1e-7);
  EXPECT_EQ(edit_of(once, "remove delay")->parameters.at("delay"), "2e-06 s");
  const Record twice = condition(once, {.force = sensor});
  EXPECT_EQ(twice.channels[0].clock.start, once.channels[0].clock.start);
}

TEST(Condition, TakesTheRecordingsOwnDelayWhenTheSensorStatesNone) {
  Channel channel = channel_in("F", Quantity::force, "N");
  channel.delay = {5e-6, 0.0, false};
  const Record result = condition(record_of({channel}), {.force = sensor_of(Quantity::force)});
  EXPECT_DOUBLE_EQ(result.channels[0].clock.start, -1e-3 - 5e-6);
}

// A velocity that was aligned to the force's clock is as late as that is.
TEST(Condition, TakesADelayOffWhatWasAlignedToItsChannelToo) {
  Record record = record_of(
      {channel_in("F", Quantity::force, "N"), channel_in("v", Quantity::velocity, "m/s")});
  const double start = record.channels[0].clock.start;
  record.channels[1].delay = datasets::Delay{5e-6, 1e-7, true};
  record.provenance.edits = {{"align", "v", {{"reference", "F"}, {"delay", "5e-06 s"}}}};
  SensorSet sensors{.force = sensor_of(Quantity::force), .velocity = sensor_of(Quantity::velocity)};
  sensors.force->delay = {2e-6, 3e-7, false};
  sensors.velocity->delay = {4e-7, 1e-7, false};
  const Record result = condition(record, sensors);
  for (const Channel& channel : result.channels)
    EXPECT_NEAR(channel.clock.start, start - 2e-6, 1e-15) << channel.name;
  EXPECT_DOUBLE_EQ(result.channels[1].delay->value, 7e-6);
  EXPECT_DOUBLE_EQ(result.channels[1].delay->uncertainty, 1e-7);
  EXPECT_EQ(result.provenance.edits.back().parameters.at("with"), "F");
  record.provenance.edits[0].parameters.clear();  // as a file may have it
  EXPECT_NEAR(condition(record, sensors).channels[1].clock.start, start, 1e-15);
}

TEST(Condition, TellsOfAPolarityThatTwoPlacesState) {
  Record record = record_of(
      {channel_in("F", Quantity::force, "N"), channel_in("v", Quantity::velocity, "m/s")});
  record.provenance.edits = {{"map channel", "F", {{"polarity", "-1"}}}};
  Sensor force = sensor_of(Quantity::force), velocity = sensor_of(Quantity::velocity);
  EXPECT_THAT(condition(record, {.force = force}).warnings, testing::IsEmpty());
  force.polarity = velocity.polarity = -1.0;
  EXPECT_THAT(condition(record, {.force = force, .velocity = velocity}).warnings,
              testing::ElementsAre("Channel 'F' has been inverted by its map, and is again by "
                                   "sensors.force.polarity = -1, so that it is as recorded; state "
                                   "it in one place."));
}

TEST(Condition, TellsOfADelayThatTwoPlacesStateDifferently) {
  Channel channel = channel_in("F", Quantity::force, "N");
  channel.delay = {5e-6, 0.0, false};
  Sensor sensor = sensor_of(Quantity::force);
  sensor.delay = {0.0, 1e-6, false};
  const Record result = condition(record_of({channel}), {.force = sensor});
  EXPECT_EQ(result.channels[0].clock.start, -1e-3);
  EXPECT_THAT(result.warnings,
              testing::ElementsAre("Channel 'F' states a delay of 5e-06 s, but sensors.force.delay "
                                   "is 0 s, which is used; state it in one place."));
  sensor.delay.value = 5e-6;
  EXPECT_THAT(condition(record_of({channel}), {.force = sensor}).warnings, testing::IsEmpty());
}

TEST(Condition, TellsOfADelayThatItLeavesBesideOneThatIsOff) {
  Channel channel = channel_in("F", Quantity::force, "N");
  channel.delay = {5e-6, 0.0, true};
  Sensor sensor = sensor_of(Quantity::force);
  EXPECT_THAT(condition(record_of({channel}), {.force = sensor}).warnings, testing::IsEmpty());
  sensor.delay = {2e-6, 0.0, false};
  const Record result = condition(record_of({channel}), {.force = sensor});
  EXPECT_EQ(result.channels[0].clock.start, channel.clock.start);
  EXPECT_THAT(result.warnings,
              testing::ElementsAre("Channel 'F' has had a delay of 5e-06 s taken off, so "
                                   "sensors.force.delay, 2e-06 s, is not; state it in one place."));
}

TEST(Condition, CarriesTheCalibrationAndTheRange) {
  Sensor sensor = force_in_volts("CH1");
  sensor.range = 5000.0;
  const Record result =
      condition(record_of({channel_in("CH1", Quantity::voltage, "V")}), {.force = sensor});
  ASSERT_TRUE(result.channels[0].calibration);
  EXPECT_EQ(result.channels[0].calibration->sensitivity, 4e-3);
  EXPECT_EQ(result.channels[0].calibration->uncertainty, 8e-5);
  EXPECT_EQ(result.channels[0].calibration->recorded_unit, "V");
  EXPECT_EQ(result.channels[0].calibration->physical_unit, "N");
  EXPECT_EQ(result.channels[0].attributes.at("sensor.range"), "5000");
}

TEST(Condition, LeavesOutWhatNoSensorClaims) {
  const Record result = condition(
      record_of({channel_in("t", Quantity::time, "s"), channel_in("F", Quantity::force, "N"),
                 channel_in("T", Quantity::temperature, "K")}),
      {.force = sensor_of(Quantity::force)});
  ASSERT_EQ(result.channels.size(), 1u);
  EXPECT_EQ(edit_of(result, "leave out channels")->parameters.at("channels"), "'t', 'T'");
}

TEST(Condition, TakesWhatThereIsWithoutSensors) {
  const Record result = condition(
      record_of(
          {channel_in("t", Quantity::time, "s"), channel_in("a1", Quantity::acceleration, "g"),
           channel_in("a2", Quantity::acceleration, "g"), channel_in("F", Quantity::force, "kN")}),
      {});
  ASSERT_EQ(result.channels.size(), 3u);
  EXPECT_NEAR(result.channels[0].value(1), 9.80665, 1e-12);
  EXPECT_EQ(result.channels[2].value(1), 1000.0);
}

TEST(Condition, ChoosesByIndexAndWithoutRegardToCase) {
  const Record record = record_of(
      {channel_in("CH1", Quantity::voltage, "V"), channel_in("CH2", Quantity::voltage, "V")});
  EXPECT_EQ(condition(record, {.force = force_in_volts("1")}).channels[0].name, "CH2");
  EXPECT_EQ(condition(record, {.force = force_in_volts("ch1")}).channels[0].name, "CH1");
}

TEST(Condition, LeavesANamedChannelToTheSensorThatNamesIt) {
  Sensor velocity = force_in_volts();
  velocity.quantity = Quantity::velocity;
  const Record result = condition(record_of({channel_in("CH1", Quantity::voltage, "V"),
                                             channel_in("CH2", Quantity::voltage, "V")}),
                                  {.force = force_in_volts("CH1"), .velocity = velocity});
  ASSERT_EQ(result.channels.size(), 2u);
  EXPECT_EQ(result.channels[1].name, "CH2");
  EXPECT_EQ(result.channels[1].unit, "m/s");
}

TEST(Condition, BelievesARecordingThatIsInSiAlready) {
  const Record result =
      condition(record_of({channel_in("F", Quantity::force, "N")}), {.force = force_in_volts()});
  EXPECT_EQ(result.channels[0].value(2), 2.0);
  ASSERT_EQ(result.warnings.size(), 1u);
  EXPECT_EQ(result.warnings[0],
            "Channel 'F' is recorded in N already, so sensors.force.sensitivity is not applied.");
  // The same sensor is as uncertain whoever applied its sensitivity.
  EXPECT_EQ(result.channels[0].calibration->uncertainty, 8e-5);
}

TEST(Condition, TakesTheRecordedUnitFromTheSensitivityAndSaysSo) {
  const Record result = condition(record_of({channel_in("CH1", Quantity::unknown, "")}),
                                  {.force = force_in_volts("CH1")});
  EXPECT_DOUBLE_EQ(result.channels[0].value(2), 500.0);
  ASSERT_EQ(result.warnings.size(), 1u);
  EXPECT_EQ(result.warnings[0],
            "Channel 'CH1' states no unit; it is taken to be in V as sensors.force.sensitivity "
            "says.");
}

TEST(Condition, WarnsOfAVibrometerRangeWithLowCut) {
  Sensor sensor = sensor_of(Quantity::velocity);
  sensor.low_cut = {0.5, 1};
  const Record result =
      condition(record_of({channel_in("v", Quantity::velocity, "m/s")}), {.velocity = sensor});
  ASSERT_EQ(result.warnings.size(), 1u);
  EXPECT_EQ(result.warnings[0],
            "sensors.velocity.low_cut is 0.5 Hz: the constant approach speed does not reach the "
            "recording, so restitution cannot be read off as a ratio of plateaus; use a decoder "
            "range that goes down to 0 Hz.");
}

TEST(Condition, KeepsWhatElseTheRecordSays) {
  Record record = record_of({channel_in("F", Quantity::force, "N")});
  record.title = "shot 3";
  record.started = "2024-05-06T07:08:09Z";
  record.attributes["operator"] = "JS";
  record.provenance.edits.push_back({"cut", "", {}});
  const Record result = condition(record, {});
  EXPECT_EQ(result.title, "shot 3");
  EXPECT_EQ(result.started, "2024-05-06T07:08:09Z");
  EXPECT_EQ(result.attributes.at("operator"), "JS");
  EXPECT_EQ(result.provenance.edits.front().what, "cut");
}

TEST(Condition, AllowsDropoutsThatAreMarked) {
  Channel channel = channel_in("F", Quantity::force, "N", {1.0, nan, 3.0});
  channel.valid = {1, 0, 1};
  EXPECT_EQ(condition(record_of({channel}), {}).channels[0].valid, channel.valid);
}

// --- Errors -------------------------------------------------------------------------------------

TEST(Condition, RefusesAnAbsentChannel) {
  EXPECT_EQ(message_of(record_of({channel_in("Time", Quantity::time, "s"),
                                  channel_in("Vib", Quantity::velocity, "m/s")}),
                       {.force = sensor_of(Quantity::force, "Force")}),
            "shot.csv: there is no single channel 'Force', which sensors.force.channel names; the "
            "channels are: 0 'Time' [s], 1 'Vib' [m/s]");
}

TEST(Condition, RefusesARecordingWithoutAForce) {
  EXPECT_EQ(message_of(record_of({channel_in("Vib", Quantity::velocity, "m/s")}),
                       {.force = sensor_of(Quantity::force)}),
            "shot.csv: there is no force among the channels (0 'Vib' [m/s]); choose one with "
            "sensors.force.channel, or take [sensors.force] out of the rig file");
  EXPECT_EQ(message_of(record_of({}), {.force = sensor_of(Quantity::force)}),
            "shot.csv: there is no force among the channels (none); choose one with "
            "sensors.force.channel, or take [sensors.force] out of the rig file");
}

TEST(Condition, RefusesToChooseAmongSeveral) {
  EXPECT_EQ(message_of(record_of({channel_in("F1", Quantity::force, "N"),
                                  channel_in("F2", Quantity::force, "N"),
                                  channel_in("F3", Quantity::force, "kN")}),
                       {.force = sensor_of(Quantity::force)}),
            "shot.csv: channels 'F1', 'F2' and 'F3' can all be the force; choose one with "
            "sensors.force.channel");
}

TEST(Condition, RefusesAnotherQuantity) {
  EXPECT_EQ(message_of(record_of({channel_in("Acc", Quantity::acceleration, "m/s2")}),
                       {.force = sensor_of(Quantity::force, "Acc")}),
            "shot.csv: channel 'Acc' is in m/s2, which is no force; state "
            "sensors.force.sensitivity or choose another channel with sensors.force.channel");
}

TEST(Condition, RefusesASensitivityForAnotherUnit) {
  EXPECT_EQ(message_of(record_of({channel_in("Acc", Quantity::acceleration, "m/s2")}),
                       {.force = force_in_volts("Acc")}),
            "shot.csv: channel 'Acc' is in m/s2, but sensors.force.sensitivity is for a recording "
            "in V; correct the sensitivity or choose another channel with sensors.force.channel");
}

TEST(Condition, RefusesAChannelWithoutUnit) {
  EXPECT_EQ(message_of(record_of({channel_in("CH1", Quantity::unknown, "")}),
                       {.force = sensor_of(Quantity::force, "CH1")}),
            "shot.csv: channel 'CH1' states no unit; state sensors.force.sensitivity or choose "
            "another channel with sensors.force.channel, or state its unit when importing");
}

TEST(Condition, RefusesASensitivityOfZero) {
  Sensor sensor = force_in_volts("CH1");
  sensor.sensitivity = {0.0, 0.0};
  EXPECT_EQ(message_of(record_of({channel_in("CH1", Quantity::voltage, "V")}), {.force = sensor}),
            "shot.csv: sensors.force.sensitivity is 0 V/(N), which turns every sample of channel "
            "'CH1' into nothing; state the calibrated value");
}

TEST(Condition, RefusesSamplesThatAreNotFinite) {
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(
      message_of(
          record_of({channel_in("F", Quantity::force, "N", {1.0, 2.0, nan, infinity, -infinity})}),
          {}),
      "shot.csv: channel 'F' has 3 samples that are not finite, the first is sample 2 at "
      "-0.000998 s; mark them invalid or cut them out");
  EXPECT_EQ(message_of(record_of({channel_in("F", Quantity::force, "N", {nan, 2.0})}), {}),
            "shot.csv: channel 'F' has 1 sample that is not finite, the first is sample 0 at "
            "-0.001 s; mark them invalid or cut them out");
}

TEST(Condition, RefusesAClockThatIsNotUniform) {
  Channel channel = channel_in("F", Quantity::force, "N");
  channel.clock.times = {0.0, 1e-6, 4e-6};
  channel.clock.interval = 2e-6;
  EXPECT_EQ(
      message_of(record_of({channel}), {}),
      "shot.csv: channel 'F' is sampled at uneven times (steps from 1e-06 s to 3e-06 s); "
      "resample it (step = \"resample\" in a map for `impactrig import`), or state the sample "
      "rate when importing");
}

TEST(Condition, RefusesAClockWithoutStep) {
  Channel channel = channel_in("F", Quantity::force, "N");
  channel.clock.interval = 0.0;
  EXPECT_EQ(message_of(record_of({channel}), {}),
            "shot.csv: channel 'F' has a sample interval of 0 s; state the sample rate when "
            "importing");
}

TEST(Condition, RefusesASpectrum) {
  Channel channel = channel_in("F", Quantity::force, "N");
  channel.imaginary = {0.0, 0.0, 0.0};
  EXPECT_EQ(message_of(record_of({channel}), {}),
            "shot.csv: channel 'F' holds complex numbers, so it is a spectrum; choose a channel "
            "that is a time history");
}

TEST(Condition, RefusesAnEmptyChannelThatIsNamed) {
  const Record record = record_of({channel_in("F", Quantity::force, "N", {})});
  EXPECT_EQ(message_of(record, {.force = sensor_of(Quantity::force, "F")}),
            "shot.csv: channel 'F' has no samples; choose another channel");
}

TEST(Condition, PassesByEmptyChannelsAndSpectra) {
  Channel spectrum = channel_in("S", Quantity::force, "N");
  spectrum.attributes["domain"] = "frequency";
  const Record record = record_of(
      {channel_in("E", Quantity::force, "N", {}), spectrum, channel_in("F", Quantity::force, "N")});
  for (const SensorSet& sensors : {SensorSet{}, SensorSet{.force = sensor_of(Quantity::force)}}) {
    const Record result = condition(record, sensors);
    ASSERT_EQ(result.channels.size(), 1u);
    EXPECT_EQ(result.channels[0].name, "F");
  }
}

TEST(Condition, RefusesTwoSensorsOnOneChannel) {
  Sensor velocity = force_in_volts("0");
  velocity.quantity = Quantity::velocity;
  EXPECT_EQ(message_of(record_of({channel_in("CH1", Quantity::voltage, "V")}),
                       {.force = force_in_volts("CH1"), .velocity = velocity}),
            "shot.csv: channel 'CH1' is claimed by both sensors.force and sensors.velocity; "
            "choose another with sensors.velocity.channel");
}

TEST(Condition, RefusesARecordingOfNothingKnown) {
  EXPECT_EQ(message_of(record_of({channel_in("U", Quantity::voltage, "V")}), {}),
            "shot.csv: there is no force, velocity, displacement or acceleration among the "
            "channels (0 'U' [V]); describe them in a rig file under [sensors.force] and "
            "[sensors.velocity]");
}

}  // namespace

}  // namespace impactrig::acquisition
