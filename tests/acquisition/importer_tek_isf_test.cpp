// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "acquisition/importer.hpp"
#include "tests/acquisition/sound_channel.hpp"
#include "tests/acquisition/tek_isf_bytes.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using datasets::Record;
using testing::ElementsAre;
using tests::expect_head;
using tests::import_error;
using tests::imported;
using tests::Isf;
using tests::part;
using tests::sound_channel;

TEST(TekIsf, IsReadWithLongAndShortKeysInBothByteOrders) {
  for (const bool short_keys : {false, true})
    for (const bool big_endian : {false, true}) {
      Isf file;
      file.short_keys = short_keys;
      file.big_endian = big_endian;
      const Record record = imported(file.bytes());
      const auto& channel = sound_channel(record, "tek-isf");
      expect_head(channel, "CH 2", "V", -2e-6, 1e-6);
      // (raw - 2) 0.5 + 1; the sample PT_OFF is at XZERO
      EXPECT_THAT(channel.values(), ElementsAre(1.0, -2.0, 3.0));
      EXPECT_EQ(std::get<std::vector<std::int16_t>>(channel.raw),
                (std::vector<std::int16_t>{2, -4, 6}));
      EXPECT_EQ(record.title, "Ch2, DC coupling, 1.0E0 V/div; probe");
      EXPECT_EQ(record.attributes.at("BIT_NR"), "16");
    }
}

TEST(TekIsf, HasNumbersOfEveryKind) {
  const std::vector<std::pair<std::string, int>> kinds = {
      {"RI", 1}, {"RI", 2}, {"RI", 4}, {"RP", 1}, {"RP", 2}, {"RP", 4}, {"FP", 4}, {"FP", 8}};
  for (const auto& [format, width] : kinds)
    for (const bool big_endian : {false, true}) {
      SCOPED_TRACE(fmt::format("{} {} {}", format, width, big_endian));
      Isf file;
      file.format = format;
      file.width = width;
      file.big_endian = big_endian;
      file.samples = {2, 100, 6};
      EXPECT_THAT(imported(file.bytes()).channels.at(0).values(), ElementsAre(1.0, 50.0, 3.0));
    }
}

TEST(TekIsf, CurveMayBeText) {
  Isf file;
  file.encoding = "ASC";
  EXPECT_THAT(imported(file.bytes()).channels.at(0).values(), ElementsAre(1.0, -2.0, 3.0));
  EXPECT_EQ(
      import_error(file.head() + "1,2,x\n"),
      fmt::format("FILE (byte {}): CH 2: expected a number, found 'x'", file.head().size() + 4));
}

TEST(TekIsf, EnvelopeIsTwoChannels) {
  for (const char* encoding : {"BIN", "ASC"}) {
    Isf file;
    file.encoding = encoding;
    file.point_format = "ENV";
    file.samples = {2, 4, -6, 8};
    const Record record = imported(file.bytes());
    ASSERT_EQ(record.channels.size(), 2U);
    EXPECT_EQ(record.channels[0].name, "CH 2 min");
    EXPECT_EQ(record.channels[1].name, "CH 2 max");
    EXPECT_THAT(record.channels[0].values(), ElementsAre(1.0, -3.0));
    EXPECT_THAT(record.channels[1].values(), ElementsAre(2.0, 4.0));
    EXPECT_EQ(record.channels[0].clock.interval, 2e-6);
  }
}

TEST(TekIsf, BlockMayBeOfUnknownLengthOrCutOff) {
  Isf file;
  file.block = "#0";
  EXPECT_EQ(imported(file.bytes()).channels.at(0).size(), 3U);
  file.block = "#220";
  EXPECT_THAT(imported(file.bytes()).warnings,
              ElementsAre("'CH 2': NR_PT announces 3 samples, the curve has 10",
                          "'CH 2': the file ends after 3 of 10 samples"));
  file.samples = {2, 4, 6, 8};
  file.point_format = "ENV";
  file.block = "#220";
  EXPECT_EQ(imported(file.bytes()).warnings.back(), "'CH 2': the file ends after 2 of 5 samples");
}

TEST(TekIsf, WindowIsThatOfTheWhole) {
  Isf file;
  file.samples = {2, 4, 6, 8};
  const Record record = imported(file.bytes(), part(-1e-6, 0.0));
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(2.0, 3.0));
  EXPECT_DOUBLE_EQ(record.channels.at(0).clock.start, -1e-6);
}

TEST(TekIsf, WithoutAScaleHasTheDigitizersNumbers) {
  Isf file;
  file.scaling = "";
  const Record record = imported(file.bytes());
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(2.0, -4.0, 6.0));
  EXPECT_THAT(record.warnings, ElementsAre("'CH 2': the preamble has no YMULT: the values are "
                                           "those of the digitizer"));
}

TEST(TekIsf, SaysWhatIsWrong) {
  Isf file;
  file.width = 3;
  EXPECT_EQ(import_error(file.bytes()),
            "FILE (byte 0): samples of BN_FMT 'RI' with BYT_NR 3 are not read: expected RI, RP or "
            "FP with 1, 2 or 4");
  file = {};
  file.scaling = "YMULT ?;";
  EXPECT_EQ(import_error(file.bytes()), "FILE (byte 0): YMULT: expected a number, found '?'");
  EXPECT_EQ(import_error(":WFMPRE:BYT_NR 2;BIT_NR 16"),
            "FILE (byte 0): this is a Tektronix waveform without its curve: expected ':CURVE ' in "
            "its first 64 KiB");
  EXPECT_EQ(import_error(":WFMPRE:BYT_OR MSB;:CURVE #16abcdef"),
            "FILE (byte 0): the preamble has no BYT_NR: expected the bytes of a sample");
  EXPECT_EQ(import_error(":WFMPRE:BYT_NR 2;:CURVE #16abcdef"),
            "FILE (byte 0): the preamble has no BYT_OR: expected MSB or LSB");
  EXPECT_EQ(import_error(":WFMPRE:BYT_NR 2;BYT_OR PDP;:CURVE #16abcdef"),
            "FILE (byte 0): BYT_OR: expected MSB or LSB, found 'PDP'");
  EXPECT_EQ(import_error(":WFMPRE:BYT_NR 2;BYT_OR MSB;:CURVE 1,2"),
            "FILE (byte 35): expected '#' and the length of the curve behind CURVE");
  EXPECT_EQ(import_error(":WFMPRE:BYT_NR 2;BYT_OR MSB;:CURVE #x"),
            "FILE (byte 36): expected the number of digits of the curve's length behind '#'");
  EXPECT_EQ(import_error(":WFMPRE:BYT_NR 2;BYT_OR MSB;:CURVE #3-12"),
            "FILE (byte 37): expected the length of the curve, 3 digits, found '-12'");
  EXPECT_EQ(import_error(":WFMPRE:BYT_NR 2;BYT_OR MSB;:CURVE #16"),
            "FILE (byte 38): the file ends before its first sample");
  EXPECT_EQ(imported(":WFMPRE:BYT_NR 2;BYT_OR MSB;:CURVE #9999999999ab").channels.at(0).size(), 1U);
}

}  // namespace
}  // namespace impactrig::acquisition
