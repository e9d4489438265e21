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

// "6" may be the first digit of 61: a number that the end of the file cuts is none.
TEST(TekIsf, CurveAsTextMayEndWithinANumber) {
  Isf file;
  file.encoding = "ASC";
  for (const std::string end : {"2,-4", "2,-", "2,1e"}) {
    const Record record = imported(file.head() + end);
    EXPECT_THAT(record.channels.at(0).values(), ElementsAre(1.0));
    EXPECT_THAT(record.warnings,
                ElementsAre(fmt::format("'CH 2': the file ends within a number ('{}') of the "
                                        "curve: it is left out",
                                        end.substr(2)),
                            "'CH 2': NR_PT announces 3 samples, the curve has 1"));
  }
  EXPECT_THAT(imported(file.head() + "2,-4,6").channels.at(0).values(),
              ElementsAre(1.0, -2.0, 3.0));
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
  EXPECT_EQ(imported(file.bytes() + "\n").channels.at(0).size(), 3U);
  EXPECT_THAT(imported(file.bytes() + "\n").warnings, testing::IsEmpty());
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

// As a TDS answers to WAVFRM? with DATA:SOURCE CH1,CH2.
TEST(TekIsf, NameOfASourceIsText) {
  const Record record = imported(":WFMP:SOURCE\xB7:BYT_N 1;YMU 1;:CURV #12\2\6");
  EXPECT_EQ(record.channels.at(0).name, "SOURCE\u00b7");
}

TEST(TekIsf, AnswerForTwoSourcesIsTwoChannels) {
  const std::string head =
      ":WFMPRE:BYT_NR 2;BIT_NR 16;ENCDG {};BN_FMT RI;BYT_OR MSB;CH1:WFID \"Ch1, DC\";NR_PT 2;"
      "PT_FMT Y;XUNIT \"s\";XINCR 1E-5;PT_OFF 0;YUNIT \"V\";YMULT 0.5;YOFF 0;YZERO 0;CH2:WFID "
      "\"Ch2, DC\";NR_PT 2;PT_FMT Y;XUNIT \"s\";XINCR 2E-5;PT_OFF 1;YUNIT \"A\";YMULT 2;YOFF 1;"
      "YZERO 0;:CURVE ";
  const std::string binary = fmt::format(fmt::runtime(head), "BIN");
  const std::string text = fmt::format(fmt::runtime(head), "ASC");
  for (const std::string& bytes :
       {binary + std::string("#14\0\2\0\4,#14\0\6\0\10\n", 16), text + "2,4,6,8\n"}) {
    const Record record = imported(bytes);
    ASSERT_EQ(record.channels.size(), 2U);
    expect_head(record.channels[0], "CH 1", "V", 0.0, 1e-5);
    expect_head(record.channels[1], "CH 2", "A", -2e-5, 2e-5);
    EXPECT_THAT(record.channels[0].values(), ElementsAre(1.0, 2.0));
    EXPECT_THAT(record.channels[1].values(), ElementsAre(10.0, 14.0));
    EXPECT_EQ(record.channels[1].attributes.at("YMULT"), "2");
    EXPECT_THAT(record.warnings, testing::IsEmpty());
  }
  const std::size_t curve = binary.size();
  EXPECT_EQ(import_error(binary + std::string("#14\0\2\0\4\n", 8)),
            fmt::format("FILE (byte {}): the preamble is of 2 sources, but 1 curve is there: which "
                        "curve is whose is not told; save each source in a file of its own",
                        curve + 7));
  EXPECT_EQ(import_error(text + "2,4,6\n"),
            fmt::format("FILE (byte {}): the preamble is of 2 sources, but their NR_PT, 4 "
                        "together, are not the 3 numbers of the curve: which curve is whose is not "
                        "told; save each source in a file of its own",
                        text.size()));
  EXPECT_THAT(imported(binary + std::string("#14\0\2", 5)).warnings,
              ElementsAre("'CH 1': the file ends after 1 of 2 samples",
                          "the file ends before the curve of 'CH 2'"));
}

TEST(TekIsf, SourcesThatAreNotNamedAreRefused) {
  EXPECT_EQ(import_error(":WFMPRE:BYT_NR 1;YMULT 4E-3;YMULT 4E-2;:CURVE #12ab"),
            "FILE (byte 38): the preamble states YMULT twice, '4E-3' and '4E-2', without naming "
            "the source of each: save each source in a file of its own");
  EXPECT_EQ(import_error(":WFMPRE:BYT_NR 1;YMULT 4E-3;:CURVE #12ab,#12cd"),
            "FILE (byte 40): the preamble is of 1 source, but more curves are there: which curve "
            "is whose is not told; save each source in a file of its own");
}

TEST(TekIsf, AnswersThatFollowEachOtherAreTheirChannels) {
  for (const char* encoding : {"BIN", "ASC"}) {
    Isf first;
    first.encoding = encoding;
    Isf second = first;
    second.id = "Ch4, DC";
    second.scaling = "YMULT 2;YOFF 0;YZERO 0;";
    second.samples = {1, 2};
    std::string bytes = first.bytes();
    bytes.back() = ';';
    const Record record = imported(bytes + second.bytes());
    ASSERT_EQ(record.channels.size(), 2U);
    EXPECT_THAT(record.channels[0].values(), ElementsAre(1.0, -2.0, 3.0));
    EXPECT_EQ(record.channels[1].name, "CH 4");
    EXPECT_THAT(record.channels[1].values(), ElementsAre(2.0, 4.0));
    EXPECT_EQ(record.channels[0].attributes.at("YMULT"), "5.0E-1");
    EXPECT_THAT(record.warnings, testing::IsEmpty());
    second.encoding = first.encoding == "BIN" ? "ASC" : "BIN";
    EXPECT_THAT(import_error(bytes + second.bytes()),
                testing::HasSubstr("one curve is binary and the other text, which are not read "
                                   "together: save each source in a file of its own"));
  }
}

TEST(TekIsf, BytesBehindTheCurveAreTold) {
  Isf file;
  const std::string bytes = file.bytes();
  EXPECT_THAT(imported(bytes + "\r\n").warnings, testing::IsEmpty());
  EXPECT_THAT(imported(bytes.substr(0, bytes.size() - 1) + "abcd").warnings,
              ElementsAre(fmt::format("4 bytes follow the curve at byte {} and are not read: its "
                                      "head announces no more, and they are no other waveform",
                                      bytes.size() - 1)));
}

TEST(TekIsf, FastFramesAreChannels) {
  for (const char* encoding : {"BIN", "ASC"}) {
    Isf file;
    file.encoding = encoding;
    std::string bytes = file.bytes();
    bytes.replace(bytes.find("NR_PT 3"), 7, "NR_PT 1;NR_FR 3");
    const Record record = imported(bytes);
    ASSERT_EQ(record.channels.size(), 3U);
    EXPECT_EQ(record.channels[1].name, "CH 2, frame 2");
    EXPECT_THAT(record.channels[1].values(), ElementsAre(-2.0));
    EXPECT_EQ(record.channels[1].clock.start, -2e-6);
    EXPECT_THAT(record.warnings,
                ElementsAre("'CH 2' is a FastFrame sequence of 3 frames: each is a channel, with "
                            "the time from its own trigger"));
    bytes.replace(bytes.find("NR_FR 3"), 7, "NR_FR 2");
    EXPECT_EQ(import_error(bytes),
              "FILE (byte 0): 'CH 2' is a FastFrame sequence of 2 frames (NR_FR) of 1 samples "
              "(NR_PT), but its curve has 3: where a frame ends is not told; save each frame in a "
              "file of its own");
  }
  Isf file;
  std::string cut = file.bytes();
  cut.replace(cut.find("NR_PT 3"), 7, "NR_PT 1;NR_FR 3");
  EXPECT_THAT(imported(cut.substr(0, cut.size() - 3)).warnings,
              testing::Contains("the file ends before frame 3 of 3"));
}

TEST(TekIsf, PairsOfXAndYAreRefused) {
  Isf file;
  file.point_format = "XY";
  EXPECT_EQ(import_error(file.bytes()),
            "FILE (byte 0): 'CH 2': points of PT_FMT 'XY' are not read, expected Y (samples) or "
            "ENV (minimum and maximum): save it as CSV");
}

TEST(TekIsf, NumbersMayFollowCurveWithoutABlank) {
  Isf file;
  file.encoding = "ASC";
  for (const bool short_keys : {false, true}) {
    file.short_keys = short_keys;
    std::string bytes = file.bytes();
    bytes.erase(bytes.find(' ', bytes.find(":CURV")), 1);
    EXPECT_THAT(imported(bytes).channels.at(0).values(), ElementsAre(1.0, -2.0, 3.0));
  }
}

}  // namespace
}  // namespace impactrig::acquisition
