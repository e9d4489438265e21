// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <limits>

#include "acquisition/importer.hpp"
#include "tests/acquisition/catman_bytes.hpp"
#include "tests/acquisition/sound_channel.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using datasets::Quantity;
using datasets::Record;
using testing::ElementsAre;
using testing::IsEmpty;
using tests::Catman;
using tests::CatmanColumn;
using tests::import_error;
using tests::imported;
using tests::part_from;

TEST(Catman, IsReadInEveryPrecision) {
  for (const std::uint8_t precision : std::vector<std::uint8_t>{0, 1}) {
    Catman file;
    file.columns[1].precision = precision;
    file.columns[1].comment = "left";
    const Record record = imported(file.bytes());
    ASSERT_EQ(record.channels.size(), 2U);
    const auto& channel = record.channels[1];
    EXPECT_EQ(channel.name, "force");
    EXPECT_EQ(channel.unit, "N");
    EXPECT_EQ(channel.quantity, Quantity::force);
    EXPECT_THAT(channel.values(), ElementsAre(1.0, 2.0, 3.0));
    EXPECT_EQ(std::holds_alternative<std::vector<float>>(channel.raw), precision == 1);
    EXPECT_EQ(channel.attributes.at("comment"), "left");
    EXPECT_EQ(channel.attributes.at("sensor"), "strain gage");
    EXPECT_EQ(channel.attributes.at("amplifier"), "9E5001CCB");
    EXPECT_EQ(record.title, "drop test");
    EXPECT_EQ(record.started, "2022-04-12T12:00:00");
    EXPECT_EQ(record.provenance.importer, "catman");
    EXPECT_THAT(record.warnings, IsEmpty());
  }
}

// Without the reserved texts and, the first two, without sensors [HBM, catmanread.m].
TEST(Catman, OfOlderVersionsIsRead) {
  for (const std::int16_t id : std::vector<std::int16_t>{5010, 5011, 5012}) {
    Catman file;
    file.id = id;
    const Record record = imported(file.bytes());
    ASSERT_EQ(record.channels.size(), 2U) << id;
    EXPECT_THAT(record.channels[1].values(), ElementsAre(1.0, 2.0, 3.0)) << id;
    EXPECT_EQ(record.channels[1].unit, "N") << id;
    EXPECT_EQ(record.channels[1].attributes.count("sensor"), id == 5012 ? 1U : 0U);
    EXPECT_THAT(record.warnings, IsEmpty());
  }
}

TEST(Catman, OfTwoBytesIsScaledBetweenItsLimits) {
  Catman file;
  file.columns[1].precision = 2;
  file.columns[1].low = -1.0;
  file.columns[1].high = 1.0;
  file.columns[1].samples = {0, 32767, 16383.5};
  const Record record = imported(file.bytes());
  const auto& channel = record.channels.at(1);
  EXPECT_TRUE(std::holds_alternative<std::vector<std::int16_t>>(channel.raw));
  EXPECT_EQ(channel.value(0), -1.0);
  EXPECT_DOUBLE_EQ(channel.value(1), 1.0);
  file.columns[1].high = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(import_error(file.bytes()),
              testing::HasSubstr("'force': scale nan and offset -1 are no numbers to scale samples "
                                 "by"));
}

TEST(Catman, TimeChannelIsAChannelAndTheClockOfTheOthers) {
  Catman file;
  const Record record = imported(file.bytes());
  EXPECT_EQ(record.channels[0].name, "Time  1");
  EXPECT_EQ(record.channels[0].quantity, Quantity::time);
  for (const auto& channel : record.channels) {
    EXPECT_EQ(channel.clock.interval, 0.0005);
    EXPECT_EQ(channel.clock.start, 0.0);
    EXPECT_TRUE(channel.clock.uniform());
    EXPECT_EQ(channel.attributes.at("time channel"), "Time  1");
  }
}

TEST(Catman, ThatIsCutOrReducedSaysSo) {
  Catman file;
  file.longest = 200;
  file.reduction = 10;
  EXPECT_THAT(imported(file.bytes()).warnings,
              ElementsAre("the file states a maximum channel length of 200 samples, most state 0: "
                          "channels may have been cut at that length",
                          "the file states a reduction factor of 10, most state 0: its samples may "
                          "be one of 10 recorded, or what was made of so many, and impacts between "
                          "them be lost"));
}

TEST(Catman, TimesThatContradictTheHeaderAreKept) {
  for (const std::uint8_t precision : std::vector<std::uint8_t>{0, 1}) {
    Catman file;
    file.columns[0].precision = precision;
    file.columns[0].samples = {0.0, 1.0, 4.0};
    const Record record = imported(file.bytes());
    EXPECT_THAT(record.channels[1].clock.times, ElementsAre(0.0, 1.0, 4.0));
    EXPECT_THAT(record.warnings,
                ElementsAre("'Time  1': the samples are not evenly spaced (steps differ from their "
                            "mean of 2 s by up to 1 s): every time is kept"));
  }
  Catman file;  // uniform, but not as the header has it
  file.columns[0].samples = {10.0, 10.25, 10.5};
  const Record record = imported(file.bytes());
  EXPECT_EQ(record.channels[1].clock.interval, 0.25);
  EXPECT_EQ(record.channels[1].clock.start, 10.0);
}

TEST(Catman, UnevenTimesAreKeptInEveryUnitAndPrecision) {
  for (const std::uint8_t precision : std::vector<std::uint8_t>{0, 1, 2}) {
    Catman file;
    file.columns[0].unit = "ms";
    file.columns[0].precision = precision;
    file.columns[0].samples = {0.0, 1000.0, 4000.0};
    if (precision == 2) file.columns[0].samples = {0.0, 1.0, 4.0};
    if (precision == 2) file.columns[0].high = 32767e3;
    const Record record = imported(file.bytes());
    EXPECT_THAT(record.channels[1].clock.times, ElementsAre(0.0, 1.0, 4.0));
    file.columns[0].samples.push_back(5.0 * file.columns[0].samples[1]);
    file.columns[1].samples.push_back(4.0);
    const Record part = imported(file.bytes(), part_from(0.5, "force"));
    EXPECT_THAT(part.channels.at(0).clock.times, ElementsAre(1.0, 4.0, 5.0));
    EXPECT_THAT(part.channels.at(0).values(), ElementsAre(2.0, 3.0, 4.0));
    const std::string bytes = file.bytes();
    EXPECT_THAT(imported(bytes.substr(0, bytes.size() - 4)).channels.at(1).clock.times,
                ElementsAre(0.0, 1.0, 4.0));
  }
}

TEST(Catman, TimesMayBeInAnotherUnit) {
  Catman file;
  file.columns[0].unit = "ms";
  file.columns[0].samples = {1.0, 1.5, 2.0};
  const Record record = imported(file.bytes());
  EXPECT_EQ(record.channels[1].clock.interval, 0.0005);
  EXPECT_EQ(record.channels[1].clock.start, 0.001);
}

TEST(Catman, EachRateHasItsTimeChannel) {
  Catman file;
  file.columns.push_back({.name = "Zeit 2", .unit = "s", .interval = 1000.0, .samples = {0, 1, 2}});
  file.columns.push_back({.name = "slow", .interval = 1000.0});
  file.columns.push_back({.name = "alone", .interval = 20.0, .samples = {1, 2, 3, 4}});
  file.columns.push_back({.name = "unknown", .interval = 0.0, .samples = {1, 2, 3, 4, 5}});
  const Record record = imported(file.bytes());
  ASSERT_EQ(record.channels.size(), 6U);
  EXPECT_EQ(record.channels[1].attributes.at("time channel"), "Time  1");
  EXPECT_EQ(record.channels[3].attributes.at("time channel"), "Zeit 2");
  EXPECT_EQ(record.channels[3].clock.interval, 1.0);
  EXPECT_EQ(record.channels[4].clock.interval, 0.02);
  EXPECT_EQ(record.channels[5].clock.interval, 0.0);
}

TEST(Catman, OverflowsAreMarked) {
  for (const std::uint8_t precision : std::vector<std::uint8_t>{0, 1, 2}) {
    Catman file;
    file.columns[1].precision = precision;
    file.columns[1].samples = {1, -1000000, 3};
    if (precision == 2) {
      file.columns[1].low = -1000000.0;
      file.columns[1].high = 1000.0;
      file.columns[1].samples = {1, 0, 3};
    }
    const Record record = imported(file.bytes());
    EXPECT_THAT(record.channels[1].valid, ElementsAre(1, 0, 1));
    EXPECT_EQ(record.channels[1].value(1), -1000000.0);
    EXPECT_THAT(record.channels[0].valid, IsEmpty());
    EXPECT_THAT(record.warnings,
                ElementsAre("'force': 1 of 3 samples are -1000000, catman's mark of an overflow or "
                            "an open input; marked as not valid"));
  }
}

TEST(Catman, WindowAndChannelAreThoseOfTheWhole) {
  Catman file;
  file.columns[1].samples = {1, -1000000, 3};
  const Record record = imported(file.bytes(), part_from(0.0005, "force"));
  ASSERT_EQ(record.channels.size(), 1U);
  EXPECT_THAT(record.channels[0].values(), ElementsAre(-1000000.0, 3.0));
  EXPECT_THAT(record.channels[0].valid, ElementsAre(0, 1));
}

TEST(Catman, TextsAndEmptyChannelsAreLeftOut) {
  Catman file;
  file.columns.insert(file.columns.begin() + 1,
                      {.name = "notes", .format = 1, .width = 4, .samples = {1, 2}});
  file.columns.insert(file.columns.begin() + 1,
                      {.name = "object", .format = 2, .width = 0, .samples = {}});
  file.columns.push_back({.name = "empty", .samples = {}});
  const Record record = imported(file.bytes());
  ASSERT_EQ(record.channels.size(), 2U);
  EXPECT_THAT(record.channels[1].values(), ElementsAre(1.0, 2.0, 3.0));
  EXPECT_THAT(record.warnings,
              ElementsAre("'object' holds binary objects, which is not read",
                          "'notes' holds texts, which is not read", "'empty' has no samples"));
}

TEST(Catman, ThatIsCutOffGivesWhatIsThere) {
  const std::string whole = Catman{}.bytes();
  const std::size_t data = whole.size() - 24;
  const Record record = imported(whole.substr(0, whole.size() - 2));
  EXPECT_EQ(record.channels.at(1).size(), 2U);
  EXPECT_THAT(record.warnings, ElementsAre("'force': the file ends after 2 of 3 samples"));
  EXPECT_EQ(import_error(whole.substr(0, data)),
            fmt::format("FILE (byte {}): the file ends before its first sample", data));
  EXPECT_EQ(import_error(whole.substr(0, 200)),
            "FILE (byte 167): the file ends within a channel's extended header");
  Catman empty;
  empty.columns.clear();
  EXPECT_EQ(import_error(empty.bytes().substr(0, 117)),
            "FILE (byte 115): the file ends within the maximum channel length");
  EXPECT_EQ(import_error(whole.substr(0, 350)),
            "FILE (byte 334): the file ends within a channel's sensor");
}

TEST(Catman, SaysWhatIsWrong) {
  const auto error = [](auto change) {
    Catman file;
    change(file);
    return import_error(file.bytes());
  };
  EXPECT_EQ(error([](Catman& file) { file.id = 5006; }),
            "FILE (byte 0): the file ID is 5006, expected 5010 to 5020: export it from catman "
            "anew, or as ASCII");
  EXPECT_EQ(error([](Catman& file) { file.data_offset = -1; }),
            "FILE (byte 2): the samples are said to begin at byte -1");
  EXPECT_EQ(error([](Catman& file) { file.channels = 10001; }),
            "FILE (byte 113): the file has 10001 channels, at most 10000 are read: export it in "
            "parts");
  EXPECT_EQ(error([](Catman& file) { file.columns[1].header_bytes = 100; }),
            "FILE (byte 432): 'force': the extended header has 100 bytes, expected 141 or more");
  EXPECT_EQ(error([](Catman& file) { file.columns[1].precision = 3; }),
            "FILE (byte 576): 'force': the precision is 3, expected 0 (8 bytes), 1 (4 bytes) or 2 "
            "(2 bytes)");
  std::string bytes = Catman{}.bytes();
  bytes.replace(2, 4, std::string("\x10\0\0\0", 4));
  EXPECT_EQ(import_error(bytes),
            "FILE (byte 2): the samples are said to begin at byte 16, within the header of 671 "
            "bytes");
  bytes = Catman{}.bytes();
  bytes.replace(113, 2, "\xFF\xFF");
  EXPECT_EQ(import_error(bytes), "FILE (byte 113): the number of channels is -1");
  bytes = Catman{}.bytes();
  bytes.replace(131 + 2, 4, "\xFF\xFF\xFF\xFF");
  EXPECT_EQ(import_error(bytes), "FILE (byte 133): 'Time  1' is said to have -1 samples");
  bytes = Catman{}.bytes();
  bytes.replace(137, 2, "\xFF\xFF");
  EXPECT_EQ(import_error(bytes),
            "FILE (byte 137): the length of a channel's name is -1, expected 0 or more");
  Catman long_one;
  long_one.columns[1].length = 0x7FFFFFFF;
  EXPECT_THAT(imported(long_one.bytes()).warnings,
              ElementsAre("'force': the file ends after 3 of 2147483647 samples"));
}

}  // namespace
}  // namespace impactrig::acquisition
