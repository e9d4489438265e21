// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "acquisition/importer.hpp"
#include "tests/acquisition/sound_channel.hpp"
#include "tests/acquisition/waveform_container_bytes.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using datasets::Record;
using testing::Contains;
using testing::ElementsAre;
using tests::expect_head;
using tests::import_error;
using tests::imported;
using tests::part_from;
using tests::sound_channel;
using tests::WaveformFile;

TEST(KeysightBin, IsReadInEveryVersion) {
  for (const char* cookie : {"AG01", "AG03", "AG10"}) {
    SCOPED_TRACE(cookie);
    WaveformFile file;
    file.cookie = cookie;
    const Record record = imported(file.bytes());
    const auto& channel = sound_channel(record, "keysight-bin");
    expect_head(channel, "CH 2", "V", -2e-6, 1e-6);
    EXPECT_EQ(std::get<std::vector<float>>(channel.raw), (std::vector<float>{1.5F, -2.0F, 3.0F}));
    EXPECT_EQ(record.started, "2020-11-22T19:02:34");
    EXPECT_EQ(record.attributes.at("instrument"), "DSO-X 1102G:CN1");
  }
}

TEST(KeysightBin, WaveformsOfDifferentStartsAreTold) {
  WaveformFile file;
  file.waveforms.resize(3);
  file.waveforms[1].label = "CH 3";
  file.waveforms[2].label = "CH 4";
  file.waveforms[1].time = "19:02:35";  // written a second later
  EXPECT_THAT(imported(file.bytes()).warnings, testing::IsEmpty());
  file.waveforms[2].time = "19:05:34";
  EXPECT_THAT(imported(file.bytes()).warnings,
              ElementsAre(testing::StartsWith("channels were started at different times (the first "
                                              "at 2020-11-22T19:02:34, another at "
                                              "2020-11-22T19:05:34)")));
}

TEST(RigolBin, OriginIsTheTimeBeforeTheTrigger) {
  for (const char* cookie : {"RG01", "RG03"}) {
    WaveformFile file;
    file.cookie = cookie;
    file.waveforms[0].origin = 0.0025;
    file.waveforms[0].interval = 4.0000000467443897e-07;  // went through single precision
    file.waveforms[0].date = "2025-8-26";
    file.waveforms[0].time = "8:48:5";
    const Record record = imported(file.bytes());
    EXPECT_EQ(record.provenance.importer, "rigol-bin");
    EXPECT_EQ(record.channels.at(0).clock.start, -0.0025);
    EXPECT_EQ(record.channels.at(0).clock.interval, 4e-7);
    EXPECT_EQ(record.started, "2025-08-26T08:48:05");
  }
}

TEST(RigolBin, HeaderMayBeOf128Bytes) {
  WaveformFile file;
  file.cookie = "RG01";
  file.waveforms[0].header_size = 128;
  EXPECT_THAT(imported(file.bytes()).channels.at(0).values(), ElementsAre(1.5, -2.0, 3.0));
}

TEST(RigolBin, WaveformsWithoutNamesAreNumbered) {
  WaveformFile file;
  file.cookie = "RG01";
  file.waveforms.resize(2);
  file.waveforms[0].label = file.waveforms[1].label = "";
  const Record record = imported(file.bytes());
  EXPECT_EQ(record.channels.at(1).name, "CH 2");
  EXPECT_THAT(record.warnings,
              ElementsAre("the waveforms have no names: they are numbered in their order, which "
                          "need not be the oscilloscope's"));
}

TEST(KeysightBin, BuffersAreChannels) {
  WaveformFile file;
  file.waveforms[0].type = 2;
  file.waveforms[0].buffers = {{2, 4, {1.0F, 2.0F}},
                               {3, 4, {0.0F, 1.0F}},
                               {6, 1, {1.0F, 255.0F}},
                               {4, 4, {0.5F, 0.25F}},
                               {5, 4, {7.0F, 8.0F}}};
  const Record record = imported(file.bytes());
  ASSERT_EQ(record.channels.size(), 5U);
  EXPECT_EQ(record.channels[0].name, "CH 2 max");
  EXPECT_EQ(record.channels[1].name, "CH 2 min");
  EXPECT_THAT(record.channels[1].values(), ElementsAre(0.0, 1.0));
  EXPECT_EQ(record.channels[2].name, "CH 2 digital");
  EXPECT_THAT(record.channels[2].values(), ElementsAre(1.0, 255.0));
  EXPECT_EQ(record.channels[2].unit, "");
  EXPECT_EQ(record.channels[3].name, "CH 2 time");
  EXPECT_EQ(record.channels[3].unit, "s");
  EXPECT_EQ(record.channels[4].name, "CH 2 counts");
  EXPECT_EQ(record.channels[0].attributes.at("waveform type"), "peak detect");
}

TEST(KeysightBin, SegmentsAreChannels) {
  WaveformFile file;
  file.waveforms.resize(3);
  for (std::uint32_t i = 0; i < 3; ++i) {
    file.waveforms[i].segment = i + 1;
    file.waveforms[i].time_tag = i;
  }
  const Record record = imported(file.bytes());
  EXPECT_EQ(record.channels.at(2).name, "CH 2, segment 3");
  EXPECT_EQ(record.channels.at(2).attributes.at("time tag"), "2 s");
  EXPECT_THAT(record.warnings, ElementsAre("'CH 2' comes in 3 segments: each is a channel, with "
                                           "the time from its own trigger"));
}

TEST(KeysightBin, WindowAndChannelAreThoseOfTheWhole) {
  WaveformFile file;
  file.waveforms.resize(2);
  file.waveforms[1].label = "3";
  file.waveforms[1].buffers = {{1, 4, {4.0F, 5.0F, 6.0F}}};
  const Record record = imported(file.bytes(), part_from(-1e-6, "CH 3"));
  ASSERT_EQ(record.channels.size(), 1U);
  EXPECT_THAT(record.channels[0].values(), ElementsAre(5.0, 6.0));
}

TEST(KeysightBin, ThatIsCutOffGivesWhatIsThere) {
  WaveformFile file;
  file.waveforms.resize(2);
  file.waveforms[1].label = "CH3";
  const std::string whole = file.bytes();
  const std::size_t one = 12 + 140 + 12 + 12;
  EXPECT_THAT(imported(whole.substr(0, one + 30)).warnings,
              ElementsAre("the file ends within the header of waveform 2 of 2 at byte 176"));
  const Record record = imported(whole.substr(0, whole.size() - 5));
  EXPECT_EQ(record.channels.at(1).size(), 1U);
  EXPECT_THAT(record.warnings, ElementsAre("'CH 3': the file ends after 1 of 3 samples"));
  EXPECT_EQ(import_error(whole.substr(0, one - 12)),
            "FILE (byte 164): the file ends before its first sample");
  EXPECT_EQ(import_error(whole.substr(0, 100)),
            "FILE (byte 100): the file ends within a waveform's header");
  EXPECT_EQ(import_error(whole.substr(0, 6)),
            "FILE (byte 4): the file ends within the size of the file");
  file.announced = 0xFFFFFFFF;
  EXPECT_THAT(imported(file.bytes()).warnings,
              ElementsAre("the file ends within the header of waveform 3 of 4294967295 at byte "
                          "340"));
}

TEST(KeysightBin, SaysWhatIsWrong) {
  WaveformFile file;
  file.waveforms[0].header_size = 100;
  EXPECT_EQ(import_error(file.bytes()),
            "FILE (byte 12): the header of waveform 1 is said to have 100 bytes, expected 128 or "
            "more");
  file = {};
  file.waveforms[0].buffers[0].width = 2;
  EXPECT_EQ(import_error(file.bytes()),
            "FILE (byte 158): 'CH 2': a buffer of 2 bytes a point is not read, expected 4 (single "
            "precision) or 1 (digital)");
  file = {};
  std::string bytes = file.bytes();
  bytes[152] = 11;
  EXPECT_EQ(import_error(bytes),
            "FILE (byte 152): 'CH 2': the header of its buffer is said to have 11 bytes, expected "
            "12 or more");
  bytes = file.bytes();
  bytes[24] = 9;
  EXPECT_THAT(imported(bytes).warnings,
              ElementsAre("'CH 2': 9 points are announced, its buffer has 3"));
  ImportOptions options;
  options.format = "keysight-bin";
  EXPECT_EQ(import_error("AG07" + file.bytes().substr(4), options),
            "FILE (byte 2): this is a Keysight waveform of version '07', expected 01, 03 or 10: "
            "save it as CSV on the oscilloscope");
  file.waveforms.clear();
  EXPECT_THAT(imported(file.bytes()).warnings,
              ElementsAre("no recordings in this file: it has no waveforms"));
  file.waveforms.assign(1, {});
  file.waveforms[0].buffers.assign(10001, {1, 4, {}});
  EXPECT_EQ(import_error(file.bytes()),
            "FILE (byte 120152): the file has more than 10000 waveforms: save it in parts");
}

TEST(RigolBin, OfSeveralFilesInOneIsRefused) {
  WaveformFile file;
  file.cookie = "RG01";
  file.waveforms[0].header_size = 144;
  EXPECT_EQ(imported(file.bytes()).channels.at(0).size(), 3U);
  EXPECT_EQ(import_error(file.bytes() + file.bytes()),
            "FILE (byte 12): this export (DSO-X 1102G) is several files in one, whose samples "
            "are bytes without their scale, and is not read: save it anew, or as CSV");
}

}  // namespace
}  // namespace impactrig::acquisition
