// SPDX-License-Identifier: BSD-3-Clause
// Properties that change from one segment to another.
#include <gmock/gmock.h>

#include <cmath>

#include "tests/acquisition/tdms_bytes.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using tests::import_error;
using tests::imported;
using tests::TdmsParts;
using Doubles = std::vector<double>;

const TdmsParts little;

/// What a segment states of a channel of 4 numbers.
struct Stated {
  std::string unit = "N";
  double step = 1e-3;  ///< [s]
  double offset = 0.0;
  std::int64_t seconds = 3600000000;  ///< of the start
  double fraction = 0.0;              ///< [s]
  std::vector<std::string> more{};
};

std::vector<std::string> properties(const Stated& stated) {
  std::vector<std::string> list = {
      little.property("unit_string", stated.unit), little.property("wf_increment", stated.step),
      little.property("wf_start_offset", stated.offset),
      little.raw_property("wf_start_time", 0x44,
                          little.time(stated.seconds, static_cast<std::uint64_t>(
                                                          std::ldexp(stated.fraction, 64))))};
  list.insert(list.end(), stated.more.begin(), stated.more.end());
  return list;
}

std::string segment(const Stated& stated, const Doubles& values = {1, 2, 3, 4}) {
  return little.segment({little.channel("F", little.index(10, values.size()), properties(stated))},
                        little.numbers(values));
}

std::vector<std::string> names(const datasets::Record& record) {
  std::vector<std::string> list;
  for (const datasets::Channel& channel : record.channels) list.push_back(channel.name);
  return list;
}

const char* const may_be_joined =
    "segments that differ in start or interval alone are joined end to end by --sample-rate";

TEST(TdmsChanges, AStartWhereTheSamplesEndIsNone) {
  // as the first segment, then restated; then carried on, within what double precision and the
  // clocks of writers leave; then as an offset
  const auto record =
      imported(segment({}) + segment({}, {5, 6, 7, 8}) + segment({.fraction = 0.008}, {9}) +
               segment({.fraction = 0.0094}, {10}) + segment({.offset = 0.010}, {11}) +
               segment({.step = 1e-3 * (1 + 2e-16), .offset = 0.010}, {12}));
  ASSERT_EQ(record.channels.size(), 1U);
  EXPECT_THAT(record.warnings, IsEmpty());
  EXPECT_THAT(record.channels[0].values(), ElementsAre(1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12));
  EXPECT_EQ(record.channels[0].clock.start, 0.0);
  EXPECT_EQ(record.channels[0].clock.interval, 1e-3);
  EXPECT_EQ(record.started, "2018-01-28T16:00:00Z");
  EXPECT_EQ(record.channels[0].attributes.at("wf_start_time"), "2018-01-28T16:00:00Z");
}

TEST(TdmsChanges, AGapBeginsAChannel) {
  const auto record = imported(segment({}) + segment({.seconds = 3600000005}, {5, 6, 7, 8}));
  EXPECT_THAT(names(record), ElementsAre("F", "F (segment 2)"));
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(record.channels.at(1).values(), ElementsAre(5, 6, 7, 8));
  EXPECT_EQ(record.started, "2018-01-28T16:00:00Z");
  EXPECT_EQ(record.channels[0].clock.start, 0.0);
  EXPECT_EQ(record.channels[1].clock.start, 5.0);
  EXPECT_THAT(
      record.warnings,
      ElementsAre("'F': segment 2 changes wf_start_time from 2018-01-28T16:00:00Z to "
                  "2018-01-28T16:00:05Z, after 4 samples, with a gap of 4.996 s: those that follow "
                  "are '... (segment 2)'",
                  may_be_joined,
                  "channels start at different times: time 0 is the start of the earliest"));
}

TEST(TdmsChanges, AnotherStartOffsetIsAGapToo) {
  const auto record = imported(segment({}) + segment({.offset = 5.0}, {5}));
  EXPECT_EQ(record.channels.at(0).clock.start, 0.0);
  EXPECT_EQ(record.channels.at(1).clock.start, 5.0);
  EXPECT_EQ(record.warnings.at(0),
            "'F': segment 2 changes wf_start_offset from 0 to 5, after 4 samples, with a gap of "
            "4.996 s: those that follow are '... (segment 2)'");
  // where none is stated it is 0
  const std::vector<std::string> step = {little.property("wf_increment", 1e-3)};
  const auto first = [&](double offset) {
    return imported(little.segment({little.channel("F", little.index(10, 1), step)},
                                   little.numbers(Doubles{1})) +
                    little.segment({little.channel("F", little.same(),
                                                   {little.property("wf_start_offset", offset)})},
                                   little.numbers(Doubles{2})));
  };
  EXPECT_EQ(first(5.0).channels.size(), 2U);
  EXPECT_EQ(first(1e-3).channels.size(), 1U);
  EXPECT_THAT(first(1e-3).warnings, IsEmpty());
}

TEST(TdmsChanges, AStartBeforeTheEndIsTold) {
  const auto record = imported(segment({}) + segment({.fraction = 0.002}, {5}));
  EXPECT_EQ(record.channels.at(1).clock.start, 0.002);
  EXPECT_THAT(record.warnings.at(0),
              HasSubstr("after 4 samples, with an overlap of 0.002 s: those "));
}

TEST(TdmsChanges, AnotherIntervalBeginsAChannelWhereTheOneBeforeEnds) {
  const auto record = imported(segment({}) + segment({.step = 2e-3}, {5, 6}) +
                               segment({.step = 2e-3}, {7}) + segment({.step = 1e-3}, {8}));
  EXPECT_THAT(names(record), ElementsAre("F", "F (segment 2)", "F (segment 4)"));
  EXPECT_EQ(record.channels[0].clock.interval, 1e-3);
  EXPECT_EQ(record.channels[1].clock.interval, 2e-3);
  EXPECT_EQ(record.channels[1].clock.start, 0.004);
  EXPECT_THAT(record.channels[1].values(), ElementsAre(5, 6, 7));
  EXPECT_EQ(record.channels[2].clock.interval, 1e-3);
  EXPECT_EQ(record.channels[2].clock.start, 0.010);
  EXPECT_THAT(
      record.warnings,
      ElementsAre("'F': segment 2 changes wf_increment from 0.001 to 0.002, after 4 samples: those "
                  "that follow are '... (segment 2)'",
                  "'F': segment 4 changes wf_increment from 0.002 to 0.001, after 3 samples: those "
                  "that follow are '... (segment 4)'",
                  may_be_joined));
}

// Software-timed loops: each buffer has a start and an interval of its own, which jitter.
TEST(TdmsChanges, AStatedRateJoinsWhatDiffersInItsClock) {
  ImportOptions options;
  options.sample_rate = 500.0;
  const std::string file = segment({}) + segment({.step = 1.1e-3, .fraction = 0.0051}, {5, 6}) +
                           segment({.step = 1.1e-3, .offset = 0.001, .fraction = 0.0072}, {7});
  EXPECT_EQ(imported(file).channels.size(), 3U);
  const auto record = imported(file, options);
  EXPECT_THAT(names(record), ElementsAre("F"));
  EXPECT_THAT(record.channels[0].values(), ElementsAre(1, 2, 3, 4, 5, 6, 7));
  EXPECT_EQ(record.channels[0].clock.interval, 2e-3);
  EXPECT_EQ(record.started, "2018-01-28T16:00:00Z");
  EXPECT_THAT(record.warnings,
              ElementsAre("'F': the starts or intervals of 2 later segments are passed over, since "
                          "--sample-rate joins segments end to end"));
  // another unit is another channel all the same
  EXPECT_THAT(names(imported(file + segment({.unit = "kN"}), options)),
              ElementsAre("F", "F (segment 4)"));
}

TEST(TdmsChanges, AnotherUnitBeginsAChannel) {
  const auto record = imported(segment({}) + segment({.unit = "kN"}, {5, 6}));
  EXPECT_THAT(names(record), ElementsAre("F", "F (segment 2)"));
  EXPECT_EQ(record.channels[0].unit, "N");
  EXPECT_EQ(record.channels[1].unit, "kN");
  EXPECT_EQ(record.channels[1].quantity, datasets::Quantity::force);
  EXPECT_EQ(record.channels[1].attributes.at("unit_string"), "kN");
  EXPECT_EQ(record.channels[1].clock.start, 0.004);
  EXPECT_THAT(record.warnings,
              ElementsAre("'F': segment 2 changes unit_string from 'N' to 'kN', after 4 samples: "
                          "those that follow are '... (segment 2)'"));
}

TEST(TdmsChanges, OtherScalesBeginAChannel) {
  const auto slope = [](double value) {
    return std::vector<std::string>{
        little.property("NI_Number_Of_Scales", 1U),
        little.property("NI_Scale[0]_Scale_Type", "Linear"),
        little.property("NI_Scale[0]_Linear_Slope", value),
        little.property("NI_Scale[0]_Linear_Y_Intercept", 0.0),
        little.property("NI_Scale[0]_Linear_Input_Source", 0xFFFFFFFFU),
    };
  };
  const auto record =
      imported(segment({.more = slope(2)}, {1, 2}) + segment({.more = slope(10)}, {1, 2}));
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(2, 4));
  EXPECT_THAT(record.channels.at(1).values(), ElementsAre(10, 20));
  EXPECT_EQ(record.channels[1].clock.start, 0.002);
  EXPECT_THAT(record.warnings,
              ElementsAre("'F': segment 2 changes NI_Scale[0]_Linear_Slope from 2 to 10, after 2 "
                          "samples: those that follow are '... (segment 2)'"));
}

TEST(TdmsChanges, OtherScalesOfTheGroupLeaveTheNumbersUnscaled) {
  const auto group = [](double slope) {
    return little.object("/'G'", little.none(),
                         {little.property("NI_Scale[0]_Scale_Type", "Linear"),
                          little.property("NI_Scale[0]_Linear_Slope", slope),
                          little.property("NI_Scale[0]_Linear_Y_Intercept", 0.0)});
  };
  const std::vector<std::string> unit = {little.property("unit_string", "N")};
  const auto record = imported(
      little.segment({group(2), little.channel("F", little.index(10, 1), unit)},
                     little.numbers(Doubles{1})) +
      little.segment({group(2), little.channel("F", little.same())}, little.numbers(Doubles{2})) +
      little.segment({group(3), little.channel("F", little.same())}, little.numbers(Doubles{3})));
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(1, 2, 3));
  EXPECT_EQ(record.channels[0].unit, "");
  EXPECT_EQ(record.warnings.at(0),
            "'F' is read unscaled, without its unit 'N': the scales of its group change from one "
            "segment to another");
}

TEST(TdmsChanges, ChannelsThatChangeAlikeShareAWarning) {
  const auto both = [](std::int64_t seconds, const Doubles& values) {
    const auto all = properties({.seconds = seconds});
    return little.segment({little.channel("F", little.index(10, 1), all),
                           little.channel("v", little.index(10, 1), all)},
                          little.numbers(values));
  };
  const auto record = imported(both(3600000000, {1, 11}) + both(3600000001, {2, 12}));
  EXPECT_THAT(names(record), ElementsAre("F", "v", "F (segment 2)", "v (segment 2)"));
  EXPECT_THAT(record.channels[3].values(), ElementsAre(12));
  EXPECT_EQ(record.channels[3].clock.start, 1.0);
  EXPECT_EQ(record.warnings.size(), 3U);
  EXPECT_THAT(record.warnings[0], testing::StartsWith("'F', 'v': segment 2 changes wf_start_time"));
  ImportOptions options;
  options.channels = {"G/v (segment 2)"};
  EXPECT_THAT(
      imported(both(3600000000, {1, 11}) + both(3600000001, {2, 12}), options).channels[0].values(),
      ElementsAre(12));
}

TEST(TdmsChanges, AStatementBeforeTheDataWaitsForThem) {
  // a segment without data, one that changes it back, one of another channel
  const std::string kilo = little.segment(
      {little.channel("F", little.none(), {little.property("unit_string", "kN")})}, "");
  const std::string back = little.segment(
      {little.channel("F", little.none(), {little.property("unit_string", "N")})}, "");
  const std::string other =
      little.segment({little.channel("v", little.index(10, 1))}, little.numbers(Doubles{7}));
  EXPECT_THAT(names(imported(segment({}) + kilo + back + segment({}, {5}))), ElementsAre("F"));
  const std::string same =
      little.segment({little.channel("F", little.same())}, little.numbers(Doubles{5, 6, 7, 8}));
  const auto later = imported(segment({}) + kilo + other + same);
  EXPECT_THAT(names(later), ElementsAre("F", "v", "F (segment 4)"));
  EXPECT_EQ(later.channels[2].unit, "kN");
}

TEST(TdmsChanges, AStatementAfterTheLastSampleHoldsForAllAndIsTold) {
  const std::string kilo = little.segment(
      {little.channel("F", little.none(), {little.property("unit_string", "kN")})}, "");
  const auto record = imported(segment({}) + kilo);
  EXPECT_EQ(record.channels.at(0).unit, "kN");
  EXPECT_THAT(record.warnings, ElementsAre("'F': unit_string from 'N' to 'kN' changed after its "
                                           "last sample: the last statement holds for all"));
  // what was not stated before is stated late
  const std::string late = little.segment(
      {little.channel("F", little.none(), {little.property("unit_string", "N")})}, "");
  const auto without = little.segment(
      {little.channel("F", little.index(10, 2), {little.property("wf_increment", 1.0)})},
      little.numbers(Doubles{1, 2}));
  EXPECT_EQ(imported(without + late).channels.at(0).unit, "N");
  EXPECT_THAT(imported(without + late).warnings, IsEmpty());
  const auto between =
      imported(without + late +
               little.segment({little.channel("F", little.same())}, little.numbers(Doubles{3, 4})));
  EXPECT_THAT(between.channels.at(0).values(), ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(between.warnings,
              ElementsAre("'F': segment 3 is the first with data that states unit_string 'N', "
                          "after 2 samples: it is taken to hold for all"));
}

TEST(TdmsChanges, AFileThatEndsBeforeTheDataKeepsWhatHeld) {
  const std::string file = segment({});
  const std::string next = segment({.unit = "kN", .seconds = 3600000009});
  const auto record = imported(file + next.substr(0, next.size() - 4 * 8));
  ASSERT_EQ(record.channels.size(), 1U);
  EXPECT_EQ(record.channels[0].unit, "N");
  EXPECT_EQ(record.started, "2018-01-28T16:00:00Z");
}

TEST(TdmsChanges, WithoutAnIntervalTheFirstStartIsKept) {
  const auto record = imported(segment({.step = 0}) + segment({.step = 0, .seconds = 3600000005}));
  ASSERT_EQ(record.channels.size(), 1U);
  EXPECT_EQ(record.channels[0].size(), 8U);
  EXPECT_EQ(record.started, "2018-01-28T16:00:00Z");
  EXPECT_EQ(record.warnings.at(0),
            "'F': segment 2 changes wf_start_time from 2018-01-28T16:00:00Z to "
            "2018-01-28T16:00:05Z, after 4 samples, from which no times follow: the first is kept");
}

TEST(TdmsChanges, OtherPropertiesAreThoseOfTheLastSegment) {
  const auto record = imported(segment({.more = {little.property("Operator", "A")}}) +
                               segment({.more = {little.property("Operator", "B")}}));
  ASSERT_EQ(record.channels.size(), 1U);
  EXPECT_EQ(record.channels[0].attributes.at("Operator"), "B");
  EXPECT_THAT(record.warnings, IsEmpty());
}

TEST(TdmsChanges, OfASpectrumMoveItsFirstLine) {
  const std::vector<std::string> hertz = {little.property("wf_xunit_string", "Hz")};
  const auto record = imported(segment({.step = 2.5, .more = hertz}) +
                               segment({.unit = "kN", .step = 2.5, .more = hertz}, {5}));
  EXPECT_EQ(record.channels.at(0).attributes.at("abscissa first"), "0");
  EXPECT_EQ(record.channels.at(1).attributes.at("abscissa first"), "10");
}

// Shots, each a segment with a start of its own.
TEST(TdmsChanges, ManySegmentsAreToldInFewWords) {
  std::string file;
  for (int shot = 0; shot < 1000; ++shot) file += segment({.seconds = 3600000000 + 10 * shot});
  const auto record = imported(file);
  ASSERT_EQ(record.channels.size(), 1000U);
  EXPECT_EQ(record.channels[999].name, "F (segment 1000)");
  EXPECT_EQ(record.channels[999].clock.start, 9990.0);
  ASSERT_EQ(record.warnings.size(), 6U);
  EXPECT_EQ(record.warnings[4], may_be_joined);
  EXPECT_EQ(record.warnings[3],
            "'F': 996 later segments change properties too, each begins a channel '... (segment "
            "n)'");
}

TEST(TdmsChanges, SegmentsThatGoOnTakeLittleMemoryAndTime) {
  std::string file;
  for (int i = 0; i < 30000; ++i) file += segment({.step = 1.0, .seconds = 3600000000 + 4 * i});
  const auto record = imported(file);
  ASSERT_EQ(record.channels.size(), 1U);
  EXPECT_EQ(record.channels[0].size(), 120000U);
  EXPECT_THAT(record.warnings, IsEmpty());
}

TEST(TdmsChanges, PartsWithoutEndAreRefused) {
  std::vector<std::string> many;
  for (int i = 0; i < 2000; ++i) many.push_back(little.property("p" + std::to_string(i), "x"));
  std::string file = segment({.more = many});
  for (int i = 0; i < 600; ++i) file += segment({.unit = i % 2 == 0 ? "kN" : "N"});
  EXPECT_THAT(import_error(file),
              HasSubstr("the properties of /'G'/'F' and others change in so many segments"));
}

TEST(TdmsChanges, StatedUnitsReplaceTheFiles) {
  ImportOptions options;
  options.units = {"", "mm/s"};
  const std::string file =
      little.segment({little.channel("F", little.index(10, 1), properties({})),
                      little.channel("v", little.index(10, 1), properties({}))},
                     little.numbers(Doubles{1, 2}));
  const auto record = imported(file, options);
  EXPECT_EQ(record.channels.at(0).unit, "N");
  EXPECT_EQ(record.channels.at(1).unit, "mm/s");
  EXPECT_EQ(record.channels.at(1).quantity, datasets::Quantity::velocity);
  options.units = {"N", "mm/s", "V"};
  EXPECT_EQ(import_error(file, options), "FILE: 3 units are stated but the file has 2 channels");
}

}  // namespace
}  // namespace impactrig::acquisition
