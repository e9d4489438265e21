// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "acquisition/importer.hpp"
#include "tests/acquisition/rigol_wfm_bytes.hpp"
#include "tests/acquisition/sound_channel.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using datasets::Record;
using testing::ElementsAre;
using testing::IsEmpty;
using tests::import_error;
using tests::imported;
using tests::part;
using tests::Rigol1000e;
using tests::Rigol1000z;
using tests::Rigol2000;
using tests::sound_channel;
using namespace std::string_view_literals;

TEST(Rigol1000zWfm, IsRead) {
  Rigol1000z file;
  file.delay = 1000000;  // 1 us
  const Record record = imported(file.bytes());
  const auto& channel = sound_channel(record, "rigol-wfm");
  EXPECT_EQ(channel.name, "CH 1");
  EXPECT_EQ(channel.unit, "V");
  // 20 counts a division of 2 V around 127, shifted by 3 V, a division up
  ASSERT_EQ(channel.size(), 4U);
  EXPECT_NEAR(channel.value(0), -1.0, 1e-12);
  EXPECT_NEAR(channel.value(1), 1.0, 1e-12);
  EXPECT_NEAR(channel.value(3), 5.0, 1e-12);
  EXPECT_TRUE(std::holds_alternative<std::vector<std::int16_t>>(channel.raw));
  EXPECT_EQ(channel.clock.interval, 4e-9);
  EXPECT_DOUBLE_EQ(channel.clock.start, 1e-6 - 8e-9);
  EXPECT_EQ(record.attributes.at("model"), "DS1054Z");
}

TEST(Rigol1000zWfm, InputsAlternate) {
  Rigol1000z file;
  file.scale = 20.0F;  // a volt a count
  file.shift = -107.0F;
  file.samples = {1, 2, 3, 4, 5, 6, 7, 8};
  file.depth = 8;
  const auto raw = [&](std::uint8_t enabled, std::size_t channel) {
    file.enabled = enabled;
    return std::get<std::vector<std::int16_t>>(imported(file.bytes()).channels.at(channel).raw);
  };
  EXPECT_THAT(raw(0b0101, 0), ElementsAre(2, 4, 6, 8));
  EXPECT_THAT(raw(0b0101, 1), ElementsAre(1, 3, 5, 7));
  EXPECT_THAT(raw(0b1011, 0), ElementsAre(4, 8));
  EXPECT_THAT(raw(0b1011, 2), ElementsAre(1, 5));
  EXPECT_THAT(raw(0b1111, 2), ElementsAre(2, 6));
}

TEST(Rigol1000zWfm, MayBeInvertedAndOfAnotherUnit) {
  Rigol1000z file;
  file.inverted = 1;
  file.unit = 1;
  const Record record = imported(file.bytes());
  EXPECT_EQ(record.channels.at(0).unit, "A");
  EXPECT_NEAR(record.channels.at(0).value(1), -7.0, 1e-12);
}

TEST(Rigol1000zWfm, OfFirmwareSP3HasAnotherZeroWithTwoInputs) {
  Rigol1000z file;
  file.firmware = "00.04.04.SP3";
  file.enabled = 3;
  file.shift = 0.0F;
  Record record = imported(file.bytes());
  EXPECT_NEAR(record.channels.at(1).value(0), 0.0, 1e-12);
  EXPECT_THAT(record.warnings,
              ElementsAre("the zero of firmware 00.04.04.SP3 with two inputs is known to one count "
                          "of the digitizer only"));
  file.shift = -2.0F;
  record = imported(file.bytes());
  EXPECT_NEAR(record.channels.at(1).value(0), 2.4, 1e-12);
}

TEST(Rigol1000zWfm, SaysWhatIsWrong) {
  Rigol1000z file;
  file.enabled = 0;
  EXPECT_EQ(import_error(file.bytes()),
            "FILE (byte 88): no analog input was switched on: digital inputs are not read, save "
            "them as CSV on the oscilloscope");
  file = {};
  file.logic = 1;
  EXPECT_THAT(imported(file.bytes()).warnings, ElementsAre("the digital inputs are not read"));
  const std::string whole = Rigol1000z{}.bytes();
  EXPECT_THAT(imported(whole.substr(0, 322)).warnings,
              ElementsAre("'CH 1': the file ends after 2 of 4 samples"));
  EXPECT_EQ(import_error(whole.substr(0, 320)),
            "FILE (byte 320): the file ends before its first sample");
  EXPECT_EQ(import_error(whole.substr(0, 100)), "FILE (byte 100): the file ends within the header");
  file = {};
  file.depth = 0xFFFFFFFF;
  EXPECT_THAT(imported(file.bytes()).warnings,
              ElementsAre("'CH 1': the file ends after 4 of 4294967295 samples"));
}

TEST(Rigol1000eWfm, IsRead) {
  Rigol1000e file;
  file.delay = 10000000;  // 10 us
  const Record record = imported(file.bytes());
  ASSERT_EQ(record.channels.size(), 2U);
  // 25 counts a volt, downwards from 125, shifted by 25 counts
  const auto values = record.channels[0].values();
  ASSERT_EQ(values.size(), 4U);
  EXPECT_NEAR(values[0], -1.0, 1e-12);
  EXPECT_NEAR(values[1], 0.0, 1e-12);
  EXPECT_NEAR(values[2], -2.0, 1e-12);
  EXPECT_NEAR(record.channels[1].value(1), 1.0, 1e-12);
  EXPECT_DOUBLE_EQ(record.channels[0].clock.start, 1e-5 - 2e-5);
  EXPECT_EQ(record.channels[0].clock.interval, 1e-5);
  EXPECT_EQ(record.channels[1].clock.interval, 1e-5);
  EXPECT_THAT(record.warnings, IsEmpty());
}

TEST(Rigol1000eWfm, WindowAndChannelAreThoseOfTheWhole) {
  const Record record = imported(Rigol1000e{}.bytes(), part(-1e-5, 0.0, {"CH 2"}));
  ASSERT_EQ(record.channels.size(), 1U);
  ASSERT_EQ(record.channels[0].size(), 2U);
  EXPECT_NEAR(record.channels[0].value(0), 1.0, 1e-12);
}

TEST(Rigol1000eWfm, InputsMayHaveTheirOwnDepthAndClock) {
  Rigol1000e file;
  file.samples[1] = {125, 75};
  file.depth2 = 2;
  file.trigger_mode = 4;
  file.probe = 10.0F;
  const Record record = imported(file.bytes());
  EXPECT_EQ(record.channels.at(1).size(), 2U);
  EXPECT_EQ(record.channels.at(1).clock.interval, 1e-6);
  EXPECT_NEAR(record.channels.at(1).value(1), 10.0, 1e-11);
}

TEST(Rigol1000eWfm, OfARollThatWasStoppedHasItsSoundSamples) {
  Rigol1000e file;
  file.roll_stop = 1;
  const Record record = imported(file.bytes());
  EXPECT_EQ(record.channels.at(0).size(), 1U);
  EXPECT_NEAR(record.channels.at(1).value(0), -1.0, 1e-12);
  EXPECT_EQ(record.warnings.at(0), "'CH 1': rolling was stopped: 1 of 4 samples are sound");
}

TEST(Rigol1000eWfm, SaysWhatIsWrong) {
  Rigol1000e file;
  file.enabled = {false, false};
  EXPECT_EQ(import_error(file.bytes()),
            "FILE (byte 49): no analog input was switched on: digital inputs are not read, save "
            "them as CSV on the oscilloscope");
  file = {};
  file.logic = 1;
  file.inverted = 1;
  const Record record = imported(file.bytes());
  EXPECT_THAT(record.warnings, ElementsAre("the digital inputs are not read"));
  EXPECT_EQ(record.channels.at(0).attributes.at("inverted"), "yes");
  const std::string whole = Rigol1000e{}.bytes();
  EXPECT_EQ(import_error(whole.substr(0, 276)),
            "FILE (byte 276): the file ends before its first sample");
  EXPECT_THAT(imported(whole.substr(0, 281)).warnings,
              ElementsAre("'CH 2': the file ends after 1 of 4 samples"));
  file = {};
  file.depth = 14;  // 256 + 28 bytes
  EXPECT_EQ(import_error(file.bytes()),
            "FILE (byte 0): this is a waveform of a Rigol DS1000C, which is not read: save it as "
            "CSV on the oscilloscope");
}

TEST(RigolWfm, OfOtherFamiliesIsNamed) {
  const auto says = [](const char* family, const char* instead = "CSV") {
    return fmt::format(
        "FILE (byte 0): this is a waveform of a Rigol {}, which is not read: save "
        "it as {} on the oscilloscope",
        family, instead);
  };
  EXPECT_EQ(import_error("\xA1\xA5\0\0more"sv), says("DS1000C"));
  EXPECT_EQ(import_error("\xA5\xA5\xA4\x01more"sv), says("DS1000B"));
  EXPECT_EQ(import_error("\xA5\xA5\x38\0more"sv), says("DS4000 or 6000"));
  EXPECT_EQ(import_error("\x02\0\0\0more"sv, {}, ".wfm"),
            says("DHO800, 900 or 1000", ".bin or CSV"));
  ImportOptions options;
  options.format = "rigol-wfm";
  EXPECT_EQ(import_error("nothing", options),
            "FILE (byte 0): this is no waveform of a Rigol oscilloscope");
}

TEST(Rigol2000Wfm, IsRead) {
  const Record record = imported(Rigol2000{}.bytes());
  ASSERT_EQ(record.channels.size(), 2U);
  const auto& channel = record.channels[0];
  EXPECT_EQ(channel.name, "CH 1");
  EXPECT_EQ(channel.unit, "V");
  // 25 counts a division of 50 mV around 127, shifted by 0.1 V
  ASSERT_EQ(channel.size(), 4U);
  EXPECT_NEAR(channel.value(0), -0.1, 1e-15);
  EXPECT_NEAR(channel.value(1), -0.05, 1e-15);
  EXPECT_NEAR(channel.value(2), -0.15, 1e-15);
  EXPECT_NEAR(record.channels[1].value(1), 0.0, 1e-15);
  EXPECT_EQ(channel.clock.interval, 1e-9);
  EXPECT_DOUBLE_EQ(channel.clock.start, 4.48e-6 - 2e-9);
  EXPECT_EQ(record.attributes.at("firmware"), "00.03.05.03.03");
  EXPECT_THAT(record.warnings, IsEmpty());
}

TEST(Rigol2000Wfm, OneInputMayHaveTheMemoryOfBoth) {
  Rigol2000 file;
  file.enabled = 2;
  file.interwoven = 1;
  file.samples = {{{9, 1, 3, 5, 7}, {9, 2, 4, 6, 8}}};
  file.points = 8;
  file.unsound = 1;
  const Record record = imported(file.bytes());
  ASSERT_EQ(record.channels.size(), 1U);
  EXPECT_EQ(record.channels[0].name, "CH 2");
  EXPECT_THAT(std::get<std::vector<std::int16_t>>(record.channels[0].raw),
              ElementsAre(1, 2, 3, 4, 5, 6, 7, 8));
  std::string cut = file.bytes();
  cut.pop_back();
  EXPECT_THAT(imported(cut).warnings, ElementsAre("'CH 2': the file ends after 6 of 8 samples"));
}

TEST(Rigol2000Wfm, OlderFirmwareHasUnitAndInversionTheOtherWayRound) {
  Rigol2000 file;
  file.inverted = 1;
  file.unit = 1;
  for (const std::uint8_t input : std::vector<std::uint8_t>{1, 8}) {
    file.input = input;
    const Record record = imported(file.bytes());
    EXPECT_EQ(record.channels.at(0).unit, "A");
    EXPECT_NEAR(record.channels[0].value(1), -0.15, 1e-15);
  }
  file.firmware = "00.03.00.01.03";
  EXPECT_THAT(imported(file.bytes()).warnings,
              ElementsAre("firmware 00.03.00.01.03 may state a time of the trigger that it does "
                          "not show: 4.48e-06 s"));
}

TEST(Rigol2000Wfm, ErrorsSayWhatWasFound) {
  Rigol2000 file;
  file.enabled = 0;
  EXPECT_EQ(import_error(file.bytes()),
            "FILE (byte 64): no analog input was switched on: digital inputs are not read, save "
            "them as CSV on the oscilloscope");
  file.enabled = 3;
  file.interwoven = 1;
  EXPECT_EQ(import_error(file.bytes()),
            "FILE (byte 65): two inputs are said to share the memory of both");
  file.enabled = 1;
  file.second = 300;
  EXPECT_EQ(import_error(file.bytes()),
            "FILE (byte 72): the second half of the samples precedes the first");
  file.interwoven = 0;
  EXPECT_EQ(import_error(file.bytes().substr(0, 300)),
            "FILE (byte 300): the file ends before its first sample");
}

}  // namespace
}  // namespace impactrig::acquisition
