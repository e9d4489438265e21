// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <cmath>
#include <cstdint>
#include <limits>

#include "acquisition/importer.hpp"
#include "tests/acquisition/bytes.hpp"
#include "tests/acquisition/tdm_shot.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using datasets::Record;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::Key;
using testing::Not;
using tests::bytes_of_numbers;
using tests::imported_shot;
using tests::names_and_units;
using tests::tdm_header;
using tests::TdmChannel;
using tests::TdmGroup;

std::string doubles(const std::vector<double>& numbers, bool big_endian = false) {
  return bytes_of_numbers(numbers, big_endian);
}

std::string increment(double step, double start = 0.0) {
  return fmt::format(
      "<double_attribute name=\"wf_increment\">{}</double_attribute>"
      "<double_attribute name=\"wf_start_offset\">{}</double_attribute>",
      step, start);
}

TEST(Tdm, ReadsWhatFileGroupAndChannelSay) {
  TdmChannel force;
  force.says = "<description>behind the stop</description>";
  force.attributes = increment(1e-6, -2e-6) +
                     "<string_attribute name=\"sensor\"><s>9001A &amp; 5011</s></string_attribute>"
                     "<long_attribute name=\"NI_DataType\">10</long_attribute>"
                     "<long_attribute name=\"NI_Number_Of_Scales\">2</long_attribute>";
  TdmGroup group{"Impacts", {force}};
  group.attributes = "<string_attribute name=\"rig\"><s>B</s></string_attribute>";
  const Record record =
      imported_shot(tdm_header({group}, "<author>test_pc</author>"), doubles({1.5, -2, 3e10}));
  EXPECT_EQ(record.provenance.importer, "tdm");
  EXPECT_EQ(record.title, "Shot 7");
  EXPECT_EQ(record.attributes.at("author"), "test_pc");
  EXPECT_EQ(record.attributes.at("Impacts/rig"), "B");
  EXPECT_THAT(names_and_units(record), ElementsAre("F [N]"));
  const datasets::Channel& channel = record.channels.at(0);
  EXPECT_EQ(channel.quantity, datasets::Quantity::force);
  EXPECT_THAT(channel.values(), ElementsAre(1.5, -2, 3e10));
  EXPECT_DOUBLE_EQ(channel.clock.start, -2e-6);
  EXPECT_DOUBLE_EQ(channel.clock.interval, 1e-6);
  EXPECT_EQ(channel.attributes.at("group"), "Impacts");
  EXPECT_EQ(channel.attributes.at("description"), "behind the stop");
  EXPECT_EQ(channel.attributes.at("sensor"), "9001A & 5011");
  EXPECT_EQ(channel.attributes.at("NI_DataType"), "10");
  EXPECT_THAT(channel.attributes, Not(testing::Contains(Key("NI_Number_Of_Scales"))));
  EXPECT_THAT(record.warnings, IsEmpty());
}

/// A channel of one type and the largest number that it holds, in either byte order.
template <typename Number>
void expect_type(const std::string& name) {
  const std::vector<Number> numbers = {Number(7), std::numeric_limits<Number>::lowest(),
                                       std::numeric_limits<Number>::max()};
  for (const bool big_endian : {false, true}) {
    SCOPED_TRACE(name + (big_endian ? ", big-endian" : ""));
    TdmChannel channel;
    channel.block = fmt::format(R"(byteOffset="5" length="3" valueType="{}")", name);
    channel.attributes = increment(1);
    TdmGroup group{"G", {channel}, "", "shot.tdx", big_endian ? "bigEndian" : "littleEndian"};
    const Record record =
        imported_shot(tdm_header({group}), "xxxxx" + bytes_of_numbers(numbers, big_endian));
    EXPECT_THAT(record.channels.at(0).values(),
                ElementsAre(double(numbers[0]), double(numbers[1]), double(numbers[2])));
  }
}

TEST(Tdm, ReadsNumbersOfEveryTypeInBothByteOrders) {
  expect_type<std::int8_t>("eInt8Usi");
  expect_type<std::int16_t>("eInt16Usi");
  expect_type<std::int32_t>("eInt32Usi");
  expect_type<std::int64_t>("eInt64Usi");
  expect_type<std::uint8_t>("eUInt8Usi");
  expect_type<std::uint16_t>("eUInt16Usi");
  expect_type<std::uint32_t>("eUInt32Usi");
  expect_type<std::uint64_t>("eUInt64Usi");
  expect_type<float>("eFloat32Usi");
  expect_type<double>("eFloat64Usi");
}

// Behind a head of 4 bytes lie records of a float and a 16-bit integer.
TEST(Tdm, TakesRecordsApart) {
  std::string samples = "head";
  for (int i = 0; i < 3; ++i)
    samples += bytes_of_numbers(std::vector<float>{0.5F * static_cast<float>(i)}) +
               bytes_of_numbers(std::vector<std::int16_t>{static_cast<std::int16_t>(100 - i)});
  TdmChannel first, second;
  first.attributes = second.attributes = increment(1);
  second.name = "x";
  first.block =
      R"(byteOffset="4" blockOffset="0" blockSize="6" length="3" valueType="eFloat32Usi")";
  second.block = R"(byteOffset="4" blockOffset="4" blockSize="6" length="3" valueType="eInt16Usi")";
  const auto check = [&](const TdmChannel& a, const TdmChannel& b) {
    const Record record = imported_shot(tdm_header({{"G", {a, b}}}), samples);
    EXPECT_THAT(record.channels.at(0).values(), ElementsAre(0, 0.5, 1));
    EXPECT_THAT(record.channels.at(1).values(), ElementsAre(100, 99, 98));
    EXPECT_THAT(record.warnings, IsEmpty());
  };
  check(first, second);
  // the two offsets may also be stated the other way round
  first.block =
      R"(byteOffset="0" blockOffset="4" blockSize="6" length="3" valueType="eFloat32Usi")";
  second.block = R"(byteOffset="4" blockOffset="4" blockSize="6" length="3" valueType="eInt16Usi")";
  check(first, second);
}

TEST(Tdm, ScalesRawNumbers) {
  TdmChannel channel;
  channel.block = R"(byteOffset="0" length="3" valueType="eInt16Usi")";
  channel.attributes = increment(1);
  const auto scaled = [&](const std::string& representation, const std::string& parameters) {
    channel.representation = representation;
    channel.parameters = parameters;
    return imported_shot(tdm_header({{"G", {channel}}}),
                         bytes_of_numbers(std::vector<std::int16_t>{0, 1, -2}));
  };
  // as an imc device's counts in a file of DIAdem 2020
  const Record linear = scaled("raw_linear", "5 -0.25");
  EXPECT_THAT(linear.channels.at(0).values(), ElementsAre(5, 4.75, 5.5));
  EXPECT_EQ(linear.channels[0].scale, -0.25);
  EXPECT_TRUE(std::holds_alternative<std::vector<std::int16_t>>(linear.channels[0].raw));
  EXPECT_THAT(scaled("rawlinear", " 1\n2 ").channels.at(0).values(), ElementsAre(1, 3, -3));
  EXPECT_THAT(scaled("raw_linear_external", "1 2").channels.at(0).values(), ElementsAre(1, 3, -3));
  EXPECT_THAT(scaled("raw_linear_calibrated", "1 2 10").channels.at(0).values(),
              ElementsAre(10, 30, -30));
  EXPECT_THAT(scaled("raw_polynomial", "2 1 0 3").channels.at(0).values(), ElementsAre(1, 4, 13));
  const Record without = scaled("raw_linear", "1");
  EXPECT_THAT(without.channels.at(0).values(), ElementsAre(0, 1, -2));
  EXPECT_THAT(without.warnings, ElementsAre("'F' is read unscaled, without its unit 'N': its scale "
                                            "0 states no Linear_Slope"));
  EXPECT_EQ(scaled("raw_polynomial", "-1 2").channels.at(0).unit, "");
}

// DIAdem keeps first number and step in the file of samples; other writers state them.
TEST(Tdm, TakesACourseOfNumbersForTheClock) {
  TdmChannel times{"Zeit", "ms", R"(byteOffset="24" length="2" valueType="eFloat64Usi")",
                   "implicit_linear"};
  TdmChannel force;
  const std::string samples = doubles({7, 8, 9, -0.2, 0.1});
  const auto check = [&](const Record& record) {
    EXPECT_THAT(names_and_units(record), ElementsAre("Zeit [ms]", "F [N]"));
    EXPECT_THAT(record.channels.at(0).values(), ElementsAre(-0.2, -0.2 + 0.1, -0.2 + 0.2));
    EXPECT_DOUBLE_EQ(record.channels.at(1).clock.start, -0.2e-3);
    EXPECT_NEAR(record.channels[1].clock.interval, 0.1e-3, 1e-19);
    EXPECT_TRUE(record.channels[1].clock.uniform());
    EXPECT_THAT(record.channels[1].values(), ElementsAre(7, 8, 9));
    EXPECT_EQ(record.channels[1].attributes.at("times from"), record.channels[0].name);
  };
  check(imported_shot(tdm_header({{"G", {times, force}}}), samples));
  times.block = "";
  times.parameters = "-0.2 0.1";
  check(imported_shot(tdm_header({{"G", {times, force}}}), samples));
  times.parameters = "";
  times.values = "<f>-0.2</f><f>0.1</f>";
  check(imported_shot(tdm_header({{"G", {times, force}}}), samples));
}

TEST(Tdm, ACourseIsTheClockOfWhatTheFileCutsOffToo) {
  const TdmChannel times{"Time", "s", "", "implicit_linear", "-0.5 0.25"};
  TdmChannel force, acc;
  acc.name = "A";
  acc.block = R"(byteOffset="24" length="3" valueType="eFloat64Usi")";
  const Record record =
      imported_shot(tdm_header({{"G", {times, force, acc}}}), doubles({7, 8, 9, 1}));
  ASSERT_EQ(record.channels.size(), 3U);
  EXPECT_THAT(record.channels[2].values(), ElementsAre(1));
  EXPECT_EQ(record.channels[2].clock.start, -0.5);
  EXPECT_EQ(record.channels[2].clock.interval, 0.25);
  EXPECT_THAT(record.warnings, testing::Contains("'A': the file ends after 1 of 3 samples"));
}

TEST(Tdm, ValuesBesideACourseAreToldOf) {
  TdmChannel course;
  course.representation = "implicit_linear";
  course.parameters = "-0.5 1.5";
  TdmChannel force;
  force.name = "x";
  const Record record = imported_shot(tdm_header({{"G", {course, force}}}), doubles({7, 8, 9}));
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(-0.5, 1, 2.5));
  EXPECT_EQ(record.warnings.at(0),
            "'F' is a course of numbers by its description: 3 values that it has beside are not "
            "read");
}

// A window reads the part of a course that belongs to it.
TEST(Tdm, CoursesAndConstantsAreChannels) {
  TdmChannel course{"Angle", "deg", "", "implicit_linear", "-2000 0.5"};
  TdmChannel constant{"Level", "V", "", "implicit_constant", "3"};
  course.attributes = constant.attributes = increment(1);
  TdmChannel force;
  force.attributes = increment(1);
  const std::string header = tdm_header({{"G", {course, constant, force}}});
  ImportOptions options;
  options.from = 1.0;
  const Record record = imported_shot(header, doubles({7, 8, 9}), options);
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(-1999.5, -1999));
  EXPECT_THAT(record.channels.at(1).values(), ElementsAre(3, 3));
  EXPECT_THAT(record.channels.at(2).values(), ElementsAre(8, 9));
}

TEST(Tdm, AChannelOfTimesGivesThoseOfItsGroup) {
  TdmChannel times{"Time", "s", R"(byteOffset="0" length="3" valueType="eFloat64Usi")"};
  TdmChannel force, other;
  force.block = R"(byteOffset="24" length="3" valueType="eFloat64Usi")";
  other = force;
  const std::string samples = doubles({0.0, 0.5, 0.75, 7, 8, 9});
  Record record = imported_shot(tdm_header({{"G", {times, force}}, {"H", {other}}}), samples);
  EXPECT_THAT(record.channels.at(1).clock.times, ElementsAre(0, 0.5, 0.75));
  EXPECT_EQ(record.channels.at(2).clock.interval, 0.0);
  times.name = "stage";  // by no name, but stated as the independent one
  EXPECT_EQ(
      imported_shot(tdm_header({{"G", {times, force}}}), samples).channels.at(1).clock.interval,
      0.0);
  times.column = "<independent>1</independent>";
  record = imported_shot(tdm_header({{"G", {times, force}}}), samples);
  EXPECT_THAT(record.channels.at(1).clock.times, ElementsAre(0, 0.5, 0.75));
}

// Of files of DIAdem 2020 and LabVIEW: times of day in double precision, and LabVIEW's time stamps.
TEST(Tdm, TimesOfDayBecomeSecondsSinceTheFirst) {
  TdmChannel stamps{"Zeit-abs", "", R"(byteOffset="24" length="2" valueType="eFloat64Usi")",
                    "implicit_linear"};
  stamps.attributes = "<string_attribute name=\"displaytype\"><s>Time</s></string_attribute>";
  TdmChannel force;
  Record record = imported_shot(tdm_header({{"G", {stamps, force}}}),
                                doubles({7, 8, 9, 63781458901.595, 0.005}));
  EXPECT_EQ(record.channels.at(0).attributes.at("first time stamp"), "2021-02-26T07:55:01.595");
  EXPECT_THAT(record.channels[0].values(), ElementsAre(0, 0.005, 0.01));
  EXPECT_EQ(record.channels[0].unit, "s");
  EXPECT_EQ(record.channels.at(1).clock.start, 0.0);
  EXPECT_EQ(record.channels[1].clock.interval, 0.005);

  TdmChannel dates{"Date", "", R"(byteOffset="24" length="3" valueType="eFloat64Usi")"};
  dates.says = "<datatype>DT_DATE</datatype>";
  record = imported_shot(tdm_header({{"G", {dates, force}}}),
                         doubles({7, 8, 9, 63834705468.5, 63834705469.0, 63834705470.0}));
  EXPECT_EQ(record.channels.at(0).attributes.at("first time stamp"), "2022-11-04T14:37:48.5");
  EXPECT_THAT(record.channels.at(1).clock.times, ElementsAre(0, 0.5, 1.5));
}

TEST(Tdm, ReadsTimeStampsOfLabViewInsteadOfItsIncrementOfOne) {
  const auto stamp = [](std::int64_t seconds, std::uint64_t fraction) {
    return tests::bytes_of_number(fraction) + tests::bytes_of_number(seconds);
  };
  TdmChannel times{"Time", "s", R"(byteOffset="24" length="3" valueType="eTimeUsi")"};
  TdmChannel force;
  force.attributes = increment(1);
  TdmGroup group{"Untitled", {times, force}};
  group.attributes = "<string_attribute name=\"wf_xcolumns\"><s>One</s></string_attribute>";
  constexpr std::int64_t begin = std::int64_t{1667572668} + 2082844800;  // 2022-11-04 14:37:48
  constexpr std::uint64_t half = std::uint64_t{1} << 63;
  const Record record =
      imported_shot(tdm_header({group}), doubles({7, 8, 9}) + stamp(begin, half) +
                                             stamp(begin + 1, 0) + stamp(begin + 2, half));
  EXPECT_EQ(record.channels.at(0).attributes.at("first time stamp"), "2022-11-04T14:37:48.5Z");
  EXPECT_THAT(record.channels.at(1).clock.times, ElementsAre(0, 0.5, 2));
}

TEST(Tdm, ChannelsThatStartLaterBeginLater) {
  TdmChannel first, second;
  const auto start = [](const std::string& time) {
    return "<time_attribute name=\"wf_start_time\">" + time + "</time_attribute>";
  };
  first.attributes = increment(0.25) + start("2022-11-04T14:38:05.5");
  second.attributes = increment(0.25) + start("2022-11-04T14:38:05.0");
  second.name = "x";
  const Record record = imported_shot(tdm_header({{"G", {first, second}}}), doubles({7, 8, 9}));
  EXPECT_EQ(record.started, "2022-11-04T14:38:05");
  EXPECT_DOUBLE_EQ(record.channels.at(0).clock.start, 0.5);
  EXPECT_DOUBLE_EQ(record.channels.at(1).clock.start, 0.0);
  first.attributes = increment(0.25) + start("2022-11-04T00:30:00.5+01:00");
  EXPECT_EQ(imported_shot(tdm_header({{"G", {first}}}), doubles({7, 8, 9})).started,
            "2022-11-03T23:30:00.5Z");
}

TEST(Tdm, MarksSamplesThatAreFlagged) {
  TdmChannel force;
  force.attributes = increment(1);
  force.column = "<flags external=\"marks\"/>";
  const std::string marks =
      R"(<block id="marks" byteOffset="24" length="3" valueType="eInt16Usi"/>)";
  const std::string samples = doubles({7, 8, 9});
  const Record record =
      imported_shot(tdm_header({{"G", {force}}}, "", marks),
                    samples + bytes_of_numbers(std::vector<std::int16_t>{15, 0, 15}));
  EXPECT_THAT(record.channels.at(0).valid, ElementsAre(1, 0, 1));
  const Record cut = imported_shot(tdm_header({{"G", {force}}}, "", marks),
                                   samples + bytes_of_numbers(std::vector<std::int16_t>{15, 0}));
  EXPECT_THAT(cut.channels.at(0).valid, IsEmpty());
  EXPECT_THAT(cut.warnings, ElementsAre("'F' has 2 marks of 3 samples: they are not read"));
}

TEST(Tdm, ReadsPackedDescriptionsAndSeveralFiles) {
  TdmChannel force;
  force.attributes = increment(1);
  const std::string header = tdm_header({{"G", {force}}});
  const Record record = imported_shot(tests::packed_tdm(header), doubles({7, 8, 9}));
  EXPECT_EQ(record.provenance.importer, "tdm");
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(7, 8, 9));

  const tests::WrittenFile first(doubles({7, 8, 9}), "_a.tdx");
  const tests::WrittenFile second(doubles({1, 2, 3}), "_b.tdx");
  const auto name = [](const tests::WrittenFile& file) {
    return file.path().substr(file.path().rfind('/') + 1);
  };
  TdmChannel later = force;
  force.attributes += "<time_attribute name=\"wf_start_time\">2022-11-04T14:38:05</time_attribute>";
  later.attributes += "<time_attribute name=\"wf_start_time\">2022-11-04T14:38:07</time_attribute>";
  const tests::WrittenFile file(
      tdm_header({{"G", {later}, "", name(first)}, {"H", {force}, "", name(second)}}), ".tdm");
  const Record both = import_recording(file.path(), {});
  EXPECT_THAT(both.channels.at(0).values(), ElementsAre(7, 8, 9));
  EXPECT_THAT(both.channels.at(1).values(), ElementsAre(1, 2, 3));
  EXPECT_DOUBLE_EQ(both.channels[0].clock.start, 2.0);
  EXPECT_DOUBLE_EQ(both.channels[1].clock.start, 0.0);
  EXPECT_EQ(both.started, "2022-11-04T14:38:05");
  EXPECT_EQ(both.provenance.bytes, tests::bytes_of(file.path()).size() + 48);
}

// Two shots may have the same description: what they were is in the samples.
TEST(Tdm, DescriptionAndSamplesAreBothOfTheProvenance) {
  TdmChannel force;
  force.attributes = increment(1);
  const std::string header = tdm_header({{"G", {force}}});
  for (const std::string_view mark : {"", "\xEF\xBB\xBF"}) {
    const std::string description = std::string(mark) + header;
    const datasets::Provenance one = imported_shot(description, doubles({7, 8, 9})).provenance;
    EXPECT_EQ(one.sha256, datasets::sha256_of(description + doubles({7, 8, 9})));
    EXPECT_EQ(one.bytes, description.size() + 24);
  }
}

}  // namespace
}  // namespace impactrig::acquisition
