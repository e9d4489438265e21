// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <limits>

#include "acquisition/importer.hpp"
#include "tests/acquisition/sound_channel.hpp"
#include "tests/acquisition/tek_wfm_bytes.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using datasets::Quantity;
using datasets::Record;
using testing::ElementsAre;
using tests::expect_head;
using tests::import_error;
using tests::imported;
using tests::part;
using tests::sound_channel;
using tests::TekWfm;

TEST(TekWfm, IsReadInEveryVersionAndByteOrder) {
  for (const int version : {1, 2, 3})
    for (const bool big_endian : {false, true}) {
      SCOPED_TRACE(fmt::format("version {}, big-endian {}", version, big_endian));
      TekWfm file;
      file.version = version;
      file.big_endian = big_endian;
      const Record record = imported(file.bytes());
      const auto& channel = sound_channel(record, "tek-wfm");
      expect_head(channel, "waveform", "V", -2e-6, 1e-6);
      EXPECT_EQ(channel.quantity, Quantity::voltage);
      EXPECT_EQ(std::get<std::vector<std::int16_t>>(channel.raw),
                (std::vector<std::int16_t>{2, -4, 6}));
      EXPECT_THAT(channel.values(), ElementsAre(2.0, -1.0, 4.0));
      EXPECT_EQ(record.started, "2022-04-12T11:31:47.25Z");
      EXPECT_EQ(record.attributes.at("version"), fmt::format("WFM#00{}", version));
    }
}

TEST(TekWfm, HasNumbersOfEveryKind) {
  const std::vector<std::uint8_t> widths = {2, 4, 4, 8, 4, 8, 1, 1};
  for (std::int32_t format = 0; format < 8; ++format)
    for (const bool big_endian : {false, true}) {
      SCOPED_TRACE(format);
      TekWfm file;
      file.format = format;
      file.width = widths[static_cast<std::size_t>(format)];
      file.big_endian = big_endian;
      file.frames = {{1, 100, 7}};
      EXPECT_THAT(imported(file.bytes()).channels.at(0).values(), ElementsAre(1.5, 51.0, 4.5));
    }
}

TEST(TekWfm, FramesAreChannelsWithTheirOwnTrigger) {
  TekWfm file;
  file.label = "hammer";
  file.frames = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}};
  const Record record = imported(file.bytes());
  ASSERT_EQ(record.channels.size(), 3U);
  EXPECT_EQ(record.channels[2].name, "hammer, frame 3");
  EXPECT_THAT(record.channels[2].values(), ElementsAre(4.5, 5.0, 5.5));
  EXPECT_EQ(record.channels[0].attributes.at("trigger time"), "2022-04-12T11:31:47.25Z");
  EXPECT_EQ(record.channels[2].attributes.at("trigger time"), "2022-04-12T11:31:49.25Z");
  EXPECT_EQ(record.channels[0].attributes.at("trigger to next sample"), "0.5 samples");
  EXPECT_EQ(record.channels[2].attributes.at("trigger to next sample"), "0.125 samples");
  EXPECT_THAT(record.warnings,
              ElementsAre("this is a FastFrame sequence of 3 frames: each is a channel, with the "
                          "time from its own trigger to within a sample: what is left "
                          "stands in each channel's 'trigger to next sample'"));
}

TEST(TekWfm, SummaryFrameIsNoMeasurement) {
  for (const int version : {1, 2, 3})
    for (const std::uint16_t summary : std::vector<std::uint16_t>{1, 2}) {
      TekWfm file;
      file.version = version;
      file.summary = summary;
      file.frames = {{1, 2, 3}, {3, 4, 5}, {2, 3, 4}};
      const Record record = imported(file.bytes());
      ASSERT_EQ(record.channels.size(), 3U);
      EXPECT_EQ(record.channels[1].name, "waveform, frame 2");
      const std::string kind = summary == 1 ? "average" : "envelope";
      EXPECT_EQ(record.channels[2].name,
                version == 1 ? "waveform, frame 3" : "waveform, " + kind + " of the frames");
      const std::string told =
          "the last frame is no measurement but the " + kind + " of those before it";
      EXPECT_EQ(std::ranges::count(record.warnings, told), version == 1 ? 0 : 1);
    }
}

TEST(TekWfm, WindowAndChannelsAreThoseOfTheWhole) {
  TekWfm file;
  file.frames = {{1, 2, 3, 4, 5}, {6, 7, 8, 9, 10}};
  const Record record = imported(file.bytes(), part(-1.2e-6, 1e-6, {"1"}));
  ASSERT_EQ(record.channels.size(), 1U);
  EXPECT_THAT(record.channels[0].values(), ElementsAre(4.5, 5.0, 5.5));
  EXPECT_DOUBLE_EQ(record.channels[0].clock.start, -1e-6);
}

TEST(TekWfm, KeepsWhatStandsBehindTheSamples) {
  TekWfm file;
  file.meta = {{"probe", "P6139"}, {"picture", std::string(300, 'x')}};
  const Record record = imported(file.bytes());
  EXPECT_EQ(record.attributes.at("probe"), "P6139");
  EXPECT_EQ(record.attributes.count("picture"), 0U);
  EXPECT_EQ(imported(file.bytes().substr(0, file.bytes().size() - 310)).channels[0].size(), 3U);
}

TEST(TekWfm, OverFrequencyIsNoTimeRecord) {
  TekWfm file;
  file.x_unit = "Hz";
  const Record record = imported(file.bytes());
  EXPECT_EQ(record.channels[0].attributes.at("domain"), "frequency");
  EXPECT_EQ(record.channels[0].clock.interval, 0.0);
}

TEST(TekWfm, ThatIsCutOffGivesWhatIsThere) {
  TekWfm file;
  file.frames = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}};
  const std::string whole = file.bytes();
  const std::size_t frame = 10;  // bytes
  const std::size_t samples = whole.size() - 3 * frame;
  Record record = imported(whole.substr(0, samples + frame + 6));
  ASSERT_EQ(record.channels.size(), 2U);
  EXPECT_EQ(record.channels[1].size(), 2U);
  EXPECT_THAT(record.warnings,
              testing::Contains("'waveform, frame 2': the file ends after 2 of 3 samples"));
  EXPECT_THAT(record.warnings, testing::Contains("the file ends before frame 3 of 3"));
  EXPECT_EQ(import_error(whole.substr(0, samples + 2)),
            fmt::format("FILE (byte {}): the file ends before its first sample", samples + 2));
  EXPECT_EQ(import_error(whole.substr(0, 500)),
            "FILE (byte 500): the file ends within its header of 838 bytes");
}

struct Refused {
  const char* name;
  void (*change)(TekWfm&);
  const char* error;
};

class TekWfmError : public testing::TestWithParam<Refused> {};

TEST_P(TekWfmError, SaysWhatIsWrong) {
  TekWfm file;
  GetParam().change(file);
  EXPECT_EQ(import_error(file.bytes()), GetParam().error);
}

INSTANTIATE_TEST_SUITE_P(
    All, TekWfmError,
    testing::Values(
        Refused{"version", [](TekWfm& file) { file.version = 4; },
                "FILE (byte 2): expected ':WFM#001', ':WFM#002' or ':WFM#003', found ':WFM#004': "
                "save it as CSV on the oscilloscope"},
        Refused{"dataType", [](TekWfm& file) { file.data_type = 6; },
                "FILE (byte 122): this waveform file holds logic data (data type 6), which is not "
                "read: save it as CSV on the oscilloscope"},
        Refused{"unknownDataType", [](TekWfm& file) { file.data_type = -7; },
                "FILE (byte 122): this waveform file holds unknown data (data type -7), which is "
                "not read: save it as CSV on the oscilloscope"},
        Refused{"phase", [](TekWfm& file) { file.time_base = 2; },
                "FILE (byte 768): this waveform is the phase of a spectrum, which is not read: "
                "save it as CSV on the oscilloscope"},
        Refused{"format", [](TekWfm& file) { file.format = 9; },
                "FILE (byte 240): samples of format 9 are not read in version 3: expected 0 to 7"},
        Refused{"bytesInVersion2",
                [](TekWfm& file) {
                  file.version = 2;
                  file.format = 6;
                },
                "FILE (byte 240): samples of format 6 are not read in version 2: expected 0 to 5"},
        Refused{"width", [](TekWfm& file) { file.width = 3; },
                "FILE (byte 15): the header states 3 bytes a point, its format 0 has 2"},
        Refused{"pairs", [](TekWfm& file) { file.storage = 1; },
                "FILE (byte 244): the samples are not stored one by one but as pairs of minimum "
                "and maximum (storage type 1), which is not read: save it as CSV on the "
                "oscilloscope"},
        Refused{"iq",
                [](TekWfm& file) {
                  file.meta = {{"IQ_span", "1"}};
                },
                "FILE (byte 838): this is an IQ waveform (two numbers a sample), which is not "
                "read: save it as CSV on the oscilloscope"},
        Refused{"scale", [](TekWfm& file) { file.scale = std::numeric_limits<double>::infinity(); },
                "FILE (byte 168): 'waveform': scale inf and offset 1 are no numbers to scale "
                "samples by"}),
    [](const auto& instance) { return instance.param.name; });

TEST(TekWfm, WithoutAScaleIsReadAsStored) {
  TekWfm file;
  file.scale = 0.0;
  const Record record = imported(file.bytes());
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(2.0, -4.0, 6.0));
  EXPECT_EQ(record.channels[0].unit, "");
  EXPECT_EQ(record.channels[0].quantity, Quantity::unknown);
  EXPECT_THAT(record.warnings,
              ElementsAre("'waveform': the header states a scale of 0: its numbers are as they are "
                          "stored, without a unit"));
}

TEST(TekWfm, WithoutSamplesIsTold) {
  TekWfm file;
  file.frames = {{}};
  const Record record = imported(file.bytes());
  EXPECT_EQ(record.channels.at(0).size(), 0U);
  EXPECT_THAT(record.warnings,
              ElementsAre("'waveform': the header says that there are no samples"));
}

TEST(TekWfm, WhosePlacesLieIsAnError) {
  TekWfm file;
  const std::string sound = file.bytes();
  const auto with = [&](std::size_t place, std::uint32_t value) {
    std::string bytes = sound;
    for (int i = 0; i < 4; ++i)
      bytes[place + static_cast<std::size_t>(i)] = static_cast<char>(value >> (8 * i) & 0xFF);
    return bytes;
  };
  EXPECT_EQ(import_error("\x0F\xF0" + sound.substr(2)),
            "FILE (byte 0): expected the byte order 0F0F or F0F0, found 0FF0");
  EXPECT_EQ(import_error("LLWFM " + sound),
            "FILE (byte 0): this is a Tektronix waveform of the older kind (LLWFM), which is not "
            "read: save it as CSV on the oscilloscope");
  EXPECT_EQ(import_error(with(16, 0xFFFFFFFF)),
            "FILE (byte 16): the samples are said to begin at byte -1, within the header");
  EXPECT_EQ(import_error(with(826, 0)),
            "FILE (byte 826): the samples are said to end at 0, before they begin at 2");
  EXPECT_EQ(import_error(with(72, 0xFFFFFFFF)),
            "FILE (byte 72): this is a FastFrame sequence of 4294967296 frames, at most 10000 are "
            "read: save it in parts");
  std::string frames = with(72, 1);
  frames.replace(830, 4, std::string(4, '\0'));
  EXPECT_EQ(import_error(frames),
            "FILE (byte 830): a frame is said to end at 0, before its samples end at 8");
  // an end of the samples far beyond the file
  EXPECT_THAT(imported(with(826, 0xFFFFFFFF)).warnings,
              ElementsAre("'waveform': the file ends after 4 of 2147483646 samples"));
}

}  // namespace
}  // namespace impactrig::acquisition
