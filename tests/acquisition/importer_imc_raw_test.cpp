// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>

#include "acquisition/importer.hpp"
#include "tests/acquisition/imc_raw_bytes.hpp"
#include "tests/acquisition/sound_channel.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using datasets::Quantity;
using datasets::Record;
using testing::ElementsAre;
using tests::expect_head;
using tests::imc_events;
using tests::imc_key;
using tests::ImcComponent;
using tests::ImcRaw;
using tests::import_error;
using tests::imported;
using tests::part_from;
using tests::sound_channel;

TEST(ImcRaw, IsReadInBothByteOrders) {
  for (const bool big_endian : {false, true}) {
    ImcRaw file;
    file.big_endian = big_endian;
    const Record record = imported(file.bytes());
    const auto& channel = sound_channel(record, "imc-raw");
    expect_head(channel, "force", "N", 0.25, 1e-3);
    EXPECT_EQ(channel.quantity, Quantity::force);
    EXPECT_THAT(channel.values(), ElementsAre(2.0, 3.0, 4.0));
    EXPECT_EQ(std::get<std::vector<float>>(channel.raw), (std::vector<float>{2, 4, 6}));
    EXPECT_EQ(channel.attributes.at("comment"), "ok");
    EXPECT_EQ(record.started, "2022-04-12T13:31:46.5");
    EXPECT_EQ(record.attributes.at("origin"), "test");
  }
}

TEST(ImcRaw, HasNumbersOfEveryKind) {
  for (const int format : {1, 2, 3, 4, 5, 6, 7, 8, 12, 14})
    for (const bool big_endian : {false, true}) {
      SCOPED_TRACE(format);
      ImcRaw file;
      file.big_endian = big_endian;
      file.components[0].format = format;
      file.components[0].samples = {2, 100, 6};
      EXPECT_THAT(imported(file.bytes()).channels.at(0).values(), ElementsAre(2.0, 51.0, 4.0));
    }
}

TEST(ImcRaw, RangeMayBeOffOrUnstatedOrQuoted) {
  ImcRaw file;
  file.components[0].range = "0,5.0E-01,1.0E+00,1,4,\"mbar\"";
  const Record record = imported(file.bytes());
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(2.0, 4.0, 6.0));
  EXPECT_EQ(record.channels.at(0).unit, "mbar");
  file.components[0].range = "0,1,0,0,1,N";
  EXPECT_EQ(imported(file.bytes()).channels.at(0).unit, "");
  file.components[0].range = "";
  file.components[0].name = "";
  EXPECT_EQ(imported(file.bytes()).channels.at(0).name, "channel 1");
}

TEST(ImcRaw, NamesMayHoldCommasAndLatinLetters) {
  ImcRaw file;
  file.components[0].name = "Kraft, H\xF6he";
  EXPECT_EQ(imported(file.bytes()).channels.at(0).name, "Kraft, Höhe");
}

TEST(ImcRaw, HasSeveralChannelsAndWindows) {
  ImcRaw file;
  file.components.push_back({.format = 4, .range = "1,2,0,1,1,V", .name = "head", .start = 0.0});
  const Record record = imported(file.bytes());
  ASSERT_EQ(record.channels.size(), 2U);
  EXPECT_THAT(record.channels[1].values(), ElementsAre(4.0, 8.0, 12.0));
  const auto options = part_from(0.001, "head");
  EXPECT_THAT(imported(file.bytes(), options).channels.at(0).values(), ElementsAre(8.0, 12.0));
}

TEST(ImcRaw, BufferMayBeARing) {
  ImcRaw file;
  file.components[0].first = 8;  // the third number is the oldest
  EXPECT_THAT(imported(file.bytes()).channels.at(0).values(), ElementsAre(4.0, 2.0, 3.0));
  file.components[0].filled = 8;
  EXPECT_THAT(imported(file.bytes()).channels.at(0).values(), ElementsAre(4.0, 2.0));
  file.components[0].first = 0;
  EXPECT_THAT(imported(file.bytes()).channels.at(0).values(), ElementsAre(2.0, 3.0));
}

TEST(ImcRaw, BuffersAreEvents) {
  ImcRaw file;
  file.components[0].buffers = "2,0,1,1,0,4,0,4,1,0.5,0,,2,1,4,8,0,8,1,0.75,60,";
  const Record record = imported(file.bytes());
  ASSERT_EQ(record.channels.size(), 2U);
  EXPECT_EQ(record.channels[0].name, "force, event 1");
  EXPECT_EQ(record.channels[1].name, "force, event 2");
  EXPECT_THAT(record.channels[1].values(), ElementsAre(3.0, 4.0));
  EXPECT_EQ(record.channels[1].clock.start, 0.75);
  EXPECT_EQ(record.channels[1].attributes.at("add time"), "60 s");
  EXPECT_EQ(record.channels[1].attributes.at("trigger time"), "2022-04-12T13:32:46.5");
  EXPECT_THAT(record.warnings,
              testing::Contains(testing::StartsWith("channels were started at different times")));
  EXPECT_THAT(imported(ImcRaw{}.bytes()).warnings, testing::IsEmpty());
}

TEST(ImcRaw, BuffersOfOneEventAreOneRecord) {
  ImcRaw file;
  file.components[0].samples = {2, 4, 6, 8};
  file.components[0].buffers = "2,0,1,1,0,8,0,8,1,0.25,0,,2,1,8,8,0,8,0,0.252,0,";
  Record record = imported(file.bytes());
  ASSERT_EQ(record.channels.size(), 1U);
  EXPECT_EQ(record.channels[0].name, "force");
  EXPECT_THAT(record.channels[0].values(), ElementsAre(2.0, 3.0, 4.0, 5.0));
  EXPECT_EQ(record.channels[0].clock.start, 0.25);
  // what says that it goes on, but begins elsewhere, is not put together
  file.components[0].buffers = "2,0,1,1,0,8,0,8,1,0.25,0,,2,1,8,8,0,8,0,0.5,0,";
  record = imported(file.bytes());
  ASSERT_EQ(record.channels.size(), 2U);
  EXPECT_EQ(record.channels[1].clock.start, 0.5);
}

TEST(ImcRaw, EventsOfAListAreRecordsOfTheirOwn) {
  for (const bool big_endian : {false, true}) {
    ImcRaw file;
    file.big_endian = big_endian;
    file.more = imc_events({{.first = 0, .count = 1, .start = -2e-3},
                            {.first = 1, .count = 2, .time = 7.25, .start = -1e-3}},
                           big_endian);
    file.components[0].more = imc_key("Cv", 1, "1,0,1,0,2,1,1,0,0");
    const Record record = imported(file.bytes());
    ASSERT_EQ(record.channels.size(), 2U);
    EXPECT_EQ(record.channels[0].name, "force, event 1");
    EXPECT_THAT(record.channels[0].values(), ElementsAre(2.0));
    EXPECT_EQ(record.channels[0].clock.start, -2e-3);
    EXPECT_EQ(record.channels[0].attributes.at("trigger time"), "2022-04-12T13:31:46.5");
    EXPECT_THAT(record.channels[1].values(), ElementsAre(3.0, 4.0));
    EXPECT_EQ(record.channels[1].clock.start, -1e-3);
    EXPECT_EQ(record.channels[1].clock.interval, 1e-3);
    EXPECT_EQ(record.channels[1].attributes.at("event time"), "7.25 s");
    EXPECT_EQ(record.channels[1].attributes.count("trigger time"), 0U);
    EXPECT_THAT(record.warnings,
                ElementsAre("'force': its list of events states other starts or intervals than the "
                            "channel: those of the list are taken"));
  }
}

TEST(ImcRaw, EventsOfAListMayBeSomeOfItAndBeyondTheSamples) {
  ImcRaw file;
  file.more = imc_events({{.count = 9}, {.first = 1, .count = 1}, {}, {.first = 2, .count = 5}});
  file.components[0].start = 0.0;
  file.components[0].more = imc_key("Cv", 1, "1,1,1,1,2,0,0,0,0");
  const Record record = imported(file.bytes());
  ASSERT_EQ(record.channels.size(), 2U);
  EXPECT_THAT(record.channels[0].values(), ElementsAre(3.0));
  EXPECT_THAT(record.channels[1].values(), ElementsAre(4.0));
  EXPECT_THAT(
      record.warnings,
      ElementsAre("'force, event 2': the file ends after 1 of 5 samples",
                  "'force': 1 of 3 samples are in none of its 2 events: they are left out"));
}

TEST(ImcRaw, StartIsThatOfTheBufferOrTheAbscissaOrNone) {
  const auto start = [](int usage, double of_buffer) {
    ImcRaw file;
    file.abscissa = fmt::format("1.0E-03,1,1,s,0,0,0,5,{}", usage);
    file.components[0].start = of_buffer;
    return imported(file.bytes()).channels.at(0).clock.start;
  };
  EXPECT_EQ(start(0, 3.0), 0.0);
  EXPECT_EQ(start(1, 3.0), 3.0);
  EXPECT_EQ(start(1, 0.0), 0.0);
  EXPECT_EQ(start(2, 3.0), 5.0);
}

TEST(ImcRaw, BitsToBeIgnoredAreTakenOff) {
  ImcRaw file;
  file.components[0].format = 4;
  file.components[0].range = "1,0.5,1,1,1,N";
  file.components[0].packing = "16,3,0,1,0";
  file.components[0].samples = {7, 9, -1};
  EXPECT_THAT(imported(file.bytes()).channels.at(0).values(), ElementsAre(3.0, 5.0, -1.0));
}

TEST(ImcRaw, AngleIsNoTemperature) {
  ImcRaw file;
  file.components[0].range = "1,1,0,1,4,Degr";
  const Record record = imported(file.bytes());
  EXPECT_EQ(record.channels.at(0).unit, "deg");
  EXPECT_EQ(record.channels.at(0).quantity, Quantity::angle);
}

TEST(ImcRaw, ThatIsNotClosedMayStateNoFilledSamples) {
  ImcRaw file;
  file.closed = "1,0";
  file.components[0].buffers = "1,0,1,1,0,12,0,0,1,0,0,";
  const Record record = imported(file.bytes());
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(2.0, 3.0, 4.0));
  EXPECT_THAT(record.warnings,
              ElementsAre("the file was not closed by the program that wrote it",
                          "'force': the file, which was not closed, states that no samples are "
                          "filled: all 3 that are there are read"));
}

TEST(ImcRaw, TriggerTimeMayCountFrom1980) {
  ImcRaw file;
  file.date = "1,1,1980,0,0,0.0";
  file.components[0].add_time = 1.2418051840000000E+09;
  EXPECT_EQ(imported(file.bytes()).started, "2019-05-08T17:53:04");
}

TEST(ImcRaw, MayBeOverItsOwnTimes) {
  for (const bool big_endian : {false, true})
    for (const int format : {13, 5, 8}) {
      ImcRaw file;
      file.big_endian = big_endian;
      file.type = 2;
      file.one_group = true;
      file.components.resize(2);
      file.components[1].format = format;
      file.components[1].range = "1,1E-06,0,1,1,s";
      file.components[1].samples = {0, 1000000, 4000000};
      if (format == 13) file.components[1].samples = {0, 1e12, 4e12};
      const double factor = format == 13 ? 1e6 : 1.0;
      const Record record = imported(file.bytes());
      ASSERT_EQ(record.channels.size(), 1U);
      EXPECT_THAT(record.channels[0].values(), ElementsAre(2.0, 3.0, 4.0));
      EXPECT_THAT(record.channels[0].clock.times,
                  ElementsAre(0.0, testing::DoubleEq(factor), testing::DoubleEq(4.0 * factor)));
    }
  ImcRaw file;
  file.type = 2;
  file.one_group = true;
  file.components.resize(2);
  file.components[1].range = "1,1,0,1,2,ms";
  file.components[1].samples = {0, 1, 2};
  const Record record = imported(file.bytes());
  EXPECT_DOUBLE_EQ(record.channels.at(0).clock.interval, 0.001);
  EXPECT_TRUE(record.channels.at(0).clock.uniform());
}

TEST(ImcRaw, XMayBeStoredBeforeY) {
  ImcRaw file;
  file.type = 2;
  file.one_group = true;
  file.components.resize(2);
  file.components[0] = {.format = 8, .range = "1,1,0,1,1,s", .name = "x", .index = 2};
  file.components[0].samples = {0, 1, 4};
  file.components[1].index = 1;
  const Record record = imported(file.bytes());
  ASSERT_EQ(record.channels.size(), 1U);
  EXPECT_EQ(record.channels[0].name, "force");
  EXPECT_THAT(record.channels[0].values(), ElementsAre(2.0, 3.0, 4.0));
  EXPECT_THAT(record.channels[0].clock.times, ElementsAre(0.0, 1.0, 4.0));
}

TEST(ImcRaw, OverFrequencyIsNoTimeRecord) {
  ImcRaw file;
  file.abscissa = "10,1,2,Hz,0,0,0";
  file.abscissa_version = 1;
  EXPECT_EQ(imported(file.bytes()).channels.at(0).attributes.at("domain"), "frequency");
  file.abscissa = "10,0,2,Hz,0,0,0";  // not calibrated
  EXPECT_EQ(imported(file.bytes()).channels.at(0).clock.interval, 10.0);
}

TEST(ImcRaw, WhatIsNotReadIsLeftOutBesideOthers) {
  ImcRaw file;
  file.components.push_back({.format = 10, .name = "stamps"});
  const Record record = imported(file.bytes());
  EXPECT_EQ(record.channels.size(), 1U);
  EXPECT_THAT(record.warnings,
              ElementsAre("'stamps' holds time stamps as text, which is not read"));
}

TEST(ImcRaw, BitsOfDigitalWordsAreChannels) {
  for (const bool big : {false, true}) {
    ImcRaw file;
    file.big_endian = big;
    file.components[0] = {.format = 11,
                          .digital = 2,
                          .range = "",
                          .name = "gate",
                          .more = imc_key("CN", 1, "0,0,16,4,last,0,"),
                          .bit = 1,
                          .samples = {1, 32770, 32769}};
    const Record record = imported(file.bytes());
    ASSERT_EQ(record.channels.size(), 2U);
    EXPECT_EQ(record.channels[0].name, "last");
    EXPECT_THAT(record.channels[0].values(), ElementsAre(0, 1, 1));
    EXPECT_EQ(record.channels[1].name, "gate");
    EXPECT_THAT(record.channels[1].values(), ElementsAre(1, 0, 1));
    EXPECT_EQ(record.channels[1].unit, "");
    EXPECT_EQ(record.channels[1].clock.interval, 0.001);
    EXPECT_THAT(record.warnings, ElementsAre());
    file.components[0].bit = 0;  // the word itself
    file.components[0].more = "";
    EXPECT_THAT(imported(file.bytes()).channels.at(0).values(), ElementsAre(1, 32770, 32769));
  }
}

const std::string not_read = ", which is not read: export it from FAMOS as ASCII";

/// What is said of a file so changed, behind its place.
template <typename Change>
std::string error_of(const Change& change) {
  ImcRaw file;
  change(file);
  const std::string text = import_error(file.bytes());
  return text.substr(text.find("): ") + 3);
}

TEST(ImcRaw, WhatIsNotReadIsAnErrorAlone) {
  EXPECT_EQ(error_of([](ImcRaw& file) { file.components[0].digital = 2; }),
            "'force' is digital, bit 0 in numbers of format 7" + not_read);
  EXPECT_EQ(
      error_of([](ImcRaw& file) { file.components[0] = {.format = 11, .digital = 2, .bit = 17}; }),
      "'force' is digital, bit 17 in digital words" + not_read);
  EXPECT_EQ(error_of([](ImcRaw& file) {
              file.type = 2;
              file.one_group = true;
              file.components = {{.format = 11, .digital = 2}, {.format = 11, .digital = 2}};
            }),
            "'force' is digital over an x of its own" + not_read);
  EXPECT_EQ(error_of([](ImcRaw& file) { file.components[0].format = 9; }),
            "'force' holds imc's transitional recording" + not_read);
  EXPECT_EQ(error_of([](ImcRaw& file) { file.components[0].format = 10; }),
            "'force' holds time stamps as text" + not_read);
  EXPECT_EQ(error_of([](ImcRaw& file) { file.components[0].format = 11; }),
            "'force' holds digital words" + not_read);
  EXPECT_EQ(error_of([](ImcRaw& file) { file.components[0].format = 13; }),
            "'force' holds integers of 6 bytes" + not_read);
  EXPECT_EQ(error_of([](ImcRaw& file) { file.components[0].format = 99; }),
            "'force' holds numbers of format 99" + not_read);
  EXPECT_EQ(error_of([](ImcRaw& file) { file.components[0].packing = "32,0,0,2,4"; }),
            "'force' is stored in groups of 2 numbers" + not_read);
  EXPECT_EQ(error_of([](ImcRaw& file) { file.type = 4; }),
            "'force' holds complex numbers (real and imaginary part)" + not_read);
  EXPECT_EQ(error_of([](ImcRaw& file) { file.type = 0; }),
            "'force' holds data of type 0" + not_read);
  EXPECT_EQ(error_of([](ImcRaw& file) { file.type = 3; }),
            "'force' is an x-y data set of 1 components in several buffers" + not_read);
  EXPECT_EQ(error_of([](ImcRaw& file) { file.components[0].buffers = "0,0"; }),
            "'force' has no buffer of samples ('Cb')" + not_read);
  EXPECT_EQ(error_of([](ImcRaw& file) { file.components[0].buffers = "1,0,1,2,0,4,0,4,1,0,0,"; }),
            "'force' has no samples in the file ('CS')" + not_read);
  const std::string segments = imc_key("CZ", 1, "1,1,0,1,1,s,2");
  EXPECT_EQ(error_of([&](ImcRaw& file) { file.components[0].more = segments; }),
            "'force' is a matrix, of segments of 2 samples ('CZ')" + not_read);
  EXPECT_EQ(error_of([](ImcRaw& file) { file.components[0].packing = "32,3,0,1,0"; }),
            "'force' has bits to be ignored (mask 3) in its numbers" + not_read);
}

TEST(ImcRaw, EventsThatAreNotReadAreErrors) {
  const auto events = [](const std::string& list, const std::string& reference,
                         const std::string& buffers = "") {
    return error_of([&](ImcRaw& file) {
      file.more = list;
      file.components[0].more = imc_key("Cv", 1, reference);
      file.components[0].buffers = buffers;
    });
  };
  EXPECT_EQ(events("", "1,0,1,0,2,1,1,0,0"),
            "'force' has 2 events of which 0 are in the file ('CV')" + not_read);
  EXPECT_EQ(events(imc_events({{.count = 3, .factor = 2.0}}), "1,0,1,0,1,1,1,1,0"),
            "'force' has events with scales of their own" + not_read);
  EXPECT_EQ(events(imc_events({{.count = 3}}), "1,0,1,0,1,1,1,0,0",
                   "2,0,1,1,0,4,0,4,1,0.5,0,,2,1,4,8,0,8,1,0.75,60,"),
            "'force' has a list of events in several buffers" + not_read);
  EXPECT_EQ(events("", "1,0,1,0,1,1,1,0,0", "1,0,1,2,0,4,0,4,1,0,0,"),
            "'force' has no samples in the file ('CS')" + not_read);
}

TEST(ImcRaw, PairsThatAreNotReadAreErrors) {
  const auto xy = [](auto change) {
    return error_of([&](ImcRaw& file) {
      file.type = 3;
      file.one_group = true;
      file.components.resize(2);
      change(file.components[1]);
    });
  };
  EXPECT_EQ(xy([](ImcComponent& x) {
              x.samples = {1, 2};
            }),
            "'force' has 3 samples and 2 x" + not_read);
  EXPECT_EQ(xy([](ImcComponent& x) {
              x.format = 4;
              x.packing = "16,1,0,1,0";
            }),
            "'force' is an x-y data set with bits to be ignored" + not_read);
  EXPECT_EQ(xy([](ImcComponent& x) { x.more = imc_key("Cv", 1, "1,0,1,0,1,1,1,0,0"); }),
            "'force' is an x-y data set with a list of events" + not_read);
  EXPECT_EQ(xy([](ImcComponent& x) { x.range = "0,1,0,1,2,mm"; }),
            "'force' is over 'mm', which is no time" + not_read);
  EXPECT_EQ(xy([](ImcComponent& x) {
              x.range = "0,1,0,1,1,s";
              x.samples = {0, INFINITY, 2};
            }),
            "'force' has times that are not finite" + not_read);
}

TEST(ImcRaw, ThatIsCutOffGivesWhatIsThere) {
  const std::string whole = ImcRaw{}.bytes();
  Record record = imported(whole.substr(0, whole.size() - 3));
  EXPECT_EQ(record.channels.at(0).size(), 2U);
  EXPECT_THAT(record.warnings, ElementsAre("'force': the file ends after 2 of 3 samples"));
  record = imported(whole + "|CF,2,1,1;|CG,1,5");
  EXPECT_THAT(record.warnings,
              ElementsAre(fmt::format("the file ends within the key at byte {}: what follows is "
                                      "left out",
                                      whole.size() + 10)));
  record = imported(whole + "|NO,1,50,1,4");
  EXPECT_THAT(record.warnings,
              ElementsAre(fmt::format("the file ends within the key at byte {}: what follows is "
                                      "left out",
                                      whole.size())));
  EXPECT_EQ(import_error("|CF,2,1,1;|CK,1,3,1"),
            "FILE (byte 10): the file ends within the key 'CK'");
  EXPECT_EQ(import_error("|CF,2"), "FILE (byte 0): expected '|XX,version,length,' of a key");
  ImcRaw open;
  open.closed = "1,0";
  EXPECT_THAT(imported(open.bytes()).warnings,
              ElementsAre("the file was not closed by the program that wrote it"));
}

TEST(ImcRaw, SaysWhatIsWrong) {
  ImportOptions options;
  options.format = "imc-raw";
  const std::string start = "|CF,2,1,1;";  // 10 bytes
  EXPECT_EQ(import_error("", options),
            "FILE (byte 0): expected the key '|CF' of an imc FAMOS file");
  EXPECT_EQ(import_error("|CK,1,3,1,1;", options),
            "FILE (byte 0): expected the key '|CF' of an imc FAMOS file");
  EXPECT_EQ(import_error("|CF,1,1,1;"),
            "FILE (byte 0): this is an imc FAMOS file of version 1, expected 2: save it anew with "
            "FAMOS, or as ASCII");
  EXPECT_EQ(import_error("|CF,2,1,3;"),
            "FILE (byte 0): CF: expected the processor 1 (Intel) or 2 (Motorola), found 3");
  EXPECT_EQ(import_error("|CF,2,1,x;"), "FILE (byte 0): CF: expected a processor, found 'x'");
  EXPECT_EQ(import_error(start + "junk"),
            "FILE (byte 10): expected a key that begins with '|', found 'j'");
  EXPECT_EQ(import_error(start + "|CG,1,-5,1,1,1;"),
            "FILE (byte 10): expected a key, its version and its length, found '|CG,1,-5'");
  EXPECT_EQ(import_error(start + "|CK,1,3,1,1x"),
            "FILE (byte 21): expected ';' behind the key 'CK', found 'x'");
  EXPECT_EQ(import_error(start + imc_key("CD", 1, "x,1,1,s,0,0,0")),
            "FILE (byte 10): CD: expected a distance, found 'x'");
  EXPECT_EQ(import_error(start + imc_key("CP", 1, "1,4,7,32,0,0,1,0")),
            "FILE (byte 10): the key 'CP' stands outside of a component ('CC')");
  EXPECT_EQ(
      import_error(start + imc_key("CC", 1, "1,1") + imc_key("Cb", 1, "2,0,1,1,0,4,0,4,1,0,0,")),
      "FILE (byte 22): Cb: 2 buffers are announced, 1 found");
  EXPECT_EQ(import_error(start + imc_key("CV", 1, "1,2,1,short")),
            "FILE (byte 10): CV: 2 events are announced, 0 found");
  EXPECT_EQ(import_error(start + imc_key("CV", 1, "1,x")),
            "FILE (byte 10): CV: expected a number of events");
  EXPECT_EQ(import_error(start + imc_key("CS", 1, "x")),
            "FILE (byte 10): CS: expected the number of the key, then samples");
  EXPECT_THAT(imported(start).warnings,
              ElementsAre("no recordings in this file: it has no channels with samples"));
  ImcRaw file;
  file.components[0].packing = "32,0,0,1,99999999999";
  EXPECT_THAT(import_error(file.bytes()),
              testing::EndsWith("): 'force': its numbers are said to lie 99999999999 bytes apart, "
                                "the first at 0"));
  std::string bytes = ImcRaw{}.bytes();
  bytes.replace(bytes.find("|CP,1,16,1,4,7"), 14, "|CP,1,16,1,3,7");
  EXPECT_THAT(import_error(bytes), testing::EndsWith("): 'force': numbers of format 7 have 4 "
                                                     "bytes, the key CP states 3"));
  file = {};
  file.components[0].buffers = "10001,0";
  for (int i = 0; i < 10001; ++i) file.components[0].buffers += ",1,1,0,4,0,4,1,0,0,";
  EXPECT_THAT(import_error(file.bytes()),
              testing::EndsWith("): the file has more than 10000 channels or events: save it in "
                                "parts"));
}

}  // namespace
}  // namespace impactrig::acquisition
