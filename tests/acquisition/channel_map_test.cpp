// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/channel_map.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "acquisition/importers/full_scale.hpp"
#include "datasets/input_error.hpp"

namespace impactrig::acquisition {
namespace {

using datasets::Channel;
using datasets::Quantity;
using datasets::Record;

Record recording() {
  Record record;
  record.provenance.source_file = "shot.wav";
  record.channels.resize(3);
  const char* names[] = {"ch1", "ch2", "Temp"};
  for (std::size_t i = 0; i < 3; ++i) {
    record.channels[i].name = names[i];
    record.channels[i].clock = {0.0, 1e-3, {}};
    record.channels[i].raw = std::vector<std::int16_t>{100, -200};
    record.channels[i].scale = 1e-3;
  }
  record.channels[1].unit = "mV";
  record.channels[2].unit = "degC";
  record.channels[2].quantity = Quantity::temperature;
  return record;
}

Record read(const ChannelMap& map, const Selection& wanted = {}) {
  const auto reader = mapped(reader_of(recording()), map);
  return read_into_memory(*reader, wanted);
}

std::string refused(const ChannelMap& map) {
  try {
    read(map);
  } catch (const datasets::InputError& error) {
    return error.what();
  }
  return {};
}

ChannelMapping matching(const std::string& match) {
  ChannelMapping mapping;
  mapping.match = match;
  return mapping;
}

TEST(Pattern, StarsStandForAnyCharactersAndMarksForOne) {
  EXPECT_TRUE(matches_pattern("Force 1", "Force*"));
  EXPECT_TRUE(matches_pattern("Force 1", "*1"));
  EXPECT_TRUE(matches_pattern("Force 1", "F*e ?"));
  EXPECT_TRUE(matches_pattern("aab", "*ab"));
  EXPECT_TRUE(matches_pattern("", "*"));
  EXPECT_FALSE(matches_pattern("Force 12", "Force ?"));
  EXPECT_FALSE(matches_pattern("force", "Force"));
  EXPECT_FALSE(matches_pattern("", "?"));
}

TEST(Pattern, CountsCharactersNotBytes) {
  EXPECT_TRUE(matches_pattern("Weg \xC3\xA4", "Weg ?"));
  EXPECT_TRUE(matches_pattern("\xE5\x8A\x9B 1", "? ?"));
  EXPECT_TRUE(
      matches_pattern("\xC2\xB5"
                      "e 12",
                      "*?2"));
  EXPECT_FALSE(matches_pattern("Weg \xC3\xA4", "Weg ??"));
  EXPECT_FALSE(matches_pattern("\xC3\xA4", "*??"));
}

TEST(ChannelMap, MakesVoltsAForceWithoutTouchingSamples) {
  ChannelMapping force = matching("ch2");
  force.name = "Force";
  force.role = Quantity::force;
  force.sensitivity = datasets::UncertainValue{4e-3, 1e-5};
  force.recorded_unit = "V";
  force.polarity = -1.0;
  force.position = 0.69;
  force.delay = datasets::Delay{2e-6, 1e-7, false};
  const Record record = read({"map.toml", false, {force}});
  ASSERT_EQ(record.channels.size(), 1U);
  const Channel& channel = record.channels[0];
  EXPECT_EQ(channel.name, "Force");
  EXPECT_EQ(channel.unit, "N");
  EXPECT_EQ(channel.quantity, Quantity::force);
  EXPECT_EQ(std::get<std::vector<std::int16_t>>(channel.raw)[0], 100);
  // 100 counts of 1 uV are 0.1 mV; 4 mV/N, inverted
  EXPECT_DOUBLE_EQ(channel.value(0), -0.025);
  EXPECT_EQ(channel.calibration->uncertainty, 1e-5);
  EXPECT_EQ(channel.delay->value, 2e-6);
  EXPECT_EQ(channel.attributes.at("position"), "0.69 m");
  ASSERT_EQ(record.provenance.edits.size(), 1U);
  using testing::Pair;
  EXPECT_THAT(record.provenance.edits[0].parameters,
              testing::ElementsAre(
                  Pair("delay", "2e-06 s, uncertain by 1e-07 s"), Pair("map", "map.toml"),
                  Pair("name in file", "ch2"), Pair("polarity", "-1"), Pair("position", "0.69 m"),
                  Pair("role", "force"), Pair("sensitivity", "0.004 V/(N), uncertain by 1e-05")));
}

TEST(ChannelMap, OrdersChannelsAndKeepsOthersWhenAsked) {
  ChannelMapping temperature;
  temperature.index = 2;
  const auto names = [](const Record& record) {
    std::vector<std::string> list;
    for (const Channel& channel : record.channels) list.push_back(channel.name);
    return list;
  };
  EXPECT_THAT(names(read({"m", false, {temperature, matching("ch?")}})),
              testing::ElementsAre("Temp", "ch1", "ch2"));
  EXPECT_THAT(names(read({"m", true, {temperature}})), testing::ElementsAre("Temp", "ch1", "ch2"));
  Selection second;
  second.channels = {1};
  EXPECT_THAT(names(read({"m", true, {temperature}}, second)), testing::ElementsAre("ch1"));
}

TEST(ChannelMap, ExchangesNamesAtOnce) {
  ChannelMap map;
  map.channels = {matching("ch1"), matching("Temp")};
  map.channels[0].name = "Temp";
  map.channels[1].name = "ch1";
  for (ChannelMapping& mapping : map.channels) mapping.polarity = -1.0;
  const Record record = read(map);
  EXPECT_THAT(record.warnings, testing::IsEmpty());
  for (const Channel& channel : record.channels) {
    const std::vector<const datasets::Edit*> edits = edits_of(record, channel);
    ASSERT_EQ(edits.size(), channel.name == "ch2" ? 0U : 1U) << channel.name;
    for (const datasets::Edit* const edit : edits) EXPECT_EQ(edit->channel, channel.name);
  }
}

TEST(ChannelMap, WarnsWhereItInvertsWhatAMapHasInverted) {
  ChannelMap map;
  map.file = "m.toml";
  map.channels = {matching("ch1")};
  map.channels[0].polarity = -1.0;
  const Record once = read(map);
  EXPECT_THAT(once.warnings, testing::IsEmpty());
  const auto again = mapped(reader_of(Record(once)), map);
  EXPECT_THAT(read_into_memory(*again, {}).warnings,
              testing::ElementsAre("'ch1' has been inverted by a map before and is again by "
                                   "m.toml, so that it is as recorded: state it once"));
}

TEST(ChannelMap, RefusesWhatDoesNotFit) {
  EXPECT_EQ(refused({"map.toml", false, {matching("Force")}}),
            "map.toml: no channel of shot.wav matches 'Force'; the channels are 'ch1', 'ch2', "
            "'Temp'");
  ChannelMapping several = matching("ch*");
  several.name = "Force";
  EXPECT_EQ(refused({"map.toml", false, {several}}),
            "map.toml: 'ch*' matches 2 channels, which cannot all be called 'Force' (index = picks "
            "one)");
  EXPECT_EQ(refused({"map.toml", false, {matching("*"), matching("ch1")}}),
            "map.toml: 'ch1' matches only what an entry above it took: put it first");
  ChannelMapping scaled = matching("ch2");
  scaled.unit = "V";
  scaled.full_scale = 10.0;
  EXPECT_EQ(refused({"map.toml", false, {scaled}}),
            "map.toml: 'ch2' is recorded in 'mV', not in parts of full scale: leave full_scale "
            "away");
  ChannelMapping force = matching("ch2");
  force.role = Quantity::force;
  EXPECT_EQ(refused({"map.toml", false, {force}}),
            "map.toml: 'ch2' is recorded in 'mV': as force it needs a sensitivity, for example "
            "sensitivity = \"2.25 mV/N\"");
  force.line = 7;
  force.unit = "kg";
  EXPECT_EQ(refused({"map.toml", false, {force}}),
            "map.toml:7: 'ch2' is recorded in 'kg', a mass: as force it needs unit = \"kgf\"");
  force.unit = "counts";
  EXPECT_EQ(refused({"map.toml", false, {force}}),
            "map.toml:7: 'ch2' is recorded in 'counts', which is no unit of force: state what its "
            "numbers are in, for example unit = \"N\", or unit = \"V\" with a sensitivity");
  force.line = 0;
  force.unit = "pC";
  EXPECT_EQ(refused({"map.toml", false, {force}}),
            "map.toml: 'ch2' is recorded in 'pC': as force it needs a sensitivity, for example "
            "sensitivity = \"4 pC/N\"");
  force.unit = "";
  force.match = "ch1";
  EXPECT_EQ(refused({"map.toml", false, {force}}),
            "map.toml: 'ch1' states no unit: as force it needs one, for example unit = \"N\"");
  force.sensitivity = datasets::UncertainValue{4.0, 0.0};
  force.recorded_unit = "pC";
  force.match = "ch2";
  EXPECT_EQ(refused({"map.toml", false, {force}}),
            "map.toml: 'ch2' is recorded in 'mV', its sensitivity is in pC a unit: state the "
            "recorded unit, for example unit = \"pC\"");
  force.recorded_unit = "V";
  force.sensitivity = datasets::UncertainValue{1e-320, 0.0};
  EXPECT_EQ(refused({"map.toml", false, {force}}),
            "map.toml: 'ch2' would be scaled by inf: look at its sensitivity and full scale");
  ChannelMapping twin = matching("ch1");
  twin.name = "Temp";
  EXPECT_EQ(refused({"map.toml", true, {matching("Temp"), twin}}),
            "map.toml: two channels would be called 'Temp'");
  // whichever of them is renamed
  EXPECT_EQ(refused({"map.toml", true, {twin, matching("Temp")}}),
            "map.toml: two channels would be called 'Temp'");
  ChannelMapping beyond;
  beyond.index = 7;
  EXPECT_EQ(refused({"map.toml", false, {beyond}}),
            "map.toml: no channel of shot.wav matches index 7; the channels are 'ch1', 'ch2', "
            "'Temp'");
}

TEST(ChannelMap, KnowsWhatFullScaleIs) {
  ChannelMapping force = matching("ch1");
  force.unit = "V";
  force.full_scale = 10.0;
  force.role = Quantity::force;
  force.sensitivity = datasets::UncertainValue{0.1, 0.0};
  force.recorded_unit = "V";
  const Record record = read({"m", false, {force}});
  EXPECT_DOUBLE_EQ(record.channels.at(0).value(0), 10.0);  // 0.1 of 10 V by 0.1 V/N
  EXPECT_EQ(record.provenance.edits.at(0).parameters.at("full scale"), "10 V");
}

TEST(ChannelMap, AnswersTheWarningOfFullScale) {
  RecordingHead sound;
  add_full_scale_channels(sound, "a WAVE file", 2, 2, 1e-3, 1.0);
  for (Channel& channel : sound.record.channels) channel.raw = std::vector<std::int16_t>{1, 2};
  const auto warnings = [&](const char* match) {
    ChannelMapping volts = matching(match);
    volts.full_scale = 10.0;
    volts.unit = "V";
    ChannelMap map{"m", true, {volts}};
    const auto reader = mapped(reader_of(sound.record), map);
    EXPECT_EQ(reader->head().record.warnings.size(), read_into_memory(*reader, {}).warnings.size());
    return reader->head().record.warnings.size();
  };
  EXPECT_EQ(warnings("ch1"), 1U);  // the other one's is not known
  EXPECT_EQ(warnings("ch*"), 0U);
}

TEST(ChannelMap, TakesAStatedUnitInPlaceOfTheFiles) {
  ChannelMapping velocity = matching("ch1");
  velocity.unit = "mm/s";
  velocity.role = Quantity::velocity;
  const Channel channel = read({"m", false, {velocity}}).channels.at(0);
  EXPECT_EQ(channel.unit, "mm/s");
  EXPECT_EQ(channel.quantity, Quantity::velocity);
  EXPECT_DOUBLE_EQ(channel.value(0), 0.1);
}

TEST(SuggestedMap, LeavesOutWhatIsOneValueBesideSamples) {
  Record record = recording();
  record.channels[0].name = "Fs";
  record.channels[0].raw = std::vector<double>{1e6};
  const std::string draft = suggested_map(record);
  EXPECT_THAT(draft, testing::HasSubstr("# 'Fs' is one value, no channel\n"));
  EXPECT_THAT(draft, testing::Not(testing::HasSubstr("match = \"Fs\"")));
  EXPECT_THAT(draft, testing::HasSubstr("match = \"ch2\""));
  for (Channel& channel : record.channels) channel.raw = std::vector<double>{1.0};
  EXPECT_THAT(suggested_map(record), testing::HasSubstr("match = \"Fs\""));
}

}  // namespace
}  // namespace impactrig::acquisition
