// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <limits>

#include "acquisition/importer.hpp"
#include "tests/acquisition/lecroy_trc_bytes.hpp"
#include "tests/acquisition/sound_channel.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using datasets::Record;
using testing::ElementsAre;
using tests::expect_head;
using tests::import_error;
using tests::imported;
using tests::part;
using tests::sound_channel;
using tests::Trc;

TEST(LecroyTrc, IsReadInBothByteOrdersAndWidths) {
  for (const bool big_endian : {false, true})
    for (const std::uint16_t type : std::vector<std::uint16_t>{0, 1})
      for (const char* before : {"", "#9000000362"}) {
        SCOPED_TRACE(fmt::format("{} {} {}", big_endian, type, before));
        Trc file;
        file.big_endian = big_endian;
        file.type = type;
        file.before = before;
        const Record record = imported(file.bytes());
        const auto& channel = sound_channel(record, "lecroy-trc");
        expect_head(channel, "CH 2", "V", -2e-9, 1e-9);  // not 9.99999972e-10
        // 0.5 raw - 1
        EXPECT_THAT(channel.values(), ElementsAre(0.0, -3.0, 2.0));
        EXPECT_TRUE(std::holds_alternative<std::vector<std::int16_t>>(channel.raw));
        EXPECT_EQ(channel.attributes.at("coupling"), "DC 1 MOhm");
        EXPECT_EQ(channel.attributes.at("probe attenuation"), "10");
        EXPECT_EQ(record.started, "2022-11-09T09:23:52.5");
        EXPECT_EQ(record.attributes.at("instrument"), "LECROYWR64Xi-A");
      }
}

TEST(LecroyTrc, OfTheOlderTemplateIsTheSame) {
  Trc file;
  file.pattern = "LECROY_2_2";
  EXPECT_EQ(imported(file.bytes()).channels.at(0).size(), 3U);
  file.pattern = "LECROY_3_0";
  EXPECT_EQ(import_error(file.bytes()),
            "FILE (byte 16): this is a LeCroy waveform of the template 'LECROY_3_0', expected "
            "LECROY_1_0, LECROY_2_2 or LECROY_2_3: save it as CSV or as binary of template "
            "LECROY_2_3");
}

// Its ACQ_VERT_OFFSET is another number, of divisions in a 7200A's files.
TEST(LecroyTrc, OfTheOldestTemplateHasItsOwnPlaces) {
  for (const bool big_endian : {false, true})
    for (const std::uint16_t type : std::vector<std::uint16_t>{0, 1}) {
      Trc file;
      file.pattern = "LECROY_1_0";
      file.big_endian = big_endian;
      file.type = type;
      file.label = "Trace1";
      const Record record = imported(file.bytes());
      const auto& channel = sound_channel(record, "lecroy-trc");
      expect_head(channel, "CH 2", "V", -2e-9, 1e-9);
      EXPECT_THAT(channel.values(), ElementsAre(0.0, -3.0, 2.0));
      EXPECT_EQ(channel.attributes.at("probe attenuation"), "10");
      EXPECT_EQ(record.started, "2022-11-09T09:23:52.5");
      EXPECT_EQ(record.attributes.at("instrument"), "LeCroy 7200 DSO");
    }
  Trc file;
  file.pattern = "LECROY_1_0";
  file.record_type = 9;
  EXPECT_EQ(imported(file.bytes()).attributes.at("record type"), "rolling");
  file.record_type = 7;
  file.segments = 2;
  file.samples = {1, 2, 3, 4};
  file.triggers = {{0.0, -1e-9}, {0.25, -2e-9}};
  EXPECT_EQ(imported(file.bytes()).channels.at(0).attributes.at("triggers since the first [s]"),
            "0, 0.25");
}

TEST(LecroyTrc, IsNamedAfterItsLabelWhereItHasNoSource) {
  Trc file;
  file.source = 9;
  EXPECT_EQ(imported(file.bytes()).channels.at(0).name, "waveform");
  file.label = "force";
  EXPECT_EQ(imported(file.bytes()).channels.at(0).name, "force");
}

TEST(LecroyTrc, SequenceIsOneChannelThatTellsItsSegments) {
  Trc file;
  file.segments = 2;
  file.samples = {2, 4, 6, 8};
  file.triggers = {{0.0, -1e-9}, {0.5, -1.5e-9}};
  const Record record = imported(file.bytes());
  ASSERT_EQ(record.channels.size(), 1U);
  const auto& channel = record.channels.front();
  EXPECT_THAT(channel.values(), ElementsAre(0.0, 1.0, 2.0, 3.0));
  EXPECT_EQ(channel.attributes.at("segments"), "2");
  EXPECT_EQ(channel.attributes.at("samples a segment"), "2");
  EXPECT_EQ(channel.attributes.at("triggers since the first [s]"), "0, 0.5");
  EXPECT_EQ(channel.attributes.at("segment starts after their triggers [s]"), "-1e-09, -1.5e-09");
  EXPECT_THAT(record.warnings,
              ElementsAre("'CH 2' is a sequence of 2 segments of 2 samples: they follow each other "
                          "as if there were no time between them; true within a segment only"));
}

// As roll mode leaves it, and filters that need samples on both sides.
TEST(LecroyTrc, SamplesThatWereNotAcquiredAreLeftOut) {
  for (const std::uint16_t type : std::vector<std::uint16_t>{0, 1}) {
    Trc file;
    file.type = type;
    file.samples = {0, 2, 4, 6, 0, 0};
    file.first_valid = 1;
    file.last_valid = 3;
    const Record record = imported(file.bytes());
    EXPECT_THAT(record.channels.at(0).values(), ElementsAre(0.0, 1.0, 2.0));
    EXPECT_DOUBLE_EQ(record.channels[0].clock.start, -1e-9);
    EXPECT_THAT(record.warnings,
                ElementsAre("'CH 2': 1 samples at the start and 2 at the end were not acquired "
                            "(FIRST_VALID_PNT 1, LAST_VALID_PNT 3): they are left out"));
  }
  // the waveform's last, of which the file has a part
  Trc file;
  file.last_valid = 10001;
  EXPECT_EQ(imported(file.bytes()).channels.at(0).size(), 3U);
  EXPECT_THAT(imported(file.bytes()).warnings, testing::IsEmpty());
  file.first_valid = 3;
  EXPECT_THAT(imported(file.bytes()).warnings,
              ElementsAre("'CH 2': samples before 3 or behind 10001 are said not to be acquired "
                          "(FIRST_VALID_PNT, LAST_VALID_PNT): they are read like the others"));
}

TEST(LecroyTrc, SequenceThatWasStoppedHasTheSegmentsOfItsPlan) {
  Trc file;
  file.segments = 2;
  file.segments_asked = 4;
  file.samples = {1, 2, 3, 4, 5, 6, 0, 0, 0, 0, 0, 0};
  file.last_valid = 5;
  const Record record = imported(file.bytes());
  EXPECT_EQ(record.channels.at(0).size(), 6U);
  EXPECT_EQ(record.channels[0].attributes.at("samples a segment"), "3");
  EXPECT_EQ(record.warnings.at(0),
            "'CH 2': the sequence was stopped after 2 of 4 segments: the 6 samples behind them "
            "were not acquired and are left out");
  file.last_valid = 11;  // and the array could be of two segments of six
  EXPECT_EQ(imported(file.bytes()).channels.at(0).size(), 12U);
  EXPECT_EQ(imported(file.bytes()).warnings.at(0),
            "'CH 2': the sequence was stopped after 2 of 4 segments, and which of its 12 samples "
            "are whose is not told: compare with the oscilloscope");
  file.segments = 3;
  file.segments_asked = 4;
  file.samples.resize(8);  // not of three
  file.last_valid = 7;
  EXPECT_EQ(imported(file.bytes()).channels.at(0).size(), 6U);
  file.samples.resize(6);  // not of four
  file.last_valid = 5;
  EXPECT_EQ(imported(file.bytes()).channels.at(0).attributes.at("samples a segment"), "2");
  EXPECT_EQ(imported(file.bytes()).warnings.size(), 1U);
  file.segments_asked = 3;
  file.last_valid = 1;
  EXPECT_EQ(imported(file.bytes()).channels.at(0).size(), 6U);
  EXPECT_EQ(imported(file.bytes()).warnings.at(0),
            "'CH 2': samples before 0 or behind 1 are said not to be acquired "
            "(FIRST_VALID_PNT, LAST_VALID_PNT): they are read like the others");
}

TEST(LecroyTrc, PartOfAWaveformHasItsTimes) {
  Trc file;
  file.first_point = 10;
  file.sparsing = 4;
  const Record record = imported(file.bytes());
  EXPECT_DOUBLE_EQ(record.channels.at(0).clock.start, 8e-9);
  EXPECT_DOUBLE_EQ(record.channels[0].clock.interval, 4e-9);
  EXPECT_THAT(record.warnings,
              ElementsAre("'CH 2' is a part of a waveform (FIRST_POINT 10, SPARSING_FACTOR 4): "
                          "sample k is taken as the waveform's 10 + 4 k, and HORIZ_INTERVAL as "
                          "that of the waveform; compare the times with the oscilloscope's"));
  file.last_valid = 2;  // all of the part, or less of the waveform
  EXPECT_EQ(imported(file.bytes()).warnings.size(), 1U);
  file.last_valid = 1;
  EXPECT_EQ(imported(file.bytes()).channels.at(0).size(), 3U);
  EXPECT_EQ(imported(file.bytes()).warnings.at(0),
            "'CH 2': samples before 0 or behind 1 are said not to be acquired (FIRST_VALID_PNT, "
            "LAST_VALID_PNT): they are read like the others");
}

TEST(LecroyTrc, InterleavedSweepsAreTold) {
  Trc file;
  file.record_type = 1;
  file.ris_sweeps = 10;
  file.ris_times = {0.0, 1e-10};
  const Record record = imported(file.bytes());
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(0.0, -3.0, 2.0));
  EXPECT_THAT(record.warnings,
              ElementsAre("'CH 2' is put together of 10 sweeps (RIS), each with a time of its own: "
                          "its samples are read as evenly spaced, at HORIZ_INTERVAL"));
}

TEST(LecroyTrc, ExtremaAreTwoChannels) {
  Trc file;
  file.record_type = 6;
  file.second = {0, 2, 4};
  const Record record = imported(file.bytes());
  ASSERT_EQ(record.channels.size(), 2U);
  EXPECT_EQ(record.channels[0].name, "CH 2 max");
  EXPECT_EQ(record.channels[1].name, "CH 2 min");
  EXPECT_THAT(record.channels[1].values(), ElementsAre(-1.0, 0.0, 1.0));
}

TEST(LecroyTrc, OverFrequencyIsNoTimeRecord) {
  Trc file;
  file.x_unit = "Hz";
  EXPECT_EQ(imported(file.bytes()).channels.at(0).attributes.at("domain"), "frequency");
}

TEST(LecroyTrc, WindowIsThatOfTheWhole) {
  Trc file;
  file.samples = {2, 4, 6, 8};
  const Record record = imported(file.bytes(), part(-1e-9, 0.0));
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(1.0, 2.0));
}

TEST(LecroyTrc, ThatIsCutOffGivesWhatIsThere) {
  const std::string whole = Trc{}.bytes();
  const Record record = imported(whole.substr(0, whole.size() - 1));
  EXPECT_EQ(record.channels.at(0).size(), 2U);
  EXPECT_THAT(record.warnings, ElementsAre("'CH 2': the file ends after 2 of 3 samples"));
  EXPECT_EQ(import_error(whole.substr(0, whole.size() - 6)),
            "FILE (byte 353): the file ends before its first sample");
  EXPECT_EQ(import_error(whole.substr(0, 200)),
            "FILE (byte 200): the file ends within the source of the waveform");
}

TEST(LecroyTrc, SaysWhatIsWrong) {
  Trc file;
  file.type = 2;
  EXPECT_EQ(import_error(file.bytes()),
            "FILE (byte 32): the type of the samples (COMM_TYPE) is 2, expected 0 (bytes) or 1 "
            "(words)");
  file = {};
  file.record_type = 5;
  EXPECT_EQ(import_error(file.bytes()),
            "FILE (byte 316): this waveform is of the type 'complex' (5), expected samples over "
            "time: save it as CSV");
  file.record_type = 77;
  EXPECT_EQ(import_error(file.bytes()),
            "FILE (byte 316): this waveform is of the type 'unknown' (77), expected samples over "
            "time: save it as CSV");
  file = {};
  std::string bytes = file.bytes();
  bytes.replace(116, 4, "\xFF\xFF\xFF\xFF");
  EXPECT_EQ(import_error(bytes),
            "FILE (byte 116): the number of samples is -1, expected 0 or more");
  bytes.replace(116, 4, "\xFF\xFF\xFF\x7F");
  EXPECT_THAT(imported(bytes).warnings,
              ElementsAre("'CH 2': 2147483647 samples are announced, their 6 bytes have 3"));
  file.gain = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(import_error(file.bytes()),
            "FILE (byte 156): 'CH 2': scale nan and offset -1 are no numbers to scale samples by");
  ImportOptions options;
  options.format = "lecroy-trc";
  EXPECT_EQ(import_error("nothing", options),
            "FILE (byte 0): expected 'WAVEDESC' in the first 256 bytes");
  file = {};
  file.year = -1;  // no date
  EXPECT_EQ(imported(file.bytes()).started, "");
}

TEST(LecroyTrc, TriggerAtTheEndOfAMinuteIsInThatMinute) {
  Trc file;
  file.second_of_trigger = 59.9999999999;
  EXPECT_EQ(imported(file.bytes()).started, "2022-11-09T09:23:59.999999");
  file.second_of_trigger = 60.0;  // a leap second
  EXPECT_EQ(imported(file.bytes()).started, "2022-11-09T09:23:60");
}

}  // namespace
}  // namespace impactrig::acquisition
